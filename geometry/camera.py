"""Pinhole camera and the shot plan's camera at a frame.

Camera axes: x right, y up, looking along -z. Pixel coordinates run right and down from the top left corner of the
image; the centre of the first pixel is (0.5, 0.5). Depth is measured along the viewing axis, not along the ray.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64
from ..worlds.errors import InputError

if TYPE_CHECKING:
    from ..worlds.spec import Shot

__all__ = ["Camera", "camera_at"]

STRAIGHT_DOWN = 1e-6
"""Own choice: sine of the angle to the vertical below which +Y replaces +Z as the up direction."""


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera with square pixels and the principal point in the middle."""

    position: F64
    """Eye [m], shape (3,)."""
    target: F64
    """Point in the middle of the picture [m], shape (3,)."""
    fov_deg: float
    """Vertical field of view [degrees]."""
    width: int
    """Pixels."""
    height: int
    """Pixels."""
    roll: float = 0.0
    """Turn of the picture about the viewing axis [rad], from right to up; shot plans have none."""

    def __post_init__(self) -> None:
        distance = float(np.linalg.norm(np.asarray(self.target) - np.asarray(self.position)))
        if not (math.isfinite(distance) and distance > 0.0):
            raise InputError(f"camera target lies {distance!r} m from its position; it must be > 0: move one of the two")
        if not 0.0 < self.fov_deg < 180.0:
            raise InputError(f"camera field of view {self.fov_deg!r} degrees must lie between 0 and 180, e.g. 40")
        if self.width < 1 or self.height < 1:
            raise InputError(f"camera picture is {self.width} x {self.height} pixels; both must be >= 1")

    @cached_property
    def axes(self) -> F64:
        """Rows are the camera's right, up and backward directions in the world, shape (3, 3)."""
        back = np.asarray(self.position, dtype=np.float64) - np.asarray(self.target, dtype=np.float64)
        back /= np.linalg.norm(back)
        up = np.array([0.0, 0.0, 1.0])
        if math.hypot(back[0], back[1]) < STRAIGHT_DOWN:
            up = np.array([0.0, 1.0, 0.0])
        right = np.cross(up, back)
        right /= np.linalg.norm(right)
        above = np.cross(back, right)
        if self.roll != 0.0:
            c, s = math.cos(self.roll), math.sin(self.roll)
            right, above = c * right + s * above, c * above - s * right
        return np.stack([right, above, back])

    @property
    def focal(self) -> float:
        """Focal length [pixels]."""
        return 0.5 * self.height / math.tan(math.radians(self.fov_deg) / 2.0)

    def project(self, points: F64) -> tuple[F64, F64]:
        """Pixels, shape (n, 2), and depth along the viewing axis [m], shape (n,), of world points, shape (n, 3).

        Points with depth <= 0 lie behind the eye; their pixels are NaN.
        """
        local = (np.asarray(points, dtype=np.float64).reshape(-1, 3) - self.position) @ self.axes.T
        depth = -local[:, 2]
        scale = self.focal / np.where(depth > 0.0, depth, np.nan)
        pixels = np.stack([0.5 * self.width + local[:, 0] * scale, 0.5 * self.height - local[:, 1] * scale], axis=1)
        return pixels, depth

    def in_frame(self, points: F64) -> NDArray[np.bool_]:
        """True where world points, shape (n, 3), fall into the picture (not whether something hides them), shape (n,)."""
        pixels, depth = self.project(points)
        inside = (pixels >= 0.0) & (pixels <= (self.width, self.height))
        return np.asarray((depth > 0.0) & inside.all(axis=1))

    def rays(self) -> tuple[F64, F64]:
        """Eye [m], shape (3,), and unit directions through the pixel centres, shape (height, width, 3)."""
        x = (np.arange(self.width) + 0.5 - 0.5 * self.width) / self.focal
        y = (0.5 * self.height - np.arange(self.height) - 0.5) / self.focal
        directions = x[None, :, None] * self.axes[0] + y[:, None, None] * self.axes[1] - self.axes[2]
        directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
        return np.asarray(self.position, dtype=np.float64), directions


def _smooth(frames: F64, values: F64, frame: float) -> F64:
    """Monotone cubic through `values`, shape (keys, c), at `frame`: no overshoot, at rest at both ends.

    Interior slopes are harmonic means of the neighbouring ones where these agree in sign, else zero:
    Fritsch and Butland (1984), doi:10.1137/0905021.
    """
    if frame <= frames[0] or len(frames) == 1:
        return np.asarray(values[0])
    if frame >= frames[-1]:
        return np.asarray(values[-1])
    step = np.diff(frames)[:, None]
    slope = np.diff(values, axis=0) / step
    tangent = np.zeros_like(values)
    before, after, left, right = slope[:-1], slope[1:], step[:-1], step[1:]
    agree = before * after > 0.0
    w1, w2 = 2.0 * right + left, right + 2.0 * left
    mean = (w1 + w2) / (w1 / np.where(agree, before, 1.0) + w2 / np.where(agree, after, 1.0))
    tangent[1:-1] = np.where(agree, mean, 0.0)
    k = int(np.searchsorted(frames, frame, side="right")) - 1
    h = float(step[k, 0])
    t = (frame - frames[k]) / h
    return np.asarray(
        (1 + 2 * t) * (1 - t) ** 2 * values[k]
        + t * (1 - t) ** 2 * h * tangent[k]
        + t * t * (3 - 2 * t) * values[k + 1]
        + t * t * (t - 1) * h * tangent[k + 1]
    )


def camera_at(shot: Shot, frame: int, look_width: int, look_height: int, follow_offset: F64 | None) -> Camera:
    """The camera of `shot` at `frame`; before the first and after the last key it stands still.

    Positions and targets follow a monotone cubic through the keys, the field of view changes linearly. Of several keys
    at one frame the last by id counts.

    Args:
        shot: one shot of the plan; all its keys have a target.
        frame: frame index.
        look_width: picture width [pixels].
        look_height: picture height [pixels].
        follow_offset: motion of the followed entity since the first key [m], shape (3,), added to the target.
    """
    by_frame = {key.frame: key for _, key in sorted(shot.keys.items())}
    keys = [by_frame[f] for f in sorted(by_frame)]
    frames = np.array([k.frame for k in keys], dtype=np.float64)
    path = np.array([[*k.position, *(k.target or ())] for k in keys], dtype=np.float64)
    at = _smooth(frames, path, float(frame))
    fov = float(np.interp(frame, frames, [k.fov_deg for k in keys]))
    target = at[3:] if follow_offset is None else at[3:] + follow_offset
    return Camera(at[:3], target, fov, look_width, look_height)
