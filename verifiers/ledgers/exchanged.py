"""Impulses and work that liquids, grains and cloth gave to the bodies of a rigid instance, for its ledgers (R66-R68).

The impulses are those that the rigid side received; that the liquid gave the same and lost as much itself is judged with the
liquids (`liquid_coupling`). Work is force times way: an impulse times the mean of the velocities at both ends of the interval,
uncertain by the impulse times half their difference.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.channels import QUANTITIES
from ...worlds.errors import EvidenceError

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import WorldSpec
    from .balance import Books

__all__ = [
    "CHANNEL",
    "Exchanged",
    "account",
    "both_ways",
    "exchange_steps",
    "exchanged",
    "impulses",
    "nothing",
    "partners",
    "pushed",
]

CHANNEL = "exchange/impulse"
"""Linear and angular impulse about each body's centre of mass over the frame [N s], [N m s], shape (n, 6)."""


@dataclass(frozen=True)
class Exchanged:
    """Over intervals and moving entities."""

    linear: F64
    """Impulse [N s], shape (F - 1, E, 3)."""
    angular: F64
    """Angular impulse about the entity's centre of mass [N m s], shape (F - 1, E, 3)."""
    wet: NDArray[np.bool_]
    """True where it pushed the entity in the interval, shape (F - 1, E)."""
    work: F64
    """Done on all free bodies since frame 0 [J], shape (F,)."""
    doubt: F64
    """Uncertainty of that work, summed since frame 0 [J], shape (F,)."""

    def plus(self, other: Exchanged) -> Exchanged:
        """Both together."""
        return Exchanged(
            self.linear + other.linear,
            self.angular + other.angular,
            self.wet | other.wet,
            self.work + other.work,
            self.doubt + other.doubt,
        )


def partners(spec: WorldSpec, solver: str) -> tuple[str, ...]:
    """Instances of other kinds that act on this one and are acted on by it."""
    plan, found = spec.simulation, dict[str, None]()
    for coupling in plan.couplings.values():
        if coupling.direction == "two_way" and solver in (coupling.source, coupling.target):
            other = coupling.target if coupling.source == solver else coupling.source
            if other in plan.solvers and other not in plan.rigid:
                found[other] = None
    return tuple(found)


def both_ways(spec: WorldSpec, solver: str) -> bool:
    """True if a liquid instance and this one act on each other."""
    return bool(partners(spec, solver))


def exchange_steps(candidate: Candidate, solver: str) -> F64:
    """Exchanges with coupled liquids and grains per frame, each of which also ends a step of the bodies, shape (frames,).

    Raises:
        EvidenceError: a liquid has no record of them.
    """
    total = np.zeros(candidate.frame_count)
    for name in partners(candidate.spec, solver):
        if name not in candidate.caches:
            raise EvidenceError(f"instance {name!r} has no cache yet; probe or bake it")
        # Some engines step more often than they exchange, and count both.
        counted = "exchanges" if set(QUANTITIES["exchanges"].of) & set(candidate.spec.simulation.solvers[name].moves) else "steps"
        total += np.asarray(candidate.caches[name].series(f"record/{counted}"), dtype=np.float64)[: len(total)]
    return total


def exchanged(books: Books) -> Exchanged:
    """Impulses and work of liquids; zero where none is coupled both ways.

    Raises:
        EvidenceError: one is, and the cache has no record of it.
    """
    return account(books, pushed(books)) if both_ways(books.candidate.spec, books.cache.index.solver) else nothing(books)


def pushed(books: Books) -> F64:
    """Impulses that coupled liquids, grains and cloth gave to each body, and angular ones about its centre [N s, N m s], shape (F - 1, n, 6).

    Raises:
        EvidenceError: the cache has no record of it.
    """
    return impulses(books, CHANNEL, 6)


def impulses(books: Books, channel: str, width: int) -> F64:
    """Impulses that each body was given over the intervals by a channel [N s, N m s], shape (F - 1, n, width).

    Raises:
        EvidenceError: the cache has no such record, or one of another shape or that is not finite.
    """
    given: F64 = np.asarray(books.cache.series(channel), dtype=np.float64)
    if given.shape != (books.frames, len(books.owner), width):
        raise EvidenceError(
            f"channel {channel!r} has shape {given.shape}, not {(books.frames, len(books.owner), width)}; bake again"
        )
    if not np.isfinite(given).all():
        raise EvidenceError(f"channel {channel!r} is not finite; see numerical:finite")
    return given[1:]


def nothing(books: Books) -> Exchanged:
    """Zero exchange."""
    shape, none = (books.frames - 1, len(books.entities), 3), np.zeros(books.frames)
    return Exchanged(np.zeros(shape), np.zeros(shape), np.zeros(shape[:2], dtype=bool), none, none)


def account(books: Books, given: F64) -> Exchanged:
    """Impulses and work of impulses on bodies [N s, N m s], shape (F - 1, n, 6)."""
    linear, angular = given[:, :, :3], given[:, :, 3:]
    arm = 0.5 * (
        (books.body_centers - books.centers[:, books.owner])[:-1] + (books.body_centers - books.centers[:, books.owner])[1:]
    )
    free = ~books.kinematic[books.owner][:, None]
    mean = [0.5 * (v[:-1] + v[1:]) for v in (books.velocity, books.spin)]
    change = [np.linalg.norm(np.diff(v, axis=0), axis=2) for v in (books.velocity, books.spin)]
    work = np.sum(np.where(free, linear * mean[0] + angular * mean[1], 0.0), axis=(1, 2))
    unsure = 0.5 * (np.linalg.norm(linear, axis=2) * change[0] + np.linalg.norm(angular, axis=2) * change[1])
    doubt = np.where(free[:, 0], unsure, 0.0).sum(axis=1)
    return Exchanged(
        books.per_entity(linear),
        books.per_entity(angular + np.cross(arm, linear)),
        books.per_entity(np.abs(given).sum(axis=2)) > 0.0,
        np.concatenate([[0.0], np.cumsum(work)]),
        np.concatenate([[0.0], np.cumsum(doubt)]),
    )
