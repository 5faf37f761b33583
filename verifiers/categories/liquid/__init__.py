"""Checks of liquids."""
