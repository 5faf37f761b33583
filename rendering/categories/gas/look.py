"""Light in a gas: the extinction of a ray, and the share of it that is scattered.

References:
    Single-scattering albedo of soot: T. C. Bond, R. W. Bergstrom, Aerosol Science and Technology 40 (2006) 27, doi:10.1080/02786820500421521.
    Albedo of a cloud that looks like a colour: C. Kulla, A. Conty, Revisiting Physically Based Shading at Imageworks, SIGGRAPH course (2017).
    Phase function: L. G. Henyey, J. L. Greenstein, Astrophysical Journal 93 (1941) 70, doi:10.1086/144246.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ....physics.gases import mass_extinction
from ....worlds.arrays import F64
from ....worlds.spec import Appearance, Material

__all__ = ["ASYMMETRY", "GasLook", "look_of"]

ASYMMETRY = 0.6
"""[1] Mean cosine of scattering by clusters of soot; own choice for drops too, which throw light even more straight on."""
SOOT_ALBEDO = 0.25
"""[1] Share of the light that soot takes which it scatters."""
MOST_ALBEDO = 0.999
"""[1] Own choice: drops absorb next to nothing."""


class GasLook(NamedTuple):
    """Extinction and albedo of a gas."""

    extinction: float
    """Per mass of what it carries [m^2/kg]."""
    albedo: F64
    """Share of it that is scattered, per colour, shape (3,)."""

    @property
    def shading(self) -> F64:
        """Share of the extinction that shades what lies behind, shape (3,): scattered light goes on ahead by half of 1 + the asymmetry."""
        return 1.0 - self.albedo * 0.5 * (1.0 + ASYMMETRY)


def look_of(material: Material) -> GasLook:
    """The look of a gas by its material: of the colour it declares where it is thick, else white of water and dark of soot."""
    color = material.appearance.color
    extinction = mass_extinction(material.substance)
    if color == Appearance().color and material.substance == "other":
        return GasLook(extinction, np.full(3, SOOT_ALBEDO))
    white = color == Appearance().color and material.substance == "water"
    return GasLook(extinction, _albedo(np.ones(3) if white else np.asarray(color, dtype=np.float64)))


def _albedo(color: F64) -> F64:
    """Albedo of single scatterings of a thick cloud that looks like a colour."""
    s = 4.09712 + 4.20863 * color - np.sqrt(9.59217 + 41.6808 * color + 17.7126 * color**2)
    return np.clip((1.0 - s**2) / (1.0 - ASYMMETRY * s**2), 0.0, MOST_ALBEDO)
