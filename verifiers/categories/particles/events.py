"""Evaluator of `buries`: grains that lie on a body, seen from above."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.particles.events import BuryEvent
from ....worlds.errors import EvidenceError
from ...ledgers.motion import velocities
from ...predicates.conditions import Condition, happens
from ..granules import Granules, Matter, matter_of
from ..liquid.samples import samples
from ..liquid.solids import pieces_of
from ..liquid.told import painted
from .bounds import BURY_GRAINS, BURY_RISE, BURY_SHARE

if TYPE_CHECKING:
    from ...predicates.outcome import Outcome
    from ...predicates.scope import Scope
    from ..liquid.solids import Piece

__all__ = ["buries"]


def buries(scope: Scope, p: BuryEvent) -> Outcome:
    """Measured: share of what is seen of the body from above that grains lie on."""
    matter = matter_of(scope.candidate, p.entity)
    if isinstance(matter, str):
        return painted(scope, "1", p.entity, matter)
    pieces = [q for q in pieces_of(scope.candidate) if q.entity == p.other]
    if not pieces:
        raise EvidenceError(f"{p.other!r} is no rigid body that grains could bury; name one")
    strength = float(np.linalg.norm(matter.gravity))
    slow = np.sqrt(2.0 * strength * matter.pitch)
    speed = velocities(scope.candidate, p.other)
    skins = [samples(q.solid, 0.5 * matter.pitch, q.solid.lower, q.solid.upper)[0] for q in pieces]
    share = np.zeros(scope.length)
    for i, index in enumerate(range(scope.frames[0], scope.frames[1] + 1)):
        now = matter.at(index)
        still = np.linalg.norm(now.velocity - speed[index], axis=1) <= slow
        share[i] = _covered(matter, _tops(matter, pieces, skins, index), now, still)
    conditions = (
        Condition(f"share of {p.other} seen from above that grains lie on", share, max(BURY_SHARE, p.min or 0.0)),
        Condition("rise of that share since it was least", share - np.minimum.accumulate(share), BURY_RISE),
    )
    return happens(scope, p.entity, conditions, lambda i: {"body": p.other})


def _seen(matter: Matter, points: F64) -> tuple[F64, F64]:
    """Places seen along up, shape (n, 2), and heights, shape (n,)."""
    flat = np.eye(3)[np.argsort(np.abs(matter.up))[:2]]
    return points @ (flat - np.outer(flat @ matter.up, matter.up)).T, points @ matter.up


def _tops(matter: Matter, pieces: list[Piece], skins: list[F64], index: int) -> tuple[F64, F64]:
    """Highest points of a body in squares of one grain seen from above: places (n, 2) and heights (n,)."""
    points = np.concatenate([q.world(s, index) for q, s in zip(pieces, skins, strict=True)])
    place, height = _seen(matter, points)
    cell = np.floor(place / matter.pitch).astype(np.int64)
    order = np.lexsort((height, cell[:, 1], cell[:, 0]))
    last = np.append((np.diff(cell[order], axis=0) != 0).any(axis=1), True)
    return (cell[order[last]] + 0.5) * matter.pitch, height[order[last]]


def _covered(matter: Matter, tops: tuple[F64, F64], now: Granules, still: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> float:
    """Share of the squares over which a slow grain lies."""
    from scipy.spatial import cKDTree

    rows = np.flatnonzero(still)
    if not len(rows):
        return 0.0
    place, height = _seen(matter, now.position[rows])
    near = cKDTree(place).query_ball_point(tops[0], matter.pitch)
    reach = BURY_GRAINS * matter.pitch
    return float(
        np.mean([bool(((height[n] > top) & (height[n] <= top + reach)).any()) for n, top in zip(near, tops[1], strict=True)])
    )
