"""Grains by the discrete element method, and particles that fly alone (R65)."""
