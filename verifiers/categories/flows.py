"""Evaluators of `flows` and `spreads`: of liquids and grains."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.categories.event import FlowEvent, SpreadEvent
from ...worlds.errors import EvidenceError
from ..predicates.conditions import Condition, happens
from .bounds import (
    FLOW_CARRIED,
    FLOW_ONE_WAY,
    FLOW_PARTICLES,
    FLOW_SECONDS,
    RIDES,
    SPREAD,
    SPREAD_BORNE,
)
from .granules import covered, matter_of
from .liquid.solids import pieces_of
from .liquid.told import painted

if TYPE_CHECKING:
    from ..predicates.outcome import Outcome
    from ..predicates.scope import Scope
    from .granules import Granules, Matter
    from .liquid.solids import Piece

__all__ = ["flows", "spreads"]


class _Passed(NamedTuple):
    """Passage of a disc in a frame."""

    along: float
    """[m^3]"""
    against: float
    carried: float
    """Part of both together that rode along with a body [m^3]."""
    particles: int
    """Particles along less those against."""


def flows(scope: Scope, p: FlowEvent) -> Outcome:
    """Measured: mean rate at which it passed the disc along its normal over the last half second."""
    matter = matter_of(scope.candidate, p.entity)
    if isinstance(matter, str):
        return painted(scope, "m^3/s", p.entity, matter)
    moving = [q for q in pieces_of(scope.candidate) if not q.still]
    first, last = scope.frames
    span = max(2, round(FLOW_SECONDS / matter.duration))
    begin = max(0, first - span)
    passed = np.zeros((4, last - begin + 1))
    for i, index in enumerate(range(begin + 1, last + 1), start=1):
        passed[:, i] = np.array(_passed(p, matter, moving, index), dtype=np.float64)
    windows = np.full((4, scope.length), np.nan)
    for i, index in enumerate(range(first, last + 1)):
        if index >= span:
            at = index - begin
            windows[:, i] = passed[:, at - span + 1 : at + 1].sum(axis=1)
    along, against, carried, count = windows
    every = np.maximum(along + against, 1e-12)
    conditions = (
        Condition("rate along the normal", (along - against) / (span * matter.duration), p.min or 0.0, "m^3/s"),
        Condition("particles that passed along the normal on balance", count, FLOW_PARTICLES),
        Condition("share along the normal, on balance, of all that passed", (along - against) / every, FLOW_ONE_WAY),
        Condition("share of it that rode along with a body", carried / every, FLOW_CARRIED, "1", "<="),
    )
    return happens(scope, p.entity, conditions, lambda i: {"span": [max(0, first + i - span), first + i]})


def _passed(p: FlowEvent, matter: Matter, moving: list[Piece], index: int) -> _Passed:
    """Volumes of particles whose straight way in a frame passes the disc."""
    now, before = matter.at(index), matter.at(index - 1)
    _, here, there = np.intersect1d(now.identity, before.identity, assume_unique=True, return_indices=True)
    normal = np.array(p.normal) / np.linalg.norm(p.normal)
    a, b = before.position[there] - p.point, now.position[here] - p.point
    old, new = a @ normal, b @ normal
    rows = np.flatnonzero((old < 0.0) != (new < 0.0))
    share = old[rows] / (old[rows] - new[rows])
    place = a[rows] + share[:, None] * (b[rows] - a[rows])
    rows = rows[np.linalg.norm(place - np.outer(place @ normal, normal), axis=1) <= p.radius]
    volume, along = now.volume[here[rows]], new[rows] > old[rows]
    rides = _rides(before.position[there[rows]], now.position[here[rows]], moving, index, matter.pitch)
    count = int(along.sum()) - int((~along).sum())
    return _Passed(float(volume[along].sum()), float(volume[~along].sum()), float(volume[rides].sum()), count)


def _rides(start: F64, end: F64, moving: list[Piece], index: int, reach: float) -> NDArray[np.bool_]:
    """Which particles are about a moving body and go where it would take them."""
    found = np.zeros(len(start), dtype=bool)
    way = np.linalg.norm(end - start, axis=1)
    boxes: dict[str, list[tuple[F64, F64]]] = {}
    for piece in moving:
        boxes.setdefault(piece.entity, []).append(piece.box(index - 1))
    for entity, own in boxes.items():
        low, high = np.min([b[0] for b in own], axis=0) - reach, np.max([b[1] for b in own], axis=0) + reach
        about = ((start >= low) & (start <= high)).all(axis=1)
        for piece in (q for q in moving if q.entity == entity):
            taken = piece.world(piece.local(start, index - 1), index)
            moved = np.linalg.norm(taken - start, axis=1) > 1e-9
            found |= about & moved & (np.linalg.norm(end - taken, axis=1) < RIDES * way)
    return found


def spreads(scope: Scope, p: SpreadEvent) -> Outcome:
    """Measured: area that it covers from above over that at the first frame of the interval."""
    matter = matter_of(scope.candidate, p.entity)
    if isinstance(matter, str):
        return painted(scope, "1", p.entity, matter)
    strength = float(np.linalg.norm(matter.gravity))
    if strength < 1e-6:
        raise EvidenceError("nothing spreads over anything where there is no gravity; give simulation.gravity")
    first, last = scope.frames
    area, borne = np.zeros(scope.length), np.full(scope.length, np.nan)
    for i, index in enumerate(range(first, last + 1)):
        now = matter.at(index)
        area[i] = covered(now.position, matter.up, matter.pitch)
        if index > 0:
            borne[i] = _borne(now, matter.at(index - 1), matter, strength)
    start = area[0] if area[0] > 0.0 else np.nan
    conditions = (
        Condition("area that it covers over that at the start", area / start, max(SPREAD, p.min or 0.0)),
        Condition("share of its weight that is borne", borne, SPREAD_BORNE),
    )
    return happens(scope, p.entity, conditions, lambda i: {"area_m2": float(area[i]), "from_m2": float(area[0])})


def _borne(now: Granules, before: Granules, matter: Matter, strength: float) -> float:
    """Share of the weight that is borne, by the mean upward acceleration of what is in both frames; NaN where nothing is."""
    _, here, there = np.intersect1d(now.identity, before.identity, assume_unique=True, return_indices=True)
    if not len(here):
        return float("nan")
    change = (now.velocity[here] - before.velocity[there]) @ matter.up
    return 1.0 + float(np.average(change, weights=now.volume[here])) / (matter.duration * strength)
