"""Floor 1: plain data of a world. No physics, no heavy import."""
