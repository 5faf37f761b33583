"""Springs and ropes between two points, measured from poses: length, energy, and the impulse they give per interval."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64, compose, pose_of
from ...worlds.spec import SpringJoint
from .bounds import RESOLVED

if TYPE_CHECKING:
    from ..ledgers.balance import Books

__all__ = ["Spring", "springs_of"]

NODES = 9
"""Points of Simpson's rule per interval."""
HERMITE = 1.0 / 384.0
"""Error of cubic Hermite interpolation: h^4 max|x''''| / 384."""


@dataclass(frozen=True)
class Spring:
    """One spring of an instance; its ends over the frames."""

    name: str
    joint: SpringJoint
    child: int | None
    """Row of the entity; None for static ones and the world."""
    parent: int | None
    ends: tuple[F64, F64]
    """Points at the child and at the parent [m], each shape (F, 3)."""
    speeds: tuple[F64, F64]
    """[m/s]"""
    rest: float
    books: Books

    @cached_property
    def length(self) -> F64:
        """[m], shape (F,)."""
        return np.asarray(np.linalg.norm(self.ends[0] - self.ends[1], axis=1))

    @cached_property
    def until(self) -> float:
        """Time at which it is cut [s]."""
        return self.books.detached.get(self.name, np.inf)

    @cached_property
    def energy(self) -> F64:
        """[J], shape (F,)."""
        stretch = self.length - self.rest
        stretch = np.maximum(stretch, 0.0) if self.joint.rope else stretch
        return np.where(self.books.times < self.until - 1e-9, 0.5 * self.joint.stiffness * stretch**2, 0.0)

    def _force(self, apart: F64, closing: F64) -> F64:
        """Force on the child [N]; `apart` and `closing` are child less parent, shape (..., 3)."""
        length = np.linalg.norm(apart, axis=-1, keepdims=True)
        along = apart / np.maximum(length, 1e-12)
        stretch = length - self.rest
        rate = np.sum(along * closing, axis=-1, keepdims=True)
        pull = self.joint.stiffness * stretch + self.joint.damping * rate
        force: F64 = -np.where((stretch > 0) | (not self.joint.rope), pull, 0.0) * along
        return force

    @cached_property
    def impulse(self) -> tuple[F64, F64]:
        """Impulse on the child per interval [N s], shape (F - 1, 3), and its uncertainty, shape (F - 1,).

        The ends move along cubics through the states of both frames; contacts within the interval bend that by at most
        their budget over the mass for the whole interval.
        """
        books, h = self.books, self.books.duration
        apart, speed = self.ends[0] - self.ends[1], self.speeds[0] - self.speeds[1]
        s = np.linspace(0.0, 1.0, NODES)[:, None, None]
        p0, p1, m0, m1 = apart[:-1], apart[1:], h * speed[:-1], h * speed[1:]
        path = (2 * s**3 - 3 * s**2 + 1) * p0 + (s**3 - 2 * s**2 + s) * m0 + (3 * s**2 - 2 * s**3) * p1 + (s**3 - s**2) * m1
        rate = ((6 * s**2 - 6 * s) * (p0 - p1) + (3 * s**2 - 4 * s + 1) * m0 + (3 * s**2 - 2 * s) * m1) / h
        force = self._force(path, rate)
        weights = np.ones(NODES)
        weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
        weights /= 3.0 * (NODES - 1)
        acting = (books.overlap(0.0, self.until) / h)[:, None]
        given = h * np.einsum("s,sfi->fi", weights, force) * acting
        partial = (acting[:, 0] > 1e-9) & (acting[:, 0] < 1 - 1e-9)
        rows = [r for r in (self.child, self.parent) if r is not None and not books.kinematic[r]]
        masses = [books.mass[r] for r in rows]
        if not masses:
            return given, np.zeros(len(given))
        lightest = float(min(masses))
        phase = np.sqrt(self.joint.stiffness / lightest) * h + self.joint.damping / lightest * h
        largest = np.linalg.norm(force, axis=2).max(axis=0) * h
        # Besides the cubic, the engine's forces are those of a step's beginning: half a step late.
        late = 0.5 * books.step / h * phase
        doubt = largest * (HERMITE * phase**2 + late)
        kick = sum(books.contact_budget[:, r] / books.mass[r] for r in rows)
        doubt = doubt + kick * h * (self.joint.stiffness * h + self.joint.damping)
        if self.joint.rope:
            # A rope that goes taut or slack within the interval pulls for an unknown part of it.
            taut = (np.linalg.norm(path, axis=2) > self.rest).mean(axis=0)
            doubt = doubt + np.where((taut > 0) & (taut < 1), largest, 0.0)
        doubt = np.where(partial, doubt + largest, doubt)
        if phase > RESOLVED:
            doubt = np.full(len(given), np.inf)
        return given, np.where(acting[:, 0] > 0, doubt, 0.0)


def springs_of(books: Books) -> tuple[Spring, ...]:
    """Springs whose child belongs to the instance."""
    found = []
    for name, joint in books.candidate.spec.simulation.joints.items():
        if not isinstance(joint, SpringJoint) or joint.child not in books.cache.index.colliders:
            continue
        ends, speeds = zip(
            *(_end(books, e, p) for e, p in ((joint.child, joint.child_point), (joint.parent, joint.parent_point))), strict=True
        )
        rest = joint.rest_length
        if rest is None:
            rest = float(np.linalg.norm(np.subtract(joint.child_point, joint.parent_point)))
        rows = books.row.get(joint.child), books.row.get(joint.parent or "")
        found.append(Spring(name, joint, rows[0], rows[1], (ends[0], ends[1]), (speeds[0], speeds[1]), rest, books))
    return tuple(found)


def _end(books: Books, entity: str | None, point: tuple[float, float, float]) -> tuple[F64, F64]:
    """Position [m] and velocity [m/s] of a point of an entity, each shape (F, 3); `point` is in the world as specified."""
    row = books.row.get(entity or "")
    if entity is None or row is None:
        return np.tile(np.array(point, dtype=np.float64), (books.frames, 1)), np.zeros((books.frames, 3))
    body = int(books.first[row])
    built = books.candidate.entity(entity).bodies[0]
    start = compose(pose_of(books.candidate.spec.entities[entity].pose), built.pose)
    arm = books.turns[:, body] @ (start.inverse().apply(np.array([point], dtype=np.float64))[0] - built.center)
    return books.body_centers[:, body] + arm, books.velocity[:, body] + np.cross(books.spin[:, body], arm)
