"""Densities of substances, and properties of air.

References:
    Densities: CRC Handbook of Chemistry and Physics, sections 6 and 15, widened to the nearest round number.
    Air: U.S. Standard Atmosphere (1976), NOAA-S/T 76-1562: ideal gas of 28.9644 g/mol, viscosity by Sutherland's law.
"""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["AIR_DENSITY", "AIR_HEAT_CAPACITY", "AIR_VISCOSITY", "DENSITY_RANGES", "air_density"]

AIR_DENSITY = 1.204
"""[kg/m^3] at 20 degrees C and 101325 Pa."""
AIR_VISCOSITY = 1.81e-5
"""Dynamic [Pa s] at 20 degrees C."""
AIR_HEAT_CAPACITY = 1005.0
"""Of dry air at constant pressure [J/(kg K)]: 7/2 R / M of the standard's diatomic gas, rounded."""
SEA_LEVEL = 101325.0
"""Pressure [Pa]."""
GAS_CONSTANT = 8.31432
"""R of the standard [J/(mol K)]."""
AIR_MOLAR_MASS = 0.0289644
"""[kg/mol]"""
DENSITY_RANGES: Mapping[str, tuple[float, float]] = {
    "steel": (7700, 8100),
    "iron": (6800, 7900),
    "aluminium": (2600, 2850),
    "wood": (120, 1200),
    "stone": (1500, 3300),
    "concrete": (1200, 2600),
    "brick": (1000, 2400),
    "sand": (1300, 2750),
    "soil": (900, 2300),
    "glass": (2200, 3200),
    "plastic": (850, 1600),
    "rubber": (850, 1600),
    "ceramic": (1800, 4000),
    "ice": (880, 930),
    "paper": (250, 1200),
    "foam": (10, 400),
    "fabric": (50, 1600),
    "gel": (900, 1300),
    "water": (950, 1250),
    "oil": (700, 1000),
    "lava": (2000, 3000),
    "other": (0.5, 23000),
}
"""Least and largest density [kg/m^3], in bulk (sand: from the heap to the grain; fabric: from fleece to fibre)."""


def air_density(temperature: float) -> float:
    """Density of dry air at sea level [kg/m^3]: p M / (R T), temperature in K."""
    return SEA_LEVEL * AIR_MOLAR_MASS / (GAS_CONSTANT * temperature)
