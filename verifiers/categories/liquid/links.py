"""Which of several liquids of one instance pushes a boundary (R96, R97)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.categories.liquid.facts import spacing_of
from .solids import pieces_of

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate

__all__ = ["shares"]

REACH = 1.25
"""[spacings] Particles this near to a solid touch it: those at rest beside it stand half a spacing off, the next ones one and a half."""
SOME = 4000
"""About how many of the particles beside a part are asked."""


def shares(candidate: Candidate, cache: Cache, frame: int, rows: list[int]) -> list[dict[str, float]]:
    """Share of every liquid among the particles within reach of each boundary; where none is seen there, all alike.

    Args:
        candidate: what is judged.
        cache: of the instance.
        frame: at which.
        rows: indices of the boundaries.
    """
    from ....geometry import distance_to_surface

    members, count = cache.index.bodies, len(cache.index.bodies)
    if count == 1:
        return [{members[0]: 1.0}] * len(rows)
    held = cache.read(frame, ("origin", "particle/position", "particle/fluid"))
    position = held["particle/position"].astype(np.float64) + held["origin"]
    reach = REACH * spacing_of(candidate.spec, cache.index.solver)
    found = []
    for row in rows:
        near = np.zeros(len(position), dtype=bool)
        for piece in pieces_of(candidate):
            if f"{piece.entity}/{piece.body}" != cache.index.colliders[row]:
                continue
            low, high = piece.box(frame)
            some = np.flatnonzero(((position >= low - reach) & (position <= high + reach)).all(axis=1) & ~near)
            some = some[:: -(-len(some) // SOME) or 1]
            gap = distance_to_surface(piece.solid, piece.local(position[some], frame)).distance if len(some) else np.zeros(0)
            near[some[gap <= reach]] = True
        seen = np.bincount(held["particle/fluid"][near], minlength=count)[:count]
        part = seen / seen.sum() if seen.any() else np.full(count, 1.0 / count)
        found.append(dict(zip(members, part.tolist(), strict=True)))
    return found
