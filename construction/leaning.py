"""Orientations by what lies below: along a slope, and on a side of its own on which a body stays."""

from __future__ import annotations

import numpy as np

from ..worlds.arrays import F64, RigidPose, quaternion_product
from ..worlds.errors import InputError
from .scenes import Body, upper_heights

__all__ = ["laid", "tilted"]

SAMPLES = 7
"""Own choice: a slope is the plane through so many heights along each side of what stands on it."""
STEEPEST = 0.05
"""Least z of the normal of a surface that something stands on: 87 degrees."""
STEADY = 0.3
"""Own choice: a body stays on a side where its centre is in by this share of the way from the rim to the middle."""


def tilted(body: Body, pose: RigidPose, other: Body, there: RigidPose) -> RigidPose:
    """The pose turned by the shortest way from upright to the mean normal of the surface below, about its own origin.

    Raises:
        InputError: nothing lies below, or it is too steep.
    """
    low, high = body.box(pose)
    x, y = (np.linspace(low[k], high[k], SAMPLES) for k in (0, 1))
    at = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    heights = upper_heights(other, there, at)
    known = np.isfinite(heights)
    if known.sum() < 3:
        raise InputError(
            f"nothing to tilt to lies under x, y = {pose.position[0]:.4g}, {pose.position[1]:.4g} m; give `at` over its surface"
        )
    plane = np.linalg.lstsq(np.column_stack([at[known], np.ones(int(known.sum()))]), heights[known], rcond=None)[0]
    normal = np.array([-plane[0], -plane[1], 1.0]) / np.linalg.norm([plane[0], plane[1], 1.0])
    if normal[2] < STEEPEST:
        raise InputError(f"the surface under x, y = {pose.position[0]:.4g}, {pose.position[1]:.4g} m is too steep to stand on")
    return RigidPose(pose.position, quaternion_product(_between(np.array([0.0, 0.0, 1.0]), normal), pose.quaternion))


def laid(body: Body, pose: RigidPose, center: F64) -> RigidPose:
    """The pose turned about its own origin by the least angle that brings a side of the hull down on which the body stays.

    Args:
        body: what is laid.
        pose: its pose.
        center: of mass in the body's frame [m], shape (3,).
    """
    from scipy.spatial import ConvexHull

    points, middle = body.points(pose), pose.apply(np.asarray(center)[None])[0]
    hull = ConvexHull(points)
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    best, turn = np.inf, np.array([1.0, 0.0, 0.0, 0.0])
    for normal in np.unique(hull.equations[:, :3].round(9), axis=0):
        reach = points @ normal
        side = points[reach > reach.max() - 1e-6 * size]
        angle = float(np.arccos(np.clip(-normal[2], -1.0, 1.0)))
        if angle < best and _stays(side, normal, middle):
            best, turn = angle, _between(normal, np.array([0.0, 0.0, -1.0]))
    return pose if best < 1e-9 else RigidPose(pose.position, quaternion_product(turn, pose.quaternion))


def _stays(side: F64, normal: F64, center: F64) -> bool:
    """True where a centre of mass stands over the inner part of a side, seen along its normal."""
    from scipy.spatial import ConvexHull, QhullError

    across = np.linalg.svd(normal[None])[2][1:]
    plan, point = side @ across.T, across @ center
    try:
        planes = ConvexHull(plan).equations
    except QhullError:  # an edge or a corner
        return False
    inner = float((planes[:, :2] @ plan.mean(0) + planes[:, 2]).max())
    return bool(float((planes[:, :2] @ point + planes[:, 2]).max()) < STEADY * inner)


def _between(a: F64, b: F64) -> F64:
    """Unit quaternion of the shortest turn from one unit vector to another."""
    if float(a @ b) < -1 + 1e-12:
        axis = np.cross(a, [1.0, 0.0, 0.0] if abs(a[0]) < 0.9 else [0.0, 1.0, 0.0])
        return np.array([0.0, *(axis / np.linalg.norm(axis))])
    turn = np.array([1.0 + a @ b, *np.cross(a, b)])
    return np.asarray(turn / np.linalg.norm(turn))
