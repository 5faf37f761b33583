"""Geometry at frame 0: sizes, masses, overlap, relations, declared state."""
