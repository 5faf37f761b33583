"""Impulses between cloth and every solid around it, by the cloth's own record (R96, R97).

The record holds the impulse on each solid over a frame, of contacts and of pins together. So it tells

- a contact of a sheet with a solid that holds none of its pins, where the sheet is the only member of its instance;
- a push of either on the other, pins included. Several sheets of one instance share a push by their masses, as far as their boxes
  come near the solid.

Where no two-way coupling brings the cloth's push to a body, the body pushes and is not pushed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.cloth.facts import THIN, pins_of
from ....worlds.errors import EvidenceError
from ..pushes import pressed_by
from .frames import cloth_run

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from .frames import ClothRun

__all__ = ["shares", "sheet_impulse"]


def sheet_impulse(candidate: Candidate, sheet: str, other: str) -> F64:
    """Size of the impulse between a sheet and a solid over each frame [N s], shape (frames,).

    Raises:
        EvidenceError: no record tells it.
    """
    spec = candidate.spec
    solver = next((n for n, i in spec.simulation.cloth.items() if sheet in i.members and n in candidate.caches), None)
    if solver is None:
        raise EvidenceError(f"no cache holds the cloth {sheet!r}; list it as a member of a cloth instance and bake")
    if any(p.to == other for p in pins_of(spec.entities[sheet]).values()):
        raise EvidenceError(f"{other!r} holds a pin of {sheet!r}, and the record does not tell its pull from a contact")
    return pressed_by(candidate, candidate.caches[solver], sheet, other)


def shares(candidate: Candidate, cache: Cache, frame: int, rows: list[int]) -> list[dict[str, float]]:
    """Share of every sheet in what each solid was given over a frame.

    Args:
        candidate: what is judged.
        cache: of the instance.
        frame: at which.
        rows: indices of the solids.
    """
    members = candidate.spec.simulation.solvers[cache.index.solver].members
    if len(members) == 1:
        return [{members[0]: 1.0}] * len(rows)
    run = cloth_run(candidate, cache.index.solver)
    return [_shares(candidate, run, cache.index.colliders[row].split("/", 1)[0], frame) for row in rows]


def _shares(candidate: Candidate, run: ClothRun, entity: str, frame: int) -> dict[str, float]:
    """Share of each sheet in what a solid was given over a frame: by mass, of those whose box comes near that of the solid."""
    reach = max(max(p.physics.thickness, THIN * float(p.length.min())) for p in run.pieces)
    span = range(max(0, frame - 1), frame + 1)
    solid = np.concatenate([candidate.surface(entity, p.part, k) for p in candidate.entity(entity).parts for k in span])
    low, high = solid.min(axis=0) - reach, solid.max(axis=0) + reach
    near: dict[str, float] = {}
    for piece in run.pieces:
        own = np.concatenate([run.frame(k)[0][piece.rows] for k in span])
        if (own.max(axis=0) >= low).all() and (own.min(axis=0) <= high).all():
            near[piece.entity] = near.get(piece.entity, 0.0) + float(run.mass[piece.rows].sum())
    return {name: mass / sum(near.values()) for name, mass in near.items()}
