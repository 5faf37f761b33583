"""What force fields do to liquids: accelerations of all of it, and a medium's push on the surface that it blows against (R18, R63).

The surface comes from the share phi of space that liquid fills: over a body of it, the integral of 2 phi |grad phi| is its area
whatever the width of the transition. So a particle of volume V stands for the area -2 V grad phi, outwards. Wind presses on what
faces it with its stagnation pressure and drags along with the stress that it has over open water (Large and Pond 1981,
doi:10.1175/1520-0485(1981)011<0324:OOMFMI>2.0.CO;2, for 4 to 11 m/s). Where little is around, particles are drops: spheres in the
flow (`worlds.particles.sphere_drag`). Near solids there is a lee.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .arrays import F64, I64
from .categories.particles.facts import sphere_drag
from .fields import Fields, Medium

if TYPE_CHECKING:
    from .built import TriangleMesh

__all__ = ["Push", "air_on", "in_lee", "outer_area", "pushed", "surface_points"]

CELL = 2.0
"""Of the grid on which phi is found, in spacings: lattices of particles and disorder are even on it."""
STAGNATION = 1.0
"""Share of the stagnation pressure on what faces the wind; a hemisphere then has the coefficient 0.5."""
SKIN = 1.2e-3
"""Drag coefficient of open water."""
DROP, BULK = 0.15, 0.3
"""phi at a particle up to which it is a drop, and from which it is none."""
LEE = 2.0
"""Cells of this many spacings: liquid in a cell with a solid's surface, or beside one, feels no medium."""


class Push(NamedTuple):
    """Forces of fields on particles."""

    force: F64
    """[N], shape (n, 3)."""
    rate: F64
    """At which a medium takes the velocity relative to it [1/s], shape (n,)."""


def surface_points(mesh: TriangleMesh, distance: float, low: F64 | None = None, high: F64 | None = None) -> F64:
    """Points on a surface, no farther apart than about `distance` [m], shape (k, 3).

    Args:
        mesh: the surface.
        distance: [m]
        low: only what is above this corner, if given.
        high: and below this one.
    """
    corners = np.asarray(mesh.vertices, dtype=np.float64)[mesh.faces]
    found = [np.zeros((0, 3))]
    while len(corners):
        if low is not None and high is not None:
            corners = corners[((corners.max(axis=1) >= low) & (corners.min(axis=1) <= high)).all(axis=1)]
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
        small = sides.max(axis=1) <= distance
        found.append(corners[small].mean(axis=1))
        a, b, c = np.moveaxis(corners[~small], 1, 0)
        ab, bc, ca = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
        corners = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return np.concatenate(found)


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


def in_lee(position: F64, points: F64, spacing: float) -> NDArray[np.bool_]:
    """Which particles a surface given by points shields, shape (n,)."""
    if not len(position) or not len(points):
        return np.zeros(len(position), dtype=bool)
    cell = LEE * spacing
    low = np.floor(position.min(axis=0) / cell) - 2.0
    mine = (np.floor(position / cell) - low).astype(np.int64)
    size = mine.max(axis=0) + 3
    theirs = (np.floor(points / cell) - low).astype(np.int64)
    theirs = theirs[((theirs >= 0) & (theirs < size)).all(axis=1)]
    solid = np.zeros(size, dtype=bool)
    solid[tuple(theirs.T)] = True
    for axis in range(3):
        wide = solid.copy()
        moved, kept = np.moveaxis(wide, axis, 0), np.moveaxis(solid, axis, 0)
        moved[1:] |= kept[:-1]
        moved[:-1] |= kept[1:]
        solid = wide
    return np.asarray(solid[tuple(mine.T)])


def air_on(medium: Medium, velocity: F64, mass: F64, volume: F64, area: F64, share: F64) -> Push:
    """What a medium does to particles of a liquid.

    Args:
        medium: where they are.
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
    sphere = (mass * sphere_drag(medium, radius, mass, velocity))[:, None] * flow
    force = (1.0 - drop)[:, None] * (pressure + skin) + drop[:, None] * sphere
    speed = np.maximum(np.linalg.norm(flow, axis=1), 1e-12)
    return Push(force, np.linalg.norm(force, axis=1) / (speed * mass))


def pushed(
    fields: Sequence[Fields],
    position: F64,
    velocity: F64,
    mass: F64,
    volume: F64,
    fluid: I64,
    time: float,
    spacing: float,
    solid: F64,
) -> tuple[F64, Push]:
    """Accelerations [m/s^2], shape (n, 3), and pushes of media on the particles of an instance at `time` [s].

    Args:
        fields: of each liquid.
        position: of the particles [m], shape (n, 3).
        velocity: theirs [m/s], shape (n, 3).
        mass: theirs [kg], shape (n,).
        volume: theirs [m^3], shape (n,).
        fluid: index of the liquid of each, shape (n,).
        time: [s]
        spacing: distance of particles at rest, or size of a cell [m].
        solid: points on the surfaces of solids [m], shape (k, 3).
    """
    gain, push = np.zeros_like(position), Push(np.zeros_like(position), np.zeros(len(position)))
    area, share = None, None
    for index in np.unique(fluid).tolist():
        own = fields[index]
        if not own.acts(time, time + 1e-9):
            continue
        rows = np.flatnonzero(fluid == index)
        gain[rows] = own.acceleration(position[rows], time)
        if not own.has_medium:
            continue
        if area is None or share is None:
            area, share = outer_area(position, volume, spacing)
            area[in_lee(position, solid, spacing)] = 0.0
        rows = rows[np.abs(area[rows]).max(axis=1) > 0]
        found = air_on(own.medium(position[rows], time), velocity[rows], mass[rows], volume[rows], area[rows], share[rows])
        push.force[rows], push.rate[rows] = found
    return gain, push
