"""Impulses that hold sleeping bodies up, from what they lie on: the engine lists no contacts of theirs."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from .exchanged import both_ways, pushed
from .fields import feels_fields, recorded

if TYPE_CHECKING:
    from .balance import Books

__all__ = ["Rests", "rests_of", "strangest"]


class Rests(NamedTuple):
    """Impulses that no log tells, per interval and entity [N s]."""

    held: F64
    """To those of an entity's several bodies that slept from frame to frame: the opposite of all else that is known to push them,
    shape (F - 1, E, 3)."""
    passed_on: F64
    """Most that its other bodies can have given to those, and so to what they lie on, shape (F - 1, E)."""
    unlogged: F64
    """Most that contacts of what slept for a part of the interval can have given, shape (F - 1, E)."""


def rests_of(books: Books) -> Rests:
    """The same for one ledger, computed once."""
    return books.candidate.memo(("sleep impulses", books), lambda: _rests(books))


def _rests(books: Books) -> Rests:
    """Entities of several bodies are looked at body by body: water may lift some pieces with as much as others press on what they lie
    on, so that what is known to push all together says nothing of what holds these."""
    # Before a force driver that starts within the interval, the sleeper is held against all else.
    late = np.where(books.switching, np.linalg.norm(books.known_impulse - books.driver_wrench[0], axis=2), 0.0)
    known = np.maximum(np.linalg.norm(books.known_impulse, axis=2), late)
    whole = np.where(books.dozing | books.napping, known, 0.0)
    if books.single.all():
        return Rests(np.zeros_like(books.known_impulse), np.zeros_like(known), whole)
    several = ~books.single[books.owner]
    still = several & books.asleep[:-1] & books.asleep[1:] & ~books.stirred[1:]
    part = several & (books.asleep[:-1] | books.asleep[1:] | books.napping_bodies) & ~still
    own = _on_bodies(books)
    held = -books.per_entity(np.where(still[:, :, None], own, 0.0))
    shared = books.per_entity(np.where(part, np.linalg.norm(own, axis=2), 0.0))
    # Drivers, drag and springs act on entities: they are not told apart by body.
    rest = np.linalg.norm(books.known_impulse - books.per_entity(own), axis=2)
    shared += np.where(books.dozing, rest, 0.0) + np.where(books.napping & ~books.dozing, known, 0.0)
    return Rests(held, np.where(held.any(axis=2), _among_itself(books), 0.0), np.where(books.single, whole, shared))


def _on_bodies(books: Books) -> F64:
    """Gravity, and what coupled solvers and fields gave, per body [N s], shape (F - 1, n, 3)."""
    free = books.free_time[:, books.owner]
    found: F64 = (free * books.body_mass)[:, :, None] * books.gravity
    if both_ways(books.candidate.spec, books.cache.index.solver):
        share = np.where(books.let_go[:, books.owner], free / books.duration, 1.0)
        found = found + share[:, :, None] * pushed(books)[:, :, :3]
    if feels_fields(books.candidate.spec, books.cache.index.solver):
        found = found + recorded(books)
    return found


def _among_itself(books: Books) -> F64:
    """Most that contacts among an entity's own bodies can have given [N s], shape (F - 1, E)."""
    found, result = books.contacts, np.zeros((books.frames - 1, len(books.entities)))
    rows = books.collider_row[found.a]
    own = (found.a == found.b) & (rows >= 0)
    most = np.abs(found.impulse) * np.sqrt(1.0 + books.friction[1] ** 2)
    np.add.at(result, (found.frame[own] - 1, rows[own]), most[own])
    return result


def strangest(books: Books, entity: str, frame: int) -> dict[str, object]:
    """Body of an entity of several bodies whose velocity changes most beside gravity, coupled solvers and fields in the interval that
    ends at `frame`, and by how much [m/s]: contacts among them are not in the log body by body."""
    row, k = books.row[entity], frame - 1
    if books.single[row]:
        return {}
    asleep = books.asleep[k] & books.asleep[k + 1]
    change = (
        books.velocity[k + 1]
        - books.velocity[k]
        - np.where(asleep[:, None], 0.0, _on_bodies(books)[k] / books.body_mass[:, None])
    )
    speed = np.where(books.owner == row, np.linalg.norm(change, axis=1), -np.inf)
    worst = int(speed.argmax())
    return {"body": books.cache.index.bodies[worst], "body_change": float(speed[worst])}
