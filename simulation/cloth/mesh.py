"""Rest state of a sheet: masses, triangles with their material directions, hinges, who touches whom."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...worlds.arrays import F64, I32
from ...worlds.errors import InputError

__all__ = ["Adjacency", "Fabric", "Sheet", "adjacency", "sheet_of"]

LEAST_AREA = 1e-12
"""[m^2] Own choice: a smaller triangle has no shape."""


@dataclass(frozen=True)
class Fabric:
    """Material of one sheet."""

    area_density: float
    """[kg/m^2]"""
    stretch: tuple[float, float]
    """Young's modulus times thickness along warp (u) and weft (v) [N/m]."""
    shear: float
    """Shear modulus times thickness [N/m]."""
    bend: float
    """Energy of a cylinder of curvature 1/r per area is bend / (2 r^2) [N m]."""
    damping: float
    """Stress per strain rate over stress per strain [s]."""
    thickness: float
    """[m]"""


@dataclass(frozen=True)
class Adjacency:
    """Items of each vertex, one after the other: those of vertex i are `items[start[i]:start[i + 1]]`."""

    start: I32
    items: I32


@dataclass(frozen=True)
class Sheet:
    """A sheet at rest; index arrays count its own vertices."""

    position: F64
    """(n, 3) [m], at frame 0."""
    faces: I32
    """(t, 3)"""
    inverse_rest: F64
    """(t, 4): inverse of the material edges' matrix, rows (b - a), (c - a), columns u, v [1/m]."""
    area: F64
    """(t,) at rest [m^2]."""
    modulus: F64
    """(t, 4): stretch u, stretch v, shear [N/m], damping [s]."""
    edges: I32
    """(e, 2)"""
    edge_length: F64
    """(e,) at rest [m]."""
    hinges: I32
    """(h, 4): the shared edge's ends, the two opposite vertices."""
    hinge_weight: F64
    """(h, 4): how far each vertex counts in the bending vector; sums to 0."""
    hinge_law: F64
    """(h, 3): stiffness [N/m], signed length at rest [m], damping [s]."""
    mass: F64
    """(n,) [kg]."""
    kin: I32 | None = None
    """(n,): the same number, below n, for vertices that were one before a tear; None: each is its own."""

    def damped(self, least: float) -> Sheet:
        """The same with a damping of `least` [s] where it has less."""
        modulus, law = self.modulus.copy(), self.hinge_law.copy()
        modulus[:, 3], law[:, 2] = np.maximum(modulus[:, 3], least), np.maximum(law[:, 2], least)
        return replace(self, modulus=modulus, hinge_law=law)


def adjacency(items: I32, count: int) -> Adjacency:
    """For each of `count` vertices, the places (item * columns + column) at which it stands in `items` (n, columns)."""
    flat = items.ravel()
    order = np.argsort(flat, kind="stable")
    start = np.concatenate([[0], np.cumsum(np.bincount(flat, minlength=count))])
    return Adjacency(start.astype(np.int32), order.astype(np.int32))


def sheet_of(position: F64, faces: I32, fabric: Fabric, *, warp: F64 | None = None, flat: bool = False) -> Sheet:
    """The rest state of a surface.

    Args:
        position: (n, 3) [m].
        faces: (t, 3); two-manifold, with or without rims.
        fabric: its properties.
        warp: (3,) direction of the warp; laid into each triangle. Default: x, or y where the surface stands across it.
        flat: the sheet wants to be flat wherever it was bent at the start.

    Raises:
        InputError: a triangle has no area, an edge has more than two triangles, or a vertex none.
    """
    position, faces = np.asarray(position, dtype=np.float64), np.asarray(faces, dtype=np.int32)
    a, b, c = (position[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    double = np.linalg.norm(normal, axis=1)
    if double.min(initial=np.inf) < 2 * LEAST_AREA:
        raise InputError(f"triangle {int(double.argmin())} of a sheet has no area; merge its vertices or remesh the part")
    normal /= double[:, None]
    u = _in_plane(normal, np.array([1.0, 0.0, 0.0]) if warp is None else np.asarray(warp, dtype=np.float64))
    v = np.cross(normal, u)
    rows = [(b - a, 0), (c - a, 1)]
    matrix = np.stack([np.stack([(e * u).sum(1), (e * v).sum(1)], axis=1) for e, _ in rows], axis=1)
    inverse = np.linalg.inv(matrix)  # x_b - x_a, x_c - x_a = matrix @ (F u, F v)
    area = 0.5 * double
    mass = np.zeros(len(position))
    np.add.at(mass, faces.ravel(), np.repeat(fabric.area_density * area / 3.0, 3))
    if (mass == 0).any():
        raise InputError(f"vertex {int((mass == 0).argmax())} of a sheet belongs to no triangle; leave it out")
    edges, hinges = _edges(faces)
    weight, law = _hinge_law(position, hinges, fabric, flat=flat)
    modulus = np.tile([*fabric.stretch, fabric.shear, fabric.damping], (len(faces), 1))
    return Sheet(
        position, faces, inverse.reshape(-1, 4), area, modulus, edges,
        np.linalg.norm(position[edges[:, 0]] - position[edges[:, 1]], axis=1), hinges, weight, law, mass,
    )  # fmt: skip


def _in_plane(normal: F64, direction: F64) -> F64:
    """Unit vectors in the planes of `normal` (t, 3) nearest to a direction; where it stands upright, to the next axis."""
    along = direction - (normal @ direction)[:, None] * normal
    length = np.linalg.norm(along, axis=1)
    upright = length < 0.3 * np.linalg.norm(direction)
    if upright.any():
        other = np.roll(direction, 1)
        along[upright] = (other - (normal @ other)[:, None] * normal)[upright]
        length = np.linalg.norm(along, axis=1)
    return np.asarray(along / length[:, None])


def _edges(faces: I32) -> tuple[I32, I32]:
    """Edges (e, 2), and hinges (h, 4) of the inner ones."""
    corners = np.stack([faces, np.roll(faces, -1, axis=1), np.roll(faces, -2, axis=1)], axis=2).reshape(-1, 3)
    low, high = corners[:, :2].min(axis=1), corners[:, :2].max(axis=1)
    order = np.lexsort((high, low))
    low, high, opposite = low[order], high[order], corners[order, 2]
    first = np.flatnonzero(np.concatenate([[True], (low[1:] != low[:-1]) | (high[1:] != high[:-1])]))
    count = np.diff(np.concatenate([first, [len(low)]]))
    if count.max(initial=0) > 2:
        k = first[int(count.argmax())]
        raise InputError(
            f"edge {int(low[k])}-{int(high[k])} of a sheet has {int(count.max())} triangles; a sheet has at most two"
        )
    edges = np.stack([low[first], high[first]], axis=1).astype(np.int32)
    inner = first[count == 2]
    hinges = np.stack([low[inner], high[inner], opposite[inner], opposite[inner + 1]], axis=1).astype(np.int32)
    return edges, hinges


def _hinge_law(position: F64, hinges: I32, fabric: Fabric, *, flat: bool) -> tuple[F64, F64]:
    """Weights and law of hinges (after Wardetzky et al. 2007, doi:10.1016/j.cagd.2007.07.006: the bending energy of isometric
    deformations is quadratic in the weighted sum of the four vertices).

    A clamped plate of squares with diagonals in turn then sinks by 1.28 of the law along its squares, 1.02 halfway and 0.82 along the
    diagonals, one of equal-sided triangles by 1.05 to 1.1 in any direction (tests/physics/test_cloth.py).
    """
    if len(hinges) == 0:
        return np.empty((0, 4)), np.empty((0, 3))
    x0, x1, x2, x3 = (position[hinges[:, k]] for k in range(4))

    def cotangent(p: F64, q: F64) -> F64:
        return np.asarray((p * q).sum(1) / np.linalg.norm(np.cross(p, q), axis=1))

    at0 = (cotangent(x1 - x0, x2 - x0), cotangent(x1 - x0, x3 - x0))
    at1 = (cotangent(x0 - x1, x2 - x1), cotangent(x0 - x1, x3 - x1))
    weight = np.stack([at1[0] + at1[1], at0[0] + at0[1], -at0[0] - at1[0], -at0[1] - at1[1]], axis=1)
    both = 0.5 * (np.linalg.norm(np.cross(x1 - x0, x2 - x0), axis=1) + np.linalg.norm(np.cross(x1 - x0, x3 - x0), axis=1))
    vector = np.einsum("hk,hkj->hj", weight, position[hinges])
    normal = np.cross(x1 - x0, x2 - x0) + np.cross(x3 - x0, x1 - x0)
    length = np.zeros(len(hinges)) if flat else np.linalg.norm(vector, axis=1) * np.sign((vector * normal).sum(1))
    size = np.linalg.norm(x1 - x0, axis=1)
    length[np.abs(length) < 1e-6 * size] = 0.0
    law = np.stack([fabric.bend / both, length, np.full(len(hinges), fabric.damping)], axis=1)
    return weight, law
