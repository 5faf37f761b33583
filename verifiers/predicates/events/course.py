"""Course of one entity over the frames: where it is, how it moves and turns, what gave it momentum and who touched it.

Axes: frames F; intervals F - 1, interval k leads from frame k to k + 1. Contacts come from the logs of rigid instances.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ....worlds.fields import fields_of
from ...categories.registry import judge_of, pressed
from ...ledgers import motion
from ...ledgers.balance import Books, books_of, contacts_of
from ...ledgers.origins import Given, Origin

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ....worlds.candidate import Candidate

__all__ = ["Between", "Course", "between", "course_of"]

CARRIERS = frozenset({"driver", "spring", "matter", "contact", "unlisted"})
"""Kinds of origin that can carry a body; air that drags it does not, and fields of a medium bear nothing."""


class Between(NamedTuple):
    """Contact of one entity with another, per interval."""

    impulse: F64
    """On the other, friction included [N s], shape (F - 1, 3)."""
    touched: NDArray[np.bool_]
    """True where a contact was logged, shape (F - 1,)."""


class Course:
    """Course of one entity; obtain it with `course_of`."""

    def __init__(self, candidate: Candidate, entity: str) -> None:
        motion.require_motion(candidate, entity)
        self.candidate, self.entity = candidate, entity
        self.judge = judge_of(candidate.spec, entity)
        self.gravity: F64 = np.array(candidate.spec.simulation.gravity, dtype=np.float64)
        self.strength = float(np.linalg.norm(self.gravity))
        """[m/s^2]"""
        self.up: F64 = -self.gravity / self.strength if self.strength > 0 else np.array([0.0, 0.0, 1.0])
        """Unit vector against gravity."""
        self.step = 1.0 / candidate.spec.simulation.fps
        """Time between frames [s]."""

    @cached_property
    def size(self) -> float:
        """Half of the smallest extent, and no less than what counts as contact [m]."""
        contract = self.candidate.spec.entities[self.entity]
        return max(0.5 * min(contract.dimensions.size), self.candidate.spec.simulation.limits.contact_gap)

    @cached_property
    def books(self) -> tuple[Books, int] | None:
        """Ledger of the rigid instance that moves it and its row there; None where none does."""
        for cache in self.candidate.rigid_caches.values():
            if cache.index.bodies:
                books = books_of(self.candidate, cache)
                if self.entity in books.row:
                    return books, books.row[self.entity]
        return None

    @cached_property
    def centers(self) -> F64:
        """Centre of mass [m], shape (F, 3)."""
        return self.judge.centers(self.candidate, self.entity)

    @cached_property
    def velocities(self) -> F64:
        """Velocity of the centre of mass [m/s], shape (F, 3)."""
        return self.judge.velocities(self.candidate, self.entity)

    @cached_property
    def stirs(self) -> NDArray[np.bool_]:
        """True where it moves itself at either end of an interval between frames, and not only what touches it, shape (F - 1,)."""
        moving = self.judge.moving(self.candidate, self.entity)
        return np.asarray(moving[:-1] | moving[1:])

    @cached_property
    def mass(self) -> float:
        """Mass at frame 0 [kg]."""
        return float(self.judge.mass(self.candidate, self.entity)[0])

    @cached_property
    def heights(self) -> F64:
        """Height of the centre against gravity [m], shape (F,)."""
        result: F64 = self.centers @ self.up
        return result

    @cached_property
    def kinetic(self) -> F64:
        """Kinetic energy [J], shape (F,); of translation alone where no rigid instance moves it."""
        if self.books is not None:
            books, row = self.books
            moving: F64 = books.kinetic[: self.candidate.frame_count, row]
            return moving
        result: F64 = 0.5 * self.mass * np.sum(self.velocities**2, axis=1)
        return result

    @cached_property
    def spins(self) -> F64:
        """Angular velocity [rad/s], shape (F, 3): of one body its own, of several that which their angular momentum would give one solid.

        Raises:
            EvidenceError: nothing tells how it turns.
        """
        if self.entity in self.candidate.deforming:
            soft = self.candidate.deforming[self.entity]
            return np.stack([soft.spin(k) for k in range(self.candidate.frame_count)])
        if self.books is None:
            if self.candidate.spec.entities[self.entity].motion == "static":
                return np.zeros((self.candidate.frame_count, 3))
            raise EvidenceError(f"nothing tells how {self.entity!r} turns; ask this of bodies that a rigid instance moves")
        books, row = self.books
        if books.single[row]:
            return np.asarray(books.spin[: self.candidate.frame_count, books.first[row]])
        inertia = self._inertia(books, row)
        solved = np.linalg.solve(inertia, books.angular_momentum[:, row, :, None])[: self.candidate.frame_count, :, 0]
        return np.asarray(solved, dtype=np.float64)

    def _inertia(self, books: Books, row: int) -> F64:
        """Inertia of all its bodies about their common centre [kg m^2], world axes, shape (F, 3, 3)."""
        own = np.flatnonzero(books.owner == row)
        turns = books.turns[:, own]
        arms = books.body_centers[:, own] - books.centers[:, row, None]
        local = np.einsum("fnij,njk,fnlk->fil", turns, books.inertia[own], turns, optimize=True)
        square = np.einsum("n,fnk,fnk->f", books.body_mass[own], arms, arms)
        mixed = np.einsum("n,fni,fnj->fij", books.body_mass[own], arms, arms)
        result: F64 = local + square[:, None, None] * np.eye(3) - mixed
        return result

    @cached_property
    def gyration(self) -> float:
        """Radius of gyration [m], mean over the axes, at frame 0; of what no rigid instance moves, the half-size."""
        if self.books is None:
            return self.size
        books, row = self.books
        return float(np.sqrt(np.trace(self._inertia(books, row)[0]) / (3.0 * self.mass)))

    @cached_property
    def origins(self) -> dict[Origin, Given]:
        """Origins of its momentum; see `Judge.origins`."""
        return self.judge.origins(self.candidate, self.entity)

    @cached_property
    def carried(self) -> F64:
        """Share of its weight that others bear over each interval, shape (F - 1,); 1 while a path or a release holds it."""
        count = self.candidate.frame_count - 1
        weight, borne = np.zeros(count), np.zeros(count)
        media = fields_of(self.candidate.spec, self.entity).has_medium
        for origin, given in self.origins.items():
            if origin.kind == "gravity":
                weight -= given.impulse[:count] @ self.up
            elif origin.kind in CARRIERS or (origin.kind == "fields" and not media):
                borne += given.impulse[:count] @ self.up
        return np.where(weight > 0.0, borne / np.maximum(weight, 1e-300), 1.0)

    @cached_property
    def matter(self) -> dict[str, Given]:
        """Impulse [N s] and work [J] that matter of coupled instances gave it, by entity; none where several may have given it."""
        found: dict[str, Given] = {}
        for origin, given in self.origins.items():
            members = (
                {m for n in origin.name.split(", ") for m in _members(self.candidate, n)} if origin.kind == "matter" else set()
            )
            if len(members) == 1:
                found[members.pop()] = given
        return found

    @cached_property
    def partners(self) -> tuple[str, ...]:
        """Entities with which contacts are logged, in the order of the log's colliders."""
        found: dict[str, None] = {}
        for cache in self.candidate.rigid_caches.values():
            names = cache.index.colliders
            if self.entity not in names:
                continue
            log, own = contacts_of(self.candidate, cache), names.index(self.entity)
            for side, other in ((log.a, log.b), (log.b, log.a)):
                found |= dict.fromkeys(names[k] for k in np.unique(other[(side == own) & (other != own)]))
        return tuple(found)


def _members(candidate: Candidate, solver: str) -> tuple[str, ...]:
    instance = candidate.spec.simulation.solvers.get(solver)
    return () if instance is None else tuple(instance.members)


def course_of(candidate: Candidate, entity: str) -> Course:
    """Course of an entity, worked out once.

    Raises:
        EvidenceError: no such entity, or it moves and no cache holds it.
    """
    return candidate.memo(("course", entity), lambda: Course(candidate, entity))


def between(candidate: Candidate, by: str, on: str) -> Between:
    """Contact of one entity with another, from the logs of all instances that have both; of a body with a sheet from what that gave it.

    Raises:
        EvidenceError: no log can tell, or a channel is missing or damaged.
    """
    return candidate.memo(("between", by, on), lambda: _between(candidate, by, on))


def _between(candidate: Candidate, by: str, on: str) -> Between:
    if by == on:
        raise EvidenceError(f"{by!r} does nothing to itself; name two entities")
    count = candidate.frame_count - 1
    if not any({by, on} <= set(cache.index.colliders) for cache in candidate.rigid_caches.values()):
        for body, sheet, way in ((on, by, 1.0), (by, on, -1.0)):
            felt = pressed(candidate, body, sheet) if sheet in candidate.deforming else None
            if felt is not None:
                given = course_of(candidate, body).matter.get(sheet)
                impulse = np.zeros((count, 3)) if given is None else way * given.impulse[:count]
                return Between(impulse, felt[1 : count + 1] > 0.0)
    impulse, touched = np.zeros((count, 3)), np.zeros(count, dtype=bool)
    for cache in motion.caches_with(candidate, by, on):
        log, names = contacts_of(candidate, cache), cache.index.colliders
        for side, other, sign in ((log.a, log.b, 1.0), (log.b, log.a, -1.0)):
            rows = np.flatnonzero((side == names.index(by)) & (other == names.index(on)) & (log.frame <= count))
            np.add.at(impulse, log.frame[rows] - 1, sign * log.given[rows])
            touched[log.frame[rows] - 1] = True
    return Between(impulse, touched)
