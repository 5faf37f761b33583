"""Cloth in contacts and causal chains: what every solid around it and a sheet gave each other, by the cloth's own record (R96, R97).

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
from ...ledgers.exchanged import CHANNEL, partners
from .frames import cloth_run

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.spec import WorldSpec
    from .frames import ClothRun

__all__ = ["sheet_impulse", "sheet_of", "sheet_pushes", "unfelt"]


def sheet_of(spec: WorldSpec, *entities: str) -> str | None:
    """The one of the entities that is cloth; None where none is."""
    return next((n for n in entities if n in spec.entities and spec.entities[n].physics.category == "cloth"), None)


def _sizes(candidate: Candidate, solver: str) -> F64:
    """Impulse between a cloth instance and each solid over each frame [N s], shape (frames, solids)."""
    cache = candidate.caches[solver]
    given: F64 = np.asarray(cache.series(CHANNEL), dtype=np.float64)[: candidate.frame_count]
    if given.shape[1:] != (len(cache.index.colliders), 6):
        raise EvidenceError(f"channel {CHANNEL!r} of {solver!r} has shape {given.shape}; bake again")
    sizes: F64 = np.linalg.norm(given[:, :, :3], axis=2)
    return sizes


def sheet_impulse(candidate: Candidate, a: str, b: str) -> F64 | None:
    """Size of the impulse between a sheet and a solid over each frame [N s], shape (frames,); None where neither is cloth.

    Raises:
        EvidenceError: no record tells it.
    """
    spec = candidate.spec
    sheet = sheet_of(spec, a, b)
    if sheet is None:
        return None
    other = b if sheet == a else a
    solver = next((n for n, i in spec.simulation.cloth.items() if sheet in i.members and n in candidate.caches), None)
    if solver is None:
        raise EvidenceError(f"no cache holds the cloth {sheet!r}; list it as a member of a cloth instance and bake")
    if len(spec.simulation.cloth[solver].members) > 1:
        raise EvidenceError(f"the record of {solver!r} does not tell {sheet!r} from its other members")
    if any(p.to == other for p in pins_of(spec.entities[sheet]).values()):
        raise EvidenceError(f"{other!r} holds a pin of {sheet!r}, and the record does not tell its pull from a contact")
    rows = [k for k, n in enumerate(candidate.caches[solver].index.colliders) if n.split("/", 1)[0] == other]
    if not rows:
        raise EvidenceError(f"{other!r} is none of the solids that {sheet!r} meets")
    total: F64 = _sizes(candidate, solver)[:, rows].sum(axis=1)
    return total


def sheet_pushes(candidate: Candidate) -> list[list[tuple[str, str, float]]]:
    """Per frame, sheet, entity and the impulse between them [N s]."""
    found: list[list[tuple[str, str, float]]] = [[] for _ in range(candidate.frame_count)]
    for solver, cache in candidate.cloth_caches.items():
        members = candidate.spec.simulation.cloth[solver].members
        if not cache.index.colliders:
            continue
        sizes = _sizes(candidate, solver)
        for frame, row in np.argwhere(sizes > 0.0).tolist():
            entity, size = cache.index.colliders[row].split("/", 1)[0], float(sizes[frame, row])
            if len(members) == 1:
                found[frame].append((members[0], entity, size))
            else:
                shares = _shares(candidate, cloth_run(candidate, solver), entity, frame)
                found[frame] += [(member, entity, size * part) for member, part in shares.items()]
    return found


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


def unfelt(spec: WorldSpec) -> set[tuple[str, str]]:
    """Sheets and the bodies that they do not push, because no coupling brings their push there."""
    plan = spec.simulation
    return {
        (sheet, body)
        for solver, rigid in plan.rigid.items()
        for name, cloth in plan.cloth.items()
        if name not in partners(spec, solver)
        for sheet in cloth.members
        for body in rigid.members
    }
