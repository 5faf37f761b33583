"""Boundaries of a liquid: motion of their bodies, and the impulses and work that passed between them and the liquid."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ....worlds.arrays import F64, rotation_matrix
from ....worlds.errors import EvidenceError
from ...ledgers.exchanged import partners

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.categories.deforming import Deforming
    from .frames import Frame, Liquid

__all__ = ["Bodies", "exchanged", "impulses"]


class Bodies:
    """The boundaries of a liquid instance in the order of `CacheIndex.colliders`, with their motion at every frame."""

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.names = tuple(liquid.cache.index.colliders)
        self.candidate: Candidate = liquid.candidate
        unknown = [n for n in self.names if n.count("/") != 1 or n.split("/")[0] not in self.candidate.spec.entities]
        if unknown:
            raise EvidenceError(f"collider {unknown[0]!r} of {liquid.solver!r} is not planned; bake again")

    @property
    def count(self) -> int:
        """Boundaries."""
        return len(self.names)

    @cached_property
    def entities(self) -> tuple[str, ...]:
        """Entity of every boundary."""
        return tuple(n.split("/")[0] for n in self.names)

    @cached_property
    def free(self) -> list[bool]:
        """Which of them are moved by forces."""
        return [self.candidate.spec.entities[n].motion == "dynamic" for n in self.entities]

    def coupled(self, row: int) -> str:
        """`two_way`, `one_way`, or `` where nothing is declared between the liquid and the instance that moves the body."""
        plan, entity, solver = self.candidate.spec.simulation, self.entities[row], self.liquid.solver
        owners = {n for n, s in plan.solvers.items() if entity in s.members}
        found = [c.direction for c in plan.couplings.values() if {c.source, c.target} & owners and solver in (c.source, c.target)]
        return "two_way" if "two_way" in found else "one_way" if found else ""

    @cached_property
    def motion(self) -> tuple[F64, F64]:
        """Velocity of the centre of mass and angular velocity, each shape (frames, b, 3); zero for what stands still."""
        linear, angular = np.zeros((2, self.liquid.frames, self.count, 3))
        for row, name in enumerate(self.names):
            held = self.candidate.cache_row(*name.split("/"))
            soft = self.candidate.deforming.get(name.split("/")[0])
            if soft is not None:
                linear[:, row] = [soft.velocity(k) for k in range(self.liquid.frames)]
                angular[:, row] = [soft.spin(k) for k in range(self.liquid.frames)]
            elif held is not None:
                cache, body = held
                linear[:, row] = cache.series("velocity")[: self.liquid.frames, body]
                angular[:, row] = cache.series("angular_velocity")[: self.liquid.frames, body]
        return linear, angular

    @cached_property
    def deforming(self) -> dict[int, Deforming]:
        """Those that deform, by row."""
        known = self.candidate.deforming
        return {row: known[n] for row, n in enumerate(self.entities) if n in known}

    def told_work(self, frame: int) -> tuple[set[int], float]:
        """Rows that deform and are pushed by this liquid alone, and the work [J] that those who move them say it did in a frame."""
        rows: set[int] = set()
        work, counted = 0.0, set[str]()
        for row, soft in self.deforming.items():
            cache = soft.cache
            if partners(self.candidate.spec, cache.index.solver) != (self.liquid.solver,):
                continue
            rows.add(row)
            if cache.index.solver not in counted:
                counted.add(cache.index.solver)
                work += _work(cache, frame, cloth=self.candidate.spec.entities[soft.entity].physics.category == "cloth")
        return rows, work

    def bending(self, frame: int) -> F64:
        """Root mean square speed against their own rigid motion of those that deform [m/s], shape (b,)."""
        found = np.zeros(self.count)
        for row, soft in self.deforming.items():
            place, weight = soft.positions(frame), soft.masses / soft.masses.sum()
            rigid = soft.velocity(frame) + np.cross(soft.spin(frame), place - weight @ place)
            found[row] = np.sqrt(weight @ ((soft.velocities(frame) - rigid) ** 2).sum(axis=1))
        return found

    @cached_property
    def moving(self) -> F64:
        """Fastest of all at every frame [m/s], shape (frames,); of the surface, roughly: radius 1 m at most."""
        return np.asarray(self.fastest.max(axis=1, initial=0.0))

    @cached_property
    def fastest(self) -> F64:
        """Bound of the speed of each one's surface at every frame [m/s], shape (frames, b)."""
        linear, angular = self.motion
        return np.asarray(np.linalg.norm(linear, axis=2) + np.linalg.norm(angular, axis=2) * self.reach)

    def pushes(self, points: F64, frame: int) -> F64:
        """Speed [m/s] of the fastest of those that can have met each point between the frame before and this one, shape (n,).

        One can where the point lies within its farthest reach, two spacings and its way, about its centre of mass at either frame.

        Args:
            points: [m], shape (n, 3).
            frame: at least 1.
        """
        found = np.zeros(len(points))
        for row, name in enumerate(self.names):
            speed = float(self.fastest[frame - 1 : frame + 1, row].max())
            if speed <= 0.0:
                continue
            entity, body = name.split("/")
            center = self.candidate.body(entity, body).center
            near = self.reach[row] + 2.0 * self.liquid.spacing + speed * self.liquid.duration
            for at in (frame - 1, frame):
                middle = self.candidate.pose(entity, at, body).apply(center[None])[0]
                met = np.linalg.norm(points - middle, axis=1) <= near
                found[met] = np.maximum(found[met], speed)
        return found

    def _reach(self, name: str) -> float:
        """Farthest point of a body from its centre of mass [m]."""
        entity, body = name.split("/")
        center = self.candidate.body(entity, body).center
        parts = self.candidate.entity(entity).parts_of(body)
        return max((float(np.linalg.norm(p.render.vertices - center, axis=1).max()) for p in parts), default=0.0)

    @cached_property
    def reach(self) -> F64:
        """Farthest point of every body from its centre of mass [m], shape (b,)."""
        return np.array([self._reach(n) for n in self.names])

    @cached_property
    def mass(self) -> F64:
        """[kg], shape (b,)."""
        return np.array([self.candidate.body(*n.split("/")).mass for n in self.names])

    @cached_property
    def centers(self) -> F64:
        """Centres of mass in the world [m], shape (frames, b, 3)."""
        result = np.zeros((self.liquid.frames, self.count, 3))
        for row, name in enumerate(self.names):
            position, quaternion = self.candidate.track(*name.split("/"))
            offset = self.candidate.body(*name.split("/")).center
            result[:, row] = (position + rotation_matrix(quaternion) @ offset)[: self.liquid.frames]
        return result


def _work(cache: Cache, frame: int, *, cloth: bool) -> float:
    """Work of others on what an instance deforms, over a frame [J]: of cloth the sum since frame 0 is recorded."""
    name = "record/load_work" if cloth else "record/soft_exchange_work"
    held = [float(cache.read(k, (name,))[name]) for k in ((frame - 1, frame) if cloth else (frame,))]
    return held[-1] - (held[0] if cloth else 0.0)


def exchanged(frame: Frame, name: str, count: int) -> F64:
    """Channel `exchange/<name>` of a frame, shape (b, 6).

    Raises:
        EvidenceError: it is missing or of another shape.
    """
    return _shaped(frame.others, name, frame.index, count)


def impulses(liquid: Liquid) -> F64:
    """Channel `exchange/impulse` of all frames, shape (F, b, 6): read once, and without the particles.

    Raises:
        EvidenceError: it is missing or of another shape at one of them.
    """

    def read() -> F64:
        count, cache = len(liquid.cache.index.colliders), liquid.cache
        return np.array([_shaped(cache.read(k, ("exchange/impulse",)), "impulse", k, count) for k in range(liquid.frames)])

    return liquid.candidate.memo(("liquid impulses", liquid.solver, liquid.frames), read)


def _shaped(held: Mapping[str, Any], name: str, frame: int, count: int) -> F64:
    found = held.get(f"exchange/{name}")
    if found is None or np.shape(found) != (count, 6):
        shown = "is missing" if found is None else f"has shape {np.shape(found)}"
        raise EvidenceError(f"exchange/{name} of frame {frame} {shown}, {(count, 6)} is needed; bake again")
    return np.array(found, dtype=np.float64)
