"""Rigid bodies in specifications."""
