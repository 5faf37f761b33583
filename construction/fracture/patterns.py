"""Patterns of cracks: the cells that a body is cut into, each an intersection of half spaces."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import InputError
from ...worlds.spec import Breakable, BrickPattern, GlassPattern, VoronoiPattern, WoodPattern

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["Cell", "cells_of"]

ALL_PAIRS = 40
"""Up to so many points every pair gives a plane; beyond, the neighbours that scipy's Voronoi diagram finds."""
SMOOTHING = 2
"""Rounds in which the points move to the middle of what is nearest to them: no slivers, and still no lattice."""
SAMPLES_PER_POINT = 60
NARROW = 0.25
"""Bricks cut shorter than this share of a brick are left with their neighbour."""


class Cell(NamedTuple):
    """Points x with normals . x <= offsets."""

    normals: F64
    """Unit vectors, shape (m, 3)."""
    offsets: F64
    """[m], shape (m,)."""


def cells_of(breakable: Breakable, low: F64, high: F64, inside: Callable[[F64], F64]) -> list[Cell]:
    """Cells that tile space.

    Args:
        breakable: pattern of the entity.
        low: least corner of the entity's box in its own frame [m], shape (3,).
        high: greatest corner.
        inside: which points, shape (n, 3), lie in the body.

    Raises:
        InputError: no cells come of it.
    """
    pattern = breakable.pattern
    match pattern:
        case BrickPattern():
            return _bricks(pattern, low, high)
        case GlassPattern():
            return _glass(pattern, low, high)
        case WoodPattern():
            grain = np.array(pattern.grain) / np.linalg.norm(pattern.grain)
            squeeze = np.eye(3) - (1 - 1 / pattern.slenderness) * np.outer(grain, grain)
            return _around_points(_points(pattern.pieces, pattern.seed, low, high, inside, squeeze), squeeze)
        case VoronoiPattern():
            points = _points(pattern.pieces, pattern.seed, low, high, inside, np.eye(3), pattern)
            return _around_points(points, np.eye(3))


def _points(
    count: int,
    seed: int,
    low: F64,
    high: F64,
    inside: Callable[[F64], F64],
    squeeze: F64,
    pattern: VoronoiPattern | None = None,
) -> F64:
    """Points in the body, evenly spread in the squeezed metric, or denser around a point; shape (count, 3)."""
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(seed)
    wanted, found = SAMPLES_PER_POINT * count, np.zeros((0, 3))
    for _ in range(200):
        tried = low + (high - low) * rng.random((wanted, 3))
        found = np.concatenate([found, tried[inside(tried)]])
        if len(found) >= wanted:
            break
    if len(found) < 4 * count:
        raise InputError("the body fills too little of its box to place the points of its pieces; use other parts")
    weight = np.ones(len(found))
    if pattern is not None and pattern.around is not None:
        reach = float(np.linalg.norm(high - low)) / 2
        away = np.linalg.norm(found - np.array(pattern.around), axis=1) / reach
        weight = 1 / (0.05 + away) ** (3 * pattern.clustering)
    chosen = found[np.sort(rng.choice(len(found), count, replace=False, p=weight / weight.sum()))] @ squeeze
    cloud = found @ squeeze
    for _ in range(SMOOTHING):
        nearest = cKDTree(chosen).query(cloud)[1]
        total = np.bincount(nearest, weights=weight, minlength=count)
        moved = np.stack([np.bincount(nearest, weights=weight * cloud[:, k], minlength=count) for k in range(3)], axis=1)
        chosen = np.where(total[:, None] > 0, moved / np.maximum(total, 1e-300)[:, None], chosen)
    return chosen


def _around_points(points: F64, squeeze: F64) -> list[Cell]:
    """Voronoi cells of points given in the squeezed metric, shape (n, 3)."""
    from scipy.spatial import QhullError, Voronoi

    pairs = np.array(list(itertools.combinations(range(len(points)), 2)))
    if len(points) > ALL_PAIRS:
        try:
            pairs = np.sort(Voronoi(points).ridge_points, axis=1)
        except QhullError as error:
            raise InputError("the points of the pieces lie in one plane; use another seed or thicker parts") from error
    planes: list[list[tuple[F64, float]]] = [[] for _ in points]
    for a, b in pairs:
        normal = points[b] - points[a]
        height = float(normal @ (points[a] + points[b]) / 2)
        normal = squeeze @ normal
        length = float(np.linalg.norm(normal))
        planes[a].append((normal / length, height / length))
        planes[b].append((-normal / length, -height / length))
    return [Cell(np.array([n for n, _ in own]), np.array([h for _, h in own])) for own in planes]


def _slab(axis: int, low: float, high: float) -> tuple[list[F64], list[float]]:
    """Half spaces between two coordinates; infinite ones are left out."""
    unit = np.eye(3)[axis]
    sides = [(unit, high), (-unit, -low)]
    return [n for n, h in sides if np.isfinite(h)], [h for _, h in sides if np.isfinite(h)]


def _spans(low: float, high: float, pitch: float, shift: float) -> list[tuple[float, float]]:
    """Intervals of a row of bricks; narrow rests at the ends stay with their neighbours."""
    first = low + shift * pitch
    cuts = [first + k * pitch for k in range(-1, math.ceil((high - low) / pitch) + 2)]
    cuts = [c for c in cuts if low + NARROW * pitch < c < high - NARROW * pitch]
    edges = [-math.inf, *cuts, math.inf]
    return list(itertools.pairwise(edges))


def _bricks(pattern: BrickPattern, low: F64, high: F64) -> list[Cell]:
    along = 0 if pattern.along == "x" else 1
    through = 1 - along
    length, depth, height = (s + pattern.joint for s in pattern.size)
    cells = []
    for course, (bottom, top) in enumerate(_spans(float(low[2]), float(high[2]), height, 1.0)):
        shift = pattern.offset if course % 2 else 1.0
        for front, back in _spans(float(low[through]), float(high[through]), depth, 1.0):
            for left, right in _spans(float(low[along]), float(high[along]), length, shift):
                normals: list[F64] = []
                offsets: list[float] = []
                for axis, a, b in ((2, bottom, top), (through, front, back), (along, left, right)):
                    n, h = _slab(axis, a, b)
                    normals, offsets = normals + n, offsets + h
                if normals:
                    cells.append(Cell(np.array(normals), np.array(offsets)))
    if not cells:
        raise InputError("the body is smaller than one brick; use smaller bricks or another pattern")
    return cells


def _glass(pattern: GlassPattern, low: F64, high: F64) -> list[Cell]:
    rng = np.random.default_rng(pattern.seed)
    thin = int(np.argmin(high - low))
    u, v = (k for k in range(3) if k != thin)
    center = np.array([pattern.point[u], pattern.point[v]])
    corners = np.array([(x, y) for x in (low[u], high[u]) for y in (low[v], high[v])])
    reach = float(np.linalg.norm(corners - center, axis=1).max())
    spokes, rings, scatter = pattern.radial, pattern.rings, pattern.irregularity
    angle = 2 * math.pi * (np.arange(spokes) + scatter * (rng.random(spokes) - 0.5)) / spokes
    base = np.arange(1, rings + 1) + scatter * (rng.random((spokes, rings)) - 0.5)
    radius = reach * (base / (rings + 1)) ** 1.5
    ray = np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def half(normal: F64, through_: F64) -> tuple[F64, float]:
        whole = np.zeros(3)
        whole[u], whole[v] = normal
        length = float(np.linalg.norm(whole))
        return whole / length, float(normal @ through_) / length

    cells = []
    for i in range(spokes):
        j = (i + 1) % spokes
        sides = [half(np.array([ray[i][1], -ray[i][0]]), center), half(np.array([-ray[j][1], ray[j][0]]), center)]
        chords = [(center + radius[i, k] * ray[i], center + radius[j, k] * ray[j]) for k in range(rings)]
        outward = [half(np.array([q[1] - p[1], p[0] - q[0]]), p) for p, q in chords]
        for k in range(rings + 1):
            own = list(sides)
            if k > 0:
                n, h = outward[k - 1]
                own.append((-n, -h))
            if k < rings:
                own.append(outward[k])
            cells.append(Cell(np.array([n for n, _ in own]), np.array([h for _, h in own])))
    return cells
