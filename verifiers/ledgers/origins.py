"""Momentum and kinetic energy by origin: of bodies gravity, each driver, spring and body that touches them, coupled solvers; of matter what its
records tell apart.

Work of an impulse J on a body is J times the mean of the velocities of its centre of mass at both ends of the interval. Summed over all
origins this is the change of the kinetic energy of translation exactly, since dP . (v0 + v1) / 2 = d(m v^2 / 2); how an impulse that is
one of several within an interval shares in it is uncertain by |J| |v1 - v0| / 2, which is told beside it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.fields import fields_of
from ...worlds.spec import ForceDriver
from .balance import Books, books_of
from .exchanged import partners

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["Given", "Origin", "OriginKind", "Origins", "origins_of", "with_works"]

OriginKind = Literal["gravity", "driver", "spring", "drag", "fields", "matter", "contact", "unlisted"]


class Origin(NamedTuple):
    """Source of an impulse."""

    kind: OriginKind
    name: str
    """Driver, spring, or entity that touches; several fields or instances that one record tells of together, joined by commas."""


@dataclass(frozen=True)
class Given:
    """Impulse and work of one origin on one entity, per interval between frames."""

    impulse: F64
    """[N s], shape (F - 1, 3)."""
    work: F64
    """On the motion of the centre of mass [J], shape (F - 1,)."""
    doubt: F64
    """Uncertainty of that work [J], shape (F - 1,)."""


class Origins:
    """Impulses and works on the moving entities of one instance, by origin."""

    def __init__(self, books: Books) -> None:
        self.books = books
        self._of: dict[str, dict[Origin, Given]] = {}

    def of(self, entity: str) -> dict[Origin, Given]:
        """Every origin that gave something to an entity, and what; the works add up to the change of its kinetic energy of translation.

        `unlisted` is what is left when all others are taken off the change of momentum: of joints, and of what carries sleeping bodies, whose
        contacts the engine does not list. Zero for a body while a path or a release holds it.

        Raises:
            EvidenceError: a channel is missing or damaged.
            KeyError: no body of the instance is of the entity.
        """
        if entity not in self._of:
            row = self.books.row[entity]
            found = {origin: impulse for origin, impulse in self._impulses(entity, row).items() if impulse.any()}
            free = (self.books.free_time[:, row] > 0)[:, None]
            change = np.where(free, np.diff(self.books.momentum[:, row], axis=0), 0.0)
            self._of[entity] = with_works(change, self.books.velocities[:, row], found)
        return self._of[entity]

    def _impulses(self, entity: str, row: int) -> dict[Origin, F64]:
        books, spec = self.books, self.books.candidate.spec
        found = {
            Origin("gravity", ""): books.gravity_impulse[:, row],
            Origin("drag", ""): books.drag_impulse[:, row],
            Origin("fields", ", ".join(fields_of(spec, entity).names)): books.fields.linear[:, row],
            Origin("matter", ", ".join(partners(spec, books.cache.index.solver))): books.liquid.linear[:, row],
        }
        for name, driver in spec.simulation.drivers.items():
            if isinstance(driver, ForceDriver) and driver.entity == entity:
                acting = books.overlap(max(driver.start, books.released[row]), driver.end)[:, None]
                found[Origin("driver", name)] = acting * np.array(driver.force)
        for spring in books.springs:
            ends = [sign for end, sign in ((spring.child, 1.0), (spring.parent, -1.0)) if end == row]
            if ends and not books.kinematic[row]:
                free = (books.free_time[:, row] > 0)[:, None]
                found[Origin("spring", spring.name)] = sum(ends) * np.where(free, spring.impulse[0], 0.0)
        for other, impulse in self._contacts(row).items():
            found[Origin("contact", other)] = impulse
        return found

    def _contacts(self, row: int) -> dict[str, F64]:
        """Impulse of the logged contacts with each other entity [N s], shape (F - 1, 3)."""
        log, books = self.books.contacts, self.books
        names, own = books.cache.index.colliders, books.collider_row
        found: dict[str, F64] = {}
        for side, other, sign in ((log.a, log.b, -1.0), (log.b, log.a, 1.0)):
            of = np.flatnonzero((own[side] == row) & (own[other] != row)) if len(side) else np.zeros(0, dtype=np.intp)
            for k in np.unique(other[of]):
                rows = of[other[of] == k]
                given = found.setdefault(names[k], np.zeros((books.frames - 1, 3)))
                np.add.at(given, log.frame[rows] - 1, sign * log.given[rows])
        return found


def with_works(change: F64, velocity: F64, impulses: dict[Origin, F64]) -> dict[Origin, Given]:
    """Works of impulses, with the rest of the change of momentum as `unlisted`.

    Args:
        change: of the momentum over each interval [N s], shape (F - 1, 3).
        velocity: of the centre of mass [m/s], shape (F, 3); NaN where nothing is there.
        impulses: by origin [N s], each shape (F - 1, 3).
    """
    rest = change - sum(impulses.values(), np.zeros_like(change))
    speed = np.nan_to_num(velocity)
    mean, turn = 0.5 * (speed[:-1] + speed[1:]), 0.5 * np.linalg.norm(np.diff(speed, axis=0), axis=1)
    return {
        origin: Given(impulse, np.sum(impulse * mean, axis=1), np.linalg.norm(impulse, axis=1) * turn)
        for origin, impulse in {**impulses, Origin("unlisted", ""): rest}.items()
    }


def origins_of(candidate: Candidate, entity: str) -> dict[Origin, Given]:
    """Every origin that gave momentum to an entity of a rigid instance, and what it gave; empty where no such instance moves it.

    Raises:
        EvidenceError: a channel is missing or damaged.
    """
    for cache in candidate.rigid_caches.values():
        if not cache.index.bodies:
            continue
        books = books_of(candidate, cache)
        if entity in books.row:
            return candidate.memo(("origins", cache), partial(Origins, books)).of(entity)
    return {}
