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
from .solids import CONVEX_TOLERANCE, COPLANAR

if TYPE_CHECKING:
    from .solids import Solid

__all__ = ["MANY", "Convex", "ConvexFound", "convex_clearances", "convex_of"]

MANY = 1000
"""Own choice: so many pairs of convex solids are worth loading the compiled loops, which one by one cost as much as that."""
MOST_VERTICES = 1000
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


def _flat(solids: Sequence[Solid]) -> tuple[F64, I32, NDArray[np.int64], NDArray[np.int64], F64]:
    """Vertices and faces of some solids, one after the other, where those of each begin, and sizes [m]."""
    vertices, faces = (np.ascontiguousarray(np.concatenate(p)) for p in ([s.vertices for s in solids], [s.faces for s in solids]))
    counts = [len(s.vertices) for s in solids], [len(s.faces) for s in solids]
    first_vertex, first_face = (np.concatenate([[0], np.cumsum(count, dtype=np.int64)]) for count in counts)
    return vertices, faces, first_vertex, first_face, np.array([s.size for s in solids])


def _tell_convex(solids: Sequence[Solid]) -> None:
    """Work out `Solid.convex` of small closed solids all at once."""
    from .convex_kernels import judge

    some = [s for s in solids if s.closed and len(s.vertices) <= MOST_VERTICES and "convex" not in vars(s)]
    if some:
        found = np.zeros(len(some), dtype=bool)
        judge(*_flat(some), CONVEX_TOLERANCE, found)
        for solid, convex in zip(some, found.tolist(), strict=True):
            vars(solid)["convex"] = convex


def convex_of(solids: Sequence[Solid]) -> Convex:
    """The convex ones among some solids, prepared."""
    from .convex_kernels import describe

    _tell_convex(solids)
    fit = np.array([len(s.vertices) <= MOST_VERTICES and s.convex for s in solids], dtype=bool)
    chosen = [s for s, ok in zip(solids, fit, strict=True) if ok]
    if not chosen:
        return Convex((), np.zeros((len(solids), 7), dtype=np.int64), (), fit)
    vertices, faces, first_vertex, first_face, own_size = _flat(chosen)
    normals, offsets, edges = np.zeros((len(faces), 3)), np.zeros(len(faces)), np.zeros((3 * len(faces), 2), dtype=np.int64)
    planes, sharp = np.zeros((2, len(chosen)), dtype=np.int64)
    describe(vertices, faces, first_vertex, first_face, own_size, COPLANAR, normals, offsets, edges, planes, sharp)
    numbers, size = np.zeros((len(solids), 7), dtype=np.int64), np.zeros(len(solids))
    edge = 3 * first_face[:-1]
    columns = [first_vertex[:-1], first_vertex[1:], first_face[:-1], planes, first_face[1:], edge, edge + sharp]
    numbers[fit], size[fit] = np.stack(columns, axis=1), own_size
    table = int(planes.max() * np.diff(first_vertex).max())
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
    if count == 0:
        none = np.zeros(0, dtype=bool)
        return ConvexFound(np.zeros(0), np.zeros((0, 3)), np.zeros((0, 3)), none, none)
    value, point_a, point_b, found = np.empty(count), np.zeros((count, 3)), np.zeros((count, 3)), np.empty(count, dtype=np.int8)
    rotation, move = np.ascontiguousarray(poses.rotation), np.ascontiguousarray(poses.translation)
    query = [np.ascontiguousarray(pairs, dtype=np.int64), rotation, move]
    limits = [np.ascontiguousarray(v, dtype=np.float64) for v in (skip_above, enough)]
    clearances(*query, *limits, convex.bodies, convex.numbers, convex.scratch, value, point_a, point_b, found)
    return ConvexFound(value, point_a, point_b, found != LEFT, (found != FAR) & (found != LEFT))
