"""Surface tension against gravity.

References:
    P.-G. de Gennes, F. Brochard-Wyart and D. Quere, Capillarity and Wetting Phenomena (2004), section 2.1, doi:10.1007/978-0-387-21656-0.
"""

from __future__ import annotations

__all__ = ["HEAVY", "bond_number", "is_felt"]

HEAVY = 10.0
"""Own choice: from this Bond number of one spacing on, gravity leaves nothing to surface tension: over five spacings, about the
least drop that particles resolve, the capillary pressure is then under 1 % of the weight (water: spacings from 8.6 mm on)."""


def bond_number(surface_tension: float, density: float, gravity: float, length: float) -> float:
    """Weight over capillary force [1], rho g l^2 / gamma; gamma [N/m] > 0, rho [kg/m^3], g [m/s^2], l [m]."""
    return density * gravity * length**2 / surface_tension


def is_felt(surface_tension: float, density: float, gravity: float, spacing: float) -> bool:
    """True where the Bond number of one spacing is below `HEAVY`.

    Args:
        surface_tension: [N/m].
        density: [kg/m^3].
        gravity: its strength [m/s^2].
        spacing: of the particles [m].
    """
    return surface_tension > 0.0 and bond_number(surface_tension, density, gravity, spacing) < HEAVY
