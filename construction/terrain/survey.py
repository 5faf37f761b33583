"""Questions about a built landscape: what is at a place, along a line, and where the nearest flat, dry or wet place is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy import ndimage

from ...geometry.watercourses import centre_line
from ...worlds.arrays import F64
from ...worlds.errors import InputError
from ...worlds.landscape import SavedLandscape
from .grid import Grid

__all__ = ["at_points", "flat_places", "river_places", "river_station", "shore_places", "water_at"]

LEVEL = 0.1
"""Slope up to which a place counts as flat: one in ten can be built on and stood upon."""
EIGHT = np.ones((3, 3), dtype=bool)


def _grid(land: SavedLandscape) -> Grid:
    return Grid(*land.shape, land.cell)


def _checked(grid: Grid, points: F64) -> None:
    half = 0.5 * np.array(grid.extent)
    outside = (np.abs(points) > half).any(1)
    if outside.any():
        raise InputError(
            f"point {points[outside][0].tolist()} lies outside the landscape; x is within +-{half[0]:g} m, y within +-{half[1]:g} m"
        )


def _levels(land: SavedLandscape, sea_level: float | None) -> F64:
    """Surface of all water [m], NaN where it is dry."""
    level = land.field("water_level")
    return level if sea_level is None else np.where(land.raw("sea").astype(bool), sea_level, level)


def at_points(land: SavedLandscape, points: Sequence[Sequence[float]], *, sea_level: float | None) -> list[dict[str, Any]]:
    """Survey of each point (x, y) [m]: heights, slope, normal, cover, water, moisture.

    Raises:
        InputError: a point lies outside the landscape.
    """
    grid, at = _grid(land), np.array(points, dtype=np.float64).reshape(-1, 2)
    _checked(grid, at)
    row, col = grid.indices(at[:, 0], at[:, 1])
    height = land.field("height")
    east, north = (np.gradient(height, land.cell, axis=a) for a in (1, 0))
    ground, dx, dy = (grid.sample(f, at[:, 0], at[:, 1]) for f in (height, east, north))
    normal = np.stack([-dx, -dy, np.ones(len(at))], 1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    kinds, level = _water_kind(land), _levels(land, sea_level)
    moisture, soil, away = land.field("moisture"), land.field("soil_depth"), land.field("water_distance")
    cover = land.raw("cover")
    found: list[dict[str, Any]] = []
    for k, (r, c) in enumerate(zip(row.tolist(), col.tolist(), strict=True)):
        told: dict[str, Any] = {"at": at[k].round(2).tolist()}
        if not np.isfinite(ground[k]):
            found.append({**told, "land": False})
            continue
        told |= {
            "height": round(float(ground[k]), 2), "slope": round(float(np.hypot(dx[k], dy[k])), 3),
            "normal": normal[k].round(3).tolist(), "cover": land.about["cover"][int(cover[r, c])],
            "moisture": round(float(moisture[r, c]), 2), "soil_depth": round(float(soil[r, c]), 2),
        }  # fmt: skip
        if kinds[r, c]:
            surface = float(level[r, c]) if np.isfinite(level[r, c]) else float(ground[k])
            told |= {"water": WATERS[kinds[r, c]], "water_level": round(surface, 2)}
            told["water_depth"] = round(max(surface - float(ground[k]), 0.0), 2)
        elif np.isfinite(away[r, c]):
            told["water_distance"] = round(float(away[r, c]), 1)
        found.append(told)
    return found


WATERS = ("", "sea", "lake", "river")


def _water_kind(land: SavedLandscape) -> np.ndarray:
    """Index into `WATERS` per cell; beds of rivers count as rivers."""
    kinds = np.zeros(land.shape, dtype=np.int8)
    kinds[land.raw("bed").astype(bool) | land.raw("wet").astype(bool)] = 3
    kinds[land.raw("lake") > 0] = 2
    kinds[land.raw("sea").astype(bool)] = 1
    return kinds


def _nearest_apart(grid: Grid, mask: np.ndarray, near: tuple[float, float], apart: float, most: int) -> list[int]:
    """Flat indices of marked cells, nearest first, at least `apart` [m] from each other."""
    cells = np.flatnonzero(mask)
    x, y = (cells % grid.cols - 0.5 * (grid.cols - 1)) * grid.cell, (cells // grid.cols - 0.5 * (grid.rows - 1)) * grid.cell
    order = np.argsort(np.hypot(x - near[0], y - near[1]), kind="stable")
    cells, x, y = cells[order], x[order], y[order]
    found: list[int] = []
    while len(cells) and len(found) < most:
        found.append(int(cells[0]))
        far = np.hypot(x - x[0], y - y[0]) >= apart
        cells, x, y = cells[far], x[far], y[far]
    return found


def flat_places(
    land: SavedLandscape, *, size: float, near: tuple[float, float], most: int = 10
) -> tuple[list[dict[str, Any]], float]:
    """Dry squares of a size that are flat, nearest first; where there is none, the flattest.

    Args:
        land: the landscape.
        size: side of the square [m].
        near: where the search begins [m].
        most: how many.

    Returns:
        the places, and the slope up to which they count as flat: 0.1, or more where nothing is so flat.

    Raises:
        InputError: no dry square of this size is there.
    """
    grid = _grid(land)
    height, slope = land.field("height"), land.field("slope")
    dry = (_water_kind(land) == 0) & np.isfinite(height)
    cells = max(1, int(np.ceil(size / land.cell)))
    if cells > min(grid.shape):
        raise InputError(f"size {size:g} m is larger than the landscape of {grid.extent[0]:g} x {grid.extent[1]:g} m")
    steepest = ndimage.maximum_filter(np.where(dry, slope, np.inf), cells, mode="constant", cval=np.inf)
    if not np.isfinite(steepest).any():
        raise InputError(f"no dry square of {size:g} m is there; ask for a smaller size")
    limit = max(LEVEL, float(np.percentile(steepest[np.isfinite(steepest)], 1)) if not (steepest <= LEVEL).any() else LEVEL)
    solid = np.nan_to_num(height)
    high, low = ndimage.maximum_filter(solid, cells), ndimage.minimum_filter(solid, cells)
    away = land.field("water_distance")
    found = []
    for index in _nearest_apart(grid, steepest <= limit, near, size, most):
        r, c = divmod(index, grid.cols)
        # The window of an even number of cells lies half a cell towards south-west.
        shift = 0.0 if cells % 2 else -0.5 * land.cell
        x, y = grid.place(index)
        place = {
            "center": [round(x + shift, 2), round(y + shift, 2)], "height": round(float(height[r, c]), 2),
            "steepest": round(float(steepest[r, c]), 3), "height_range": round(float(high[r, c] - low[r, c]), 2),
            "distance": round(float(np.hypot(x - near[0], y - near[1])), 1),
        }  # fmt: skip
        if np.isfinite(away[r, c]):
            place["water_distance"] = round(float(away[r, c]), 1)
        found.append(place)
    return found, limit


def shore_places(
    land: SavedLandscape, kind: str, *, sea_level: float | None, near: tuple[float, float], apart: float, most: int = 10
) -> list[dict[str, Any]]:
    """Dry places beside water of a kind (`sea`, `lake`, or `shore` for both), nearest first, with the direction of the water.

    Raises:
        InputError: there is no such water.
    """
    grid, kinds = _grid(land), _water_kind(land)
    wanted = np.isin(kinds, [k for k, n in enumerate(WATERS) if n == kind or (kind == "shore" and n in ("sea", "lake"))])
    if not wanted.any():
        raise InputError(f"the landscape has no {'sea or lake' if kind == 'shore' else kind}; declare it in /hydrology/required")
    height, slope, level = land.field("height"), land.field("slope"), _levels(land, sea_level)
    beside = ndimage.binary_dilation(wanted, EIGHT) & (kinds == 0) & np.isfinite(height)
    toward = ndimage.distance_transform_edt(~wanted, return_distances=False, return_indices=True)
    found = []
    for index in _nearest_apart(grid, beside, near, apart, most):
        r, c = divmod(index, grid.cols)
        wr, wc = int(toward[0][r, c]), int(toward[1][r, c])
        x, y = grid.place(index)
        surface = level[wr, wc]
        found.append(
            {
                "at": [round(x, 2), round(y, 2)], "height": round(float(height[r, c]), 2), "slope": round(float(slope[r, c]), 3),
                "water": WATERS[kinds[wr, wc]], "water_at": [round(v, 2) for v in grid.place(wr * grid.cols + wc)],
                "water_level": round(float(surface), 2) if np.isfinite(surface) else None,
                "distance": round(float(np.hypot(x - near[0], y - near[1])), 1),
            }
        )  # fmt: skip
    return found


def river_places(land: SavedLandscape, *, near: tuple[float, float], apart: float, most: int = 10) -> list[dict[str, Any]]:
    """Places in rivers and streams, nearest first: which reach, how wide and deep, level, and where it flows.

    Raises:
        InputError: there is no river or stream.
    """
    grid = _grid(land)
    owner = np.zeros(grid.rows * grid.cols, dtype=int)
    step = np.zeros_like(owner)
    reaches = {r["number"]: r for r in land.about["reaches"]}
    for number, reach in reaches.items():
        cells = np.array(reach["cells"][:-1], dtype=int)  # the last one belongs to what it flows into
        owner[cells], step[cells] = number, np.arange(len(cells))
    if not owner.any():
        raise InputError("the landscape has no river or stream; raise /hydrology/density or give an inflow")
    level, height, flow = land.field("water_level"), land.field("height"), land.field("discharge")
    found = []
    for index in _nearest_apart(grid, (owner > 0).reshape(grid.shape), near, apart, most):
        reach = reaches[int(owner[index])]
        k = int(step[index])
        x, y = grid.place(index)
        ahead = np.array(grid.place(reach["cells"][min(k + 3, len(reach["cells"]) - 1)])) - (x, y)
        share = k / max(len(reach["cells"]) - 1, 1)
        surface = float(level.flat[index])
        found.append(
            {
                "at": [round(x, 2), round(y, 2)], "reach": reach["number"], "kind": reach["kind"],
                "width": round(float(np.interp(share, [0, 1], reach["width"])), 2),
                "depth": round(float(np.interp(share, [0, 1], reach["depth"])), 2),
                "discharge": float(f"{float(flow.flat[index]):.4g}"), "bed": round(float(height.flat[index]), 2),
                "level": round(surface, 2) if np.isfinite(surface) else None,
                "flows_toward_deg": round(float(np.degrees(np.arctan2(ahead[1], ahead[0]))), 0),
                "distance": round(float(np.hypot(x - near[0], y - near[1])), 1),
            }
        )  # fmt: skip
    return found


def river_station(land: SavedLandscape, number: int, station: float, across: float) -> dict[str, Any]:
    """A place in a river by its station along the course: x, y, level, bed, width and depth of the channel there [m], flow direction.

    Args:
        land: the landscape.
        number: of the reach.
        station: along the course from its upper end [m].
        across: from its middle to the left, looking downstream [m].

    Raises:
        InputError: there is no such reach, or it is shorter.
    """
    grid = _grid(land)
    reaches = {r["number"]: r for r in land.about["reaches"]}
    if number not in reaches:
        raise InputError(
            f"reach {number} is not one of {sorted(reaches)[:30]}; inspect_world(part='terrain') tells their courses"
        )
    reach = reaches[number]
    line = centre_line(np.array(reach["cells"]), 0.5 * sum(reach["width"]), grid.shape, grid.cell)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    if not 0.0 <= station <= along[-1] or len(line) < 2:
        raise InputError(f"station {station:g} m is not on reach {number}, which is {along[-1]:.4g} m long from its upper end")
    k = int(np.clip(np.searchsorted(along, station) - 1, 0, len(line) - 2))
    flow = line[k + 1] - line[k]
    flow = flow / np.hypot(*flow)
    middle = np.array([np.interp(station, along, line[:, axis]) for axis in (0, 1)])
    share = station / float(along[-1])
    at = middle + across * np.array([-flow[1], flow[0]])
    return {
        "at": at.round(3).tolist(), "reach": number, "station": station, "length": round(float(along[-1]), 1),
        "width": round(float(np.interp(share, [0, 1], reach["width"])), 2),
        "depth": round(float(np.interp(share, [0, 1], reach["depth"])), 2),
        "flows": flow.round(6).tolist(), **water_at(land, at, sea_level=None),
    }  # fmt: skip


def water_at(land: SavedLandscape, at: F64, *, sea_level: float | None) -> dict[str, Any]:
    """Height of the bed and level of the water over it at x, y [m]; no level where it is dry.

    Raises:
        InputError: the place lies outside the landscape.
    """
    grid, point = _grid(land), np.asarray(at, dtype=np.float64).reshape(1, 2)
    _checked(grid, point)
    row, col = (int(i[0]) for i in grid.indices(point[:, 0], point[:, 1]))
    bed = float(grid.sample(land.field("height"), point[:, 0], point[:, 1])[0])
    level = float(_levels(land, sea_level)[row, col])
    return {"bed": round(bed, 3), **({"level": round(level, 3)} if np.isfinite(level) else {})}
