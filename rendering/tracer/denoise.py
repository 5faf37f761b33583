"""Open Image Denoise, exposure and tone curve: radiance to an 8-bit sRGB picture.

The denoiser wants uncorrelated pixels, so pictures are rendered with a box filter, and albedo and normals of the
first hit as guides. The tone curve is Narkowicz's fit of ACES (2016, "ACES Filmic Tone Mapping Curve"), applied per
channel to `radiance * gain`, then the sRGB transfer curve of IEC 61966-2-1. A gain of `KEY / metered luminance`
puts the metered grey at about 0.55 in sRGB.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F32, U8
from ...worlds.errors import EngineError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .scene import Features

__all__ = ["KEY", "denoise", "meter", "tonemap"]

KEY = 0.20
"""Exposed luminance that the metered mean is brought to; own choice."""
BRIGHTEST = 1.1
"""Exposed luminance that 95 % of the metered surface stay below, so that a white scene keeps its drawing."""
LUMINANCE = np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)
"""Luminance weights of linear sRGB primaries (IEC 61966-2-1)."""


def denoise(radiance: F32, features: Features) -> F32:
    """Remove sampling noise from linear radiance, shape (height, width, 3).

    Raises:
        EngineError: Open Image Denoise failed.
    """
    import pyoidn

    color = np.nan_to_num(np.maximum(radiance, 0.0), posinf=0.0)
    albedo = np.clip(np.nan_to_num(features.albedo), 0.0, 1.0)
    normals = np.clip(np.nan_to_num(features.normals), -1.0, 1.0)
    try:
        clean = pyoidn.denoise(color, albedo=albedo, normal=normals, hdr=True, quality="balanced")
    except RuntimeError as error:
        raise EngineError(f"Open Image Denoise failed ({error}); render with denoise=False") from error
    return np.asarray(clean, dtype=np.float32)


def meter(radiance: F32, normals: F32, panes: NDArray[np.bool_] | None = None) -> float:
    """Gain that exposes the surfaces in view: log-mean luminance to `KEY`, highlights below `BRIGHTEST`.

    Pixels without a surface (sky) do not count, unless there is nothing else; nor does what is seen through panes (the day before the
    windows of a room), unless panes take more than half of the surfaces.

    Args:
        radiance: of the picture, shape (height, width, 3).
        normals: of the first hits, zero where there is none, shape (height, width, 3).
        panes: where a pane is the first hit, shape (height, width).
    """
    luminance = radiance @ LUMINANCE
    surface = np.abs(normals).sum(-1) > 0.1
    solid = surface if panes is None else surface & ~panes
    seen = luminance[solid if 2 * solid.sum() >= surface.sum() else surface]
    if seen.size == 0:
        seen = luminance.ravel()
    level = float(np.exp(np.mean(np.log(np.maximum(seen, 1e-6)))))
    bright = float(np.percentile(seen, 95))
    return min(KEY / max(level, 1e-6), BRIGHTEST / max(bright, 1e-6))


def tonemap(radiance: F32, *, gain: float = 1.0) -> U8:
    """8-bit sRGB picture of linear radiance, shape (height, width, 3)."""
    x = np.maximum(np.nan_to_num(radiance, posinf=1e6), 0.0) * gain
    display = np.clip((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0)
    encoded = np.where(display <= 0.0031308, 12.92 * display, 1.055 * display ** (1 / 2.4) - 0.055)
    return np.asarray(np.round(encoded * 255.0), dtype=np.uint8)
