"""Velocities of moving air, and accelerations towards a centre, as functions of point and time.

References:
    Turbulence as a sum of random plane waves: R. H. Kraichnan, Physics of Fluids 13 (1970) 22, doi:10.1063/1.1692799; the spectrum of
    the inertial range, E(k) ~ k^(-5/3): A. N. Kolmogorov (1941), reprinted in doi:10.1098/rspa.1991.0075.
    Vortex: M. P. Scully (1975), Computation of helicopter rotor wake geometry, MIT ASRL TR 178-1; W. Kaufmann (1962),
    doi:10.1007/BF00538235.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .arrays import F64

__all__ = ["PlaneWaves", "attraction", "gust_share", "gust_waves", "smooth_step", "turbulence", "turbulence_waves", "vortex"]

MODES = 64
"""Waves that a turbulence is made of."""
OCTAVES = 3.0
"""Own choice: from the largest eddies to the smallest."""
GUSTS = 8
"""Waves that gusts are made of."""


@dataclass(frozen=True)
class PlaneWaves:
    """Sum of amplitude cos(vector . x - frequency t + phase) over m waves."""

    vector: F64
    """[1/m], shape (m, 3)."""
    amplitude: F64
    """[m/s], shape (m, 3); of gusts [1], shape (m, 1)."""
    frequency: F64
    """[rad/s], shape (m,)."""
    phase: F64
    """[rad], shape (m,)."""


def smooth_step(share: F64) -> F64:
    """3 s^2 - 2 s^3, shape of `share`: from 0 to 1 with no slope at either end, for s in [0, 1]."""
    return np.asarray(share * share * (3.0 - 2.0 * share))


def gust_waves(period: float, seed: int) -> PlaneWaves:
    """Gusts with periods within a factor of two of a mean [s]; equal seeds give equal gusts."""
    rng = np.random.default_rng([seed, 11])
    frequency = 2 * math.pi / period * 2.0 ** rng.uniform(-1.0, 1.0, GUSTS)
    return PlaneWaves(np.zeros((GUSTS, 3)), np.full((GUSTS, 1), 1.0 / GUSTS), frequency, rng.uniform(0, 2 * math.pi, GUSTS))


def gust_share(gusts: PlaneWaves, time: float) -> float:
    """Swell of the wind at a time [s], from -1 to 1, as share of the largest."""
    return float((gusts.amplitude[:, 0] * np.cos(gusts.frequency * time + gusts.phase)).sum())


def turbulence_waves(speed: float, length: float, seed: int) -> PlaneWaves:
    """Waves of a turbulence whose velocity has the root mean square `speed` [m/s] and the largest eddies the size `length` [m].

    Amplitudes are at right angles to their wave vectors, so that the velocity has no divergence. With the wave number k they fall as
    k^(-1/3), and wave numbers are even over their logarithm: energy per octave falls as k^(-2/3), E(k) as k^(-5/3).
    """
    rng = np.random.default_rng([seed, 7])
    number = 2 * math.pi / length * 2.0 ** rng.uniform(0.0, OCTAVES, MODES)
    way = rng.normal(size=(MODES, 3))
    way /= np.linalg.norm(way, axis=1)[:, None]
    across = np.cross(way, rng.normal(size=(MODES, 3)))
    across /= np.linalg.norm(across, axis=1)[:, None]
    size = number ** (-1.0 / 3.0)
    size *= speed / math.sqrt(0.5 * float((size**2).sum()))
    # An eddy turns over in the time that its own octave's speed takes along it.
    own = speed * (number / number.min()) ** (-1.0 / 3.0)
    return PlaneWaves(way * number[:, None], across * size[:, None], own * number, rng.uniform(0, 2 * math.pi, MODES))


def turbulence(waves: PlaneWaves, points: F64, time: float) -> F64:
    """Velocity [m/s] at points [m], both of shape (n, 3), and a time [s]."""
    phase = points @ waves.vector.T - waves.frequency * time + waves.phase
    result: F64 = np.cos(phase) @ waves.amplitude
    return result


def _across(points: F64, center: F64, axis: F64) -> tuple[F64, F64]:
    """Unit axis (3,), and points relative to it without their part along it (n, 3)."""
    unit = axis / math.hypot(*axis)
    arm = points - center
    return unit, arm - (arm @ unit)[:, None] * unit


def vortex(points: F64, *, center: F64, axis: F64, speed: float, core: float, updraft: float = 0.0) -> F64:
    """Velocity [m/s] at points [m], both of shape (n, 3), of Scully's vortex.

    At the distance r from the axis it turns with V 2 r c / (r^2 + c^2), which is greatest at the core's edge r = c, and rises with
    W c^4 / (r^2 + c^2)^2, which falls off as the vorticity does.

    Args:
        points: [m], shape (n, 3).
        center: a point of the axis [m], shape (3,).
        axis: it turns about it by the right hand, shape (3,); its length does not matter.
        speed: V at the core's edge [m/s].
        core: c [m].
        updraft: W on the axis, along it [m/s].
    """
    unit, arm = _across(points, center, axis)
    square = (arm**2).sum(axis=1)
    share = 2.0 * core / (square + core**2)
    rise = updraft * (core**2 / (square + core**2)) ** 2
    result: F64 = speed * share[:, None] * np.cross(unit, arm) + rise[:, None] * unit
    return result


def attraction(
    points: F64, *, center: F64, acceleration: float, distance: float, exponent: float = 2.0, axis: F64 | None = None
) -> F64:
    """Acceleration [m/s^2] at points [m], both of shape (n, 3), towards a centre or towards an axis through it.

    It is g (d / r)^p at the distance r >= d, with p = 2 for Newton's law of gravitation, and g r / d nearer by, as inside an even ball.

    Args:
        points: [m], shape (n, 3).
        center: [m], shape (3,).
        acceleration: g at `distance` [m/s^2].
        distance: d [m].
        exponent: p.
        axis: direction of the line through the centre, shape (3,); None: towards the centre.
    """
    arm = center - points if axis is None else -_across(points, center, axis)[1]
    share = np.linalg.norm(arm, axis=1) / distance
    # arm / distance is the unit direction times `share`.
    scale = acceleration * np.maximum(share, 1.0) ** (-exponent - 1.0)
    result: F64 = scale[:, None] * arm / distance
    return result
