"""Landscapes by formula, without construction: heights, water and plants as the spatial checks read them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.canonical import digest_of
from ...worlds.landscape import landscape_path, save_landscape
from ...worlds.spec.terrain import Terrain

__all__ = ["NAME", "axes", "declared", "keep", "patch_of"]

NAME = "land"


def declared(rows: int, cols: int, cell: float) -> Terrain:
    """A terrain of that grid; what it says of layers does not matter here."""
    return Terrain(extent=(cols * cell, rows * cell), cell=cell)


def axes(rows: int, cols: int, cell: float) -> tuple[F64, F64]:
    """x and y of the lattice points [m], shapes (rows, cols)."""
    x, y = ((np.arange(n) - 0.5 * (n - 1)) * cell for n in (cols, rows))
    xx, yy = np.meshgrid(x, y)
    return xx, yy


def keep(
    folder: Path,
    terrain: Terrain,
    height: F64,
    *,
    water: F64 | None = None,
    plants: Sequence[tuple[float, float, float, str]] = (),
) -> None:
    """Write a landscape.

    Args:
        folder: of the world.
        terrain: what it stands for.
        height: [m], shape (rows, cols).
        water: level [m], NaN where there is none.
        plants: x, y, height [m] and shape of each; they stand on the ground.
    """
    rows, cols = height.shape
    shapes = sorted({p[3] for p in plants})
    place = np.array([p[:2] for p in plants], dtype=np.float64).reshape(-1, 2)
    v, u = place[:, 1] / terrain.cell + 0.5 * (rows - 1), place[:, 0] / terrain.cell + 0.5 * (cols - 1)
    arrays: dict[str, Any] = {
        "height": height,
        "water_level": (np.full(height.shape, np.nan) if water is None else water).astype(np.float32),
        "plant_kind": np.array([shapes.index(p[3]) for p in plants], dtype=np.int16),
        "plant_position": np.column_stack([place, _bilinear(height, v, u)]),
        "plant_height": np.array([p[2] for p in plants], dtype=np.float32),
        "plant_radius": np.full(len(plants), 0.1, dtype=np.float32),
        "plant_yaw": np.zeros(len(plants), dtype=np.float32),
    }
    about = {"rows": rows, "cols": cols, "cell": terrain.cell, "plant_shapes": shapes, "species": shapes}
    save_landscape(
        landscape_path(folder, NAME, digest_of(terrain)),
        arrays,
        {**about, "terrain": digest_of(terrain), "lakes": [], "reaches": []},
    )


def _bilinear(height: F64, v: F64, u: F64) -> F64:
    from scipy import ndimage

    return np.asarray(ndimage.map_coordinates(height, np.stack([v, u]), order=1, mode="nearest"))


def patch_of(
    height: F64, cell: float, low: tuple[int, int], high: tuple[int, int]
) -> tuple[list[list[float]], tuple[float, float], tuple[float, float]]:
    """Heights, size and centre of the ground between two lattice points (row, column)."""
    part = height[low[0] : high[0] + 1, low[1] : high[1] + 1]
    middle = [0.5 * (low[k] + high[k]) - 0.5 * (height.shape[k] - 1) for k in (1, 0)]
    size = (high[1] - low[1]) * cell, (high[0] - low[0]) * cell
    return part.tolist(), size, (middle[0] * cell, middle[1] * cell)
