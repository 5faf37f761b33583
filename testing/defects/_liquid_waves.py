"""Seeded defects of declared waves: a sea of linear waves between its zones, and the same with other waves than declared."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np

from ...physics.waves import Sea, wavelength
from ...worlds.arrays import F64
from ...worlds.spec import WavesDriver
from ...worlds.waves import sea_of
from ..worlds.liquid_worlds import DENSITY, Flow, G, lattice, liquid_world, water
from .cases import World

__all__ = ["flat_waves", "slow_waves", "waving"]

SPACING, DEPTH, PERIOD, HEIGHT = 0.05, 0.3, 0.8, 0.03
"""[m] and [s]; low waves, so that linear theory keeps their volume and energy."""
BETWEEN = 0.6
"""[m] of sea between the zones."""
WIDTH = 4
"""Spacings across."""
FRAMES = 36


def waving(rng: np.random.Generator, *, gain: float = 1.0, stretch: float = 1.0, height: float = HEIGHT) -> Flow:
    """Waves from one zone to the other; every particle on its ellipse, and what zones gave in the books.

    Args:
        rng: gives the phase at frame 0.
        gain: height of the waves over the declared one.
        stretch: their period over the declared one.
        height: declared [m].
    """
    zone = math.ceil(wavelength(PERIOD, DEPTH, G) / SPACING) * SPACING
    size = (2.0 * zone + BETWEEN, WIDTH * SPACING, DEPTH)
    driver = WavesDriver(
        entity="pool", height=height, period=PERIOD, level=DEPTH, depth=DEPTH, zone=zone,
        start=-20.0 - float(rng.uniform(0.0, PERIOD)),
    )  # fmt: skip
    spec = liquid_world(
        {"pool": water(size, (0.5 * size[0], 0.5 * size[1], 0.5 * DEPTH), SPACING)}, spacing=SPACING, low=(0.0, 0.0, 0.0),
        high=(size[0], size[1], 2.0 * DEPTH), sides=("closed",) * 5 + ("open",), frames=FRAMES, drivers={"sea": driver},
    )  # fmt: skip
    sea = sea_of(driver, G)
    sea = dataclasses.replace(sea, amplitude=gain * sea.amplitude, omega=sea.omega / stretch)
    base = lattice((0.0, 0.0, 0.0), size, SPACING)
    times = np.arange(FRAMES) / spec.simulation.fps
    moved = [_moved(sea, base, zone, size[0], float(t)) for t in times]
    flow = Flow(spec, [m[0] for m in moved], [m[1] for m in moved], [np.arange(len(base))] * FRAMES, SPACING**3)
    flow.change |= _given(flow)
    return flow


def _moved(sea: Sea, base: F64, zone: float, length: float, time: float) -> tuple[F64, F64]:
    """Places and velocities at a time: s u and s w - s' psi, integrated; s rises over one zone and falls over the other."""
    a, omega, k = float(sea.amplitude[0]), float(sea.omega[0]), float(sea.number[0])
    x, z = base[:, 0], base[:, 2]
    q, p = np.clip(x / zone, 0.0, 1.0), np.clip((length - x) / zone, 0.0, 1.0)
    first, last = (v * v * (3.0 - 2.0 * v) for v in (q, p))
    s = first * last
    slope = (6.0 * q * (1.0 - q) * last - 6.0 * p * (1.0 - p) * first) / zone
    angle = k * x - omega * time + float(sea.phase[0])
    c, d = np.cosh(k * z) / math.sinh(k * sea.depth), np.sinh(k * z) / math.sinh(k * sea.depth)
    way = np.stack([-a * s * c * np.sin(angle), 0.0 * x, a * d * (s * np.cos(angle) + slope / k * np.sin(angle))], axis=1)
    speed = np.stack(
        [a * omega * s * c * np.cos(angle), 0.0 * x, a * omega * d * (s * np.sin(angle) - slope / k * np.cos(angle))], axis=1
    )
    return base + way, speed


def _given(flow: Flow) -> dict[tuple[int, str], F64]:
    """Records of the zones: all energy that came, and no momentum, since closed sides can give it."""
    mass = flow.volume * DENSITY
    energy = np.array([
        mass * float((0.5 * (v**2).sum(axis=1) + G * p[:, 2]).sum()) for p, v in zip(flow.position, flow.velocity, strict=True)
    ])  # fmt: skip
    found: dict[tuple[int, str], F64] = {}
    for k in range(flow.frames):
        found[k, "record/driver_work"] = np.array(energy[k] - energy[0])
        found |= {(k, f"record/driver_impulse_{a}"): np.array(0.0) for a in "xyz"}
    return found


def flat_waves(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Waves lack a share of their declared height."""
    return World(waving(rng, gain=1.0 - magnitude).candidate(folder), ("water", "pool"))


def slow_waves(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Waves have a period longer by a share than declared."""
    return World(waving(rng, stretch=1.0 + magnitude).candidate(folder), ("water", "pool"))
