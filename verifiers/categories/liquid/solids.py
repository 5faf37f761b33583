"""The solids that a liquid can meet, where they are at a frame, and how deep points lie in them.

The visible surface of every part of every rigid entity counts. Depth in a convex part is the distance to its nearest facet
plane; in any other it comes from a kernel (nearest triangle, winding number) in single precision about the part's middle,
which errs by some 1e-7 of the part's size.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....geometry import Solid
from ....geometry.launch import launch, warp
from ....worlds.arrays import F64, rotation_matrix
from .frames import Rows
from .outside import MANY, OutsideCells

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate

__all__ = ["Depth", "Piece", "deepest", "pieces_of", "rows_within"]

MOST_FACETS = 64
"""Own choice: a convex part of more facets goes to the kernel."""
NOWHERE = -1e30


@dataclass(frozen=True, eq=False)
class Piece:
    """One part of a rigid entity."""

    entity: str
    body: str
    part: str
    solid: Solid
    position: F64
    """Position of its body's frame [m], shape (frames, 3)."""
    turn: F64
    """Shape (frames, 3, 3)."""
    still: bool
    """True if it never moves."""
    solid_through: bool
    """True if its surface bounds a volume."""

    def local(self, points: F64, frame: int) -> F64:
        """World points in the body's frame."""
        return np.asarray((points - self.position[frame]) @ self.turn[frame])

    def world(self, points: F64, frame: int) -> F64:
        """Points of the body's frame in the world."""
        return np.asarray(points @ self.turn[frame].T + self.position[frame])

    def box(self, frame: int) -> tuple[F64, F64]:
        """Bounding box in the world [m]."""
        low, high = self._boxes
        return low[0 if self.still else frame], high[0 if self.still else frame]

    @cached_property
    def _boxes(self) -> tuple[F64, F64]:
        """Corners of its box at every frame, each shape (frames, 3); at the first one only where it is still."""
        corners = self.solid.vertices if len(self.solid.vertices) <= 64 else _corners(self.solid)
        count = 1 if self.still else len(self.position)
        placed = np.einsum("fij,cj->fci", self.turn[:count], corners) + self.position[:count, None]
        return placed.min(axis=1), placed.max(axis=1)

    @cached_property
    def _mesh(self) -> Any:
        """On the device, about its middle; the query needs the arrays that the mesh was made from."""
        wp = warp()
        points = wp.array(np.ascontiguousarray(self.solid.vertices - self.solid.sphere_center, dtype=np.float32), dtype=wp.vec3)
        faces = wp.array(np.ascontiguousarray(self.solid.faces.reshape(-1)), dtype=wp.int32)
        return wp.Mesh(points, faces, support_winding_number=True)

    def depth(self, points: F64, least: float = 0.0) -> F64:
        """Depth of points of the body's frame [m], shape (n,): positive inside, not above zero outside.

        Depths of at most `least` may be told as 0, which costs less.
        """
        solid = self.solid
        result = np.full(len(points), NOWHERE)
        if not self.solid_through:
            return result
        near = rows_within(points, solid.lower, solid.upper)
        if len(near) == 0:
            return result
        if solid.convex and len(solid.facets.offsets) <= MOST_FACETS:
            result[near] = (solid.facets.offsets - points[near] @ solid.facets.normals.T).min(axis=1)
            return result
        sides = None
        if len(near) >= MANY:
            rows, sides = self._outside.near(points[near])
            near = near[rows]
        result[near] = self._measured(points[near], sides, least)
        return result

    @cached_property
    def _outside(self) -> OutsideCells:
        return OutsideCells(self.solid, self._measured)

    def _measured(self, points: F64, sides: F64 | None = None, least: float = 0.0) -> F64:
        """Distance of points of the body's frame to the surface [m], shape (n,): positive inside, negative outside, 0 below `least`.

        Args:
            points: shape (n, 3).
            sides: by point, such a distance of a place whose side is known, and how far that is away, shape (n, 2).
            least: [m], at least 0.
        """
        from .kernels import depth

        wp = warp()
        found = wp.zeros(len(points), dtype=float, device="cpu")
        known = np.tile([0.0, np.inf], (len(points), 1)) if sides is None else sides
        asked = _placed(points, self.solid), wp.array(known.astype(np.float32), dtype=wp.vec2, device="cpu")
        reach = float(2.0 * self.solid.size)
        launch(depth, len(points), [self._mesh.id, *asked, reach, max(least, 0.0), found], device="cpu")
        return np.asarray(found.numpy(), dtype=np.float64)

    def between(self, start: F64, end: F64, frame: int) -> NDArray[np.bool_]:
        """Which straight ways between world points, each shape (n, 3), meet its surface at a frame, shape (n,)."""
        low, high = self.box(frame)
        result = np.zeros(len(start), dtype=bool)
        near = np.flatnonzero(((np.minimum(start, end) <= high) & (np.maximum(start, end) >= low)).all(axis=1))
        if len(near) == 0:
            return result
        from .kernels import met

        wp = warp()
        ends = [_placed(self.local(p[near], frame), self.solid) for p in (start, end)]
        found = wp.zeros(len(near), dtype=wp.uint8, device="cpu")
        launch(met, len(near), [self._mesh.id, *ends, found], device="cpu")
        result[near] = found.numpy() > 0
        return result


def _placed(points: F64, solid: Solid) -> Any:
    """Points about the middle of a solid, on the device."""
    wp = warp()
    return wp.array(np.ascontiguousarray(points - solid.sphere_center, dtype=np.float32), dtype=wp.vec3, device="cpu")


def _corners(solid: Solid) -> F64:
    low, high = solid.lower, solid.upper
    return np.array([[(low, high)[k >> a & 1][a] for a in range(3)] for k in range(8)])


def rows_within(points: F64, low: F64, high: F64) -> Rows:
    """Rows of the points that lie in a box or on its sides, axis by axis, so that most are looked at once."""
    rows = np.arange(len(points))
    for axis in range(points.shape[1]):
        along = points[rows, axis] if axis else points[:, 0]
        rows = rows[(along >= low[axis]) & (along <= high[axis])]
    return rows


def pieces_of(candidate: Candidate) -> tuple[Piece, ...]:
    """All parts of all rigid entities, made once per candidate."""
    return candidate.memo("pieces beside liquids", lambda: _pieces(candidate))


def _pieces(candidate: Candidate) -> tuple[Piece, ...]:
    found = []
    for name, contract in candidate.spec.entities.items():
        if contract.physics.category != "rigid":
            continue
        for part in candidate.entity(name).parts:
            position, quaternion = candidate.track(name, part.body)
            still = candidate.cache_row(name, part.body) is None or bool(
                (position == position[:1]).all() and (quaternion == quaternion[:1]).all()
            )
            solid = Solid.from_mesh(part.render, closed=part.closed)
            found.append(
                Piece(
                    name,
                    part.body,
                    part.part,
                    solid,
                    position,
                    rotation_matrix(quaternion),
                    still,
                    part.closed and solid.is_watertight,
                )
            )
    return tuple(found)


@dataclass(frozen=True)
class Depth:
    """Points in a solid."""

    piece: Piece
    rows: Rows
    """Which points."""
    value: F64
    """Depths of the points [m]."""


def deepest(pieces: tuple[Piece, ...], points: F64, frame: int, least: float) -> list[Depth]:
    """Points that lie deeper than `least` [m] in a solid at a frame, per solid."""
    if len(points) == 0:
        return []
    low, high = points.min(axis=0), points.max(axis=0)
    found = []
    for piece in pieces:
        box_low, box_high = piece.box(frame)
        if (box_low > high).any() or (box_high < low).any():
            continue
        near = rows_within(points, box_low, box_high)
        if len(near) == 0:
            continue
        value = piece.depth(piece.local(points[near], frame), least)
        rows = value > least
        if rows.any():
            found.append(Depth(piece, near[rows], value[rows]))
    return found
