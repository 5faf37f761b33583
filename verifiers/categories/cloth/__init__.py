"""Checks of cloth."""
