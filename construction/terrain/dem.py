"""Measured heights from files: GeoTIFF, 16-bit PNG, npy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy import ndimage

from ...worlds.arrays import F64
from ...worlds.errors import InputError
from ...worlds.folder import safe_join
from ...worlds.limits import check_cap
from ...worlds.spec.terrain import Dem
from .grid import Grid

__all__ = ["read_dem"]

MAX_FILE_BYTES = 600_000_000
TAG_PIXEL_SCALE, TAG_NO_DATA = 33550, 42113
"""GeoTIFF ModelPixelScale and GDAL_NODATA."""


def read_dem(grid: Grid, layer: Dem, assets: Path) -> F64:
    """Heights of a file on the grid [m]; NaN where it has none and `holes` is `keep`.

    Raises:
        InputError: there is no such file, it cannot be read, is no single band, or has holes.
    """
    path = safe_join(assets, layer.file)
    if not path.is_file():
        raise InputError(f"there is no file {layer.file!r} in the world's assets/ folder; put it there first")
    if path.stat().st_size > MAX_FILE_BYTES:
        raise InputError(f"{layer.file!r} has {path.stat().st_size:,} bytes, at most {MAX_FILE_BYTES:,}; crop it first")
    raw, cell = _read(path)
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


def _read(path: Path) -> tuple[F64, float | None]:
    """Values, NaN where the file says no data, and the side of a cell [m] where it says so."""
    try:
        if path.suffix == ".npy":
            return np.load(path, allow_pickle=False), None
        if path.suffix == ".npz":
            with np.load(path, allow_pickle=False) as found:
                name = "elevation" if "elevation" in found else found.files[0]
                return found[name], None
        import cv2

        image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        if image is None:
            raise ValueError("no picture in it")
        return _geotiff(path, image) if path.suffix in (".tif", ".tiff") else (image, None)
    except (ValueError, OSError, KeyError, IndexError, EOFError) as error:
        raise InputError(
            f"{path.name!r} cannot be read as a DEM: {error}; use a single-band GeoTIFF, 16-bit PNG or npy"
        ) from error


def _geotiff(path: Path, image: F64) -> tuple[F64, float | None]:
    import tifffile

    with tifffile.TiffFile(path) as file:
        tags = file.pages.first.tags
        scale = tags.get(TAG_PIXEL_SCALE)
        empty = tags.get(TAG_NO_DATA)
        values = image.astype(np.float64)
        if empty is not None:
            values[values == float(str(empty.value).strip("\x00 "))] = np.nan
        size = None if scale is None else float(scale.value[0])
    # Degrees, not metres: a geographic file says nothing usable about cell size.
    return values, size if size is not None and size > 0.05 else None


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
