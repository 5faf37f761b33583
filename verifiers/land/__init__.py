"""Landscapes: terrain, drainage, grounds."""
