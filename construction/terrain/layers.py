"""Layers of height: each takes the land so far and gives the land after it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy import ndimage

from ...worlds.arrays import F64
from ...worlds.errors import InputError
from ...worlds.spec import terrain as spec
from . import noise
from .dem import read_dem
from .grid import Grid
from .meanders import winding
from .zones import along, declared_zone, inside_weight, zone_distance

__all__ = ["is_late", "shape_land"]

LEAST_TILT = 0.03
"""Slope of a floor towards the course that winds over it, beside twice its fall: else water takes the straight way."""
STOSS_SHARE = 0.75
"""Windward part of a dune's length: with it the lee side of a usual dune (height : spacing = 1 : 10) stands at 22 to 33 deg."""


def shape_land(grid: Grid, terrain: spec.Terrain, assets: Path, *, after: F64 | None = None) -> F64:
    """Height of the land [m], shape (rows, cols); NaN where a DEM has no data.

    Before erosion: of all layers that are not late. With `after`, the eroded land: with the late layers worked into it.

    Raises:
        InputError: a layer names an unknown zone or a file that cannot be used.
    """
    height = np.full(grid.shape, float(terrain.datum)) if after is None else after
    for name, layer in sorted(terrain.layers.items(), key=lambda item: (item[1].order, item[0])):
        if is_late(layer) != (after is not None):
            continue
        try:
            made = _LAYERS[layer.kind](grid, height, layer, terrain, assets)
            height = _blend(grid, height, made, layer, terrain)
        except InputError as error:
            raise InputError(f"layer {name!r}: {error}") from error
    return height


def is_late(layer: spec.Layer) -> bool:
    """True if a layer is worked into the land after erosion."""
    return layer.kind in ("flatten", "road") if layer.late is None else layer.late


def _blend(grid: Grid, before: F64, after: F64, layer: Any, terrain: spec.Terrain) -> F64:
    if layer.zone is None or layer.kind in ("mesa", "flatten"):
        return after
    weight = inside_weight(zone_distance(grid, declared_zone(terrain, layer.zone)), layer.falloff)
    return np.asarray(before + weight * (after - before))


def _noise(grid: Grid, height: F64, layer: spec.Noise, terrain: spec.Terrain, assets: Path) -> F64:
    x, y = grid.points()
    seed = terrain.seed * 1009 + layer.seed
    if layer.warp > 0:
        x, y = noise.warped(x, y, wavelength=layer.wavelength / 2, strength=layer.warp, seed=seed)
    kinds = {"fbm": noise.fractal, "ridged": noise.ridged, "billow": noise.billow}
    made = kinds[layer.style](
        x, y, wavelength=layer.wavelength, octaves=layer.octaves, gain=layer.gain, seed=seed, cell=grid.cell
    )
    return np.asarray(height + layer.amplitude * made)


def _ramp(grid: Grid, height: F64, layer: spec.Ramp, terrain: spec.Terrain, assets: Path) -> F64:
    x, y = grid.points()
    angle = np.radians(layer.direction_deg)
    reach = abs(np.cos(angle)) * grid.extent[0] + abs(np.sin(angle)) * grid.extent[1]
    return np.asarray(height + layer.rise * (0.5 + (x * np.cos(angle) + y * np.sin(angle)) / reach))


def _outline(x: F64, y: F64, center: tuple[float, float], radius: float, irregularity: float, seed: int) -> F64:
    """Distance from the centre over the radius of a wavy outline."""
    dx, dy = x - center[0], y - center[1]
    away = np.hypot(dx, dy)
    # Noise along a circle around the origin of its own plane: closed and the same at every distance.
    unit = np.maximum(away, 1e-9)
    wave = noise.fractal(
        dx / unit * radius, dy / unit * radius, wavelength=1.3 * radius, octaves=5, gain=0.5, seed=seed, cell=radius / 64
    )
    return np.asarray(away / (radius * np.maximum(1.0 + 2.0 * irregularity * wave, 0.2)))


def _cone(grid: Grid, height: F64, layer: spec.Cone, terrain: spec.Terrain, assets: Path) -> F64:
    x, y = grid.points()
    out = _outline(x, y, layer.center, layer.radius, layer.irregularity, terrain.seed * 1009 + layer.seed)
    return np.asarray(height + layer.height * np.clip(1.0 - out, 0.0, 1.0) ** layer.steepness)


def _crater(grid: Grid, height: F64, layer: spec.Crater, terrain: spec.Terrain, assets: Path) -> F64:
    x, y = grid.points()
    dx, dy = x - layer.center[0], y - layer.center[1]
    out = np.hypot(dx, dy) / layer.radius
    ring = np.abs(out - 1.0) <= 0.1
    top = float(np.median(height[ring])) if ring.any() else float(height[grid.indices(*np.array(layer.center))])
    rim = top + layer.rim
    t = np.clip((out - layer.floor) / (1.0 - layer.floor), 0.0, 1.0)
    bowl = rim - layer.depth + layer.depth * t * t * (3 - 2 * t)
    outside = np.clip((out - 1.0) / 0.6, 0.0, 1.0)
    skirt = height + (np.maximum(rim - height, 0.0)) * (1 - outside) ** 2 * (out < 1.6)
    made = np.where(out <= 1.0, bowl, np.maximum(height, skirt) if layer.rim > 0 else height)
    if layer.breach_deg is None:
        return np.asarray(made)
    turn = np.arctan2(dy, dx) - np.radians(layer.breach_deg)
    off = np.abs((turn + np.pi) % (2 * np.pi) - np.pi)
    notch = np.clip(1.0 - off / 0.25, 0.0, 1.0) * (out > layer.floor) * (out < 1.8)
    lowest = rim - 0.5 * layer.depth
    return np.asarray(np.where(notch > 0, np.minimum(made, made + notch * (np.minimum(lowest, made) - made)), made))


def _mesa(grid: Grid, height: F64, layer: spec.Mesa, terrain: spec.Terrain, assets: Path) -> F64:
    if layer.zone is None:
        raise InputError("a mesa needs the zone of its top; add one to /terrains/<id>/zones")
    distance = zone_distance(grid, declared_zone(terrain, layer.zone))
    weight = inside_weight(distance, layer.cliff)
    level = float(np.nanmean(height[distance <= 0])) if (distance <= 0).any() else 0.0
    top = np.maximum(height, level + layer.height) if layer.height > 0 else np.minimum(height, level + layer.height)
    return np.asarray(height + weight * (top - height))


def _dunes(grid: Grid, height: F64, layer: spec.Dunes, terrain: spec.Terrain, assets: Path) -> F64:
    x, y = grid.points()
    seed = terrain.seed * 1009 + layer.seed
    angle = np.radians(layer.wind_deg)
    wave = noise.fractal(x, y, wavelength=6 * layer.spacing, octaves=3, gain=0.5, seed=seed, cell=grid.cell)
    down = (x * np.cos(angle) + y * np.sin(angle)) / layer.spacing + 0.8 * wave
    phase = down % 1.0
    rise = np.clip(phase / STOSS_SHARE, 0.0, 1.0)
    fall = np.clip((1.0 - phase) / (1.0 - STOSS_SHARE), 0.0, 1.0)
    profile = np.where(phase < STOSS_SHARE, rise * rise * (3 - 2 * rise), fall)
    strength = 0.6 + 0.4 * noise.fractal(x, y, wavelength=4 * layer.spacing, octaves=2, gain=0.5, seed=seed + 5, cell=grid.cell)
    return np.asarray(height + layer.height * profile * np.clip(strength, 0.1, 1.0))


def _ridge(grid: Grid, height: F64, layer: spec.Ridge, terrain: spec.Terrain, assets: Path) -> F64:
    away, _, _ = along(grid, np.array(layer.line))
    t = np.clip(1.0 - away / (0.5 * layer.width), 0.0, 1.0)
    return np.asarray(height + layer.height * t * t * (3 - 2 * t))


def _valley(grid: Grid, height: F64, layer: spec.Valley, terrain: spec.Terrain, assets: Path) -> F64:
    line = np.array(layer.line)
    away, passed, _ = along(grid, line)
    start = float(grid.sample(np.nan_to_num(height), line[:1, 0], line[:1, 1])[0])
    floor = start - layer.depth - passed * layer.fall
    t = np.clip((away / (0.5 * layer.width) - layer.floor) / (1.0 - layer.floor), 0.0, 1.0)
    if layer.sinuosity > 1:
        floor = start - layer.depth + _winding_floor(grid, layer)
    wall = t * t * (3 - 2 * t) if layer.walls == "smooth" else np.floor(4 * t + 0.5 * t * t) / 4.5 + 0.1 * t
    made = floor + np.clip(wall, 0.0, 1.0) * (height - floor)
    return np.where(away < 0.5 * layer.width, np.minimum(height, made), height)


def _winding_floor(grid: Grid, layer: spec.Valley) -> F64:
    """Height of the floor over its first point [m]: it falls along a winding course and towards it."""
    line, half = np.array(layer.line), 0.5 * layer.width * layer.floor
    away, passed, _ = along(grid, winding(line, sinuosity=layer.sinuosity, half_floor=half, cell=grid.cell))
    steep = LEAST_TILT + 2.0 * layer.fall / float(np.hypot(*np.diff(line, axis=0).T).sum())
    return np.asarray(-passed * layer.fall + steep * np.minimum(away, half))


def _coast(grid: Grid, height: F64, layer: spec.Coast, terrain: spec.Terrain, assets: Path) -> F64:
    if terrain.sea_level is None:
        raise InputError("a coast needs /terrains/<id>/sea_level")
    away, _, side = along(grid, np.array(layer.line))
    offshore = np.clip(-side * away / layer.shelf, 0.0, 1.0)
    bottom = terrain.sea_level - layer.depth * offshore
    weight = offshore**0.3 * (side < 0)
    return np.asarray(height + weight * (np.minimum(height, bottom) - height))


def _flatten(grid: Grid, height: F64, layer: spec.Flatten, terrain: spec.Terrain, assets: Path) -> F64:
    if layer.zone is None:
        raise InputError("flatten needs a zone; add one to /terrains/<id>/zones")
    distance = zone_distance(grid, declared_zone(terrain, layer.zone))
    if not (distance <= 0).any():
        raise InputError(
            f"zone {layer.zone!r} holds no cell of the grid; make it larger than {grid.cell:g} m or move it into the extent"
        )
    level = float(np.nanmean(height[distance <= 0])) if layer.height is None else layer.height
    return np.asarray(height + inside_weight(distance, layer.falloff) * (level - height))


def _road(grid: Grid, height: F64, layer: spec.Road, terrain: spec.Terrain, assets: Path) -> F64:
    line = np.array(layer.line)
    away, passed, _ = along(grid, line)
    length = float(np.hypot(*np.diff(line, axis=0).T).sum())
    stations = np.linspace(0.0, 1.0, max(16, int(length / grid.cell)) + 1)
    corner = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))]) / max(length, 1e-12)
    ground = grid.sample(np.nan_to_num(height), np.interp(stations, corner, line[:, 0]), np.interp(stations, corner, line[:, 1]))
    step = layer.grade * length / (len(stations) - 1)
    # Highest profile below and lowest above the ground that keep the grade; their mean splits cut and fill.
    below, above = ground.copy(), ground.copy()
    for k in range(1, len(below)):
        below[k], above[k] = min(below[k], below[k - 1] + step), max(above[k], above[k - 1] - step)
    for k in range(len(below) - 2, -1, -1):
        below[k], above[k] = min(below[k], below[k + 1] + step), max(above[k], above[k + 1] - step)
    bed = np.interp(passed, stations, ndimage.gaussian_filter1d(0.5 * (below + above), 2.0, mode="nearest"))
    return np.asarray(height + inside_weight(away - 0.5 * layer.width, layer.falloff or layer.width) * (bed - height))


def _dem(grid: Grid, height: F64, layer: spec.Dem, terrain: spec.Terrain, assets: Path) -> F64:
    return height + read_dem(grid, layer, assets)


_LAYERS: Mapping[str, Callable[[Grid, F64, Any, spec.Terrain, Path], F64]] = {
    "noise": _noise,
    "ramp": _ramp,
    "cone": _cone,
    "crater": _crater,
    "mesa": _mesa,
    "dunes": _dunes,
    "ridge": _ridge,
    "valley": _valley,
    "coast": _coast,
    "flatten": _flatten,
    "road": _road,
    "dem": _dem,
}
