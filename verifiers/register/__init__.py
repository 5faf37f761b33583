"""The approximation register."""
