"""Grains and flying particles in specifications."""
