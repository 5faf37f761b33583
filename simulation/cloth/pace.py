"""Reasons to shorten steps while cloth runs: stretch that stiffens it, and solids that come fast."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64, I32

if TYPE_CHECKING:
    from ..boundaries import BodyState, Boundary

__all__ = ["fastest_point", "stiffened", "stiffening", "stretched"]

TENSION = 1.5
"""Own choice, above what tension adds to the stiffness across itself per extension."""
MOST = 4.0
"""Largest factor on the stiffness of squeezed triangles: beyond, a sheet folds and is squeezed no further."""


def stiffening(x: F64, edges: I32, length: F64) -> float:
    """Square of the highest frequency over that at rest, about, and at least 1.

    Tension stiffens a sheet across itself, squeezed triangles shear harder.

    Args:
        x: vertices [m], shape (n, 3).
        edges: shape (e, 2).
        length: theirs at rest [m], shape (e,).
    """
    return stiffened(*stretched(x, edges, length))


def stretched(x: F64, edges: I32, length: F64) -> tuple[float, float]:
    """Greatest and least length of edges over that at rest; arguments as `stiffening`."""
    ratio = np.linalg.norm(x[edges[:, 0]] - x[edges[:, 1]], axis=1) / length
    return float(ratio.max()), float(ratio.min())


def stiffened(greatest: float, least: float) -> float:
    """As `stiffening`, by the greatest and the least stretch."""
    return max(1.0 + TENSION * (greatest - 1.0), min(1.0 / max(least, 1e-3) ** 2, MOST), 1.0)


def fastest_point(boundaries: Sequence[Boundary], place: F64, row: I32, bodies: BodyState) -> float:
    """Fastest point of any solid that moves [m/s].

    Args:
        boundaries: the solids.
        place: vertices of all of them in their bodies' frames [m], shape (m, 3).
        row: the solid of each vertex, ascending, shape (m,).
        bodies: states of the solids.
    """
    moving = [k for k, b in enumerate(boundaries) if b.motion != "static" and not b.deforming]
    if not moving:
        return 0.0
    speed, spin = (np.sqrt((v[moving] ** 2).sum(1)) for v in (bodies.velocity, bodies.angular_velocity))
    most = 0.0
    # What neither moves nor turns, as the pieces of a wall that stands, is not looked at.
    for k in (k for k, v, w in zip(moving, speed, spin, strict=True) if v > 0.0 or w > 0.0):
        first, end = np.searchsorted(row, (k, k + 1))
        arm = place[first:end] @ bodies.rotation[k].T + bodies.position[k] - bodies.center[k]
        far = float(np.sqrt((arm**2).sum(1).max(initial=0.0)))
        most = max(most, float(np.linalg.norm(bodies.velocity[k]) + far * np.linalg.norm(bodies.angular_velocity[k])))
    return most
