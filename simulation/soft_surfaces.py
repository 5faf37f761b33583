"""Surfaces that deform, as boundaries of other matter: elastic bodies and cloth (R66, R68)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..worlds.arrays import F64, RigidPose, pose_of
from ..worlds.built import BuiltBody, BuiltEntity, TriangleMesh
from ..worlds.categories.deforming import lumped
from ..worlds.errors import EvidenceError, InputError
from .boundaries import Boundary, SoftBoundary

if TYPE_CHECKING:
    from ..worlds.cache import Cache
    from ..worlds.simulation_mesh import SimulationMesh
    from ..worlds.spec import WorldSpec

__all__ = ["VertexPath", "soft_boundaries"]

HERE = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))


class _Deformed(NamedTuple):
    """A deforming boundary with its mass properties."""

    boundary: Boundary
    body: BuiltBody
    soft: SoftBoundary


def soft_boundaries(
    spec: WorldSpec, built: Mapping[str, BuiltEntity], names: tuple[str, ...], *, friction: float | None = None
) -> Iterator[_Deformed]:
    """Surfaces of deforming entities at rest, in the world.

    Args:
        spec: the specification.
        built: its geometry.
        names: of the entities.
        friction: of every one; None takes that of its material.

    Raises:
        InputError: one has no simulation mesh.
    """
    for name in names:
        contract, whole = spec.entities[name], built[name]
        pose, start, vertices, faces, mass = pose_of(contract.pose), 0, [], [], []
        for part in whole.parts:
            mesh = part.simulation
            if mesh is None:
                raise InputError(f"part {part.part!r} of {name!r} has no simulation mesh; call place_object again")
            vertices.append(pose.apply(mesh.vertices))
            faces.append(mesh.faces + start)
            mass.append(lumped(mesh) * _size(mesh))
            start += len(mesh.vertices)
        share = np.concatenate(mass)
        weight = sum(b.mass for b in whole.bodies) * share / share.sum()
        place = np.concatenate(vertices)
        first = whole.bodies[0]
        body = BuiltBody(first.name, HERE, float(weight.sum()), weight @ place / weight.sum(), first.inertia, first.volume)
        rough = max(spec.materials[p.material].friction for p in whole.parts) if friction is None else friction
        closed = all(p.closed for p in whole.parts)
        surface = TriangleMesh(place, np.concatenate(faces).astype(np.int32))
        boundary = Boundary(f"{name}/{first.name}", surface, "dynamic", closed, rough, deforming=True)
        yield _Deformed(boundary, body, SoftBoundary(name, tuple(p.part for p in whole.parts), weight))


def _size(mesh: SimulationMesh) -> float:
    """Rest volume [m^3], of a sheet its area [m^2]."""
    if len(mesh.tets):
        edges = mesh.vertices[mesh.tets][:, 1:] - mesh.vertices[mesh.tets][:, :1]
        return float(np.abs(np.linalg.det(edges)).sum() / 6.0)
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


class VertexPath:
    """Vertices of a deforming entity on the paths that a cache holds: straight between two frames.

    Raises:
        EvidenceError: no cache has it.
    """

    def __init__(self, soft: SoftBoundary, caches: Mapping[str, Cache], fps: int) -> None:
        self._fps, self._kept = fps, dict[int, F64]()
        for cache in caches.values():
            start, rows = 0, dict[str, slice]()
            for name, count in zip(cache.index.deformables, cache.index.vertices, strict=True):
                rows[name] = slice(start, start + count)
                start += count
            if all(f"{soft.entity}/{part}" in rows for part in soft.parts):
                self._cache, self._rows = cache, [rows[f"{soft.entity}/{part}"] for part in soft.parts]
                return
        raise EvidenceError(f"no cache holds how {soft.entity!r} deforms; bake its instance first")

    def _frame(self, frame: int) -> F64:
        if frame not in self._kept:
            whole = np.asarray(self._cache.read(frame, ("vertex/position",))["vertex/position"], dtype=np.float64)
            self._kept[frame] = np.concatenate([whole[r] for r in self._rows])
            for old in [k for k in self._kept if k < frame - 1]:
                del self._kept[old]
        return self._kept[frame]

    def at(self, frame: int, share: float) -> tuple[F64, F64]:
        """Places [m] and velocities [m/s] when `share` of the way from `frame` to the next is done, each (v, 3)."""
        first, last = self._frame(frame), self._frame(frame + 1)
        return first + share * (last - first), (last - first) * self._fps
