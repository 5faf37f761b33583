"""Events that happen to a gas in its own way: it rises, drifts, spreads, fills a vessel (R28, R131).

New gas comes all the time, so the way of the middle of all that is there tells little. What counts is how far the flow carries the soot: the
sum over frames of its mean velocity.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.event import SpreadEvent, VesselEvent
from ...predicates.conditions import Condition, happens
from ...predicates.events.measures import run_sums
from ..vessel import vessel_of
from .bounds import CUT, DRIFT_SHARE, FILL_RISE, FILL_SHARE, FILLED, HALF_SIZE, SPREAD
from .predicates import moved_gas, no_gas, top_of

if TYPE_CHECKING:
    from ....worlds.predicates import BodyEvent
    from ...predicates.outcome import Outcome
    from ...predicates.scope import Evaluator, Scope
    from .frames import GasBox

__all__ = ["EVENTS"]

TINY = 1e-30


def _carried(box: GasBox, scope: Scope) -> tuple[F64, F64]:
    """Way that the flow carries the soot on the mean over each interval that ends in the scope [m], (length, 3), and its length, (length,)."""
    first, last = scope.frames
    ways, lengths = np.zeros((scope.length, 3)), np.zeros(scope.length)
    for i, index in enumerate(range(first, last + 1)):
        if index == 0:
            continue
        for k in (index - 1, index):
            moment, length, total = box.candidate.memo(("carried soot", box.solver, k), partial(_moving, box, k))
            ways[i] += 0.5 * box.duration * moment / total
            lengths[i] += 0.5 * box.duration * length / total
    return ways, lengths


def _moving(box: GasBox, index: int) -> tuple[F64, float, float]:
    """Soot by its velocity at a frame [kg/s m^-2], by its speed, and all of it; per volume of a cell."""
    frame = box.read(index)
    mass = frame.soot.astype(np.float64) * frame.room
    moment = np.tensordot(mass, box.velocity(frame), axes=3)
    return moment, float((mass * frame.speed).sum()), max(float(mass.sum()), TINY)


def _least(scope: Scope, p: BodyEvent) -> float:
    return max(HALF_SIZE * 0.5 * min(scope.candidate.spec.entities[p.entity].dimensions.size), p.min or 0.0)


def rises(scope: Scope, p: BodyEvent) -> Outcome:
    """Measured: how far the flow carries its soot up without a break [m]."""
    box = moved_gas(scope.candidate, p.entity)
    if isinstance(box, str):
        return no_gas(scope, p.entity, "m", box)
    up = _carried(box, scope)[0] @ box.up
    height, least = run_sums(up > 0.0, up), _least(scope, p)
    source = next(s for s in box.sources if s.entity == p.entity)
    tops = np.array([top_of(box, box.read(k)) for k in range(scope.frames[0], scope.frames[1] + 1)])
    conditions = [Condition("way that the flow carries it up without a break", height, least, "m")]
    if box.up[2] > 1.0 - 1e-9:
        conditions.append(Condition("height of its top over that of its source", tops - source.upper[2], _least(scope, p), "m"))
    return happens(scope, p.entity, conditions)


def drifts(scope: Scope, p: BodyEvent) -> Outcome:
    """Measured: how far the flow carries its soot level on the mean, without a break [m]."""
    box = moved_gas(scope.candidate, p.entity)
    if isinstance(box, str):
        return no_gas(scope, p.entity, "m", box)
    ways, lengths = _carried(box, scope)
    level = ways - (ways @ box.up)[:, None] * box.up
    way = np.linalg.norm(level, axis=1)
    on = way > 0.0
    sums = np.stack([run_sums(on, level[:, a]) for a in range(3)], axis=1)
    value, total = np.linalg.norm(sums, axis=1), run_sums(on, lengths)
    conditions = (
        Condition("level way that the flow carries its middle", value, _least(scope, p), "m"),
        Condition("share of it in the mean way of all its soot", value / np.maximum(total, TINY), DRIFT_SHARE),
    )
    return happens(scope, p.entity, conditions, lambda i: {"way": [round(float(v), 4) for v in sums[i]]})


def spreads(scope: Scope, p: SpreadEvent) -> Outcome:
    """Measured: area over which one sees it from above, over that at the first frame of the interval or that of its source."""
    box = moved_gas(scope.candidate, p.entity)
    if isinstance(box, str):
        return no_gas(scope, p.entity, "1", box)
    axis = int(np.argmax(np.abs(box.up)))
    area = np.zeros(scope.length)
    for i, index in enumerate(range(scope.frames[0], scope.frames[1] + 1)):
        frame = box.read(index)
        depth = box.extinction * box.cell * np.sum(frame.soot * frame.room, axis=axis, dtype=np.float64)
        area[i] = float((depth >= CUT).sum()) * box.cell**2
    source = next(s for s in box.sources if s.entity == p.entity)
    start = max(float(area[0]), float(np.prod(np.delete(source.width, axis))))
    conditions = (
        Condition("area that is seen of it from above, over that at the start", area / start, max(SPREAD, p.min or 0.0)),
    )
    return happens(scope, p.entity, conditions, lambda i: {"area_m2": float(area[i]), "from_m2": start})


def fills(scope: Scope, p: VesselEvent) -> Outcome:
    """Measured: share of what the walls of the vessel enclose that it takes up."""
    box = moved_gas(scope.candidate, p.entity)
    if isinstance(box, str):
        return no_gas(scope, p.entity, "1", box)
    vessel = vessel_of(scope.candidate, p.other, box.up)
    least = FILLED * box.dark(p.entity)
    share = np.zeros(scope.length)
    for i, index in enumerate(range(scope.frames[0], scope.frames[1] + 1)):
        frame = box.read(index)
        within = vessel.inside(vessel.local(frame.centers.reshape(-1, 3), index)).reshape(frame.soot.shape)
        room = np.where(within, frame.room, 0.0).astype(np.float64)
        share[i] = float(room[(frame.soot >= least) & (frame.soot > 0.0)].sum()) * box.volume / vessel.capacity
    conditions = (
        Condition(f"share of {p.other} that it takes up", share, max(FILL_SHARE, p.min or 0.0)),
        Condition("rise of that share since it was least", share - np.minimum.accumulate(share), FILL_RISE),
    )
    return happens(scope, p.entity, conditions, lambda i: {"vessel": p.other, "capacity_m3": vessel.capacity})


EVENTS: Mapping[str, Evaluator] = {"rises": rises, "drifts": drifts, "spreads": spreads, "fills": fills}
"""By kind: what a gas meets by definitions of its own."""
