"""A lattice of cells with quadratic displacements (27 nodes each), and what a body embedded in it weighs and stores.

Displacements are tensor products of quadratic Lagrange polynomials in each cell (the finite cell method: J. Parvizian, A. Duester,
E. Rank, Computational Mechanics 41 (2007) 121), so that bending is free of the locking of linear tetrahedra. Integrals over the body
are sums over its tetrahedra.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, I64
from ...worlds.simulation_mesh import SimulationMesh, volumes

__all__ = ["Lattice"]

_GAUSS = np.array([[0.58541020, 0.13819660, 0.13819660, 0.13819660]])
CORNERS = np.concatenate([np.roll(_GAUSS, k, axis=1) for k in range(4)])
"""Barycentric points of the rule of degree 2 on a tetrahedron, each of a quarter of the weight (P. Hammer and A. Stroud, 1956)."""
LEAST_MASS = 0.02
"""Least mass of a node in units of the mean: a node whose share of a cut cell is less, or negative, has this much."""


@dataclass(frozen=True, eq=False)
class Lattice:
    """Nodes along x, y, z at rest in the body's frame, z fastest; `2 cells + 1` along each axis."""

    mesh: SimulationMesh

    @cached_property
    def low(self) -> F64:
        """Least corner [m], shape (3,)."""
        return np.asarray(self.mesh.vertices.min(0))

    @cached_property
    def counts(self) -> I64:
        """Nodes along each axis, shape (3,)."""
        return 2 * self.mesh.cells.astype(np.int64) + 1

    @cached_property
    def edge(self) -> F64:
        """Edges of a cell [m], shape (3,)."""
        return np.asarray(np.ptp(self.mesh.vertices, axis=0) / self.mesh.cells)

    @cached_property
    def nodes(self) -> F64:
        """Places of the nodes at rest [m], shape (n, 3)."""
        axes: list[F64] = [a + 0.5 * e * np.arange(c) for a, e, c in zip(self.low, self.edge, self.counts, strict=True)]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)

    def _local(self, points: F64) -> tuple[I64, F64]:
        """The 27 nodes of each point's cell, shape (p, 27), and the point in it, 0..1 per axis, shape (p, 3)."""
        scaled = (points - self.low) / self.edge
        cell = np.clip(np.floor(scaled), 0, self.mesh.cells - 1).astype(np.int64)
        steps = np.stack(np.meshgrid(*[np.arange(3)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
        at = 2 * cell[:, None] + steps
        return (at[..., 0] * self.counts[1] + at[..., 1]) * self.counts[2] + at[..., 2], scaled - cell

    def shape(self, points: F64) -> tuple[I64, F64]:
        """Nodes that carry points at rest, and their weights, each (p, 27)."""
        index, x = self._local(points)
        line = _line(x)
        return index, np.einsum("pa,pb,pc->pabc", line[:, 0], line[:, 1], line[:, 2]).reshape(-1, 27)

    def slopes(self, points: F64) -> tuple[I64, F64]:
        """The same with the gradients of the weights [1/m], shape (p, 27, 3)."""
        index, x = self._local(points)
        line, slope = _line(x), _slope(x) / self.edge[:, None]
        parts = []
        for axis in range(3):
            own = [slope[:, k] if k == axis else line[:, k] for k in range(3)]
            parts.append(np.einsum("pa,pb,pc->pabc", *own).reshape(-1, 27))
        return index, np.stack(parts, axis=-1)

    @cached_property
    def vertex_weights(self) -> tuple[I64, F64]:
        """Nodes of each simulation vertex and their weights."""
        return self.shape(self.mesh.vertices)

    def at_vertices(self, values: F64) -> F64:
        """Values at the nodes, shape (n, 3), taken to the simulation vertices, shape (v, 3)."""
        index, weight = self.vertex_weights
        return np.asarray(np.einsum("pk,pkc->pc", weight, values[index]))

    def to_nodes(self, forces: F64) -> F64:
        """Forces at the simulation vertices, shape (v, 3), taken to the nodes, shape (n, 3): the transpose of `at_vertices`."""
        index, weight = self.vertex_weights
        found = np.zeros((len(self.nodes), 3))
        touched = np.flatnonzero(forces.any(axis=1))
        np.add.at(found, index[touched], weight[touched][..., None] * forces[touched, None])
        return found

    @cached_property
    def used(self) -> NDArray[np.bool_]:
        """Nodes of cells that hold some of the body, shape (n,)."""
        found = np.zeros(len(self.nodes), dtype=bool)
        index, _ = self._local(self.mesh.vertices[self.mesh.tets].mean(axis=1))
        found[index.reshape(-1)] = True
        return found

    def masses(self, mass: float) -> F64:
        """Share of the body's `mass` [kg] at each node, shape (n,): 0 where nothing of the body is, positive elsewhere."""
        corner = self.mesh.vertices[self.mesh.tets]
        weight = np.abs(volumes(self.mesh.vertices, self.mesh.tets))
        own = np.zeros(len(self.nodes))
        for points, share in _finer():
            # Masses are of degree 6 in a cell: hence eight halves of each tetrahedron.
            index, shape = self.shape((points @ corner).reshape(-1, 3))
            sums = np.repeat(weight * share, len(points)) / len(points)
            own += np.bincount(index.reshape(-1), (shape * sums[:, None]).reshape(-1), minlength=len(own))
        least = LEAST_MASS * float(weight.sum()) / max(int(self.used.sum()), 1)
        own = np.where(self.used, np.maximum(own, least), 0.0)
        return np.asarray(own * (mass / own.sum()))

    @cached_property
    def _points(self) -> tuple[I64, F64, F64]:
        """Nodes and slopes at the integration points, and the volume of each point [m^3]."""
        corner = self.mesh.vertices[self.mesh.tets]
        index, slope = self.slopes((CORNERS @ corner).reshape(-1, 3))
        return index, slope, np.repeat(np.abs(volumes(self.mesh.vertices, self.mesh.tets)) / 4.0, 4)

    def gradients(self, places: F64) -> F64:
        """Deformation gradients at the integration points with the nodes at `places`, shape (q, 3, 3)."""
        index, slope, _ = self._points
        return np.asarray(np.einsum("pkc,pkd->pcd", places[index], slope))

    def energy(self, places: F64, young: float, poisson: float) -> float:
        """Elastic energy of the corotated linear material [J] with the nodes at `places` [m], shape (n, 3); NaN where one is not finite."""
        if not np.isfinite(places).all():
            return np.nan
        stretch = np.linalg.svd(self.gradients(places), compute_uv=False) - 1.0
        mu, lame = young / (2 * (1 + poisson)), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
        density = mu * (stretch**2).sum(axis=1) + 0.5 * lame * stretch.sum(axis=1) ** 2
        return float(density @ self._points[2])


def _line(x: F64) -> F64:
    """Quadratic Lagrange polynomials on 0, 1/2, 1 at x, shape (..., 3) -> (..., 3, 3)."""
    return np.stack([(1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1)], axis=-1)


def _slope(x: F64) -> F64:
    return np.stack([4 * x - 3, 4 - 8 * x, 4 * x - 1], axis=-1)


def _finer() -> list[tuple[F64, float]]:
    """Barycentric points (4, 4) and shares of the volume of the eight halves of a tetrahedron (J. Bey, 1995)."""
    corner = np.eye(4)
    mid = {(a, b): 0.5 * (corner[a] + corner[b]) for a in range(4) for b in range(a + 1, 4)}
    m01, m02, m03, m12, m13, m23 = (mid[k] for k in ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)))
    c0, c1, c2, c3 = corner
    halves = [(c0, m01, m02, m03), (m01, c1, m12, m13), (m02, m12, c2, m23), (m03, m13, m23, c3)]
    halves += [(m01, m02, m03, m13), (m01, m02, m12, m13), (m02, m03, m13, m23), (m02, m12, m13, m23)]
    return [(CORNERS @ np.array(h), 1.0 / 8.0) for h in halves]
