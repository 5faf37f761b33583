"""Signed clearance of very many pairs of convex solids at once, by compiled loops: `polytopes` for a list of different pairs.

`polytopes` takes one pair over all its poses, and is slow where thousands of pairs have one pose each. Importing numba takes half a second.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, I32
from .polytopes import Relative
from .solids import COPLANAR

if TYPE_CHECKING:
    from .solids import Solid

__all__ = ["MANY", "Convex", "ConvexFound", "convex_clearances", "convex_of"]

MANY = 1000
"""Own choice: so many pairs of convex solids are worth loading the compiled loops, which one by one cost as much as that."""
MOST_VERTICES = 256
"""Own choice: solids of more vertices are left out; the loops look at every vertex of one with every plane of the other."""


class Convex(NamedTuple):
    """Convex solids as flat arrays for the loops; solids left out have no vertex."""

    bodies: tuple[Any, ...]
    numbers: NDArray[np.int64]
    scratch: tuple[Any, ...]
    fit: NDArray[np.bool_]
    """Which solids are in it."""


class ConvexFound(NamedTuple):
    """Answers in the order of the queries."""

    value: F64
    """Signed clearance [m]; above `skip_above` a lower bound that is above it too."""
    point_a: F64
    """Point of the surface of the first in the frame of the second [m], shape (n, 3)."""
    point_b: F64
    answered: NDArray[np.bool_]
    """False where the loops leave it to `clearance`."""
    exact: NDArray[np.bool_]
    """False for lower bounds, which have no points."""


def convex_of(solids: Sequence[Solid]) -> Convex:
    """The convex ones among some solids, prepared."""
    from .convex_kernels import describe

    fit = np.array([len(s.vertices) <= MOST_VERTICES and s.convex for s in solids], dtype=bool)
    none = np.zeros((0, 3))
    some = [(s.vertices, s.faces) if ok else (none, none.astype(np.int32)) for s, ok in zip(solids, fit, strict=True)]
    vertices, faces = (np.ascontiguousarray(np.concatenate([p[k] for p in some])) for k in (0, 1))
    first_vertex, first_face = (np.concatenate([[0], np.cumsum([len(p[k]) for p in some])]) for k in (0, 1))
    size = np.array([s.size for s in solids])
    normals, offsets, edges = np.zeros((len(faces), 3)), np.zeros(len(faces)), np.zeros((3 * len(faces), 2), dtype=np.int64)
    planes, sharp = np.zeros((2, len(solids)), dtype=np.int64)
    describe(vertices, faces, first_vertex, first_face, size, COPLANAR, normals, offsets, edges, planes, sharp)
    numbers = np.stack(
        [first_vertex[:-1], first_vertex[1:], first_face[:-1], planes, first_face[1:], 3 * first_face[:-1], 3 * first_face[:-1] + sharp],
        axis=1,
    )
    table = int(planes.max(initial=0) * np.diff(first_vertex).max(initial=0))
    scratch = (np.empty_like(vertices), np.empty_like(vertices), np.empty(table), np.empty(table))
    return Convex((vertices, normals, offsets, faces, edges, size), np.ascontiguousarray(numbers), scratch, fit)


def convex_clearances(convex: Convex, pairs: I32, poses: Relative, *, skip_above: F64, enough: F64) -> ConvexFound:
    """Clearance of pairs of solids that are `fit`, each at one pose of the first in the frame of the second.

    Args:
        convex: the solids.
        pairs: which two, shape (n, 2).
        poses: of the first in the frame of the second.
        skip_above: [m] beyond which a lower bound is enough, shape (n,).
        enough: depth [m] from which on it is no matter how deep, shape (n,).
    """
    from .convex_kernels import FAR, LEFT, clearances

    count = len(pairs)
    value, point_a, point_b, found = np.empty(count), np.zeros((count, 3)), np.zeros((count, 3)), np.empty(count, dtype=np.int8)
    rotation, move = np.ascontiguousarray(poses.rotation), np.ascontiguousarray(poses.translation)
    query = [np.ascontiguousarray(pairs, dtype=np.int64), rotation, move]
    limits = [np.ascontiguousarray(v, dtype=np.float64) for v in (skip_above, enough)]
    clearances(*query, *limits, convex.bodies, convex.numbers, convex.scratch, value, point_a, point_b, found)
    return ConvexFound(value, point_a, point_b, found != LEFT, (found != FAR) & (found != LEFT))
