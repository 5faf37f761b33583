"""Evaluators of `bends`, `stretches` and `wobbles`: from a body's middle line and from its shape in its own frame; `bends` of sheets too."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.elastic.events import DeformEvent
from ....worlds.errors import EvidenceError
from ...ledgers.strains import require_deforming
from ...predicates.conditions import Condition, happens
from ...predicates.turns import turning_points
from .bounds import BEND_SHARE, LINE_PARTS, STRETCH_SHARE, TURNS, WOBBLE_SHARE

if TYPE_CHECKING:
    from ....worlds.categories.deforming import Deforming
    from ...predicates.outcome import Outcome
    from ...predicates.scope import Scope

__all__ = ["bends", "stretches", "wobbles"]


class _Line:
    """Middle line of a body: the centres of slices across its longest extent at rest.

    Args:
        scope: candidate and frames.
        entity: a body that deforms.
        nth: which extent, the longest being 0.
    """

    def __init__(self, scope: Scope, entity: str, nth: int = 0) -> None:
        self.soft: Deforming = require_deforming(scope.candidate, entity)
        rest = self.soft.rest
        size = np.ptp(rest, axis=0)
        axis = int(np.argsort(-size, kind="stable")[nth])
        self.length = float(size[axis])
        """[m], at rest."""
        place = (rest[:, axis] - rest[:, axis].min()) / self.length
        self.slices = np.minimum((place * LINE_PARTS).astype(int), LINE_PARTS - 1)
        self.used = np.unique(self.slices)
        self.frames = range(scope.frames[0], scope.frames[1] + 1)

    def at(self, frame: int) -> F64:
        """Its points at a frame [m], shape (parts, 3)."""
        x, weight = self.soft.positions(frame), self.soft.masses
        return np.stack([np.average(x[self.slices == k], axis=0, weights=weight[self.slices == k]) for k in self.used])

    def sag(self, frame: int) -> F64:
        """Distance of its points from the straight line between its ends, in the body's own frame [m], shape (parts, 3)."""
        points = self.at(frame)
        way = points[-1] - points[0]
        share = ((points - points[0]) @ way / max(float(way @ way), 1e-300))[:, None]
        return self.soft.pose(frame).inverse().apply(points) - self.soft.pose(frame).inverse().apply(points[0] + share * way)


def _solid(scope: Scope, entity: str) -> None:
    """Raise EvidenceError unless it is an elastic body."""
    if scope.candidate.spec.entities[entity].physics.category != "elastic":
        raise EvidenceError(f"{entity!r} is cloth; ask bends, flutters, tears or drape of it")


def bends(scope: Scope, p: DeformEvent) -> Outcome:
    """Measured: change of the middle line's sag since the first frame, over the body's length; of a sheet along the side that sags more."""
    sheet = scope.candidate.spec.entities[p.entity].physics.category != "elastic"
    lines = [_Line(scope, p.entity, nth) for nth in range(2 if sheet else 1)]
    each = np.array([_bent(line) for line in lines])
    line, value = lines[int(each.max(axis=1).argmax())], each.max(axis=0)
    sag = Condition("change of its middle line's sag, over its length,", value, max(BEND_SHARE, p.min or 0.0))
    return happens(scope, p.entity, [sag], lambda i: {"length_m": line.length, "bent_at_the_end": float(value[-1])})


def _bent(line: _Line) -> F64:
    """Change of a line's sag since the first frame, over its length, shape (frames,)."""
    first = line.sag(line.frames[0])
    return np.array([np.linalg.norm(line.sag(f) - first, axis=1).max() for f in line.frames]) / line.length


def stretches(scope: Scope, p: DeformEvent) -> Outcome:
    """Measured: growth of the middle line since the first frame, over its length then."""
    _solid(scope, p.entity)
    line = _Line(scope, p.entity)
    length = np.array([np.linalg.norm(np.diff(line.at(f), axis=0), axis=1).sum() for f in line.frames])
    growth = Condition("growth of its middle line", length / length[0] - 1.0, max(STRETCH_SHARE, p.min or 0.0))
    return happens(scope, p.entity, [growth], lambda i: {"length_m": float(length[i])})


def wobbles(scope: Scope, p: DeformEvent) -> Outcome:
    """Measured: turning points so far of the point that has most, in the body's own frame."""
    _solid(scope, p.entity)
    line = _Line(scope, p.entity)
    own = np.stack([line.soft.pose(f).inverse().apply(line.soft.positions(f)) for f in line.frames])
    away = own - own.mean(axis=0)
    _, _, main = np.linalg.svd(away.transpose(1, 0, 2), full_matrices=False)
    along = np.einsum("fvi,vi->fv", away, main[:, 0])
    least = WOBBLE_SHARE * line.length
    wide = np.argsort(np.ptp(along, axis=0))[::-1][:MOST_POINTS]
    turns = np.array([turning_points(along[:, v], least) for v in wide]).max(axis=0)
    count = Condition("turning points against the rest of it", turns, max(TURNS, p.min or 0.0))
    return happens(scope, p.entity, [count], lambda i: {"least_swing_m": least})


MOST_POINTS = 50
"""Points that go farthest, which are looked at."""
