"""Push of moving air, or another medium, on the free surface of a liquid that is made of particles.

The surface comes from the share phi of space that liquid fills: over a body of it, the integral of 2 phi |grad phi| is its area
whatever the width of the transition. So a particle of volume V stands for the area -2 V grad phi, outwards. Wind presses on what
faces it with its stagnation pressure, 1/2 rho u^2, and drags along it with the stress that it has over open water, C rho u^2. Where
little is around, particles are drops: spheres in the flow.

References:
    W. G. Large and S. Pond, Journal of Physical Oceanography 11 (1981) 324,
    doi:10.1175/1520-0485(1981)011<0324:OOMFMI>2.0.CO;2: C = 1.2e-3 for winds of 4 to 11 m/s.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .arrays import F64, I64
from .drag import Medium, sphere_drag_rate

__all__ = ["Push", "outer_area", "push_on_liquid"]

CELL = 2.0
"""Size of the grid on which phi is found, in spacings: lattices of particles and disorder are even on it."""
STAGNATION = 1.0
"""Share of the stagnation pressure on what faces the wind; a hemisphere then has the coefficient 0.5."""
SKIN = 1.2e-3
"""Drag coefficient of open water."""
DROP, BULK = 0.15, 0.3
"""phi at a particle up to which it is a drop, and from which it is none."""


class Push(NamedTuple):
    """Forces of a medium on n particles."""

    force: F64
    """[N], shape (n, 3)."""
    rate: F64
    """At which it takes the velocity relative to it [1/s], shape (n,)."""


class _Grid:
    """Nodes of a regular grid around points, and the eight that each point lies between."""

    def __init__(self, points: F64, cell: float) -> None:
        self.cell = cell
        self.low: F64 = np.floor(points.min(axis=0) / cell) - 1.0
        place = points / cell - self.low
        base = np.floor(place).astype(np.int64)
        self.part: F64 = place - base
        self.shape: I64 = base.max(axis=0) + 2
        self.strides = np.array([self.shape[1] * self.shape[2], self.shape[2], 1])
        self.first: I64 = base @ self.strides

    def corners(self) -> list[tuple[I64, F64, F64]]:
        """Node, weight (n,) and gradient of the weight [1/m] (n, 3) of each point's eight."""
        result = []
        for k in range(8):
            up = np.array([k >> 2 & 1, k >> 1 & 1, k & 1])
            one = np.where(up == 1, self.part, 1.0 - self.part)
            slope = np.where(up == 1, 1.0, -1.0) / self.cell
            across = np.stack([one[:, 1] * one[:, 2], one[:, 0] * one[:, 2], one[:, 0] * one[:, 1]], axis=1)
            result.append((self.first + int(up @ self.strides), one.prod(axis=1), slope * across))
        return result


def outer_area(position: F64, volume: F64, spacing: float) -> tuple[F64, F64]:
    """Outward area [m^2] that each particle stands for, shape (n, 3), and the share of space that is filled around it, (n,).

    Args:
        position: of the particles [m], shape (n, 3).
        volume: theirs [m^3], shape (n,).
        spacing: their distance at rest, or the size of a cell [m].
    """
    if not len(position):
        return np.zeros((0, 3)), np.zeros(0)
    grid = _Grid(position, CELL * spacing)
    corners = grid.corners()
    total = np.zeros(int(np.prod(grid.shape)))
    for node, weight, _ in corners:
        total += np.bincount(node, volume * weight, len(total))
    filled = np.minimum(total / grid.cell**3, 1.0)
    slope, share = np.zeros_like(position), np.zeros(len(position))
    for node, weight, gradient in corners:
        slope += filled[node][:, None] * gradient
        share += filled[node] * weight
    return -2.0 * volume[:, None] * slope, share


def push_on_liquid(medium: Medium, velocity: F64, mass: F64, volume: F64, area: F64, share: F64) -> Push:
    """Push of a medium on particles of a liquid.

    Args:
        medium: at the particles.
        velocity: theirs [m/s], shape (n, 3).
        mass: theirs [kg], shape (n,).
        volume: theirs [m^3], shape (n,).
        area: outward [m^2], shape (n, 3), zero in the lee of solids; `outer_area`.
        share: of space that is filled around each, shape (n,).
    """
    flow = medium.velocity - velocity
    size = np.linalg.norm(area, axis=1)
    normal = area / np.maximum(size, 1e-300)[:, None]
    inwards = np.minimum((flow * normal).sum(axis=1), 0.0)
    along = flow - (flow * normal).sum(axis=1)[:, None] * normal
    pressure = (-0.5 * STAGNATION * medium.density * inwards**2 * size)[:, None] * normal
    skin = (SKIN * medium.density * np.linalg.norm(along, axis=1) * size)[:, None] * along
    radius = np.cbrt(3.0 * volume / (4.0 * np.pi))
    drop = np.where(size > 0, np.clip((BULK - share) / (BULK - DROP), 0.0, 1.0), 0.0)
    sphere = (mass * sphere_drag_rate(medium, radius, mass, velocity))[:, None] * flow
    force = (1.0 - drop)[:, None] * (pressure + skin) + drop[:, None] * sphere
    speed = np.maximum(np.linalg.norm(flow, axis=1), 1e-12)
    return Push(force, np.linalg.norm(force, axis=1) / (speed * mass))
