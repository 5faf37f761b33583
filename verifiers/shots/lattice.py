"""Views whose pixels are turned, so that no row of bars can line up with them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...geometry import Camera

__all__ = ["lattice", "upright"]

TURN = math.atan(2.0 / (1.0 + math.sqrt(5.0)))
"""[rad] The finer pixels are turned by this, whose tangent is the golden ratio's: farthest from every simple slope."""


def lattice(camera: Camera, size: tuple[int, int]) -> Camera:
    """The same view with its pixels turned, which no row of bars can line up with; it encloses an upright picture of `size`."""
    side = math.ceil(math.hypot(*size))
    tall = side / size[1] * math.tan(math.radians(camera.fov_deg) / 2.0)
    return Camera(camera.position, camera.target, 2.0 * math.degrees(math.atan(tall)), side, side, TURN)


def upright(camera: Camera, size: tuple[int, int], window: tuple[int, int, int, int]) -> NDArray[np.bool_]:
    """Which pixels of a window of a turned view lie in the upright picture in its middle, shape (rows, columns)."""
    x = np.arange(window[0], window[1]) + 0.5 - camera.width / 2
    y = (camera.height / 2 - 0.5 - np.arange(window[2], window[3]))[:, None]
    c, s = math.cos(camera.roll), math.sin(camera.roll)
    return np.asarray((np.abs(c * x - s * y) <= size[0] / 2) & (np.abs(s * x + c * y) <= size[1] / 2))
