"""Impulses, and twists where lift is declared, that force fields gave to the bodies of a rigid instance, as the engine applied them (R18, R63)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64
from ...worlds.fields import acting_on, field_drivers, fields_of, lifted_members
from ...worlds.instances import carriers_of
from ...worlds.media import media_of
from .exchanged import Exchanged, account, impulses, nothing

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.fields import Fields
    from ...worlds.spec import WorldSpec
    from .balance import Books

__all__ = ["CHANNEL", "blown", "blown_at", "feels_fields", "fields_in", "recorded", "twisted"]

CHANNEL = "field/impulse"
"""Impulse of fields on each body over the frame, at its centre of mass [N s], shape (n, 3)."""

TWIST = "field/twist"
"""Angular impulse of media with lift on each body over the frame, about its centre of mass [N m s], shape (n, 3)."""


def feels_fields(spec: WorldSpec, solver: str) -> bool:
    """True if a force field acts on a moving member of the instance, or the medium of another."""
    members = set(spec.simulation.solvers[solver].members)
    if carriers_of(spec, solver):
        return True
    return any(members & set(acting_on(spec, d)) for d in field_drivers(spec).values())


def fields_in(candidate: Candidate, entity: str) -> Fields:
    """Fields that act on an entity, with the media of instances as their caches hold them."""
    media = candidate.memo("media", lambda: media_of(candidate.spec, candidate.caches))
    return fields_of(candidate.spec, entity, media=media)


def recorded(books: Books) -> F64:
    """Impulses of fields on the bodies over the intervals [N s], shape (F - 1, n, 3).

    Raises:
        EvidenceError: a field acts, and the cache has no record of what it gave.
    """
    return impulses(books, CHANNEL, 3)


def twisted(books: Books) -> F64:
    """Angular impulses of media with lift on the bodies over the intervals [N m s], shape (F - 1, n, 3); zero where nothing declares any.

    Raises:
        EvidenceError: a medium lifts a body, and the cache has no record of how it turned it.
    """
    if not lifted_members(books.candidate.spec, books.cache.index.solver):
        return np.zeros((books.frames - 1, len(books.owner), 3))
    return impulses(books, TWIST, 3)


def blown(books: Books) -> Exchanged:
    """Impulses and work of fields; zero where none acts on the instance."""
    if not feels_fields(books.candidate.spec, books.cache.index.solver):
        return nothing(books)
    return account(books, np.concatenate([recorded(books), twisted(books)], axis=2))


def blown_at(candidate: Candidate, entity: str, frame: int) -> dict[str, float]:
    """Size of the impulse that fields gave to an entity in the interval that ends at `frame` [N s], by the drivers' ids together.

    What the medium of an instance carries is a push of its own, and none of a field.
    """
    if entity not in candidate.spec.entities:
        return {}
    found = fields_in(candidate, entity)
    if not found.drivers:
        return {}
    for cache in candidate.rigid_caches.values():
        rows = [k for k, b in enumerate(cache.index.bodies) if b.split("/", 1)[0] == entity]
        if rows:
            read = cache.read(frame, (CHANNEL, "position"))
            if (
                found.carriers
                and found.carried(np.asarray(read["position"], dtype=np.float64)[rows], frame / cache.index.fps).any()
            ):
                return {}
            size = float(np.linalg.norm(np.asarray(read[CHANNEL], dtype=np.float64)[rows].sum(axis=0)))
            return {", ".join(sorted(d for d in found.names if d not in found.carriers)): size} if size > 0 else {}
    return {}
