"""Which frames of a film a judge sees, metric by metric (R145-R147, R150): pure functions of its number of frames."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ....worlds.errors import InputError

__all__ = [
    "LEAST_FRAMES",
    "Window",
    "causal_links",
    "causal_stages",
    "composition_windows",
    "production_windows",
    "shot_segments",
]

STAGES, SEGMENTS = 5, 8
"""S_c of Caus; of Qual and Comp."""
MOST = 16
"""K_c: frames per stage or segment."""
OVERLAP = 0.1
"""Share of a stage's length that it has in common with each neighbour, half of it on either side of their bound (own choice)."""
STEP, WIDTH, STRIDE = 10, 64, 32
"""Comp: one frame in ten; windows of at most 64 sampled frames, 32 apart."""
PRODUCTION = 64
"""Prod: frames per window."""
LEAST_FRAMES = SEGMENTS
"""Frames of the shortest film that can be judged: one per segment."""


class Window(NamedTuple):
    """Frames that are shown together, in temporal order."""

    part: int
    """Stage, segment or window, from 0."""
    frames: tuple[int, ...]


def _span(count: int, parts: int, part: int, *, margin: float = 0.0) -> tuple[int, int]:
    """First and last frame of a part of a film, widened by a share of its length to both sides where there is film."""
    if count < LEAST_FRAMES:
        raise InputError(f"a film of {count} frames cannot be judged; it needs at least {LEAST_FRAMES}")
    first, after = part * count // parts, (part + 1) * count // parts
    reach = round(margin * count / parts)
    return max(0, first - reach), min(count, after + reach) - 1


def _spread(first: int, last: int, most: int) -> tuple[int, ...]:
    """At most so many frames, evenly from first to last with both."""
    if last - first + 1 <= most:
        return tuple(range(first, last + 1))
    return tuple(int(k) for k in np.rint(np.linspace(first, last, most)))


def causal_stages(count: int) -> list[Window]:
    """Five ordered stages of a film of `count` frames, at most 16 frames each, neighbours overlapping by a tenth."""
    return [Window(s, _spread(*_span(count, STAGES, s, margin=OVERLAP / 2), MOST)) for s in range(STAGES)]


def causal_links(count: int) -> list[Window]:
    """The four pairs of adjacent stages: frames of both, each once and in order."""
    stages = causal_stages(count)
    return [Window(s, tuple(sorted({*stages[s].frames, *stages[s + 1].frames}))) for s in range(STAGES - 1)]


def shot_segments(count: int) -> list[Window]:
    """Eight contiguous segments, at most 16 frames each."""
    return [Window(s, _spread(*_span(count, SEGMENTS, s), MOST)) for s in range(SEGMENTS)]


def composition_windows(count: int) -> list[Window]:
    """Every tenth frame of each of eight segments from its first on; more than 64 of them in windows of 64 that begin 32 apart."""
    found = []
    for segment in range(SEGMENTS):
        first, last = _span(count, SEGMENTS, segment)
        sampled = tuple(range(first, last + 1, STEP))
        starts = range(0, len(sampled) - WIDTH + STRIDE, STRIDE) if len(sampled) > WIDTH else (0,)
        found += [Window(segment, sampled[s : s + WIDTH]) for s in starts]
    return found


def production_windows(count: int) -> list[Window]:
    """Contiguous windows of 64 frames, the last with what remains: every frame stands in exactly one."""
    if count < 1:
        raise InputError("a film without frames cannot be judged")
    return [
        Window(w, tuple(range(w * PRODUCTION, min(count, (w + 1) * PRODUCTION)))) for w in range(math.ceil(count / PRODUCTION))
    ]
