"""Light of hot matter: a black body in three colours, on the scale of the lights of pictures."""

from __future__ import annotations

import numpy as np

from ..worlds.arrays import F32, F64

__all__ = ["COLD", "glow"]

BANDS = (0.61e-6, 0.55e-6, 0.465e-6)
"""Wavelengths of red, green and blue [m]."""
BAND_SHARE = 0.16
"""Share of daylight's power in each of the three bands: lights are given in power over all of them."""
BAND_WIDTH = 0.1e-6
COLD = 700.0
"""Below this nothing glows visibly [K]."""


def glow(temperature: F64 | F32) -> F64:
    """Radiance of a black body in three colours on the scale of the scene's lights [W/(m^2 sr)], shape (..., 3).

    Planck's law at three wavelengths.
    """
    h, c, k = 6.62607015e-34, 299792458.0, 1.380649e-23
    wave = np.array(BANDS)
    hot = np.maximum(np.asarray(temperature, dtype=np.float64), 1.0)[..., None]
    spectral = 2 * h * c**2 / wave**5 / np.expm1(np.minimum(h * c / (wave * k * hot), 700.0))
    return np.where(hot > COLD, spectral * BAND_WIDTH / BAND_SHARE, 0.0)
