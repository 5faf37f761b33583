"""Parametric generators of things."""
