"""Checks of rigid bodies."""
