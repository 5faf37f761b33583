"""Ropes: a polyline resampled into capsules of equal length."""

from __future__ import annotations

import itertools

import numpy as np

from ..worlds.arrays import F64, RigidPose
from ..worlds.errors import InputError
from ..worlds.spec import Capsule, Rope

__all__ = ["rope_segments"]


def _z_to(direction: F64) -> F64:
    """Unit quaternion that turns +z into `direction` (unit)."""
    w = 1.0 + direction[2]
    if w < 1e-12:
        return np.array([0.0, 1.0, 0.0, 0.0])
    quaternion = np.array([w, -direction[1], direction[0], 0.0])
    return np.asarray(quaternion / np.linalg.norm(quaternion))


def rope_segments(rope: Rope) -> list[tuple[Capsule, RigidPose]]:
    """Capsules and their poses in the entity's frame, from the first point to the last.

    Raises:
        InputError: a segment would be shorter than the rope is thick.
    """
    points = np.array(rope.points, dtype=np.float64)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    length = float(along[-1] / rope.segments)
    if length <= rope.radius:
        raise InputError(
            f"rope segments of {length:.4g} m are shorter than the radius {rope.radius:g} m; use at most {int(along[-1] / rope.radius)} segments"
        )
    at = np.linspace(0.0, along[-1], rope.segments + 1)
    knots = np.stack([np.interp(at, along, points[:, k]) for k in range(3)], axis=-1)
    result = []
    for a, b in itertools.pairwise(knots):
        span = float(np.linalg.norm(b - a))
        result.append((Capsule(radius=rope.radius, length=span), RigidPose((a + b) / 2, _z_to((b - a) / span))))
    return result
