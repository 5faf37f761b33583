"""Checks of gas."""
