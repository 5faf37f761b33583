"""Waves on water by linear (Airy) theory over a flat bed, and the spectra of wind seas.

References:
    Dispersion, group speed: R. G. Dean and R. A. Dalrymple, Water Wave Mechanics for Engineers and Scientists (1991), chapters 3 and 4,
    doi:10.1142/1232; first guess: C. Eckart (1952). Breaking: R. Miche, Annales des Ponts et Chaussees (1944).
    Spectra: W. J. Pierson and L. Moskowitz (1964), doi:10.1029/JZ069i024p05181; K. Hasselmann et al. (1973), Joint North Sea Wave
    Project (JONSWAP), Deutsche Hydrographische Zeitschrift, Reihe A 12.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .arrays import F64
from .flows import smooth_step

__all__ = ["Sea", "breaking_steepness", "group_speed", "spectral_density", "wavelength", "wavenumber"]

MICHE = 0.142
"""Steepness at which waves on deep water break."""


def wavenumber(omega: F64 | float, depth: float, gravity: float) -> F64:
    """Solution k [1/m] of omega^2 = g k tanh(k d), shape of `omega`; omega [rad/s], depth d [m], gravity g [m/s^2]."""
    deep = np.asarray(omega, dtype=np.float64) ** 2 / gravity
    k = deep / np.sqrt(np.tanh(np.maximum(deep * depth, 1e-12)))  # Eckart: within 5 %
    for _ in range(12):
        t = np.tanh(k * depth)
        k = k - (k * t - deep) / (t + k * depth * (1.0 - t * t))
    return np.asarray(k)


def wavelength(period: float, depth: float, gravity: float) -> float:
    """Length [m] of waves of a period [s] on water of a depth [m]; gravity [m/s^2]."""
    return 2.0 * math.pi / float(wavenumber(2.0 * math.pi / period, depth, gravity))


def group_speed(period: float, depth: float, gravity: float) -> float:
    """Speed of a group of waves, and of their energy [m/s]: omega / 2k (1 + 2kd / sinh 2kd); period [s], depth d [m], gravity [m/s^2]."""
    omega = 2.0 * math.pi / period
    k = float(wavenumber(omega, depth, gravity))
    twice = 2.0 * k * depth
    return 0.5 * omega / k * (1.0 + (twice / math.sinh(twice) if twice < 500.0 else 0.0))


def breaking_steepness(period: float, depth: float, gravity: float) -> float:
    """Height over length at which waves break, 0.142 tanh(kd) by Miche; period [s], depth d [m], gravity [m/s^2]."""
    return MICHE * math.tanh(2.0 * math.pi * depth / wavelength(period, depth, gravity))


def spectral_density(omega: F64, period: float, peakedness: float = 1.0) -> F64:
    """Variance of elevation per frequency up to a factor, shape of `omega`: x^-5 exp(-5/4 x^-4) G, with x = omega period / 2 pi.

    Args:
        omega: [rad/s].
        period: of the peak [s].
        peakedness: gamma of JONSWAP, G = gamma^exp(-(x - 1)^2 / 2 s^2), s = 0.07 up to the peak and 0.09 beyond. 1: the spectrum of
            Pierson and Moskowitz.
    """
    ratio = omega * period / (2.0 * math.pi)
    width = np.where(ratio <= 1.0, 0.07, 0.09)
    shape = ratio**-5.0 * np.exp(-1.25 * ratio**-4.0)
    return np.asarray(shape * peakedness ** np.exp(-((ratio - 1.0) ** 2) / (2.0 * width**2)))


@dataclass(frozen=True)
class Sea:
    """Sum of c long-crested waves: elevation = sum of amplitude cos(k . x - omega t + phase)."""

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
        return smooth_step(share)

    def angle(self, points: F64, time: F64 | float) -> F64:
        """k . x - omega t + phase of each component, shape (n, c), at points (n, 2) [m] and time [s], one or (n,)."""
        way = np.asarray(points, dtype=np.float64)[:, :2] @ (self.number[:, None] * self.direction).T
        return np.asarray(way - np.atleast_1d(time)[:, None] * self.omega + self.phase)

    def elevation(self, points: F64, time: F64 | float, *, quadrature: bool = False) -> F64:
        """Height above still water (n,) [m]; with `quadrature`, a quarter of a period later of every wave."""
        angle = self.angle(points, time) - (0.5 * math.pi if quadrature else 0.0)
        return np.asarray(np.cos(angle) @ self.amplitude * self.strength(time))

    @property
    def variance(self) -> float:
        """Variance of elevation [m^2]."""
        return 0.5 * float(self.amplitude @ self.amplitude)
