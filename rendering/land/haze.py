"""Air between a camera and a landscape: what is far takes the colour of the sky at the horizon (Koschmieder 1924)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ...geometry.camera import Camera
from ...worlds.arrays import F32

if TYPE_CHECKING:
    from ..tracer.scene import SceneRenderer

__all__ = ["VISIBILITY_M", "hazed"]

VISIBILITY_M = 220_000.0
"""Distance at which a black object is lost against the sky [m]: very clear sea air; the eye that a picture is for has more range than its eight bits."""
ABOVE = 3.0e4
"""Height from which the sky is looked at [m]: nothing stands before it there."""
ELEVATION_DEG = 3.0
BEYOND = 2.0e5
"""Distance beyond which everything has the colour of the sky [m]."""


def hazed(scene: SceneRenderer, view: Camera, radiance: F32, *, seed: int) -> F32:
    """Radiance with the light that the air adds and without what it takes, shape (height, width, 3)."""
    depth = scene.depth(view)
    along = view.target - view.position
    level = float(np.hypot(along[0], along[1]))
    azimuth = math.atan2(along[1], along[0]) if level > 1e-9 else 0.0
    eye = view.position + np.array([0.0, 0.0, ABOVE])
    e = math.radians(ELEVATION_DEG)
    toward = np.array([math.cos(e) * math.cos(azimuth), math.cos(e) * math.sin(azimuth), math.sin(e)])
    sky = scene.radiance(Camera(eye, eye + toward, 2.0, 8, 4), 4, seed=seed).reshape(-1, 3).mean(0)
    _, directions = view.rays()
    pixel = math.radians(view.fov_deg) / view.height
    # The sky has nothing below the horizon, and the sea ends just short of it.
    edge = (directions[..., 2] < pixel) & ((depth == 0) | (depth > BEYOND)) & (directions[..., 2] > -20 * pixel)
    kept = np.where(edge, 0.0, np.where(depth > 0, np.exp(-3.912 / VISIBILITY_M * depth), 1.0))[..., None]
    return np.asarray(radiance * kept + sky * (1.0 - kept), dtype=np.float32)
