"""Rings of a profile that is carried along a path, by parallel transport with mitred bends.

Source: A. J. Hanson and H. Ma, Parallel transport approach to curve framing, Indiana University TR 425, 1995.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .arrays import F64, I32, cross

if TYPE_CHECKING:
    from .shapes import Sweep

__all__ = ["side_faces", "sweep_rings", "sweep_volume"]

SHORT = 1e-12
"""[m] Own choice: segments of a path that are shorter have no direction."""
FOLDED = 1e-3
"""Own choice: a bend whose halves are this far from opposite directions cannot be mitred."""


def _directions(shape: Sweep) -> F64:
    """Unit vectors along the segments of the path, shape (n - 1, 3), or (n, 3) where it is closed.

    Raises:
        ValueError: a segment has no length, or the path folds back on itself.
    """
    path = np.array(shape.path, dtype=np.float64)
    steps = np.diff(np.concatenate([path, path[:1]]) if shape.closed else path, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    if lengths.min() <= SHORT:
        raise ValueError(f"points {int(lengths.argmin())} and the next of the path are the same; leave one out")
    along: F64 = steps / lengths[:, None]
    turns = (along * np.roll(along, -1, axis=0)).sum(1)[: None if shape.closed else -1]
    if len(turns) and turns.min() <= FOLDED - 1:
        raise ValueError(f"the path folds back on itself after segment {int(turns.argmin())}; bend it over several points")
    return along


def sweep_rings(shape: Sweep) -> F64:
    """Corners of the profile at each point of the path [m], shape (points, corners, 3).

    Raises:
        ValueError: a segment has no length, the path folds back on itself, or a bend is so tight that the profile would pass through itself.
    """
    along, path = _directions(shape), np.array(shape.path, dtype=np.float64)
    profile = np.array(shape.profile, dtype=np.float64)
    scales = np.ones(len(path)) if shape.scales is None else np.array(shape.scales)
    rings = np.empty((len(path), len(profile), 3))
    right, up = _first_frame(along[0])
    for k, point in enumerate(path):
        before = along[k - 1] if k or shape.closed else along[0]
        after = along[k % len(along)] if k < len(along) else along[-1]
        if k:
            right, up = _carried(right, along[k - 1], after), _carried(up, along[k - 1], after)
        flat = scales[k] * (profile[:, :1] * right + profile[:, 1:] * up)
        normal = before + after
        # Slid along the segment onto the plane that halves the bend.
        rings[k] = point + flat - np.outer(flat @ normal / (after @ normal), after)
    ahead = np.concatenate([rings, rings[:1]]) if shape.closed else rings
    gain = np.einsum("kij,kj->ki", np.diff(ahead, axis=0), along)
    if gain.min() <= 0.0:
        raise ValueError(
            f"segment {int(gain.min(1).argmin())} of the path is too short for its bends: the inner side of the profile would pass "
            "through itself; make it longer, the bend wider, or the profile smaller"
        )
    if shape.closed:
        _require_meeting(rings, along, right, up)
    return rings


def _first_frame(along: F64) -> tuple[F64, F64]:
    wanted = np.array([0.0, 0.0, 1.0]) if abs(along[2]) < 0.999 else np.array([0.0, 1.0, 0.0])
    up = wanted - (wanted @ along) * along
    up /= np.linalg.norm(up)
    return cross(along, up), up


def _carried(vector: F64, before: F64, after: F64) -> F64:
    """A vector turned by the least turn from one direction to the next."""
    axis, cosine = cross(before, after), float(before @ after)
    turned: F64 = vector * cosine + cross(axis, vector) + axis * float(axis @ vector) / (1.0 + cosine)
    return turned


def _require_meeting(rings: F64, along: F64, right: F64, up: F64) -> None:
    """Refuse a closed path in space after which the profile comes back turned."""
    back = _carried(up, along[-1], along[0])
    first = _first_frame(along[0])[1]
    if float(back @ first) < 1.0 - 1e-9:
        raise ValueError("a closed path must be plane: the profile comes back turned, and its ends do not meet")


def side_faces(points: int, corners: int, *, closed: bool) -> I32:
    """Triangles of the sides between rings of `corners` vertices, shape (n, 3), for a profile that is counter-clockwise in (u, v)."""
    ring = np.arange(points if closed else points - 1)[:, None] * corners
    this = np.arange(corners)
    following = (this + 1) % corners
    low, high = ring, (ring + corners) % (points * corners)
    halves = [(low + this, high + this, high + following), (low + this, high + following, low + following)]
    return np.concatenate([np.stack([a, b, c], axis=-1).reshape(-1, 3) for a, b, c in halves]).astype(np.int32)


def sweep_volume(shape: Sweep) -> float:
    """Volume between flat triangles of the rings [m^3].

    Raises:
        ValueError: as `sweep_rings`.
    """
    rings = sweep_rings(shape)
    points, corners = rings.shape[:2]
    faces = [side_faces(points, corners, closed=shape.closed)]
    if not shape.closed:
        fan = np.array([(0, k, k + 1) for k in range(1, corners - 1)])
        faces += [fan, fan[:, ::-1] + (points - 1) * corners]
    corner = rings.reshape(-1, 3)[np.concatenate(faces)]
    return abs(float(np.einsum("ij,ij->i", corner[:, 0], cross(corner[:, 1], corner[:, 2])).sum())) / 6
