"""Declared seas: spectra, their components, and the motion that linear theory gives them (Airy waves over a flat bed).

What a `waves` driver declares is worked out here once, so that engines, verifiers and pictures speak of the same sea. Nothing is
simulated here.

References:
    Hasselmann et al. (1973), Joint North Sea Wave Project (JONSWAP); Pierson and Moskowitz (1964), doi:10.1029/JZ069i024p05181;
    Miche (1944) for the steepness at which waves break; Jacobsen, Fuhrman and Fredsoe (2012), doi:10.1002/fld.2726, and
    Peric and Abdel-Maksoud (2016), doi:10.1080/09377255.2015.1119921, for zones that generate and absorb.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .arrays import F64

if TYPE_CHECKING:
    from .spec import WavesDriver, WorldSpec

__all__ = [
    "Sea",
    "developed",
    "heading",
    "inward",
    "sea_of",
    "spectral_density",
    "steepest",
    "wavelength",
    "wavenumber",
    "waves_of",
]

BANDS = (0.55, 2.4)
"""Frequencies of components, in peak frequencies: 97 % of the energy of a Pierson-Moskowitz spectrum, 98 % of JONSWAP 3.3."""
FINEST = 6.0
"""Spacings of the shortest wave of a spectrum: shorter ones are not declared to an engine, their energy goes to the others."""
MICHE = 0.142
RISE_PERIODS = 2.0


def wavenumber(omega: F64 | float, depth: float, gravity: float) -> F64:
    """Solve omega^2 = g k tanh(k depth) for k [1/m]; omega [rad/s], depth [m], g [m/s^2]."""
    deep = np.asarray(omega, dtype=np.float64) ** 2 / gravity
    k = deep / np.sqrt(np.tanh(np.maximum(deep * depth, 1e-12)))  # Eckart: within 5 %
    for _ in range(12):
        t = np.tanh(k * depth)
        k = k - (k * t - deep) / (t + k * depth * (1.0 - t * t))
    return np.asarray(k)


def wavelength(period: float, depth: float, gravity: float) -> float:
    """Of linear waves [m]."""
    return 2.0 * math.pi / float(wavenumber(2.0 * math.pi / period, depth, gravity))


def steepest(period: float, depth: float, gravity: float) -> float:
    """Height over length at which waves of this period break (Miche)."""
    return MICHE * math.tanh(2.0 * math.pi * depth / wavelength(period, depth, gravity))


def spectral_density(omega: F64, driver: WavesDriver) -> F64:
    """Variance of elevation per frequency, up to a factor: the shape of a driver's spectrum at omega [rad/s]."""
    ratio = omega * driver.period / (2.0 * math.pi)
    shape = ratio**-5.0 * np.exp(-1.25 * ratio**-4.0)
    if driver.spectrum == "jonswap":
        width = np.where(ratio <= 1.0, 0.07, 0.09)
        shape = shape * driver.peakedness ** np.exp(-((ratio - 1.0) ** 2) / (2.0 * width**2))
    return np.asarray(shape)


@dataclass(frozen=True)
class Sea:
    """Waves that together are a declared sea; elevation = sum of amplitude cos(k . x - omega t + phase)."""

    amplitude: F64
    """(c,) [m]"""
    omega: F64
    """(c,) [rad/s]"""
    number: F64
    """(c,) wavenumber [1/m]"""
    direction: F64
    """(c, 2) unit vectors of travel"""
    phase: F64
    """(c,) [rad]"""
    level: float
    """Still water, world z [m]."""
    depth: float
    """[m]"""
    gravity: float
    """[m/s^2]"""
    start: float
    """[s], from frame 0 on."""
    rise: float
    """[s]"""

    def strength(self, time: F64 | float) -> F64:
        """Share of the full height at a time [s]: a smooth rise."""
        share = np.clip((np.asarray(time, dtype=np.float64) - self.start) / self.rise, 0.0, 1.0)
        return np.asarray(share * share * (3.0 - 2.0 * share))

    def angle(self, points: F64, time: F64 | float) -> F64:
        """k . x - omega t + phase of each component, shape (n, c), at points (n, 2) [m] and time [s], one or (n,)."""
        way = np.asarray(points, dtype=np.float64)[:, :2] @ (self.number[:, None] * self.direction).T
        return np.asarray(way - np.atleast_1d(time)[:, None] * self.omega + self.phase)

    def elevation(self, points: F64, time: F64 | float, *, quadrature: bool = False) -> F64:
        """Above still water (n,) [m]; with `quadrature`, a quarter of a period later of every wave."""
        angle = self.angle(points, time) - (0.5 * math.pi if quadrature else 0.0)
        return np.asarray(np.cos(angle) @ self.amplitude * self.strength(time))

    @property
    def variance(self) -> float:
        """Of elevation [m^2]."""
        return 0.5 * float(self.amplitude @ self.amplitude)


def sea_of(driver: WavesDriver, gravity: float, spacing: float = 0.0) -> Sea:
    """The components of a driver's spectrum; equal declarations give equal bytes.

    Args:
        driver: the declaration.
        gravity: strength [m/s^2].
        spacing: of the engine [m]; waves shorter than `FINEST` spacings are left out.

    Each component has an equal band of frequency and lies at a random place in it, so that the sea does not repeat itself early.
    """
    peak = 2.0 * math.pi / driver.period
    rise = _rise(driver)
    random = np.random.default_rng([driver.seed, 0x5EA])
    if driver.spectrum == "regular":
        omega, amplitude = np.array([peak]), np.array([0.5 * driver.height])
        phase = np.zeros(1)
    else:
        top = BANDS[1] * peak
        if spacing > 0.0:
            short = 2.0 * math.pi / (FINEST * spacing)
            top = min(top, max(1.2 * peak, math.sqrt(gravity * short * math.tanh(short * driver.depth))))
        edges = np.linspace(BANDS[0] * peak, top, driver.components + 1)
        omega = edges[:-1] + random.random(driver.components) * np.diff(edges)
        power = spectral_density(omega, driver)
        amplitude = np.sqrt(power / power.sum() * driver.height**2 / 8.0)
        phase = random.uniform(0.0, 2.0 * math.pi, driver.components)
    spread = driver.spreading * random.standard_normal(len(omega)).clip(-2.0, 2.0) if driver.spreading > 0.0 else 0.0
    heading = np.radians(driver.direction + spread + np.zeros(len(omega)))
    return Sea(
        amplitude, omega, wavenumber(omega, driver.depth, gravity), np.column_stack([np.cos(heading), np.sin(heading)]), phase,
        driver.level, driver.depth, gravity, driver.start, rise,
    )  # fmt: skip


def heading(driver: WavesDriver) -> F64:
    """Unit vector of the main direction of travel (2,)."""
    angle = math.radians(driver.direction)
    return np.array([math.cos(angle), math.sin(angle)])


def inward(side: str) -> F64:
    """Unit vector into the domain from one of its sides -x, +x, -y, +y, (2,)."""
    sign = 1.0 if side[0] == "-" else -1.0
    return np.array([sign, 0.0] if side[1] == "x" else [0.0, sign])


def developed(driver: WavesDriver, gravity: float) -> float:
    """When waves of full height have crossed the zone that makes them [s]: group speed of the peak."""
    omega = 2.0 * math.pi / driver.period
    k = float(wavenumber(omega, driver.depth, gravity))
    depth = 2.0 * k * driver.depth
    group = 0.5 * omega / k * (1.0 + (depth / math.sinh(depth) if depth < 500.0 else 0.0))
    return driver.start + _rise(driver) + driver.zone / group


def _rise(driver: WavesDriver) -> float:
    return driver.rise if driver.rise is not None else RISE_PERIODS * driver.period


def waves_of(spec: WorldSpec, name: str) -> dict[str, WavesDriver]:
    """Waves in the liquids of an instance, by driver id."""
    members = spec.simulation.liquid[name].members
    return {k: d for k, d in spec.simulation.drivers.items() if d.kind == "waves" and d.entity in members}
