"""Evaluators of `cracks` and `breaks`: from the log of bonds, and from where pieces are that no bond holds any more."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ....worlds.arrays import F64
from ....worlds.bonds import components
from ....worlds.categories.fracture.events import FractureEvent
from ...predicates.conditions import Condition, happens
from .bounds import BREAK_APART, BREAK_SHARE, CRACK_SHARE
from .predicates import by_cause, frames_of

if TYPE_CHECKING:
    from ...predicates.outcome import Outcome
    from ...predicates.scope import Scope
    from .frames import Frames

__all__ = ["breaks", "cracks"]


def _broken(scope: Scope, p: FractureEvent, frames: Frames) -> F64:
    """Share of the bonds that broke since the interval began, by the cause that is asked for, per frame of it."""
    first, last = scope.frames
    total = max(1, len(frames.bonds))
    if p.other is not None:
        return by_cause(frames, p.entity, p.other, (first, last))
    before = frames.broken(max(0, first - 1))
    return np.array([float((frames.broken(f) & ~before).sum()) for f in range(first, last + 1)]) / total


def _least(frames: Frames) -> float:
    """Least share of the bonds that tells a crack."""
    return max(CRACK_SHARE, 1.0 / max(1, len(frames.bonds)))


def cracks(scope: Scope, p: FractureEvent) -> Outcome:
    """Measured: share of the bonds that broke since the interval began."""
    frames = frames_of(scope.candidate, p.entity)
    by = "" if p.other is None else f" by {p.other}"
    share = Condition(f"share of its bonds that broke{by}", _broken(scope, p, frames), max(_least(frames), p.min or 0.0))
    return happens(scope, p.entity, [share], lambda i: {"bonds": len(frames.bonds)})


def breaks(scope: Scope, p: FractureEvent) -> Outcome:
    """Measured: share of its mass in lumps that came off since the interval began."""
    frames = frames_of(scope.candidate, p.entity)
    first, last = scope.frames
    off = [_came_off(frames, max(0, first - 1), f) for f in range(first, last + 1)]
    by = "" if p.other is None else f" by {p.other}"
    conditions = (
        Condition("share of its mass that came off", np.array([sum(o.values()) for o in off]), max(BREAK_SHARE, p.min or 0.0)),
        Condition(f"share of its bonds that broke{by}", _broken(scope, p, frames), _least(frames)),
    )

    def detail(i: int) -> dict[str, Any]:
        return {"came_off": {n: round(s, 4) for n, s in off[i].items()}}

    return happens(scope, p.entity, conditions, detail)


def _came_off(frames: Frames, start: int, frame: int) -> dict[str, float]:
    """Lumps that were one with others at a frame and are now apart from them, by their first piece, with their shares of the mass.

    Of every lump of the start one part stays: what the world holds, else the heaviest. The others came off where they are not
    where that one's motion would have taken them.
    """
    bodies = frames.built.bodies
    mass = np.array([b.mass for b in bodies])
    (begin, turned), (now, turn) = frames.poses(start), frames.poses(frame)
    centers = np.stack([b.center for b in bodies])
    begin_at, now_at = (p + np.einsum("nij,nj->ni", r, centers) for p, r in ((begin, turned), (now, turn)))
    whole, _ = components(len(bodies), frames.bonds, ~frames.broken(start))
    labels, fixed = components(len(bodies), frames.bonds, ~frames.broken(frame))
    rest = frames.rest_points(
        np.concatenate([q.render.vertices + b.pose.position for b in bodies for q in frames.built.parts_of(b.name)])
    )
    apart = BREAK_APART * float(np.linalg.norm(np.ptp(rest, axis=0)))
    found: dict[str, float] = {}
    for lump in np.unique(whole):
        parts = np.unique(labels[whole == lump])
        if len(parts) < 2:
            continue
        weight = [(bool(fixed[q]), float(mass[labels == q].sum())) for q in parts]
        stays = parts[max(range(len(parts)), key=lambda k: weight[k])]
        lead = int(np.flatnonzero(labels == stays)[np.argmax(mass[labels == stays])])
        moved = turn[lead] @ turned[lead].T
        for part in parts[parts != stays]:
            own = labels == part
            was, is_at = (np.average(x[own], axis=0, weights=mass[own]) for x in (begin_at, now_at))
            if np.linalg.norm(is_at - now[lead] - moved @ (was - begin[lead])) >= apart:
                found[bodies[int(np.flatnonzero(own)[0])].name] = float(mass[own].sum() / mass.sum())
    return found
