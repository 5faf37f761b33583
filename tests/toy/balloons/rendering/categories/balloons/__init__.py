"""Balloons in pictures."""
