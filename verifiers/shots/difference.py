"""Pixels in which two pictures differ by more than their noise, in CIELAB.

Each picture is there twice, from two seeds. The difference is that of the means over the seeds. The two seeds of one picture differ by
sqrt(2) of its noise, so that the mean square of the difference that noise alone gives is a quarter of the sum of both squared
differences between seeds; averaged over the pixels of a window, since two seeds tell the noise of one pixel badly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...worlds.arrays import F64, U8
from ...worlds.plates import Plate
from .bounds import JUST_NOTICEABLE, SEEN_NOISE

__all__ = ["Difference", "compared", "lab", "lab_of", "linear"]

WINDOW = 5
"""[pixels] Own choice: side of the window over which noise is averaged: 50 differences between seeds tell it within 10 %."""
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
"""Linear sRGB to CIE XYZ (IEC 61966-2-1)."""
WHITE = TO_XYZ.sum(axis=1)


class Difference(NamedTuple):
    """Two pictures compared, pixel by pixel; each of shape (height, width)."""

    delta: F64
    """Distance of their colours in CIELAB."""
    noise: F64
    """Distance that noise alone gives, root mean square."""

    @property
    def differs(self) -> np.ndarray:
        """Where they differ, by more than noise does and by what an eye notices."""
        return np.asarray(self.delta > np.maximum(SEEN_NOISE * self.noise, JUST_NOTICEABLE))


def linear(picture: U8) -> F64:
    """Linear sRGB of an 8-bit picture, 0..1 (IEC 61966-2-1)."""
    x = np.asarray(picture, dtype=np.float64) / 255.0
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def lab(picture: U8) -> F64:
    """CIELAB of an 8-bit sRGB picture, same shape."""
    return lab_of(linear(picture))


def lab_of(values: F64) -> F64:
    """CIELAB of linear sRGB (CIE 15:2004, white of D65), same shape."""
    ratio = values @ TO_XYZ.T / WHITE
    small = (6.0 / 29.0) ** 3
    f = np.where(ratio > small, np.cbrt(ratio), ratio / (3.0 * (6.0 / 29.0) ** 2) + 4.0 / 29.0)
    return np.stack([116.0 * f[..., 1] - 16.0, 500.0 * (f[..., 0] - f[..., 1]), 200.0 * (f[..., 1] - f[..., 2])], axis=-1)


def compared(plate: Plate) -> Difference:
    """The pictures of a plate with and without its subject."""
    from scipy.ndimage import uniform_filter

    shown, bare = lab(plate.shown), lab(plate.bare)
    squares = ((shown[0] - shown[1]) ** 2).sum(-1) + ((bare[0] - bare[1]) ** 2).sum(-1)
    noise = np.sqrt(np.maximum(uniform_filter(squares, WINDOW, mode="nearest"), 0.0) / 4.0)
    return Difference(np.linalg.norm(shown.mean(0) - bare.mean(0), axis=-1), noise)
