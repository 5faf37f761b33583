"""Least and largest masses of bodies of given volumes and substances (R154)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from .materials import DENSITY_RANGES

__all__ = ["LEAST_WALL", "ROUNDING", "Weights", "allowed"]

LEAST_WALL = 1e-4
"""[m] Thinnest wall of a hollow body: that of a drinks can."""
SPHERE = (36.0 * math.pi) ** (1.0 / 3.0)
"""No body of volume V has less surface than a ball: (36 pi)^(1/3) V^(2/3)."""
ROUNDING = 0.01
"""Share by which a mass may be off: facets of round parts, and digits of messages."""


class Weights(NamedTuple):
    """Least and largest mass of a body [kg]."""

    least: float
    hollow: float
    """Least as a shell of the thinnest wall."""
    most: float


def allowed(pieces: Sequence[tuple[float, str]]) -> Weights:
    """Least and largest mass [kg] of a body of these volumes [m^3] and substances.

    Parts may lie in one another: the least is that of the heaviest part alone, the most that of all of them.
    """
    found = [(v, *DENSITY_RANGES[s]) for v, s in pieces]
    return Weights(
        max((v * low for v, low, _ in found), default=0.0),
        max((min(v, SPHERE * v ** (2.0 / 3.0) * LEAST_WALL) * low for v, low, _ in found), default=0.0),
        sum(v * high for v, _, high in found),
    )
