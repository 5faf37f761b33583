"""Evaluator of `splashes`: liquid, or grains, that a body's impact throws above the surface."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.liquid.events import SplashEvent
from ....worlds.errors import EvidenceError
from ...ledgers.exchanged import CHANNEL
from ...ledgers.motion import centers, fastest_points
from ...predicates.conditions import Condition, happens
from ..granules import matter_of
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
    from numpy.typing import NDArray

    from ....worlds.candidate import Candidate
    from ...predicates.outcome import Outcome
    from ...predicates.scope import Scope
    from ..granules import Granules, Matter

__all__ = ["splashes"]


class _Impact(NamedTuple):
    """A body strikes the matter within a frame."""

    frame: int
    place: F64
    """Position of the body's middle [m], shape (3,)."""
    speed: float
    """Against the matter about it [m/s]."""
    level: float
    """Level of the surface about it at the frame before, along up [m]."""
    below: frozenset[int]
    """Ids of what was then about it, not above the surface."""


class _Body:
    """Body that may strike loose matter."""

    def __init__(self, candidate: Candidate, entity: str, matter: Matter) -> None:
        self.matter = matter
        self.cache = next(
            candidate.caches[n]
            for n, s in candidate.spec.simulation.solvers.items()
            if matter.entity in s.members and n in candidate.caches
        )
        self.rows = [i for i, n in enumerate(self.cache.index.colliders) if n.split("/", 1)[0] == entity]
        if not self.rows:
            raise EvidenceError(f"{entity!r} does not meet {matter.entity!r}; couple them, or name a body that it meets")
        size = np.ptp(candidate.vertices(entity, 0), axis=0)
        self.half, self.extent = 0.5 * float(size.min()), float(size.max())
        self.weight = float(sum(b.mass for b in candidate.entity(entity).bodies)) * float(np.linalg.norm(matter.gravity))
        self.place = centers(candidate, entity)
        self.speed = fastest_points(candidate, entity)

    def pressed(self, frame: int) -> bool:
        """True if the matter pushed it in a frame."""
        given = np.asarray(self.cache.read(frame, (CHANNEL,))[CHANNEL], dtype=np.float64)
        if given.shape != (len(self.cache.index.colliders), 6):
            raise EvidenceError(f"channel {CHANNEL!r} of {self.cache.index.solver!r} has shape {given.shape}; bake again")
        return float(np.linalg.norm(given[self.rows, :3].sum(axis=0))) > FELT * self.weight * self.matter.duration

    def impact(self, frame: int, least: float) -> _Impact | None:
        """Impact on the matter within a frame, at a speed of at least `least` [m/s]; None where there is none."""
        speed = float(self.speed[frame - 1 : frame + 1].max())
        if speed < least or not self.pressed(frame):
            return None
        then = self.matter.at(frame - 1)
        about = self._about(then, self.place[frame])
        if not len(about):
            return None
        flow = then.velocity[about].mean(axis=0)
        against = float(np.linalg.norm((self.place[frame] - self.place[frame - 1]) / self.matter.duration - flow))
        if max(against, speed - float(np.linalg.norm(flow))) < least:
            return None
        heights = then.position[about] @ self.matter.up
        level = float(np.quantile(heights, 0.95)) + 0.5 * self.matter.pitch
        return _Impact(
            frame, self.place[frame], max(against, speed), level, frozenset(then.identity[about[heights <= level]].tolist())
        )

    def _about(self, now: Granules, place: F64, more: float = 0.0) -> NDArray[np.intp]:
        """Rows of the matter about a place, seen from above."""
        away = now.position - place
        flat = away - np.outer(away @ self.matter.up, self.matter.up)
        return np.flatnonzero(np.linalg.norm(flat, axis=1) <= SPLASH_ABOUT * self.extent + more)

    def crest(self, impact: _Impact, frame: int) -> float:
        """Height over the surface before an impact that eight particles which were under it reach about it at a frame [m]."""
        now = self.matter.at(frame)
        rows = self._about(now, impact.place, impact.speed * (frame - impact.frame + 1) * self.matter.duration)
        rows = rows[np.isin(now.identity[rows], list(impact.below))]
        if len(rows) < SPLASH_CREST:
            return 0.0
        return float(np.partition(now.position[rows] @ self.matter.up, -SPLASH_CREST)[-SPLASH_CREST]) - impact.level


def splashes(scope: Scope, p: SplashEvent) -> Outcome:
    """Measured: height over the surface that the liquid, or grains, are thrown to by the body's impact, over its half-size."""
    matter = matter_of(scope.candidate, p.entity)
    if isinstance(matter, str):
        return painted(scope, "1", p.entity, matter)
    strength = float(np.linalg.norm(matter.gravity))
    if strength < 1e-6:
        raise EvidenceError("nothing splashes where there is no gravity; give simulation.gravity")
    body = _Body(scope.candidate, p.other, matter)
    found = liquid_or_none(scope.candidate, p.entity)
    spacing = matter.pitch if isinstance(found, str) else found[0].spacing
    least = max(SPLASH_HEIGHT, p.min or 0.0, SPLASH_SPACINGS * spacing / body.half)
    slow = SPLASH_SPEED * float(np.sqrt(2.0 * strength * least * body.half))
    span = max(2, round(SPLASH_SECONDS / matter.duration))
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
