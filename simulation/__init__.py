"""Floor 4: scene to motion."""
