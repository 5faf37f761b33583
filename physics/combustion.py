"""Burning of gaseous fuels in air: one step from fuel and air to products.

References:
    A. Tewarson, Generation of Heat and Chemical Compounds in Fires, SFPE Handbook of Fire Protection Engineering, 3rd ed. (2002),
    table 3-4.16: net heats of complete combustion, shares of the heat released that are radiated, yields of soot (well ventilated).
    NFPA 325 (1994): autoignition temperatures. Wood: V. Babrauskas, Ignition of Wood, Interflam 2001, pilot and gases of its surface.
    M. G. Zabetakis, Flammability Characteristics of Combustible Gases and Vapors, Bureau of Mines Bulletin 627 (1965), table of
    limiting oxygen in nitrogen; of wood's gases: own choice.
    C. Huggett, Fire and Materials 4 (1980) 61, doi:10.1002/fam.810040202: 13.1 MJ per kg of oxygen, within 5 % for most fuels.
    FDS: K. McGrattan et al., Fire Dynamics Simulator Technical Reference Guide, NIST SP 1018-1, chapter Combustion: lumped species,
    eddy dissipation, times of mixing, bound of the heat per volume, extinction by the heat of a stoichiometric pocket.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .arrays import F64
from .substances import AIR_HEAT_CAPACITY, air_density

__all__ = [
    "FUELS",
    "HEAT_RATIO",
    "OXYGEN_SHARE",
    "SOOT_ABSORPTION",
    "SOOT_SOLID",
    "Fuel",
    "greatest_power",
    "longest_burning",
    "soot_power",
]

OXYGEN_SHARE = 0.2314
"""Mass of oxygen in a mass of dry air."""
SOOT_ABSORPTION = 1500.0
"""Absorption coefficient of soot per share of volume and temperature [1/(m K)]: 1200 to 1800 for soot of most fuels (de Ris 1979)."""
SOOT_SOLID = 1800.0
"""Density of soot itself [kg/m^3]."""
STEFAN_BOLTZMANN = 5.670374419e-8
"""[W/(m^2 K^4)] (CODATA 2018)."""
OXYGEN_PARTS = 0.2095
"""Moles of oxygen in a mole of dry air."""
HEAT_RATIO = 1.4
"""Ratio of the heat capacities of air."""
CARBON, HYDROGEN, OXYGEN = 12.011, 1.008, 15.999
"""Atomic masses [g/mol]."""


@dataclass(frozen=True)
class Fuel:
    """A fuel CxHyOz as a gas."""

    name: str
    atoms: tuple[float, float, float]
    """Carbon, hydrogen, oxygen."""
    heat: float
    """Net heat of combustion [J/kg]."""
    radiant: float
    """Share of it that is radiated where it burns."""
    soot: float
    """Mass of soot per mass of fuel."""
    ignition: float
    """Temperature from which on it burns by itself [K]."""
    least_oxygen: float
    """Share of oxygen, by volume, below which air at 20 degrees C does not let it burn."""

    @property
    def oxygen(self) -> float:
        """Mass of oxygen that burns a mass of fuel."""
        c, h, o = self.atoms
        return (c + 0.25 * h - 0.5 * o) * 2.0 * OXYGEN / (c * CARBON + h * HYDROGEN + o * OXYGEN)

    @property
    def air(self) -> float:
        """Mass of air that burns a mass of fuel."""
        return self.oxygen / OXYGEN_SHARE

    @property
    def least_heat(self) -> float:
        """Heat of a kg of the weakest mixture that burns at 20 degrees C [J/kg]: fuel with just the air that it takes, diluted with what
        does not burn until the oxygen in that air falls to its limit."""
        share = self.least_oxygen / OXYGEN_PARTS / self.air
        return self.heat * share / (1.0 + share)


FUELS: Mapping[str, Fuel] = {
    fuel.name: fuel
    for fuel in (
        Fuel("methane", (1.0, 4.0, 0.0), 50.0e6, 0.14, 0.0, 810.0, 0.12),
        Fuel("propane", (3.0, 8.0, 0.0), 46.0e6, 0.29, 0.024, 723.0, 0.115),
        Fuel("methanol", (1.0, 4.0, 1.0), 20.0e6, 0.16, 0.0, 737.0, 0.10),
        Fuel("heptane", (7.0, 16.0, 0.0), 44.6e6, 0.33, 0.037, 477.0, 0.115),
        Fuel("wood", (1.0, 1.7, 0.72), 17.1e6, 0.37, 0.015, 623.0, 0.13),
    )
}
"""By name. Wood is red oak; its gas is taken to burn fully, with the net heat of complete combustion."""


def greatest_power(cell: float) -> float:
    """Most heat per volume that a cell of a size [m] releases [W/m^3]: 200 kW/m^2 of flame sheet, and 2500 kW/m^3 (FDS)."""
    return 2.0e5 / cell + 2.5e6


BURNING_SHARE = 0.5
"""Own choice: most volume that burning makes per volume in a step."""


def longest_burning(cell: float, ambient: float) -> float:
    """Longest step [s] in which no cell of a size [m] in air of a temperature [K] makes more than a share of its volume by burning."""
    return BURNING_SHARE * air_density(ambient) * AIR_HEAT_CAPACITY * ambient / greatest_power(cell)


def soot_power(soot: F64, temperature: F64) -> F64:
    """Power that thin soot [kg/m^3] of a temperature [K] radiates per volume [W/m^3]: 4 kappa sigma T^4."""
    kappa = SOOT_ABSORPTION / SOOT_SOLID * soot * temperature
    return np.asarray(4.0 * kappa * STEFAN_BOLTZMANN * temperature**4)
