"""Water of a landscape as Mitsuba shapes: sea and lakes coloured by their depth, rivers as ribbons of their width."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy import ndimage

from ...geometry.watercourses import centre_line
from ...worlds.arrays import F64
from ...worlds.landscape import SavedLandscape
from ..tracer.meshes import mesh_of
from .triangles import grid_faces, grid_uv

__all__ = ["Course", "courses", "drawn_height", "ribbon_of", "surface_height", "water_shapes"]

DEEP = (0.006, 0.03, 0.045)
SHALLOW = (0.05, 0.20, 0.19)
FRESH = (0.012, 0.05, 0.055)
FOAM = (0.55, 0.58, 0.58)
"""Linear colours."""
CLEAR_M = 7.0
"""Depth at which two thirds of the way to the colour of deep water are gone [m]: Jerlov's coastal waters let 10 m be seen."""
SURF_M = 0.7
"""Water shallower than this breaks at the shore [m]."""
SEA_BEYOND = 2000.0
"""Half side of the sea over that of the land: to the horizon of a camera as high as the land is wide."""
WIDE_CELLS = 2.0
"""Rivers from this many cells on are drawn at their level, between banks that the grid carries; narrower ones lie on the land."""
RIBBON = 8
"""Corners of a narrow ribbon across, per cell of the landscape."""
OVER = 4
"""Places between two corners of a ribbon, where it must not lie under the land."""
POOL = 0.5
"""Most that a narrow ribbon stands over the drawn land [m], where the grid dams it."""
LIFT = 0.12
"""Height of a narrow ribbon over the drawn land [m]."""


class Course(NamedTuple):
    """A reach: points of its smoothed centre line [m], shape (n, 2), widths and levels there [m], shape (n,)."""

    line: F64
    width: F64
    level: F64
    kind: str


def courses(land: SavedLandscape) -> list[Course]:
    """All rivers and streams, from source to end; levels fall downstream."""
    discharge = land.field("discharge").ravel()
    level, ground = land.field("water_level").ravel(), land.field("height").ravel()
    found = []
    for reach in land.about["reaches"]:
        cells = np.array(reach["cells"])
        if len(cells) < 3:
            continue
        flow = discharge[cells]
        flow[-1] = flow[-2]  # the last cell belongs to what it flows into
        width = reach["width"][1] * np.sqrt(flow / max(float(flow[-1]), 1e-12))
        smooth = centre_line(cells, float(width.mean()), land.shape, land.cell)
        height = np.where(np.isfinite(level[cells]), level[cells], ground[cells])
        at = np.linspace(0, len(cells) - 1, 4 * (len(cells) - 1) + 1)
        dense = np.stack([_smooth_between(smooth[:, k], at) for k in (0, 1)], 1)
        known = np.arange(len(cells))
        found.append(
            Course(dense, np.interp(at, known, width), np.minimum.accumulate(np.interp(at, known, height)), reach["kind"])
        )
    return found


def _smooth_between(values: F64, at: F64) -> F64:
    """A cubic through values at whole numbers, asked at `at`."""
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(np.arange(len(values)), values)(at))


def surface_height(x: F64, y: F64, height: F64, at: F64) -> F64:
    """Height of the drawn triangles of a grid at points, shape (n, 2); they part every cell from south-west to north-east."""
    u = np.clip((at[:, 0] - x[0]) / (x[1] - x[0]), 0, len(x) - 1.001)
    v = np.clip((at[:, 1] - y[0]) / (y[1] - y[0]), 0, len(y) - 1.001)
    col, row = u.astype(int), v.astype(int)
    s, t = u - col, v - row
    a, b, c, d = height[row, col], height[row, col + 1], height[row + 1, col], height[row + 1, col + 1]
    return np.asarray(np.where(s >= t, a + s * (b - a) + t * (d - b), a + t * (c - a) + s * (d - c)))


def drawn_height(drawn: Sequence[tuple[F64, F64, F64]], at: F64) -> F64:
    """Height of what is drawn at points, shape (n, 2): the land, and where a ground lies in its place, that."""
    found = np.zeros(len(at))
    for k, (x, y, height) in enumerate(drawn):
        inside = (at[:, 0] >= x[0]) & (at[:, 0] <= x[-1]) & (at[:, 1] >= y[0]) & (at[:, 1] <= y[-1])
        own = inside if k else np.ones(len(at), dtype=bool)
        solid = np.nan_to_num(height, nan=float(np.nanmin(height)))
        found[own] = surface_height(x, y, solid, at[own])
    return found


def water_shapes(
    mi: Any,
    name: str,
    land: SavedLandscape,
    sea_level: float | None,
    drawn: list[tuple[F64, F64, F64]],
    simulated: Sequence[tuple[F64, F64]] = (),
) -> dict[str, Any]:
    """Mitsuba objects by name.

    Args:
        mi: Mitsuba.
        name: of the terrain.
        land: its landscape.
        sea_level: [m], or None.
        drawn: columns, rows and heights [m] of the corners of the drawn land, and after it of grounds that lie in its place.
        simulated: least and greatest corners of boxes in which a liquid is simulated: lakes and rivers are not painted there.
    """
    shapes: dict[str, Any] = {}
    if sea_level is not None and land.raw("sea").any():
        shapes |= _sea(mi, name, land, sea_level)
    shapes |= _lakes(mi, name, land, simulated)
    shapes |= _rivers(mi, name, land, drawn, simulated)
    return shapes


def _unsimulated(vertices: F64, faces: np.ndarray, boxes: Sequence[tuple[F64, F64]]) -> np.ndarray:
    """Faces whose middle lies over none of the boxes."""
    middle = vertices[faces].mean(1)[:, :2]
    inside = [((middle > low[:2]) & (middle < high[:2])).all(1) for low, high in boxes]
    return faces[~np.logical_or.reduce(inside)] if inside else faces


def _bsdf(mi: Any, color: Any, roughness: float) -> Any:
    found = {"type": "principled", "base_color": color, "roughness": roughness, "specular": 0.55}
    return mi.load_dict({"type": "twosided", "bsdf": found})


def _plain(color: tuple[float, float, float]) -> dict[str, Any]:
    return {"type": "rgb", "value": list(color)}


def _depth_color(depth: F64, deep: tuple[float, float, float], shallow: tuple[float, float, float]) -> np.ndarray:
    share = 1.0 - np.exp(-np.maximum(depth, 0.0) / CLEAR_M)
    return np.asarray(np.array(shallow) + share[..., None] * (np.array(deep) - np.array(shallow)), dtype=np.float32)


def _picture(mi: Any, image: np.ndarray) -> dict[str, Any]:
    bitmap = mi.Bitmap(np.ascontiguousarray(image))
    return {"type": "bitmap", "bitmap": bitmap, "raw": True, "wrap_mode": "clamp"}


def _sea(mi: Any, name: str, land: SavedLandscape, level: float) -> dict[str, Any]:
    """A sheet over the landscape, paler where it is shallow, with surf at the shore; four more to the horizon."""
    height = np.nan_to_num(
        ndimage.zoom(np.nan_to_num(land.field("height"), nan=level - 100.0), 2, order=1, mode="nearest", grid_mode=True)
    )
    depth = level - height
    image = _depth_color(depth, DEEP, SHALLOW)
    rng = np.random.default_rng(11)
    ragged = SURF_M * (1 + 0.8 * ndimage.gaussian_filter(rng.normal(size=depth.shape), 1.2) * 3)
    image[(depth < ragged) & (depth > -1.0)] = FOAM
    east, north = 0.5 * land.shape[1] * land.cell, 0.5 * land.shape[0] * land.cell
    far = SEA_BEYOND * max(east, north)
    shapes = {}
    sheets = [
        (-east, east, -north, north),
        (-far, -east, -far, far),
        (east, far, -far, far),
        (-east, east, -far, -north),
        (-east, east, north, far),
    ]
    for k, (x0, x1, y0, y1) in enumerate(sheets):
        corners = np.array([[x0, y0, level], [x1, y0, level], [x1, y1, level], [x0, y1, level]])
        bsdf = _bsdf(mi, _picture(mi, image) if k == 0 else _plain(DEEP), 0.14)
        key = f"sea{k}-{name}"
        shapes[key] = mesh_of(mi, key, (corners, np.array([[0, 1, 2], [0, 2, 3]])), bsdf, uv=grid_uv(land, corners))
    return shapes


def _lakes(mi: Any, name: str, land: SavedLandscape, simulated: Sequence[tuple[F64, F64]]) -> dict[str, Any]:
    """Sheets at the level of each lake, a cell wider where the bank cuts them off."""
    lake, height = land.raw("lake"), land.field("height")
    wide_rivers = _wide(land)
    mask = (lake > 0) | wide_rivers
    if not mask.any():
        return {}
    level = land.field("water_level")
    near = ndimage.distance_transform_edt(~mask, return_distances=False, return_indices=True)
    surface = level[tuple(near)]
    sheet = mask | (ndimage.binary_dilation(mask, np.ones((3, 3))) & (height >= surface))
    keep = sheet[:-1, :-1] & sheet[1:, :-1] & sheet[:-1, 1:] & sheet[1:, 1:]
    if not keep.any():
        return {}
    rows, cols = land.shape
    used, faces = np.unique(grid_faces(rows, cols, keep), return_inverse=True)
    x = (np.arange(cols) - 0.5 * (cols - 1)) * land.cell
    y = (np.arange(rows) - 0.5 * (rows - 1)) * land.cell
    xx, yy = np.meshgrid(x, y)
    vertices = np.stack([xx, yy, np.nan_to_num(surface)], axis=-1).reshape(-1, 3)[used]
    faces = _unsimulated(vertices, faces.reshape(-1, 3), simulated)
    if not len(faces):
        return {}
    image = _depth_color(np.nan_to_num(surface - height), FRESH, SHALLOW)
    bsdf = _bsdf(mi, _picture(mi, image), 0.06)
    return {f"lakes-{name}": mesh_of(mi, f"lakes-{name}", (vertices, faces), bsdf, uv=grid_uv(land, vertices))}


def _wide(land: SavedLandscape) -> np.ndarray:
    """Cells under rivers that the grid can carry."""
    if not any(max(r["width"]) >= WIDE_CELLS * land.cell for r in land.about["reaches"]):
        return np.zeros(land.shape, dtype=bool)
    flowing = np.isfinite(land.field("water_level")) & (land.raw("lake") == 0) & ~land.raw("sea").astype(bool)
    return np.asarray(ndimage.binary_opening(flowing, np.ones((2, 2))))


def ribbon_of(course: Course, cell: float, drawn: Sequence[tuple[F64, F64, F64]]) -> F64:
    """Corners of a narrow river's surface, downstream and from its right to its left, shape (n, m, 3) [m].

    A corner lies over the highest drawn land between it and its neighbours, so that no ridge of a triangle stands out of the water.
    """
    many = 2 * max(2, int(np.ceil(RIBBON * course.width.max() / cell / 2))) + 1
    known = np.arange(len(course.line))
    at = np.linspace(0, known[-1], known[-1] * OVER + 1)
    line = np.stack([np.interp(at, known, course.line[:, k]) for k in (0, 1)], 1)
    along = np.gradient(line, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1), 1e-9)[:, None]
    side = np.stack([-along[:, 1], along[:, 0]], 1)
    across = np.linspace(-0.5, 0.5, OVER * (many - 1) + 1)
    places = line[:, None] + across[None, :, None] * (np.interp(at, known, course.width)[:, None] * side)[:, None]
    ground = drawn_height(drawn, places.reshape(-1, 2)).reshape(places.shape[:2])
    # A bump of the drawn land dams what is above it, by no more than a shallow pool.
    middle = ground.mean(1)
    level = np.minimum(np.maximum.accumulate(middle[::-1])[::-1], middle + POOL)
    z = ndimage.maximum_filter(np.maximum(ground, level[:, None]), size=2 * OVER + 1, mode="nearest") + LIFT
    return np.concatenate([places, z[..., None]], axis=2)[::OVER, ::OVER]


def _rivers(
    mi: Any, name: str, land: SavedLandscape, drawn: list[tuple[F64, F64, F64]], simulated: Sequence[tuple[F64, F64]]
) -> dict[str, Any]:
    """Ribbons: as wide as the river, laid on the drawn land where the grid is too coarse for its bed."""
    pieces, start = [], 0
    faces = []
    for course in courses(land):
        if course.width.max() >= WIDE_CELLS * land.cell:
            continue
        ribbon = ribbon_of(course, land.cell, drawn)
        count, across = ribbon.shape[:2]
        pieces.append(ribbon.reshape(-1, 3))
        faces.append(grid_faces(count, across, np.ones((count - 1, across - 1), dtype=bool)) + start)
        start += count * across
    if not pieces:
        return {}
    vertices = np.concatenate(pieces)
    shown = _unsimulated(vertices, np.concatenate(faces), simulated)
    if not len(shown):
        return {}
    bsdf = _bsdf(mi, _plain((0.02, 0.06, 0.07)), 0.08)
    return {f"rivers-{name}": mesh_of(mi, f"rivers-{name}", (vertices, shown), bsdf, normals="smooth")}
