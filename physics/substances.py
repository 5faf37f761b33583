"""Properties of air.

References:
    U.S. Standard Atmosphere (1976), NOAA-S/T 76-1562: ideal gas of 28.9644 g/mol, viscosity by Sutherland's law.
"""

from __future__ import annotations

import numpy as np

from .arrays import F64

__all__ = ["AIR_DENSITY", "AIR_HEAT_CAPACITY", "AIR_VISCOSITY", "air_density", "air_viscosity"]

AIR_DENSITY = 1.204
"""[kg/m^3] at 20 degrees C and 101325 Pa."""
AIR_VISCOSITY = 1.81e-5
"""Dynamic [Pa s] at 20 degrees C."""
AIR_HEAT_CAPACITY = 1005.0
"""Specific heat of dry air at constant pressure [J/(kg K)]: 7/2 R / M of the standard's diatomic gas, rounded."""
SEA_LEVEL = 101325.0
"""Pressure [Pa]."""
GAS_CONSTANT = 8.31432
"""R of the standard [J/(mol K)]."""
AIR_MOLAR_MASS = 0.0289644
"""[kg/mol]"""
SUTHERLAND = 1.458e-6, 110.4
"""Constants beta [kg/(s m K^0.5)] and S [K] of the standard's viscosity."""


def air_density(temperature: float) -> float:
    """Density of dry air at sea level [kg/m^3]: p M / (R T), temperature in K."""
    return SEA_LEVEL * AIR_MOLAR_MASS / (GAS_CONSTANT * temperature)


def air_viscosity(temperature: F64) -> F64:
    """Dynamic viscosity of air [Pa s], shape of `temperature` [K]: beta T^1.5 / (T + S) (Sutherland)."""
    beta, constant = SUTHERLAND
    return np.asarray(beta * np.asarray(temperature) ** 1.5 / (temperature + constant))
