"""Layers of pictures: one per category of matter, found in `registry.py`."""
