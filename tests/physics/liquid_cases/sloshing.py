"""A standing wave in a closed basin against linear theory (Airy): its period, and how much of its height it keeps."""

from __future__ import annotations

import numpy as np
from worldagent.simulation.step_reports import StepReport

from .world import EngineName, Figure, G, advance, lattice, liquid, make, near

__all__ = ["standing_wave"]

DEPTH, LENGTH, WIDTH = 0.2, 0.4, 0.1
HEIGHT = 0.02
"""Amplitude at the walls [m]: a twentieth of the length."""
PERIODS = 3.0


def standing_wave(engine: EngineName, cells: int) -> list[Figure]:
    """The lowest mode, half a wave long, let go at rest; `cells` over the depth.

    The centre of mass swings by 2 a L / (pi^2 h) about the middle (a amplitude, L length, h depth): its swing is the wave's height.
    """
    spacing = DEPTH / cells
    position = lattice((0, 0, 0), (LENGTH, WIDTH, DEPTH), spacing)
    number = np.pi / LENGTH
    # The mode's own displacement of a liquid at rest (Airy): divergence-free, along the walls at the walls.
    x, z = position[:, 0].copy(), position[:, 2].copy()
    share = HEIGHT / np.sinh(number * DEPTH)
    position[:, 2] += share * np.cos(number * x) * np.sinh(number * z)
    position[:, 0] -= share * np.sin(number * x) * np.cosh(number * z)
    running = make(engine, liquid(spacing, position, (LENGTH, WIDTH, 2 * DEPTH)))
    period = 2 * np.pi / np.sqrt(G * number * np.tanh(number * DEPTH))
    time, swing = [0.0], [_swing(running)]

    def look(now: float, _: StepReport) -> None:
        time.append(now)
        swing.append(_swing(running))

    advance(running, (PERIODS + 0.5) * period, (), look, longest=period / 60)
    t, s = np.array(time), np.array(swing)
    crossings = t[1:][(s[1:] > 0) != (s[:-1] > 0)]
    late = s[t > (PERIODS - 0.5) * period]
    return [
        near("period / linear theory", 2 * float(np.diff(crossings).mean()) / period, 1.0, 0.05),
        near("height after three periods / at first", float(late.max()) / s[0], 1.0, 0.1),
    ]


def _swing(running: object) -> float:
    p = running.particles()  # type: ignore[attr-defined]
    return 0.5 * LENGTH - float((p.volume * p.position[:, 0]).sum() / p.volume.sum())
