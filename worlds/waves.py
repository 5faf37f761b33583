"""Declared seas: the waves of a `waves` driver, by linear theory (`physics.waves`).

What a driver declares is worked out here once, so that engines, verifiers and pictures speak of the same sea. Nothing is simulated
here.

References:
    Jacobsen, Fuhrman and Fredsoe (2012), doi:10.1002/fld.2726, and Peric and Abdel-Maksoud (2016),
    doi:10.1080/09377255.2015.1119921, for zones that generate and absorb.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..physics.waves import Sea, group_speed, spectral_density, wavenumber
from .arrays import F64

if TYPE_CHECKING:
    from .spec import WavesDriver, WorldSpec

__all__ = ["developed", "heading", "inward", "sea_of", "waves_of"]

BANDS = (0.55, 2.4)
"""Frequencies of components, in peak frequencies: 97 % of the energy of a Pierson-Moskowitz spectrum, 98 % of JONSWAP 3.3."""
FINEST = 6.0
"""Spacings of the shortest wave of a spectrum: shorter ones are not declared to an engine, their energy goes to the others."""
RISE_PERIODS = 2.0
"""Periods over which a sea rises unless it declares a time."""


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
        power = spectral_density(omega, driver.period, driver.peakedness if driver.spectrum == "jonswap" else 1.0)
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
    return driver.start + _rise(driver) + driver.zone / group_speed(driver.period, driver.depth, gravity)


def _rise(driver: WavesDriver) -> float:
    return driver.rise if driver.rise is not None else RISE_PERIODS * driver.period


def waves_of(spec: WorldSpec, name: str) -> dict[str, WavesDriver]:
    """Waves in the liquids of an instance, by driver id."""
    members = spec.simulation.liquid[name].members
    return {k: d for k, d in spec.simulation.drivers.items() if d.kind == "waves" and d.entity in members}
