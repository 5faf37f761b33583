"""The judge of balloons."""
