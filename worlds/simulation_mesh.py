"""Simulation meshes: what a solver deforms, and how the visible vertices follow."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from .arrays import F64, I32

__all__ = ["SimulationMesh", "mesh_arrays", "mesh_from", "volumes"]


@dataclass(frozen=True)
class SimulationMesh:
    """Mesh of a deforming part at rest, in its body's frame.

    Channel `vertex/position` holds the vertices of all such parts of an instance, in the order of `CacheIndex.deformables`.
    """

    vertices: F64
    """[m], shape (n, 3)."""
    faces: I32
    """The surface that collides, shape (m, 3), counter-clockwise seen from outside."""
    tets: I32
    """Shape (k, 4), of positive volume at rest; empty for sheets."""
    indices: I32
    """Vertices that carry each visible vertex, shape (r, 4)."""
    weights: F64
    """Their weights, each row sums to 1, shape (r, 4)."""
    cells: I32 = field(default_factory=lambda: np.zeros(3, dtype=np.int32))
    """Cells of the lattice that carries it, along x, y, z of the body's frame, shape (3,); zeros where there is none."""

    def bound(self, positions: F64) -> F64:
        """Visible vertices where the simulation vertices are at `positions`, shape (..., n, 3) -> (..., r, 3) [m]."""
        return np.asarray(np.einsum("rk,...rkc->...rc", self.weights, positions[..., self.indices, :]))


def volumes(positions: F64, tets: I32) -> F64:
    """Signed volumes of tetrahedra [m^3], shape (k,); negative where one is inverted."""
    corner = positions[tets]
    edges = corner[:, 1:] - corner[:, :1]
    return np.asarray(np.einsum("ni,ni->n", edges[:, 0], np.cross(edges[:, 1], edges[:, 2])) / 6.0)


NAMES = tuple(f.name for f in fields(SimulationMesh))


def mesh_arrays(mesh: SimulationMesh, prefix: str) -> Iterable[tuple[str, Any]]:
    """Its arrays by name, for a file of arrays."""
    return ((f"{prefix}/{name}", getattr(mesh, name)) for name in NAMES)


def mesh_from(array: Callable[[str], Any], prefix: str) -> SimulationMesh:
    """The mesh whose arrays a file holds under `prefix`."""
    return SimulationMesh(*(array(f"{prefix}/{name}") for name in NAMES))
