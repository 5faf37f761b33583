"""Balloons in specifications."""
