"""Measured heights from files: GeoTIFF, 16-bit PNG, npy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy import ndimage

from ...worlds.arrays import F64
from ...worlds.errors import InputError
from ...worlds.limits import check_cap
from ...worlds.spec.terrain import Dem
from ..outside import arrays_of
from .grid import Grid

__all__ = ["read_dem"]


def read_dem(grid: Grid, layer: Dem, assets: Path) -> F64:
    """Heights of a file on the grid [m]; NaN where it has none and `holes` is `keep`.

    Raises:
        InputError: there is no such file, it cannot be read, is no single band, or has holes.
    """
    found = arrays_of("dem", assets, layer.file, "dem_bytes")
    raw, cell = found["values"], float(found["cell"]) if "cell" in found else None
    if raw.dtype.kind not in "iuf":
        raise InputError(f"{layer.file!r} holds {raw.dtype} values; a DEM holds numbers")
    if raw.ndim != 2 or min(raw.shape) < 2:
        raise InputError(f"{layer.file!r} has shape {raw.shape}; a DEM is one band of at least 2 x 2 cells")
    check_cap("cells", raw.size, what=f"the file {layer.file}")
    values = raw.astype(np.float64) * layer.scale + layer.offset
    values = np.flipud(values)  # files begin in the north
    missing = ~np.isfinite(values)
    if missing.all():
        raise InputError(f"{layer.file!r} holds no finite height")
    if missing.any() and layer.holes == "refuse":
        raise InputError(
            f"{layer.file!r} has {int(missing.sum()):,} cells without data ({missing.mean():.1%}); set holes to 'fill' (interpolate) "
            "or 'keep' (no land there)"
        )
    if np.ptp(values[~missing]) == 0 and values.size > 4:
        raise InputError(f"{layer.file!r} is flat: every height is {values[~missing][0]:g} m; check scale and the file's units")
    if missing.any():
        nearest = ndimage.distance_transform_edt(missing, return_distances=False, return_indices=True)
        values = values[tuple(nearest)]
    return _resampled(grid, values, missing, layer.cell or cell, keep=layer.holes == "keep")


def _resampled(grid: Grid, values: F64, missing: np.ndarray, cell: float | None, *, keep: bool) -> F64:
    rows, cols = values.shape
    width = cols * cell if cell else grid.extent[0]
    depth = rows * cell if cell else grid.extent[1]
    if cell and (width < grid.extent[0] - cell or depth < grid.extent[1] - cell):
        raise InputError(
            f"the file covers {width:g} x {depth:g} m, the terrain {grid.extent[0]:g} x {grid.extent[1]:g} m; make the extent smaller or "
            "leave out cell to stretch the file"
        )
    x, y = grid.axes()
    u = np.clip((x / width + 0.5) * cols - 0.5, 0, cols - 1)
    v = np.clip((y / depth + 0.5) * rows - 0.5, 0, rows - 1)
    step = max(cols * grid.cell / width, rows * grid.cell / depth)
    source = ndimage.gaussian_filter(values, 0.5 * (step - 1), mode="nearest") if step > 1.5 else values
    places = np.meshgrid(v, u, indexing="ij")
    found = ndimage.map_coordinates(source, places, order=1, mode="nearest")
    if keep and missing.any():
        gone = ndimage.map_coordinates(missing.astype(np.float64), places, order=1, mode="nearest") > 0.5
        found = np.where(gone, np.nan, found)
    return np.asarray(found)
