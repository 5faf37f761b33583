"""The engine of balloons."""
