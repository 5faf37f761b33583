"""Numbers of the gas engine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from ...physics.combustion import Fuel

__all__ = ["GasSettings", "Side"]

Side = Literal["open", "closed", "periodic"]


@dataclass(frozen=True)
class GasSettings:
    """Material of a gas, and numbers of its solver; SI units."""

    scheme: Literal["maccormack", "reflection"] = "reflection"
    """Scheme that carries velocities. Reflection (Zehnder, Narain and Thomaszewski 2018, doi:10.1145/3197517.3201324) makes two half steps with two
    solves and keeps eddies alive; MacCormack alone takes half the time."""
    expands: bool = True
    """True: light gas is accelerated as its density asks, and heat makes volume. False: Boussinesq's approximation."""
    viscosity: float = 0.0
    """Kinematic [m^2/s]; 0 leaves what the scheme has."""
    diffusivity: float = 0.0
    """Thermal [m^2/s]."""
    confinement: float = 0.0
    """Strength of vorticity confinement [1]; it puts energy in."""
    courant: float = 2.0
    """Most cells that the fastest gas passes in a step; own choice."""
    tolerance: float = 1e-5
    """Largest divergence after the projection, as a share of the largest speed per cell."""
    iterations: int = 60
    ambient_temperature: float = 293.15
    """Temperature of the air around, where lightness is 0 [K]."""
    fuel: Fuel | None = None
    """Fuel that the gas may burn; the gas then expands."""
