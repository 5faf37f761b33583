"""Packing of spheres, and the time scale of their contacts.

References:
    Random close packing: G. D. Scott and D. M. Kilgour (1969), doi:10.1088/0022-3727/2/6/311.
    Time step by Rayleigh waves: Y. Li, Y. Xu and C. Thornton, Powder Technology 160 (2005) 219, doi:10.1016/j.powtec.2005.09.002.
"""

from __future__ import annotations

import math

__all__ = ["CLOSE_PACKING", "rayleigh_time"]

CLOSE_PACKING = 0.64
"""Random close packing of equal spheres; with radii spread by half of the mean about 0.66."""


def rayleigh_time(radius: float, density: float, young_modulus: float, poisson_ratio: float) -> float:
    """Time in which a Rayleigh wave runs half around a sphere [s]: pi r sqrt(rho / G) / (0.1631 nu + 0.8766).

    Args:
        radius: r [m].
        density: rho [kg/m^3].
        young_modulus: [Pa]; the shear modulus is G = E / 2 (1 + nu).
        poisson_ratio: nu.
    """
    shear = 0.5 * young_modulus / (1.0 + poisson_ratio)
    return math.pi * radius * math.sqrt(density / shear) / (0.1631 * poisson_ratio + 0.8766)
