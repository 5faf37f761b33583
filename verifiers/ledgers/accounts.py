"""The ledgers of a candidate as one account, for pictures and for agents that ask where energy and momentum went."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...worlds.accounts import Account, Mark
from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ..categories.rigid.bounds import IMPULSE
from ..categories.rigid.joints import stored
from ..categories.rigid.laws import unexplained
from .balance import Books, books_of

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["account_of"]


def account_of(candidate: Candidate) -> Account:
    """The account of all instances.

    Raises:
        EvidenceError: nothing is simulated, or a channel is missing.
    """
    if not candidate.rigid_caches:
        raise EvidenceError("nothing is simulated yet, so there is no account; call probe_sim")
    count = candidate.frame_count
    books = [books_of(candidate, c) for c in candidate.rigid_caches.values() if c.index.bodies]
    if not any((~b.kinematic).any() for b in books):
        raise EvidenceError("no body moves freely, so there is no account")
    names = [*dict.fromkeys(n for b in books for n in b.sources)]

    free = [~b.kinematic for b in books]  # energy and momentum of bodies on paths are their drivers'

    def join(parts: list[F64], rows: int) -> F64:
        return np.concatenate([p[:rows, keep] for p, keep in zip(parts, free, strict=True)], axis=1)

    values = []
    for one in books:
        found = unexplained(one)
        values.append(np.where(found.judged, np.maximum(found.value, 0.0), np.nan))
    return Account(
        times=books[0].times[:count],
        entities=tuple(n for b, keep in zip(books, free, strict=True) for n, k in zip(b.entities, keep, strict=True) if k),
        mass=np.concatenate([b.mass[keep] for b, keep in zip(books, free, strict=True)]),
        kinetic=join([b.kinetic for b in books], count),
        potential=join([b.potential for b in books], count),
        elastic=np.sum([(b.elastic + stored(b))[:count] for b in books], axis=0),
        work=np.sum([(b.record("driver_work") + b.outside.work)[:count] for b in books], axis=0),
        momentum=join([b.momentum for b in books], count),
        angular_momentum=join([b.angular_momentum for b in books], count),
        sources={n: join([b.sources[n] for b in books], count - 1) for n in names},
        contact=join([b.logged_impulse for b in books], count - 1),
        unexplained=join(values, count - 1),
        bound=IMPULSE,
        events=tuple(sorted((m for b in books for m in _marks(b)), key=lambda m: (m.time, m.name))),
    )


def _marks(books: Books) -> list[Mark]:
    names = books.cache.index.colliders
    found = []
    for log in books.ragged("event/time", "event/pair"):
        for time, (a, b) in zip(log["event/time"].tolist(), log["event/pair"].tolist(), strict=True):
            found.append(Mark(float(time), f"{names[a]} - {names[b]}"))
    return found
