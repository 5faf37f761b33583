"""Extinction of light by what gases carry: soot, droplets, dust.

References:
    Soot of flames: G. W. Mulholland, C. Croarkin, Specific extinction coefficient of flame generated smoke, Fire and Materials 24 (2000)
    227: 8.7 +- 1.1 m^2/g at 633 nm.
    Droplets and grains larger than a wavelength: H. C. van de Hulst, Light Scattering by Small Particles (1957): twice their section,
    hence 3 / (2 density radius) per mass.
    Visibility: T. Jin, Visibility through fire smoke, Journal of Fire and Flammability 9 (1978) 135, after Koschmieder's law.
"""

from __future__ import annotations

__all__ = ["SIGN_DEPTH", "SOOT_EXTINCTION", "mass_extinction"]

SOOT_EXTINCTION = 8700.0
"""[m^2/kg] Light that soot takes out of a ray, per mass."""
DROPLET_EXTINCTION = 300.0
"""[m^2/kg] Of steam and mist: drops of 5 micrometres in radius."""
DUST_EXTINCTION = 190.0
"""[m^2/kg] Of dust: grains of 3 micrometres in radius and 2650 kg/m^3."""
MINERALS = ("sand", "soil", "stone", "concrete", "brick", "ceramic", "glass")
"""Substances whose clouds are dust."""
SIGN_DEPTH = 3.0
"""[1] Optical depth over which a sign that reflects light is just seen; one that shines, 8 (Jin)."""


def mass_extinction(substance: str) -> float:
    """Light that what a gas carries takes out of a ray, per mass [m^2/kg].

    Args:
        substance: of its material; all but water and minerals count as soot.
    """
    if substance == "water":
        return DROPLET_EXTINCTION
    return DUST_EXTINCTION if substance in MINERALS else SOOT_EXTINCTION
