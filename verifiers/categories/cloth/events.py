"""Evaluator of `tears`: from the edges that open and how far their lips part."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.cloth.events import TearEvent
from ....worlds.categories.cloth.tears import following
from ...predicates.conditions import Condition, happens
from .bounds import TEAR_PARTS, TEAR_SHARE
from .predicates import instance_run, opened_since, tearing_pieces_of

if TYPE_CHECKING:
    from ...predicates.outcome import Outcome
    from ...predicates.scope import Scope
    from .tears import TearingPiece

__all__ = ["tears"]


def tears(scope: Scope, p: TearEvent) -> Outcome:
    """Measured: length of the edges that opened since the interval began, over the side of a square as large as the cloth."""
    run = instance_run(scope.candidate, p.entity)
    pieces = tearing_pieces_of(run, p.entity)
    side = float(np.sqrt(sum(q.area.sum() for q in pieces)))
    first, last = scope.frames
    since, names = max(0, first - 1), run.cache.index.colliders
    length: F64 = np.array([sum(opened_since(q, f, since, p.other, names) for q in pieces) for f in range(first, last + 1)])
    lips: F64 = np.array([max(_parted(q, f, since) for q in pieces) for f in range(first, last + 1)])
    by = "" if p.other is None else f" by {p.other}"
    conditions = (
        Condition(f"length torn{by}, over the side of a square as large,", length / side, max(TEAR_SHARE, p.min or 0.0)),
        Condition("farthest that the lips part, in the same measure,", lips / side, TEAR_PARTS),
    )
    return happens(scope, p.entity, conditions, lambda i: {"torn_m": float(length[i]), "side_m": side})


def _parted(piece: TearingPiece, frame: int, since: int) -> float:
    """Farthest that the two sides of an edge are apart that opened since a frame [m]."""
    corners, opened, _ = piece.frames[frame]
    rows = np.flatnonzero(opened & ~piece.frames[since][1] & (piece.seams.mate >= 0)).astype(np.int32)
    if not len(rows):
        return 0.0
    mate = piece.seams.mate[rows]
    ends = [corners[rows] - corners[following(mate)], corners[following(rows)] - corners[mate]]
    return float(max(np.linalg.norm(e, axis=1).max() for e in ends))
