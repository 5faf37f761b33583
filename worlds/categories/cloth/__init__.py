"""Cloth in specifications."""
