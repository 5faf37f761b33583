"""Breakable bodies in specifications."""
