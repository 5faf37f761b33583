"""Whether surface tension is felt at the scale that a liquid's particles resolve."""

from __future__ import annotations

__all__ = ["HEAVY", "is_felt"]

HEAVY = 10.0
"""Own choice: from this Bond number of one spacing on, gravity leaves nothing to surface tension: over five spacings, about the
least drop that particles resolve, the capillary pressure is then under 1 % of the weight (water: spacings from 8.6 mm on)."""


def is_felt(surface_tension: float, density: float, gravity: float, spacing: float) -> bool:
    """Whether the Bond number density gravity spacing^2 / surface_tension is below HEAVY.

    Args:
        surface_tension: [N/m].
        density: [kg/m^3].
        gravity: its strength [m/s^2].
        spacing: of the particles [m].
    """
    return surface_tension > 0.0 and density * gravity * spacing**2 < HEAVY * surface_tension
