"""Surfaces of entities where they stand at frame 0, and the clearance between them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..geometry import Solid, kept_solid, signed_clearance
from ..worlds.arrays import F64, RigidPose, compose, pose_of
from ..worlds.built import BuiltEntity, TriangleMesh
from ..worlds.errors import InputError
from ..worlds.folder import WorldFolder
from ..worlds.spec import WorldSpec
from .store import build_world

__all__ = ["Body", "Scene", "clearance", "upper_heights"]

STILL_GAP = 1e-4
"""[m] Clearance that is left between things that never move, and on which no collision skin acts."""


class Body(NamedTuple):
    """Surfaces of one entity, in its own frame."""

    solids: tuple[tuple[RigidPose, Solid], ...]

    def points(self, pose: RigidPose) -> F64:
        """All vertices at a pose [m], shape (n, 3)."""
        return np.concatenate([pose.apply(place.apply(solid.vertices)) for place, solid in self.solids])

    def box(self, pose: RigidPose) -> tuple[F64, F64]:
        """Least and greatest corner at a pose [m], shape (3,) each."""
        points = self.points(pose)
        return points.min(0), points.max(0)

    def scaled(self, factor: float) -> Body:
        """The same, larger or smaller by a factor about the entity's origin."""
        return Body(
            tuple(
                (
                    RigidPose(factor * place.position, place.quaternion),
                    kept_solid(TriangleMesh(factor * solid.vertices, solid.faces), closed=solid.closed),
                )
                for place, solid in self.solids
            )
        )


LEVEL = 0.005
"""[m] Own choice: what ends no higher above the lowest of an assembly stands with it."""


class Scene:
    """Entities of a world at frame 0, built as they are asked for.

    Args:
        folder: the world.
        spec: its specification.
    """

    def __init__(self, folder: WorldFolder, spec: WorldSpec) -> None:
        self._folder, self.spec = folder, spec
        self._bodies: dict[str, Body] = {}

    def body(self, name: str) -> Body:
        """Surfaces of an entity.

        Raises:
            InputError: it cannot be built.
        """
        if name not in self._bodies:
            built = self.built(name)
            poses = {b.name: b.pose for b in built.bodies}
            self._bodies[name] = Body(tuple((poses[p.body], kept_solid(p.render, closed=p.closed)) for p in built.parts))
        return self._bodies[name]

    def built(self, name: str) -> BuiltEntity:
        """Built geometry of an entity."""
        return build_world(self._folder, self.spec, [name])[0][name]

    def mass(self, names: Sequence[str]) -> tuple[float, F64]:
        """Mass of entities [kg], and its centre in the frame of the first one [m]."""
        back, total, moment = self.pose(names[0]).inverse(), 0.0, np.zeros(3)
        for name in names:
            for body in self.built(name).bodies:
                place = compose(compose(back, self.pose(name)), body.pose)
                total += body.mass
                moment += body.mass * place.apply(body.center[None])[0]
        return total, moment / total

    def level(self, name: str, at: F64) -> float:
        """Height of the upper surface of an entity over x, y [m].

        Raises:
            InputError: it is not there.
        """
        height = float(upper_heights(self.body(name), self.pose(name), np.asarray(at)[None, :2])[0])
        if not np.isfinite(height):
            raise InputError(f"{name!r} is not at x, y = {at[0]:.4g}, {at[1]:.4g} m; give `at` over it")
        return height

    def joined(self, names: Sequence[str]) -> Body:
        """Surfaces of entities as they stand to each other, in the frame of the first one."""
        if len(names) == 1:
            return self.body(names[0])
        back = self.pose(names[0]).inverse()
        return Body(
            tuple((compose(compose(back, self.pose(n)), place), solid) for n in names for place, solid in self.body(n).solids)
        )

    def pose(self, name: str) -> RigidPose:
        """Pose of an entity at frame 0."""
        return pose_of(self.spec.entities[name].pose)

    def standing_gap(self, names: Sequence[str], on: str) -> float:
        """Largest gap that those of some entities which stand lowest leave over another [m]: a lid asks for none of its jar."""
        lows = {n: float(self.body(n).box(self.pose(n))[0][2]) for n in names}
        lowest = min(lows.values())
        return max(self.gap(n, on) for n in names if lows[n] <= lowest + LEVEL)

    def gap(self, a: str, b: str) -> float:
        """Clearance [m] at which b rests on a: their collision skins; less air between things that never move."""
        skins = sum(
            max((s.settings.skin for s in self.spec.simulation.rigid.values() if name in s.members), default=0.0)
            for name in (a, b)
        )
        still = all(self.spec.entities[name].motion == "static" for name in (a, b))
        return min(STILL_GAP, skins) if still else skins


def clearance(a: Body, pose_a: RigidPose, b: Body, pose_b: RigidPose) -> float:
    """Least exact signed clearance between the parts of two bodies [m]; negative where they overlap."""
    return min(
        signed_clearance(solid_a, compose(pose_a, place_a), solid_b, compose(pose_b, place_b)).distance
        for place_a, solid_a in a.solids
        for place_b, solid_b in b.solids
    )


def upper_heights(body: Body, pose: RigidPose, at: F64) -> F64:
    """Height of the upper surface over points (n, 2) [m], NaN where there is none."""
    found = np.full(len(at), -np.inf)
    low, high = at.min(0), at.max(0)
    for place, solid in body.solids:
        corners = compose(pose, place).apply(solid.triangles.reshape(-1, 3)).reshape(-1, 3, 3)
        plan = corners[:, :, :2]
        near = (plan.min(1) <= high).all(1) & (plan.max(1) >= low).all(1)
        for triangle in corners[near]:
            a, b, c = triangle
            edges = np.column_stack([b[:2] - a[:2], c[:2] - a[:2]])
            area = float(np.linalg.det(edges))
            if abs(area) < 1e-15:
                continue
            weight = np.linalg.solve(edges, (at - a[:2]).T)
            inside = (weight >= -1e-12).all(0) & (weight.sum(0) <= 1 + 1e-12)
            z = a[2] + weight[0] * (b[2] - a[2]) + weight[1] * (c[2] - a[2])
            found = np.where(inside, np.maximum(found, z), found)
    return np.where(np.isfinite(found), found, np.nan)
