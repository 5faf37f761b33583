"""Grains and flying particles in pictures."""
