"""Small landscapes for the tests."""

from __future__ import annotations

import numpy as np
from worldagent.construction.terrain.grid import Grid
from worldagent.construction.terrain.noise import fractal


def rough_land(
    rows: int = 96, cols: int = 120, *, cell: float = 10.0, seed: int = 3, tilt: float = 0.03
) -> tuple[Grid, np.ndarray]:
    """Fractal relief of some hundred metres with depressions, on a tilted plane."""
    grid = Grid(rows, cols, cell)
    x, y = grid.points()
    relief = 120 * fractal(x, y, wavelength=400, octaves=6, gain=0.55, seed=seed, cell=cell)
    return grid, relief + tilt * x


def pit_land(depth: float = 10.0, radius: float = 40.0, *, cell: float = 1.0) -> tuple[Grid, np.ndarray]:
    """A cone-shaped pit in a plane that falls gently to the east, away from which nothing rises."""
    grid = Grid(141, 161, cell)
    x, y = grid.points()
    return grid, -depth * np.clip(1 - np.hypot(x, y) / radius, 0, 1) - 1e-6 * x
