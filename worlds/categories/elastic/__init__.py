"""Elastic bodies in specifications."""
