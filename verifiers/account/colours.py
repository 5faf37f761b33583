"""Words for colours: the nearest of the names that people gave in a survey."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..shots.difference import lab, lab_of

if TYPE_CHECKING:
    from ...worlds.spec import Appearance

__all__ = ["NAMES", "colour_word"]

NAMES: dict[str, int] = {
    "black": 0x000000,
    "white": 0xFFFFFF,
    "grey": 0x929591,
    "light grey": 0xD8DCD6,
    "dark grey": 0x363737,
    "red": 0xE50000,
    "dark red": 0x840000,
    "pink": 0xFF81C0,
    "orange": 0xF97306,
    "brown": 0x653700,
    "light brown": 0xAD8150,
    "dark brown": 0x341C02,
    "tan": 0xD1B26F,
    "beige": 0xE6DAA6,
    "yellow": 0xFFFF14,
    "gold": 0xDBB40C,
    "olive": 0x6E750E,
    "green": 0x15B01A,
    "light green": 0x96F97B,
    "dark green": 0x033500,
    "teal": 0x029386,
    "turquoise": 0x06C2AC,
    "cyan": 0x00FFFF,
    "blue": 0x0343DF,
    "light blue": 0x95D0FC,
    "dark blue": 0x00035B,
    "purple": 0x7E1E9C,
    "light purple": 0xBF77F6,
    "magenta": 0xC20078,
}
"""sRGB of common names, the medians of a survey of 222 500 people.

References:
    R. Munroe, Color Survey Results, 2010. https://blog.xkcd.com/2010/05/03/color-survey-results/
"""
CLEAR, METALLIC = 0.5, 0.5
"""Own choice: share of transmission, and of metal, from which on the look is called so."""


def colour_word(look: Appearance) -> str:
    """Name of the colour of a material, with `clear` or `metallic` before it where it is."""
    named = np.array([(v >> 16, v >> 8 & 255, v & 255) for v in NAMES.values()], dtype=np.uint8)
    nearest = int(np.argmin(np.linalg.norm(lab(named) - lab_of(np.array(look.color)), axis=1)))
    kind = "clear " if look.transmission >= CLEAR else "metallic " if look.metallic >= METALLIC else ""
    return kind + list(NAMES)[nearest]
