"""Evaluator of `splashes`: liquid that a body's impact throws above the surface."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.liquid.events import SplashEvent
from ....worlds.errors import EvidenceError
from ...ledgers.motion import centers, fastest_points
from ...predicates.conditions import Condition, happens
from .bodies import Bodies, exchanged
from .bounds import (
    FELT,
    SPLASH_ABOUT,
    SPLASH_CREST,
    SPLASH_HEIGHT,
    SPLASH_SECONDS,
    SPLASH_SPACINGS,
    SPLASH_SPEED,
)
from .told import liquid_or_none, painted

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ...predicates.outcome import Outcome
    from ...predicates.scope import Scope
    from .frames import Frame, Liquid, Rows

__all__ = ["splashes"]


class _Impact(NamedTuple):
    """A body strikes the liquid within a frame."""

    frame: int
    place: F64
    """Position of the body's middle [m], shape (3,)."""
    speed: float
    """Against the liquid about it [m/s]."""
    level: float
    """Level of the surface about it at the frame before, along up [m]."""
    below: frozenset[int]
    """Ids of what was then about it, not above the surface."""


class _Body:
    """Body that may strike a liquid."""

    def __init__(self, candidate: Candidate, entity: str, liquid: Liquid, member: int) -> None:
        self.liquid, self.member = liquid, member
        bodies = Bodies(liquid)
        self.rows = [i for i, n in enumerate(bodies.entities) if n == entity]
        if not self.rows:
            raise EvidenceError(f"{entity!r} does not meet this liquid; couple them, or name a body that it meets")
        self.count = bodies.count
        size = np.ptp(candidate.vertices(entity, 0), axis=0)
        self.half, self.extent = 0.5 * float(size.min()), float(size.max())
        self.weight = float(sum(b.mass for b in candidate.entity(entity).bodies)) * liquid.strength
        self.place = centers(candidate, entity)
        self.speed = fastest_points(candidate, entity)

    def pressed(self, frame: int) -> bool:
        """True if the liquid pushed it in a frame."""
        given = exchanged(self.liquid.read(frame), "impulse", self.count)[self.rows, :3]
        return float(np.linalg.norm(given.sum(axis=0))) > FELT * self.weight * self.liquid.duration

    def impact(self, frame: int, least: float) -> _Impact | None:
        """Impact on the liquid within a frame, at a speed of at least `least` [m/s]; None where there is none."""
        speed = float(self.speed[frame - 1 : frame + 1].max())
        if speed < least or not self.pressed(frame):
            return None
        then = self.liquid.read(frame - 1)
        about = self._about(then, self.place[frame])
        if not len(about):
            return None
        flow = then.velocity[about].mean(axis=0)
        against = float(np.linalg.norm((self.place[frame] - self.place[frame - 1]) / self.liquid.duration - flow))
        if max(against, speed - float(np.linalg.norm(flow))) < least:
            return None
        heights = then.position[about] @ self.liquid.up
        level = float(np.quantile(heights, 0.95)) + 0.5 * self.liquid.pitch
        return _Impact(
            frame, self.place[frame], max(against, speed), level, frozenset(then.identity[about[heights <= level]].tolist())
        )

    def _about(self, frame: Frame, place: F64, more: float = 0.0) -> Rows:
        """Rows of the liquid about a place, seen from above."""
        away = frame.position - place
        flat = away - np.outer(away @ self.liquid.up, self.liquid.up)
        near = np.linalg.norm(flat, axis=1) <= SPLASH_ABOUT * self.extent + more
        return np.flatnonzero(near & (frame.fluid == self.member))

    def crest(self, impact: _Impact, frame: int) -> float:
        """Height over the surface before an impact that eight particles which were under it reach about it at a frame [m]."""
        now = self.liquid.read(frame)
        rows = self._about(now, impact.place, impact.speed * (frame - impact.frame + 1) * self.liquid.duration)
        rows = rows[np.isin(now.identity[rows], list(impact.below))]
        if len(rows) < SPLASH_CREST:
            return 0.0
        return float(np.partition(now.position[rows] @ self.liquid.up, -SPLASH_CREST)[-SPLASH_CREST]) - impact.level


def splashes(scope: Scope, p: SplashEvent) -> Outcome:
    """Measured: height over the surface that the liquid is thrown to by the body's impact, over its half-size."""
    found = liquid_or_none(scope.candidate, p.entity)
    if isinstance(found, str):
        return painted(scope, "1", p.entity, found)
    liquid, member = found
    if liquid.strength < 1e-6:
        raise EvidenceError("nothing splashes where there is no gravity; give simulation.gravity")
    body = _Body(scope.candidate, p.other, liquid, member)
    least = max(SPLASH_HEIGHT, p.min or 0.0, SPLASH_SPACINGS * liquid.spacing / body.half)
    slow = SPLASH_SPEED * float(np.sqrt(2.0 * liquid.strength * least * body.half))
    span = max(2, round(SPLASH_SECONDS / liquid.duration))
    first, last = scope.frames
    struck = [hit for k in range(max(1, first), last + 1) if (hit := body.impact(k, slow)) is not None]
    height, speed = np.zeros(scope.length), np.zeros(scope.length)
    for impact in struck:
        for frame in range(impact.frame, min(last, impact.frame + span) + 1):
            crest, i = body.crest(impact, frame) / body.half, frame - first
            if crest > height[i] or speed[i] == 0.0:
                height[i], speed[i] = max(crest, height[i]), impact.speed
    conditions = (
        Condition("height over the surface that it is thrown to, over the body's half-size,", height, least),
        Condition(f"speed at which {p.other} struck it", speed, slow, "m/s"),
    )
    return happens(scope, p.entity, conditions, lambda i: {"body": p.other, "struck_at": [s.frame for s in struck][:12]})
