"""Deforming entities in a candidate: where their simulation vertices are, and the rigid motion that fits them best.

The frame of a deforming body at a frame is the rest frame moved by the best rigid fit of its simulation vertices, weighted by
mass (W. Kabsch, Acta Crystallographica A 32 (1976) 922): its centre of mass is exact, its rotation is that of least squares.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import F64, RigidPose, quaternion_of
from ..built import BuiltEntity, BuiltPart
from ..cache import Cache
from ..errors import EvidenceError
from ..kept import kept
from ..simulation_mesh import SimulationMesh, volumes

__all__ = ["Deforming", "deforming_of", "lumped"]


def lumped(mesh: SimulationMesh) -> F64:
    """Share of the rest volume, or of the area of a sheet, that belongs to each simulation vertex; shape (n,), sums to 1."""
    cells, corners = mesh.tets, 4
    if len(cells):
        size = np.abs(volumes(mesh.vertices, cells))
    else:
        cells, corners = mesh.faces, 3
        a, b, c = (mesh.vertices[cells[:, k]] for k in range(3))
        size = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    weight = np.bincount(cells.reshape(-1), np.repeat(size / corners, corners), minlength=len(mesh.vertices))
    return np.asarray(weight / max(float(weight.sum()), 1e-300))


@dataclass(frozen=True, eq=False)
class Deforming:
    """One deforming entity of a cache."""

    entity: str
    built: BuiltEntity
    cache: Cache
    ranges: dict[str, slice]
    """Rows of the channels `vertex/*`, per part."""

    @cached_property
    def meshes(self) -> dict[str, SimulationMesh]:
        """Simulation mesh per part."""
        return {p.part: p.simulation for p in self.built.parts if p.simulation is not None}

    @cached_property
    def masses(self) -> F64:
        """Mass of every simulation vertex, all parts one after the other [kg], shape (n,)."""
        size = {name: _size(mesh) for name, mesh in self.meshes.items()}
        total = sum(size.values())
        mass = sum(b.mass for b in self.built.bodies)
        return mass * np.concatenate([lumped(self.meshes[name]) * size[name] / total for name in self.ranges])

    @cached_property
    def rest(self) -> F64:
        """Simulation vertices at rest in the body's frame, all parts one after the other [m], shape (n, 3)."""
        return np.concatenate([self.meshes[name].vertices for name in self.ranges])

    def positions(self, frame: int, part: str | None = None) -> F64:
        """Simulation vertices in the world [m], of one part or of all, shape (n, 3)."""
        return self._channel("vertex/position", frame, part)

    def velocities(self, frame: int, part: str | None = None) -> F64:
        """Velocities of the simulation vertices [m/s], of one part or of all, shape (n, 3)."""
        return self._channel("vertex/velocity", frame, part)

    def _channel(self, name: str, frame: int, part: str | None) -> F64:
        rows = self._read(name, frame)
        wanted = self.ranges.values() if part is None else (self.ranges[part],)
        return np.concatenate([rows[r] for r in wanted])

    @kept(64)
    def _read(self, name: str, frame: int) -> F64:
        found = np.asarray(self.cache.read(frame, (name,))[name], dtype=np.float64)
        if found.shape != (sum(self.cache.index.vertices), 3):
            raise EvidenceError(f"channel {name!r} of frame {frame} has shape {found.shape}; bake again")
        return found

    @kept(4096)
    def pose(self, frame: int) -> RigidPose:
        """Best rigid fit of the rest shape's frame; not finite where the vertices are not."""
        now, weight = self.positions(frame), self.masses / self.masses.sum()
        here, there = weight @ now, weight @ self.rest
        if not np.isfinite(now).all():
            return RigidPose(np.full(3, np.nan), np.full(4, np.nan))
        left, _, right = np.linalg.svd(((now - here) * weight[:, None]).T @ (self.rest - there))
        turn = left @ np.diag([1.0, 1.0, np.sign(np.linalg.det(left) * np.linalg.det(right)) or 1.0]) @ right
        return RigidPose(here - turn @ there, quaternion_of(turn))

    def velocity(self, frame: int) -> F64:
        """Velocity of the centre of mass [m/s], shape (3,)."""
        return np.asarray(self.masses @ self.velocities(frame) / self.masses.sum())

    def spin(self, frame: int) -> F64:
        """Angular velocity of the rigid motion with the same angular momentum [rad/s], world axes, shape (3,)."""
        arm = self.positions(frame) - self.masses @ self.positions(frame) / self.masses.sum()
        turning = (self.masses[:, None] * np.cross(arm, self.velocities(frame))).sum(0)
        inertia = np.eye(3) * (self.masses @ (arm**2).sum(1)) - (arm * self.masses[:, None]).T @ arm
        return np.asarray(np.linalg.lstsq(inertia, turning, rcond=None)[0])

    def surface(self, part: BuiltPart, frame: int) -> F64:
        """Visible vertices of a part in the world [m], shape (r, 3)."""
        return self.meshes[part.part].bound(self.positions(frame, part.part))


def _size(mesh: SimulationMesh) -> float:
    """Rest volume [m^3], of a sheet its area [m^2]."""
    if len(mesh.tets):
        return float(np.abs(volumes(mesh.vertices, mesh.tets)).sum())
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def deforming_of(built: Mapping[str, BuiltEntity], caches: Mapping[str, Cache]) -> dict[str, Deforming]:
    """Deforming entities by name.

    Raises:
        EvidenceError: a cache has other parts or numbers of vertices than what is built.
    """
    found: dict[str, Deforming] = {}
    for cache in caches.values():
        start, ranges = 0, dict[str, dict[str, slice]]()
        for name, count in zip(cache.index.deformables, cache.index.vertices, strict=True):
            entity, part = name.split("/", 1)
            ranges.setdefault(entity, {})[part] = slice(start, start + count)
            start += count
        for entity, own in ranges.items():
            parts = {p.part: p.simulation for p in built[entity].parts} if entity in built else {}
            for part, rows in own.items():
                mesh = parts.get(part)
                if mesh is None or len(mesh.vertices) != rows.stop - rows.start:
                    raise EvidenceError(f"the cache of {entity}/{part} does not belong to what is built; bake again")
            found[entity] = Deforming(entity, built[entity], cache, own)
    return found
