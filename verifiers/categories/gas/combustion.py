"""A fuel in air: the amounts that burning leaves as they are, and the bounds of its flames (R100).

References:
    K. McGrattan et al., Fire Dynamics Simulator Technical Reference Guide, NIST SP 1018-1, chapter Combustion: one step from fuel and air
    to products. What of a gas was fuel once is the mixture fraction, which burning leaves as it is (R. W. Bilger, Combustion Science and
    Technology 13 (1976) 155).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ....physics.substances import AIR_HEAT_CAPACITY
from ....worlds.arrays import F64

if TYPE_CHECKING:
    from ....physics.combustion import Fuel
    from .cells import FireCells

__all__ = ["Combustion"]


@dataclass(frozen=True)
class Combustion:
    """A fuel in air."""

    fuel: Fuel
    share: float
    """Mass of the fuel in a mass of the gas at its source."""
    temperature: float
    """Temperature of the gas at its source [K]."""
    ambient: float
    """Temperature of the air around [K]."""
    air: float
    """Density of that air [kg/m^3]."""

    @property
    def product(self) -> float:
        """Mass of products per mass of fuel, soot left out."""
        return 1.0 + self.fuel.air - self.fuel.soot

    @property
    def hottest(self) -> float:
        """Temperature of fuel that burns in just its air and keeps what is not radiated at once [K]; no flame is hotter."""
        warm = max(self.temperature, self.ambient)
        return warm + (1.0 - self.fuel.radiant) * self.fuel.heat / ((1.0 + self.fuel.air) * AIR_HEAT_CAPACITY)

    @property
    def sootiest(self) -> float:
        """Soot that burning leaves where all is burnt in just its air and has cooled to the ambient temperature [kg/m^3]."""
        return self.fuel.soot / (1.0 + self.fuel.air) * self.air

    @property
    def soot_heat(self) -> float:
        """Heat that a kg of soot takes out of the gas which it was, above nothing at all [J/kg]: gas that became soot is gas no more."""
        return AIR_HEAT_CAPACITY * self.ambient

    def atoms(self, cells: FireCells) -> F64:
        """Fuel, burnt or not [kg/m^3]."""
        return np.asarray(cells.fuel.astype(np.float64) + cells.product.astype(np.float64) / self.product)
