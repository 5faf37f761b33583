"""Landscapes of a world on disk: built once per recipe, kept, reused."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...geometry import watercourses
from ...worlds.arrays import F64
from ...worlds.canonical import digest_of, source_digest
from ...worlds.errors import EvidenceError, InputError
from ...worlds.folder import WorldFolder, safe_join, write_atomically
from ...worlds.landscape import SavedLandscape, landscape_path, save_landscape
from ...worlds.limits import HEIGHT_ROWS
from ...worlds.provenance import landscape_digest
from ...worlds.slices import MOTION_VERSION
from ...worlds.spec import WorldSpec
from ...worlds.spec.terrain import Terrain
from .clearings import outlines_of
from .grid import Grid
from .landscape import Landscape, build_landscape

__all__ = ["GroundPatch", "build_terrain_file", "cut_patch", "terrain_recipe"]


class GroundPatch(NamedTuple):
    """A part of a landscape as a collision height field."""

    file: str
    """Name in the world's `assets/` folder."""
    digest: str
    size: tuple[float, float]
    low: float
    high: float
    deviation: float
    """Largest difference from the landscape at cell centres and between [m]."""


def terrain_recipe(folder: WorldFolder, spec: WorldSpec, name: str) -> str:
    """Hash of all that a landscape derives from: its slice, DEM files, this folder's source and the numerical libraries.

    Raises:
        InputError: there is no such terrain.
    """
    terrain = _terrain(spec, name)
    files: dict[str, str] = {}
    for layer in terrain.layers.values():
        if layer.kind == "dem":
            path = safe_join(folder.assets, layer.file)
            files[layer.file] = hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else "missing"
    versions = {package: version(package) for package in ("numpy", "scipy", "numba", "warp-lang")}
    source = source_digest(Path(__file__).parent), hashlib.sha256(Path(watercourses.__file__).read_bytes()).hexdigest()
    return digest_of(MOTION_VERSION, landscape_digest(spec, name), files, source, versions)


def build_terrain_file(
    folder: WorldFolder, spec: WorldSpec, name: str, *, say: Callable[[float, str], None] = lambda done, text: None
) -> tuple[SavedLandscape, bool]:
    """The landscape of a terrain, built now if its recipe has no file yet; and whether it was.

    Raises:
        InputError: the terrain cannot be built.
        LimitError: it is too large.
    """
    path = landscape_path(folder.root, name, terrain_recipe(folder, spec, name))
    saved = SavedLandscape(path)
    if path.is_file():
        try:
            _ = saved.about
        except EvidenceError:
            path.unlink(missing_ok=True)  # another process may find it damaged, too
        else:
            return saved, False
    terrain = _terrain(spec, name)
    land = build_landscape(terrain, folder.assets, outlines=outlines_of(spec, terrain, folder.assets), say=say)
    save_landscape(path, _arrays(land), {**_about(land), "terrain": landscape_digest(spec, name)})
    return SavedLandscape(path), True


def cut_patch(
    folder: WorldFolder, name: str, land: SavedLandscape, *, center: tuple[float, float], size: tuple[float, float], cells: int
) -> GroundPatch:
    """Write a part of a landscape as a height file in `assets/`.

    Args:
        folder: the world.
        name: of the terrain.
        land: its landscape.
        center: of the patch [m].
        size: of the patch x, y [m].
        cells: along the longer side.

    Raises:
        InputError: the patch leaves the landscape, or holds cells without land.
    """
    grid = Grid(*land.shape, land.cell)
    for axis in (0, 1):
        if abs(center[axis]) + size[axis] / 2 > grid.extent[axis] / 2 + 1e-9:
            raise InputError(
                f"a patch of {size[0]:g} x {size[1]:g} m at {center} leaves the landscape of {grid.extent[0]:g} x {grid.extent[1]:g} m; "
                "make it smaller or move it"
            )
    height = land.field("height")
    counts = [min(HEIGHT_ROWS, max(2, round(cells * s / max(size)) + 1)) for s in size]
    x = center[0] + np.linspace(-size[0] / 2, size[0] / 2, counts[0])
    y = center[1] + np.linspace(-size[1] / 2, size[1] / 2, counts[1])
    found = grid.sample(height, *np.meshgrid(x, y))
    if not np.isfinite(found).all():
        raise InputError(f"the patch at {center} holds places without land; move it, or let the DEM layer fill its holes")
    # What the solver gets is what is drawn and judged, so that no rounding stands between them.
    found = found.astype(np.float32).astype(np.float64)
    buffer = io.BytesIO()
    np.save(buffer, found)
    data = buffer.getvalue()
    digest = hashlib.sha256(data).hexdigest()
    file = f"{name}-{digest[:12]}.npy"
    write_atomically(folder.assets / file, data)
    return GroundPatch(
        file,
        digest,
        (float(size[0]), float(size[1])),
        float(found.min()),
        float(found.max()),
        _deviation(grid, height, x, y, found),
    )


def _deviation(grid: Grid, height: F64, x: F64, y: F64, patch: F64) -> float:
    """Largest vertical distance between patch and landscape at the landscape's cell centres inside the patch [m]."""
    from scipy.interpolate import RegularGridInterpolator

    east, north = grid.axes()
    cols, rows = (east >= x[0]) & (east <= x[-1]), (north >= y[0]) & (north <= y[-1])
    if not cols.any() or not rows.any():
        return 0.0
    there = np.stack(np.meshgrid(north[rows], east[cols], indexing="ij"), axis=-1)
    ours = RegularGridInterpolator((y, x), patch)(there)
    return float(np.abs(ours - height[np.ix_(rows, cols)]).max())


def _terrain(spec: WorldSpec, name: str) -> Terrain:
    if name not in spec.terrains:
        raise InputError(
            f"there is no terrain {name!r}; the world has {sorted(spec.terrains)}. Add /terrains/{name} with edit_spec"
        )
    return spec.terrains[name]


def _arrays(land: Landscape) -> dict[str, Any]:
    arrays: dict[str, Any] = {k: v.astype(np.float32) for k, v in land.fields.items() if k not in ("east", "north")}
    # Heights and what must close to the last cell stay exact.
    arrays |= {
        k: land.fields[k]
        for k in ("height", "ground", "filled", "accumulation", "start", "uplift", "earthworks", "wear", "deposit")
    }
    none = np.isnan(land.fields["start"])
    if none.any():
        arrays |= {k: np.where(none, np.nan, arrays[k]) for k in ("height", "ground", "bedrock")}
    arrays |= {
        "flow_direction": land.drainage.directions(),
        "basin": land.drainage.basins(),
        "lake": land.water.lake,
        "sea": land.water.sea,
        "wet": land.wet,
        "bed": land.channels.bed,
        "water_level": land.water_level.astype(np.float32),
        "cover": land.cover.index,
    }
    if land.plants is not None:
        plants = land.plants
        arrays |= {
            "plant_kind": plants.kind,
            "plant_position": plants.position,
            "plant_height": plants.height.astype(np.float32),
            "plant_radius": plants.radius.astype(np.float32),
            "plant_yaw": plants.yaw.astype(np.float32),
        }
    return arrays


def _about(land: Landscape) -> dict[str, Any]:
    return {
        "rows": land.grid.rows,
        "cols": land.grid.cols,
        "cell": land.grid.cell,
        "lakes": [
            {
                "number": lake.number,
                "level": lake.level,
                "area": lake.area,
                "volume": lake.volume,
                "depth": lake.depth,
                "contributing_area": lake.contributing_area,
                "outlet": list(land.grid.place(lake.outlet)),
            }
            for lake in land.water.lakes
        ],
        "reaches": [
            {
                "number": river.number,
                "kind": river.kind,
                "order": river.order,
                "ends_in": river.ends_in,
                "cells": river.cells.tolist(),
                "width": [float(river.width[0]), float(river.width[-1])],
                "depth": [float(river.depth[0]), float(river.depth[-1])],
                "discharge": [float(river.discharge[0]), float(river.discharge[-1])],
            }
            for river in land.water.rivers
        ],
        "cover": list(land.cover.names),
        "species": list(land.plants.species) if land.plants is not None else [],
        "plant_shapes": list(land.plants.shapes) if land.plants is not None else [],
        "figures": land.figures,
    }
