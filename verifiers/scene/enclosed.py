"""Parts that no camera sees though they lie in no solid: in a closed cavity, or as lumps of one mesh inside another lump of it (R154)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...geometry.inside import contains
from ...geometry.solids import Solid
from ...geometry.triangles import ray_hits
from ...worlds.arrays import F64, cross
from ...worlds.built import TriangleMesh
from .bounds import ESCAPES, SIGHT_LINES, SIGHT_PLACES

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["lumps", "nested", "shut_in", "within_one"]

BLOCK = 2_000_000
"""Pairs of sight lines and triangles that are looked at at once, for memory."""
PORTIONS = 16
"""Own choice: portions in which sight lines are asked."""


def lumps(solid: Solid) -> list[Solid]:
    """The connected surfaces of a solid, each as a solid, the largest first."""
    labels = solid.component[solid.faces[:, 0]]
    found = [
        Solid.from_mesh(TriangleMesh(solid.vertices, solid.faces[labels == label]), closed=solid.closed)
        for label in np.unique(labels)
    ]
    return sorted(found, key=lambda s: -abs(s.volume))


def nested(solid: Solid) -> list[Solid]:
    """Lumps of a closed mesh that lie in the matter of a larger lump of it: their volume counts twice."""
    if solid.convex:
        return []
    own = lumps(solid)
    sign = np.sign(solid.volume)
    filled = [s for s in own if s.volume * sign > 0.0]
    voids = [s for s in own if s.volume * sign < 0.0]
    return [
        s
        for k, s in enumerate(filled)
        if any(within_one(s, larger) for larger in filled[:k]) and not any(within_one(s, void) for void in voids)
    ]


def within_one(inner: Solid, around: Solid) -> bool:
    """True if a closed surface lies within another one, whichever way their faces look."""
    if (around.lower > inner.lower).any() or (around.upper < inner.upper).any():
        return False
    points = inner.centroids - 1e-6 * inner.size * np.sign(inner.volume) * inner.face_normals
    return bool(_within(around, points).all())


def _within(solid: Solid, points: F64) -> NDArray[np.bool_]:
    """Which points lie within a closed surface, whichever way its faces look."""
    turned = solid if solid.volume > 0.0 else Solid(solid.vertices, np.ascontiguousarray(solid.faces[:, ::-1]), solid.closed)
    return contains(turned, points)


def shut_in(inner: Solid, around: Sequence[Solid]) -> bool:
    """True if hardly a sight line from the surface of a solid gets past the others: what they enclose is never seen."""
    around = [s for s in around if s is not inner]
    if not around:
        return False
    low, high = np.min([s.lower for s in around], axis=0), np.max([s.upper for s in around], axis=0)
    if (inner.lower <= low).any() or (inner.upper >= high).any():
        return False  # it reaches as far out as what is about it
    starts, ways = _sight_lines(inner)
    escaped = 0
    for first in range(PORTIONS):
        # Every sixteenth line of all places: where much is open, the first portion tells.
        escaped += int(_open(around, starts[first::PORTIONS], ways[first::PORTIONS]).sum())
        if escaped > ESCAPES * len(starts):
            return False
    return True


def _open(around: Sequence[Solid], starts: F64, ways: F64) -> NDArray[np.bool_]:
    """Which sight lines get past all solids."""
    free = np.ones(len(starts), dtype=bool)
    for solid in around:
        left = np.flatnonzero(free)
        left = left[_meets_box(solid.lower, solid.upper, starts[left], ways[left])]
        step = max(1, BLOCK // len(solid.faces))
        for i in range(0, len(left), step):
            here = left[i : i + step]
            free[here] = np.isinf(ray_hits(solid.triangles, starts[here], ways[here])).all(axis=1)
    return free


def _meets_box(low: F64, high: F64, starts: F64, ways: F64) -> NDArray[np.bool_]:
    """Which lines from some starts on meet a box, widened by a billionth of its size, so that none that meets what lies in it is missed."""
    slack = 1e-9 * (high - low).max()
    # Lines along a plane of the box meet it nowhere or everywhere: a slope of nearly nothing does the same.
    slope = np.where(np.abs(ways) < 1e-300, 1e-300, ways)
    with np.errstate(over="ignore"):
        one, two = (low - slack - starts) / slope, (high + slack - starts) / slope
    return np.asarray(np.maximum(np.minimum(one, two).max(axis=1), 0.0) <= np.maximum(one, two).min(axis=1))


def _sight_lines(solid: Solid) -> tuple[F64, F64]:
    """Starts and directions of lines that leave a surface, shapes (n, 3)."""
    corners = solid.triangles
    areas = np.linalg.norm(cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    # Even over the area: the largest triangles may all look one way.
    along = np.cumsum(areas)
    chosen = np.searchsorted(along, (np.arange(SIGHT_PLACES) + 0.5) / SIGHT_PLACES * along[-1])
    # Fibonacci's spiral: even directions over the sphere.
    k = np.arange(SIGHT_LINES) + 0.5
    height, turn = 1.0 - 2.0 * k / SIGHT_LINES, k * np.pi * (1.0 + 5.0**0.5)
    flat = np.sqrt(1.0 - height**2)
    ways = np.stack([flat * np.cos(turn), flat * np.sin(turn), height], axis=1)
    normals = solid.face_normals[chosen] * np.sign(solid.volume)
    faces, lines = np.nonzero(normals @ ways.T > 0.0)
    starts = solid.centroids[chosen] + 1e-6 * solid.size * normals
    return starts[faces], ways[lines]
