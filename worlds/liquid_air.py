"""Force fields on liquids: accelerations of all of it, and a medium's push on the surface that it blows against (R18, R63).

The law of the push is `physics.liquid_air`. Near solids there is a lee.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..physics.liquid_air import Push, outer_area, push_on_liquid
from .arrays import F64, I64
from .fields import Fields

if TYPE_CHECKING:
    from .built import TriangleMesh

__all__ = ["LEE", "Matter", "in_lee", "pushed", "surface_points"]

LEE = 2.0
"""Cells of this many spacings: liquid in a cell with a solid's surface, or beside one, feels no medium."""


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


class Matter(NamedTuple):
    """Particles of the liquids of an instance."""

    position: F64
    """[m], shape (n, 3)."""
    velocity: F64
    """[m/s], shape (n, 3)."""
    mass: F64
    """[kg], shape (n,)."""
    volume: F64
    """[m^3], shape (n,)."""
    fluid: I64
    """Index of the liquid of each, shape (n,)."""


def pushed(fields: Sequence[Fields], matter: Matter, time: float, spacing: float, solid: F64) -> tuple[F64, Push]:
    """Accelerations [m/s^2], shape (n, 3), and pushes of media on the particles of an instance at `time` [s].

    Args:
        fields: of each liquid.
        matter: the particles.
        time: [s]
        spacing: distance of particles at rest, or size of a cell [m].
        solid: points on the surfaces of solids [m], shape (k, 3).
    """
    place = matter.position
    gain, push = np.zeros_like(place), Push(np.zeros_like(place), np.zeros(len(place)))
    area, share = None, None
    for index in np.unique(matter.fluid).tolist():
        own = fields[index]
        if not own.acts(time, time + 1e-9):
            continue
        rows = np.flatnonzero(matter.fluid == index)
        gain[rows] = own.acceleration(place[rows], time)
        if not own.has_medium:
            continue
        if area is None or share is None:
            area, share = outer_area(place, matter.volume, spacing)
            area[in_lee(place, solid, spacing)] = 0.0
        rows = rows[np.abs(area[rows]).max(axis=1) > 0]
        medium, velocity = own.medium(place[rows], time), matter.velocity[rows]
        push.force[rows], push.rate[rows] = push_on_liquid(
            medium, velocity, matter.mass[rows], matter.volume[rows], area[rows], share[rows]
        )
    return gain, push
