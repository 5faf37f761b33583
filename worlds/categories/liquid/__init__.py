"""Liquids in specifications."""
