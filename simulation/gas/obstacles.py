"""Rigid bodies in a gas's box: open shares of its cells and faces, and the velocity of what closes them, as they move."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.solids import Solid
from ...worlds.arrays import F64, RigidPose
from ..bodies import resting
from ..liquid.filling import PlacedSolid
from .solids import corners_of, cut
from .thin_walls import crossed

if TYPE_CHECKING:
    from ...worlds.categories.gas.facts import Grid
    from ..boundaries import BodyState, Surround
    from .solids import Solids

__all__ = ["BodyPlace", "Obstacles", "body_place"]

REACH = 2.0
"""Cells from a surface within which distances are known; farther away only the side counts."""
HERE = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))


class BodyPlace(NamedTuple):
    """A rigid body's frame and motion."""

    position: F64
    rotation: F64
    center: F64
    velocity: F64
    spin: F64


class Obstacles:
    """The bodies that reach into a box.

    Args:
        surround: the bodies.
        grid: the box.
    """

    def __init__(self, surround: Surround, grid: Grid) -> None:
        self.grid = grid
        self._points = corners_of(grid.shape, grid.cell, grid.corner)
        shape = self._points.shape[:3]
        solids = [(row, PlacedSolid("", Solid.from_mesh(mesh, closed=True), HERE)) for row, mesh in surround.parts]
        self._moving = [(row, s) for row, s in solids if surround.boundaries[row].motion != "static"]
        self._distance = np.full(shape, REACH * grid.cell)
        self._thin = np.ones((*shape, 3), np.float32)
        rest = resting(surround)
        for row, solid in solids:
            if surround.boundaries[row].motion == "static":
                self._add(solid, body_place(rest, row, 0.0), self._distance, self._thin)
        self._standing = cut(self._distance)
        self._standing.opening[...] *= self._thin
        self.start = self.at(rest, 0.0)
        """Where they are at frame 0."""

    @property
    def moves(self) -> bool:
        """True where any of them may move."""
        return bool(self._moving)

    def at(self, bodies: BodyState, ahead: float) -> Solids:
        """Open shares some seconds ahead of a state, the bodies going on as they do in it."""
        if not self._moving:
            return self._standing
        distance, thin = self._distance.copy(), self._thin.copy()
        still = self._standing
        found = type(still)(still.room.copy(), still.opening.copy(), still.velocity.copy())
        regions = []
        for row, solid in self._moving:
            place = body_place(bodies, row, ahead)
            region, nearest = self._add(solid, place, distance, thin)
            if region is None:
                continue
            regions.append(region)
            speed = place.velocity + np.cross(place.spin, self._points[region][nearest] - place.center)
            found.velocity[region][nearest] = speed
        for region in regions:
            self._paste(region, cut(distance[region]), thin, found)
        return found

    def _add(
        self, solid: PlacedSolid, place: BodyPlace, distance: F64, thin: NDArray[np.float32]
    ) -> tuple[tuple[slice, ...] | None, NDArray[np.bool_]]:
        """Take a body into distances and thin walls; the corners that it can reach, and where it is nearest of all."""
        reach = REACH * self.grid.cell
        low, high = solid.box
        corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
        placed = corners @ place.rotation.T + place.position
        first = np.floor((placed.min(axis=0) - reach - self.grid.corner) / self.grid.cell).astype(int)
        last = np.ceil((placed.max(axis=0) + reach - self.grid.corner) / self.grid.cell).astype(int)
        count = np.array(self.grid.shape)
        first, last = np.clip(first, 0, count), np.clip(last, 0, count)
        if (last <= first).any():
            return None, np.zeros(0, bool)
        region = tuple(slice(int(a), int(b) + 1) for a, b in zip(first, last, strict=True))
        local = (self._points[region].reshape(-1, 3) - place.position) @ place.rotation
        own = _signed(solid, local, reach).reshape(distance[region].shape)
        nearest = own < distance[region]
        distance[region] = np.minimum(own, distance[region])
        thin[region] = np.minimum(thin[region], 1.0 - crossed(solid, local.reshape(*own.shape, 3), own, self.grid.cell))
        return region, nearest

    @staticmethod
    def _paste(region: tuple[slice, ...], part: Solids, thin: NDArray[np.float32], into: Solids) -> None:
        """Write the cells and faces of a region."""
        cells = tuple(slice(s.start, s.stop - 1) for s in region)
        into.room[cells] = part.room[:-1, :-1, :-1]
        for axis in range(3):
            faces = tuple(s if a == axis else cells[a] for a, s in enumerate(region))
            own = tuple(slice(None) if a == axis else slice(0, -1) for a in range(3))
            into.opening[faces][..., axis] = part.opening[own][..., axis] * thin[faces][..., axis]


def body_place(bodies: BodyState, row: int, ahead: float) -> BodyPlace:
    """Place and motion of a body some seconds after a state, going on as it does in it."""
    from scipy.spatial.transform import Rotation

    spin, velocity = bodies.angular_velocity[row], bodies.velocity[row]
    turn = Rotation.from_rotvec(spin * ahead).as_matrix()
    center = bodies.center[row] + ahead * velocity
    position = center - turn @ (bodies.center[row] - bodies.position[row])
    return BodyPlace(position, turn @ bodies.rotation[row], center, velocity, spin)


def _signed(solid: PlacedSolid, points: F64, reach: float) -> F64:
    """Distance to a solid, negative in it; at most `reach` (n,). The side is asked for by itself: single precision errs beside edges."""
    distance, _ = solid.signed(points, reach)
    size = np.minimum(np.abs(distance), reach)
    return np.where(solid.inside(points), -size, size)
