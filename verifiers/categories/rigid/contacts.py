"""Laws of contact on the ledgers of a rigid instance.

- `contacts`: pairs that are logged as touching can reach each other.
- `friction`: a body that slides all the frame long without turning loses what Coulomb's law takes, no more and no less.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....geometry import aabb_of
from ....worlds.arrays import F64
from ...ledgers.balance import Books, Flags, frictions
from .bounds import FRICTION, REACH, ROLLS, SLIDING, STRAIGHT
from .corrections import compare_materials
from .rows import Law
from .speeds import surface_speeds

if TYPE_CHECKING:
    from ...rows.findings import Finding

__all__ = ["contacts", "friction", "moves"]


def _boxes(books: Books) -> tuple[F64, F64]:
    """Lowest and highest corners of every collider over the frames [m], each shape (F, colliders, 3)."""
    candidate, names = books.candidate, books.cache.index.colliders
    low = np.full((books.frames, len(names), 3), np.inf)
    high = -low
    for column, name in enumerate(names):
        built = candidate.entity(name)
        for body in built.bodies:
            parts = built.parts_of(body.name)
            if not parts:
                continue
            points = np.concatenate([p.render.vertices for p in parts])
            lo, hi = aabb_of(points, *candidate.track(name, body.name))
            low[: len(lo), column] = np.minimum(low[: len(lo), column], lo)
            high[: len(hi), column] = np.maximum(high[: len(hi), column], hi)
    return low, high


def contacts(books: Books) -> Finding:
    """Distance of bodies that are logged as touching: boxes swept over the interval, grown by the way that the fastest step of it could have led."""
    found = books.contacts
    low, high = _boxes(books)
    k = found.frame
    low, high = np.minimum(low[k - 1], low[k]), np.maximum(high[k - 1], high[k])
    rows = np.arange(len(k))
    gap = np.maximum(low[rows, found.a] - high[rows, found.b], low[rows, found.b] - high[rows, found.a]).max(
        axis=1, initial=-np.inf
    )
    peak = books.record("max_speed")[k]
    excess = gap - books.candidate.spec.simulation.limits.contact_gap - 0.5 * books.duration * peak * 2.0
    table = np.full((books.frames - 1, len(books.entities)), -np.inf)
    for side in (found.a, found.b):
        row = books.collider_row[side]
        np.maximum.at(table, (k[row >= 0] - 1, row[row >= 0]), excess[row >= 0])
    law = Law(REACH, "m", "distance of bodies that are logged as touching", "no contact is logged in this interval")
    return law.judge(books.entities, table)


# ---------------------------------------------------------------- friction


def friction(books: Books) -> Finding:
    """Deviation from Coulomb's law.

    All normals of a body that slides along without turning are perpendicular to its velocity, so that the momentum it loses
    along its way is the friction of all its contacts: mu times the sum of their normal impulses, at least and at most. A blow
    that begins in the interval or the one before may brake it along a normal: no slide is judged there.
    """
    found = books.contacts
    low, high = (table[found.a, found.b] for table in frictions(books.candidate, books.cache.index.colliders, sliding=True))
    total, least, most = np.zeros((3, books.frames - 1, len(books.entities)))
    moving = np.zeros((books.frames - 1, len(books.entities)), dtype=bool)
    for side, other in ((found.a, found.b), (found.b, found.a)):
        row, partner = books.collider_row[side], books.collider_row[other]
        mine = row >= 0
        at = (found.frame[mine] - 1, row[mine])
        np.add.at(total, at, found.impulse[mine])
        np.add.at(least, at, found.impulse[mine] * low[mine])
        np.add.at(most, at, found.impulse[mine] * high[mine])
        np.logical_or.at(moving, at, moves(books, partner[mine], found.frame[mine] - 1))
    v0, v1 = books.velocities[:-1], books.velocities[1:]
    speeds = np.linalg.norm(v0, axis=2), np.linalg.norm(v1, axis=2)
    straight = np.sum(v0 * v1, axis=2) > STRAIGHT * speeds[0] * speeds[1]
    spin = np.linalg.norm(books.spin[:, books.first], axis=2) * books.reach
    turning = np.maximum(spin[:-1], spin[1:]) > ROLLS * np.minimum(*speeds)
    slides = (np.minimum(*speeds) > SLIDING) & straight & ~turning & ~moving & ~books.dozing & ~books.switching
    judged = slides & ~_struck(books) & books.lone & (total > 0) & (books.free_time > books.duration - 1e-9)
    along = v0 + v1
    along /= np.maximum(np.linalg.norm(along, axis=2, keepdims=True), 1e-12)
    lost = -np.sum(books.residual * along, axis=2)
    scale = np.maximum(total, 1e-12)
    # In units of the normal impulse; a frictionless contact must not brake either.
    share = np.maximum(least - lost, lost - most) / scale
    allowed = FRICTION * np.maximum(most / scale, 0.02)
    law = Law(
        FRICTION,
        "1",
        "deviation from Coulomb's law",
        "no free body slides straight on something that rests for a whole frame",
        lambda entity: compare_materials(f"the friction that acts on {entity} is not the declared one"),
    )
    return law.judge(books.entities, share / allowed * FRICTION, judged)


def _struck(books: Books) -> Flags:
    """True where a contact of an entity begins in an interval or in the one before, shape (F - 1, E)."""
    began = np.zeros((books.frames, len(books.entities)), dtype=bool)
    for frame, log in enumerate(books.ragged("event/pair")[1 : books.frames], start=1):
        rows = books.collider_row[log["event/pair"].reshape(-1).astype(np.int64)]
        began[frame, rows[rows >= 0]] = True
    return np.asarray(began[:-1] | began[1:])


def moves(books: Books, rows: NDArray[np.int64], interval: NDArray[np.int64]) -> Flags:
    """True where the other body of a contact moves at either end of the interval; static ones (row -1) do not."""
    fastest = surface_speeds(books)
    known = np.maximum(rows, 0)
    return np.asarray((rows >= 0) & (np.maximum(fastest[interval, known], fastest[interval + 1, known]) > 1e-3))
