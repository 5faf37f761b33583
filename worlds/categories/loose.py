"""Facts that loose matter shares: the domain in which it is followed, and the caps on its numbers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import F64

if TYPE_CHECKING:
    from ..spec import GasInstance, LiquidInstance, ParticleInstance, WorldSpec

__all__ = ["ROUNDED", "LooseEstimate", "counts", "domain_box", "told_box"]

ROUNDED = 1e-3
"""Share that sizes may be short by: messages tell spacings with three digits, and corners are sums."""

CACHE_BYTES_PER_PARTICLE_FRAME = 48
"""Position, velocity, id, fluid, volume, density, pressure, temperature in 32 bits [bytes]."""


class LooseEstimate(NamedTuple):
    """Amounts that an instance will take."""

    particles: float
    """At most at one time."""
    steps: float
    """Of the whole run, preroll included."""
    cells: float = 0.0
    """Of its grid; 0 for particles."""


def domain_box(instance: GasInstance | LiquidInstance | ParticleInstance) -> tuple[F64, F64]:
    """Least and greatest corner of a domain [m]."""
    center, half = np.array(instance.settings.domain.center), 0.5 * np.array(instance.settings.domain.size)
    return center - half, center + half


def told_box(low: F64, high: F64) -> str:
    """Text for a box."""
    return f"[{', '.join(f'{v:.4g}' for v in low)}] to [{', '.join(f'{v:.4g}' for v in high)}] m"


def counts(spec: WorldSpec, estimates: Iterable[LooseEstimate]) -> dict[str, float]:
    """Sum of the amounts of instances, by name of the cap."""
    found = list(estimates)
    particles = sum(e.particles for e in found)
    return {
        "steps": sum(e.steps for e in found),
        "particles": particles,
        "particle_steps": sum(e.particles * e.steps for e in found),
        "cells": sum(e.cells for e in found),
        "cache_bytes": particles * spec.simulation.frames * CACHE_BYTES_PER_PARTICLE_FRAME,
    }
