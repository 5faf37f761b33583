"""Checks of breakable bodies."""
