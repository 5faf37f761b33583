"""Boiling of water at a hot surface, at one atmosphere: heat flux by how much hotter than boiling the surface is, and what a kg of steam takes.

References:
    F. P. Incropera, D. P. DeWitt, T. L. Bergman, A. S. Lavine, Fundamentals of Heat and Mass Transfer, 6th ed. (2007), chapter 10: boiling
    curve of water (figure 10.4), equations 10.5 (Rohsenow), 10.6 and 10.7 (Zuber), 10.8 to 10.10 (Bromley); table A.4, steam; table A.6.
    P. J. Berenson, Film-Boiling Heat Transfer From a Horizontal Surface, Journal of Heat Transfer 83 (1961) 351, doi:10.1115/1.3682280.
    L. A. Bromley, Heat Transfer in Stable Film Boiling, Chemical Engineering Progress 46 (1950) 221: radiation beside conduction.
"""

from __future__ import annotations

import math

import numpy as np

__all__ = [
    "BOILING",
    "STEAM_DENSITY",
    "boiling_flux",
    "film_conductance",
    "greatest_flux",
    "least_film_flux",
    "nucleate_flux",
    "steam_heat",
    "with_radiation",
]

BOILING = 373.15
"""[K] Boiling point of water at one atmosphere."""
LATENT = 2.257e6
"""[J/kg] Heat of vaporisation there."""
STEAM_DENSITY = 0.5956
"""[kg/m^3] Of saturated steam there."""
WATER_DENSITY = 957.9
"""[kg/m^3] Of saturated water there."""
WATER_HEAT_CAPACITY = 4217.0
"""[J/(kg K)] Of saturated water there."""
COLD_HEAT_CAPACITY = 4190.0
"""[J/(kg K)] Of water between 273 and 373 K, mean."""
WATER_VISCOSITY = 279e-6
"""[Pa s] Of saturated water there."""
WATER_PRANDTL = 1.76
"""Prandtl number of saturated water there."""
TENSION = 0.0589
"""[N/m] Of water against steam there."""
GRAVITY = 9.8
"""[m/s^2]"""
SURFACE = 0.0128
"""Rohsenow's factor of water and scored or polished metal; others differ up to twice, and the flux eightfold."""
STEFAN_BOLTZMANN = 5.670374419e-8
"""[W/(m^2 K^4)] (CODATA 2018)."""
EMISSIVITY = 0.9
"""Own choice: of lava and of metal with scale; water takes up all of it."""
CRITICAL, LEIDENFROST = 30.0, 120.0
"""[K] Excess temperatures of the greatest flux, and from which on a film of steam keeps the water off (figure 10.4)."""
BERENSON, BERENSON_SENSIBLE = 0.425, 0.5
BROMLEY_CYLINDER, BROMLEY_SENSIBLE = 0.62, 0.8
"""Factors of the film's conductance and of the heat that its steam takes up beyond evaporation."""
WAVE = math.sqrt(TENSION / (GRAVITY * (WATER_DENSITY - STEAM_DENSITY)))
"""[m] Length of the waves of a film over a flat surface, which stands for its size (Berenson)."""
STEAM = np.array(
    [
        (380.0, 0.5863, 2060.0, 12.71e-6, 24.6e-3),
        (400.0, 0.5542, 2014.0, 13.44e-6, 26.1e-3),
        (450.0, 0.4902, 1980.0, 15.25e-6, 29.9e-3),
        (500.0, 0.4405, 1985.0, 17.04e-6, 33.9e-3),
        (550.0, 0.4005, 1997.0, 18.84e-6, 37.9e-3),
        (600.0, 0.3652, 2026.0, 20.67e-6, 42.2e-3),
        (650.0, 0.3380, 2056.0, 22.47e-6, 46.4e-3),
        (700.0, 0.3140, 2085.0, 24.26e-6, 50.5e-3),
        (750.0, 0.2931, 2119.0, 26.04e-6, 54.9e-3),
        (800.0, 0.2739, 2152.0, 27.86e-6, 59.2e-3),
        (850.0, 0.2579, 2186.0, 29.69e-6, 63.7e-3),
    ]
)
"""Temperature [K], density [kg/m^3], heat capacity [J/(kg K)], viscosity [Pa s] and conductivity [W/(m K)] of steam (table A.4)."""


def _steam(temperature: float) -> tuple[float, float, float, float]:
    """Density, heat capacity, viscosity and conductivity of steam; beyond the table's end they go on as between its last two rows, the density as an ideal gas."""
    known = STEAM[:, 0]
    if temperature <= known[-1]:
        density, capacity, viscosity, conductivity = (float(np.interp(temperature, known, STEAM[:, k])) for k in range(1, 5))
        return density, capacity, viscosity, conductivity
    ahead = (temperature - known[-1]) / (known[-1] - known[-2])
    capacity, viscosity, conductivity = (float(v) for v in STEAM[-1, 2:] + ahead * (STEAM[-1, 2:] - STEAM[-2, 2:]))
    return float(STEAM[-1, 1] * known[-1] / temperature), capacity, viscosity, conductivity


def film_conductance(excess: float, length: float, factor: float, sensible: float) -> float:
    """Heat that goes through a film of steam by conduction, per area and excess temperature [W/(m^2 K)].

    factor (k^3 rho (rho_water - rho) g (latent + sensible c excess) / (viscosity excess length))^(1/4), of steam at the film's mean temperature.

    Args:
        excess: of the surface over the boiling point [K].
        length: that stands for its size [m]: a diameter, or `WAVE` of a flat one.
        factor: of its shape.
        sensible: share of the heat of the film's own warmth that counts.
    """
    density, capacity, viscosity, conductivity = _steam(BOILING + 0.5 * excess)
    heat = LATENT + sensible * capacity * excess
    lift = conductivity**3 * density * (WATER_DENSITY - density) * GRAVITY * heat
    return float(factor * (lift / (viscosity * length * excess)) ** 0.25)


def with_radiation(conductance: float, excess: float, emissivity: float) -> float:
    """Conductance of a film with what the surface radiates through it [W/(m^2 K)]: h^(4/3) = conductance^(4/3) + radiated h^(1/3) (Bromley)."""
    radiated = emissivity * STEFAN_BOLTZMANN * ((BOILING + excess) ** 4 - BOILING**4) / excess
    found = conductance + 0.75 * radiated
    for _ in range(50):
        found = (conductance ** (4.0 / 3.0) + radiated * found ** (1.0 / 3.0)) ** 0.75
    return found


def nucleate_flux(excess: float) -> float:
    """Heat flux into bubbles at a wet surface [W/m^2] (Rohsenow)."""
    lift = math.sqrt(GRAVITY * (WATER_DENSITY - STEAM_DENSITY) / TENSION)
    return WATER_VISCOSITY * LATENT * lift * (WATER_HEAT_CAPACITY * excess / (SURFACE * LATENT * WATER_PRANDTL)) ** 3


def greatest_flux() -> float:
    """Greatest heat flux of a wet surface [W/m^2] (Zuber)."""
    lift = TENSION * GRAVITY * (WATER_DENSITY - STEAM_DENSITY) / STEAM_DENSITY**2
    return float(0.149 * LATENT * STEAM_DENSITY * lift**0.25)


def least_film_flux() -> float:
    """Least heat flux that keeps a film of steam [W/m^2] (Zuber)."""
    lift = GRAVITY * TENSION * (WATER_DENSITY - STEAM_DENSITY) / (WATER_DENSITY + STEAM_DENSITY) ** 2
    return float(0.09 * STEAM_DENSITY * LATENT * lift**0.25)


def _film_flux(excess: float) -> float:
    conductance = film_conductance(excess, WAVE, BERENSON, BERENSON_SENSIBLE)
    return with_radiation(conductance, excess, EMISSIVITY) * excess


def boiling_flux(excess: float) -> float:
    """Heat flux from a surface into water that boils at it [W/m^2]: bubbles, the greatest flux, between it and a film evenly in logarithms, a film.

    Args:
        excess: of the surface over the boiling point [K]; none boils at or below it.
    """
    if excess <= 0.0:
        return 0.0
    if excess <= CRITICAL:
        return min(nucleate_flux(excess), greatest_flux())
    if excess >= LEIDENFROST:
        return _film_flux(excess)
    share = math.log(excess / CRITICAL) / math.log(LEIDENFROST / CRITICAL)
    return float(greatest_flux() ** (1.0 - share) * _film_flux(LEIDENFROST) ** share)


def steam_heat(water: float) -> float:
    """Heat that a kg of water of a temperature [K] takes up until it is steam [J/kg]."""
    return LATENT + COLD_HEAT_CAPACITY * max(0.0, BOILING - water)
