"""Impulses on one sheet of several in an instance, whose records hold those of all together.

Where a sheet is near no other and no pin holds it to the world, only solids and air can act on it. What solids gave is its own where no
other sheet is near them; the rest of its change of momentum is then of the air. Elsewhere nothing is told.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.cloth.facts import THIN, pins_of
from ....worlds.fields import fields_of
from ...ledgers.exchanged import CHANNEL
from ...ledgers.origins import Origin
from .frames import cloth_run
from .links import shares

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from .frames import ClothRun

__all__ = ["given_apart"]


def given_apart(candidate: Candidate, cache: Cache, entity: str, momentum: F64) -> dict[Origin, F64]:
    """Impulses on one sheet by origin [N s], each shape (frames - 1, 3), over the intervals in which it is certain whose they are.

    Args:
        candidate: what is judged.
        cache: of its instance, which has other sheets.
        entity: the sheet.
        momentum: its own [N s], shape (frames, 3).

    Raises:
        EvidenceError: a channel is missing or damaged.
    """
    run, frames = cloth_run(candidate, cache.index.solver), candidate.frame_count
    solid, sure = _of_solids(candidate, cache, entity)
    fields = fields_of(candidate.spec, entity)
    if not fields.has_medium or any(p.to is None for p in pins_of(candidate.spec.entities[entity]).values()):
        return solid
    step = 1.0 / candidate.spec.simulation.fps
    mass = sum(float(run.mass[p.rows].sum()) for p in run.pieces if p.entity == entity)
    rest = np.diff(momentum, axis=0) - mass * step * np.array(candidate.spec.simulation.gravity)
    rest -= sum(solid.values(), np.zeros_like(rest))
    free = np.arange(frames - 1) * step >= run.start - 1e-9
    alone = sure & free & ~_beside_another(run, entity)
    return solid | {Origin("fields", ", ".join(sorted(fields.names))): np.where(alone[:, None], rest, 0.0)}


def _of_solids(candidate: Candidate, cache: Cache, entity: str) -> tuple[dict[Origin, F64], NDArray[np.bool_]]:
    """Impulses of solids near which no other sheet is, by origin; and True where no solid gave what may be another sheet's."""
    given: F64 = np.asarray(cache.series(CHANNEL), dtype=np.float64)[1 : candidate.frame_count, :, :3]
    found: dict[Origin, F64] = {}
    sure = np.ones(len(given), dtype=bool)
    for k in np.flatnonzero(given.any(axis=(1, 2))).tolist():
        rows = np.flatnonzero(given[k].any(axis=1)).tolist()
        for row, share in zip(rows, shares(candidate, cache, k + 1, rows), strict=True):
            if entity not in share:
                continue
            if len(share) > 1:
                sure[k] = False
                continue
            origin = Origin("contact", cache.index.colliders[row].split("/", 1)[0])
            found.setdefault(origin, np.zeros((len(given), 3)))[k] -= given[k, row]
    return found, sure


def _beside_another(run: ClothRun, entity: str) -> NDArray[np.bool_]:
    """True over the intervals in which the sheet's box comes within reach of that of another, shape (frames - 1,)."""
    reach = max(max(p.physics.thickness, THIN * float(p.length.min())) for p in run.pieces)
    names = list(dict.fromkeys(p.entity for p in run.pieces))
    rows = {n: np.concatenate([np.arange(p.rows.start, p.rows.stop) for p in run.pieces if p.entity == n]) for n in names}
    boxes: dict[str, tuple[list[F64], list[F64]]] = {n: ([], []) for n in names}
    for k in range(run.candidate.frame_count):
        x, _ = run.frame(k)
        for n in names:
            boxes[n][0].append(x[rows[n]].min(axis=0))
            boxes[n][1].append(x[rows[n]].max(axis=0))
    swept = {
        n: (np.minimum(low[:-1], low[1:]) - 0.5 * reach, np.maximum(high[:-1], high[1:]) + 0.5 * reach)
        for n, (low, high) in ((n, (np.array(a), np.array(b))) for n, (a, b) in boxes.items())
    }
    low, high = swept.pop(entity)
    near = [((low <= top) & (high >= bottom)).all(axis=1) for bottom, top in swept.values()]
    return np.asarray(np.any(near, axis=0))
