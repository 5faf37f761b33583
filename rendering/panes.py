"""Glass in quick pictures: what lies behind shows through, darker and tinted towards the edges, under the light that the surface throws back."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F32, F64

__all__ = ["LAYERS", "PANE", "Glass", "glazed"]

PANE = 0.5
"""[1] Own choice: transmission from which on a part is one that pictures see through."""
LAYERS = 4
"""Parts of glass behind one another that a picture shows."""
TINT = np.array([0.90, 0.955, 0.94])
"""[1] Own choice: share of the light behind that clear glass lets through, linear RGB: iron in it takes the red."""
EDGE = 0.62
"""[1] Own choice: share of that which is lost where one looks along the wall, and so through much of it."""
STRAIGHT, GRAZING = 0.04, 0.85
"""[1] Share of the sky thrown back at normal incidence (Fresnel, index 1.5), and added to it at grazing incidence."""
SHINE, SHARP = 0.7, 90.0
"""[1] Own choice: brightness and sharpness of the sun's spot."""


class Glass(NamedTuple):
    """Looks of the parts that are seen through, by their ids."""

    colors: F32
    """Linear RGB, shape (n, 3)."""
    roughness: F64
    """[1], shape (n,)."""
    transmission: F64
    """[1], shape (n,)."""


def glazed(behind: F64, glass: Glass, ids: NDArray[np.int32], faces: F64, directions: F64, sun: F64, sky: F64) -> F64:
    """Radiance of pixels at which a layer of glass stands before what was painted, shape (n, 3).

    Args:
        behind: radiance of what lies behind it, shape (n, 3).
        glass: looks of all parts.
        ids: the part at each pixel, shape (n,).
        faces: unit normals there, of either side, shape (n, 3).
        directions: unit directions of sight, shape (n, 3).
        sun: unit vector towards the sun, shape (3,).
        sky: radiance that the surface mirrors, shape (3,).
    """
    normals = np.where(((faces * directions).sum(1) > 0.0)[:, None], -faces, faces)
    along = 1.0 - np.clip(-(normals * directions).sum(1), 0.0, 1.0)
    through = glass.colors[ids] * TINT * (1.0 - EDGE * along**3)[:, None]
    # Ground glass and thick colours show themselves: the rougher, the more.
    own = np.clip(0.04 + 0.6 * glass.roughness[ids] + (1.0 - glass.transmission[ids]), 0.0, 1.0)[:, None]
    thrown = (STRAIGHT + GRAZING * along**4)[:, None]
    half = sun - directions
    half /= np.maximum(np.linalg.norm(half, axis=1, keepdims=True), 1e-12)
    spot = SHINE * np.clip((normals * half).sum(1), 0.0, 1.0) ** SHARP
    inside = behind * through * (1.0 - own) + glass.colors[ids] * own * 0.6
    result: F64 = inside * (1.0 - thrown) + thrown * sky + spot[:, None]
    return result
