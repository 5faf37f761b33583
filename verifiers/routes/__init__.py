"""Navigability: ways that walkers, carriers and fluids can take."""
