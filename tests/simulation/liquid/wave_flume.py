"""A flume two spacings wide with waves, and what its surface does, for tests of both engines."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from worldagent.physics.waves import Sea, wavelength
from worldagent.simulation.boundaries import BodyState
from worldagent.simulation.liquid.engine import Fluid, LiquidSetup, WaveZones
from worldagent.worlds.spec import WavesDriver
from worldagent.worlds.waves import sea_of

G = 9.81
FPS = 20


def flume(
    spacing: float, *, between: float, period: float, depth: float, height: float, width: int = 2, **changes: Any
) -> LiquidSetup:
    """Water at rest with a zone of one wavelength at either end and `between` wavelengths in the middle."""
    length = wavelength(period, depth, G)
    driver = WavesDriver(
        entity="water", height=height, period=period, level=depth, depth=depth, zone=length,
        **{"rise": period, **changes},
    )  # fmt: skip
    counts = [round((2 + between) * length / spacing), width, round(depth / spacing)]
    axes = [(np.arange(n) + 0.5) * spacing for n in counts]
    position = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    n = len(position)
    sides = ("-x", "+x", "-y", "+y")
    zones = WaveZones(
        "sea", sea_of(driver, G, spacing), length,
        tuple(s in driver.generate for s in sides), tuple(s in driver.absorb for s in sides),
    )  # fmt: skip
    upper = np.array([counts[0] * spacing, width * spacing, counts[2] * spacing + 2 * height + 3 * spacing])
    return LiquidSetup(
        spacing, np.zeros(3), upper, ("closed",) * 6, (Fluid("water", 1000.0, 1e-3),), np.array([0.0, 0.0, -G]), position,
        np.zeros((n, 3)), np.zeros(n, dtype=np.int32), np.full(n, spacing**3), waves=(zones,),
    )  # fmt: skip


def engine_of(kind: str, setup: LiquidSetup, **settings: Any) -> Any:
    """An engine by name."""
    if kind == "flip":
        from worldagent.simulation.liquid.flip.engine import Flip
        from worldagent.simulation.liquid.flip.settings import FlipSettings

        return Flip(setup, FlipSettings(**settings))
    from worldagent.simulation.liquid.dfsph import Dfsph, DfsphSettings

    return Dfsph(setup, DfsphSettings(**{"density_error": 5e-4, **settings}))


def nobody() -> BodyState:
    """No boundaries."""
    z = np.zeros
    return BodyState(z((0, 3)), z((0, 3, 3)), z((0, 3)), z((0, 3)), z((0, 3)), z(0), z((0, 3, 3)), z((0, 3)))


@dataclass
class Surface:
    """Elevation over time, from the volume of particles in columns."""

    x: Any
    """Middle of the columns (k,) [m]."""
    time: Any
    """(frames,) [s]"""
    eta: Any
    """(frames, k) [m]"""
    driven: Any
    """Momentum and energy that the zones gave, summed (frames, 4)."""
    energy: Any
    """Kinetic and potential of the water, against still water [J], (frames,)."""


def watch(engine: Any, seconds: float, sea: Sea) -> Surface:
    """Run an engine and keep the surface of every frame."""
    setup, bodies = engine.setup, nobody()
    edges = np.linspace(0.0, setup.upper[0], round(setup.upper[0] / (2 * setup.spacing)) + 1)
    area = setup.upper[1] * np.diff(edges)
    rest = 0.5 * 1000.0 * G * float(setup.volume.sum()) * sea.depth
    eta, total, energy = [], [np.zeros(4)], []
    for frame in range(1, round(seconds * FPS) + 1):
        given = np.zeros(4)
        while engine.time < frame / FPS - 1e-9:
            left = frame / FPS - engine.time
            given += engine.step(left / max(1, math.ceil(left / engine.stable_dt() - 1e-6)), bodies).driven
        p = engine.particles()
        eta.append(np.histogram(p.position[:, 0], edges, weights=p.volume)[0] / area - sea.depth)
        mass = 1000.0 * p.volume
        energy.append(float(mass @ (0.5 * (p.velocity**2).sum(axis=1) + G * p.position[:, 2])) - rest)
        total.append(total[-1] + given)
    time = np.arange(1, len(eta) + 1) / FPS
    return Surface(0.5 * (edges[1:] + edges[:-1]), time, np.array(eta), np.array(total[1:]), np.array(energy))


@dataclass
class Waves:
    """A wave one way and one the other way that together are what a stretch of surface does at one frequency."""

    forward: float
    """Amplitude [m]."""
    backward: float
    length: float
    """[m]"""


def fitted(surface: Surface, omega: float, number: float, between: tuple[float, float], last: float) -> Waves:
    """Least squares over the columns within `between` [m] and the `last` seconds; the wavenumber is found, too."""
    from scipy.optimize import minimize_scalar

    span, here = surface.time > surface.time[-1] - last, (surface.x > between[0]) & (surface.x < between[1])
    turn = np.exp(1j * omega * surface.time[span])
    c = 2.0 * (surface.eta[span][:, here] * turn[:, None]).mean(axis=0)
    x = surface.x[here]

    def basis(k: float) -> Any:
        return np.stack([np.exp(1j * k * x), np.exp(-1j * k * x)], axis=1)

    def rest(k: float) -> float:
        return float(np.abs(basis(k) @ np.linalg.lstsq(basis(k), c, rcond=None)[0] - c).sum())

    tries = number * np.linspace(0.75, 1.3, 56)
    start = tries[int(np.argmin([rest(k) for k in tries]))]
    k = float(minimize_scalar(rest, bounds=(0.97 * start, 1.03 * start), method="bounded").x)
    there, back = np.abs(np.linalg.lstsq(basis(k), c, rcond=None)[0])
    return Waves(float(there), float(back), 2 * math.pi / k)
