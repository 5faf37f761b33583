"""Checks of elastic bodies."""
