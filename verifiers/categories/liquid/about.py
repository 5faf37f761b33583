"""Which liquid stands about a body: what it touches, and what no solid keeps from it.

What lies lower than the water near by is not under water for that: it may lie behind a wall, or in an empty vessel. A part of a body
counts as under water where it is lower than the liquid about it and liquid touches it, or touches the body elsewhere with a way there
that stays in the body and lower than the liquid, and no other solid between. A body that drives all liquid from where it is thus
counts whole, its inside included; one that hangs over a wall counts on the wet side alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....geometry import Solid
from ....worlds.arrays import F64
from .samples import sample_inside, scattered
from .solids import pieces_of, rows_within

if TYPE_CHECKING:
    from .frames import Liquid
    from .solids import Piece

__all__ = ["COLUMN", "Hull", "Surroundings", "hull_of", "others_than"]

REACH = 2.0
"""[spacings] Liquid this near to a surface touches it: particles stay up to one away, and as much again where they are in motion."""
NEAREST = 4
"""Own choice: a way to liquid is looked for from or to so many of the nearest points."""
LINKS = 12
"""Own choice: points of a body that one of them is joined to."""
SKIN = 600
"""Own choice: points on the surface of a body at which it is asked whether liquid touches it, about."""
COLUMN = 1.5
"""[spacings] Width of a column of liquid: no gap of a resting liquid is as wide."""


@dataclass(frozen=True)
class Hull:
    """Points of a body, in its frame or the world [m]."""

    inside: F64
    """Each for an equal share of its volume, shape (n, 3)."""
    skin: F64
    """On its surface, shape (m, 3)."""


def hull_of(liquid: Liquid, name: str) -> Hull:
    """Points of a body, called `entity/body`, in its frame."""
    entity, body = name.split("/")
    solids = [Solid.from_mesh(p.render, closed=p.closed) for p in liquid.candidate.entity(entity).parts_of(body)]
    # `scattered` sets four points per square of its spacing.
    spacing = max(liquid.spacing, 2.0 * float(np.sqrt(sum(s.area for s in solids) / SKIN)))
    skin = np.concatenate([scattered(s, spacing, s.lower, s.upper)[0] for s in solids])
    return Hull(sample_inside(liquid, name), skin)


def others_than(liquid: Liquid, entity: str) -> tuple[Piece, ...]:
    """Parts of all other rigid entities: what can keep liquid from it."""
    return tuple(p for p in pieces_of(liquid.candidate) if p.entity != entity)


class Surroundings:
    """A body among liquid and other solids at one frame."""

    def __init__(self, liquid: Liquid, walls: tuple[Piece, ...], index: int, hull: Hull, position: F64) -> None:
        """Find where liquid touches the body.

        Args:
            liquid: the instance.
            walls: solids that can stand between.
            index: the frame.
            hull: points of the body in the world.
            position: particles in the world [m], shape (n, 3).
        """
        from scipy.spatial import cKDTree

        self.walls, self.index, self.hull = walls, index, hull
        reach = REACH * liquid.spacing
        low, high = hull.skin.min(axis=0) - reach, hull.skin.max(axis=0) + reach
        near = rows_within(position, np.nextafter(low, np.inf), np.nextafter(high, -np.inf))
        self.touched: NDArray[np.bool_] = np.zeros(len(hull.skin), dtype=bool)
        """Which points of the skin liquid touches."""
        self.touching: NDArray[np.intp] = near[:0]
        """Rows of the particles that do."""
        if len(near):
            _, at = cKDTree(position[near]).query(hull.skin, k=NEAREST, distance_upper_bound=reach)
            point, which = np.nonzero(at < len(near))
            rows = near[at[point, which]]
            clear = ~self._between(hull.skin[point], position[rows])
            self.touched[point[clear]] = True
            self.touching = np.unique(rows[clear])

    def _between(self, start: F64, end: F64) -> NDArray[np.bool_]:
        """Which straight ways lead through another solid."""
        found = np.zeros(len(start), dtype=bool)
        if not len(start):
            return found
        for wall in self._meeting(np.minimum(start, end).min(axis=0), np.maximum(start, end).max(axis=0)):
            rows = np.flatnonzero(~found)
            found[rows] = wall.between(start[rows], end[rows], self.index)
        return found

    @cached_property
    def _boxes(self) -> tuple[F64, F64]:
        """Corners of the boxes of all walls [m], each shape (walls, 3)."""
        boxes = np.array([w.box(self.index) for w in self.walls]).reshape(-1, 2, 3)
        return boxes[:, 0], boxes[:, 1]

    def _meeting(self, low: F64, high: F64) -> list[Piece]:
        """Walls whose boxes meet a box."""
        lowest, highest = self._boxes
        return [self.walls[k] for k in np.flatnonzero(((lowest <= high) & (highest >= low)).all(axis=1))]

    def in_sight(self, position: F64) -> NDArray[np.bool_]:
        """Which places no other solid hides from the nearest points that liquid touches, shape (n,)."""
        from scipy.spatial import cKDTree

        wet = self.hull.skin[self.touched]
        if not len(wet) or not len(position):
            return np.zeros(len(position), dtype=bool)
        count = min(NEAREST, len(wet))
        at = np.asarray(cKDTree(wet).query(position, k=count)[1]).reshape(len(position), count)
        seen = np.zeros(len(position), dtype=bool)
        for which in at.T:
            rows = np.flatnonzero(~seen)
            seen[rows] = ~self._between(wet[which[rows]], position[rows])
        return seen

    def tops(self, position: F64, flat: F64, height: F64, near: NDArray[np.intp], width: float) -> NDArray[np.intp]:
        """Rows of the highest particles of the columns about the body that no solid hides from it.

        Where all are hidden, as from what lies in a full pipe under a lake, those of what touches the body.

        Args:
            position: particles in the world [m], shape (n, 3).
            flat: across `up` [m], shape (n, 2).
            height: along `up` [m], shape (n,).
            near: rows of those about the body.
            width: of a column [m].
        """
        rows = _highest(flat, height, near, width)
        rows = rows[self.in_sight(position[rows])]
        return rows if len(rows) else _highest(flat, height, self.touching, width)

    def wet(self, inside: NDArray[np.bool_], skin: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Which points inside the body, of those lower than the liquid about it, are joined to where liquid touches it, shape (n,).

        Args:
            inside: which points inside are lower.
            skin: which points of the skin are.
        """
        from scipy.sparse import coo_matrix
        from scipy.sparse.csgraph import connected_components
        from scipy.spatial import cKDTree

        within, around = np.flatnonzero(inside), np.flatnonzero(skin)
        result = np.zeros(len(inside), dtype=bool)
        touched = self.touched[around]
        if not len(within) or not touched.any():
            return result
        points = np.concatenate([self.hull.inside[within], self.hull.skin[around]])
        if not self._meeting(points.min(axis=0), points.max(axis=0)):
            result[within] = True
            return result
        count = min(LINKS + 1, len(points))
        at = np.asarray(cKDTree(points).query(points, k=count)[1]).reshape(len(points), count)
        one, other = np.repeat(np.arange(len(points)), count), at.reshape(-1)
        both = np.unique(np.minimum(one, other) * len(points) + np.maximum(one, other))
        one, other = np.divmod(both, len(points))
        clear = ~self._between(points[one], points[other])
        joined = coo_matrix((clear[clear], (one[clear], other[clear])), shape=(len(points), len(points)))
        _, part = connected_components(joined, directed=False)
        result[within] = np.isin(part[: len(within)], part[len(within) :][touched])
        return result


def _highest(flat: F64, height: F64, rows: NDArray[np.intp], width: float) -> NDArray[np.intp]:
    """Rows of those particles that are the highest of their columns."""
    if not len(rows):
        return rows
    column = np.floor(flat[rows] / width).astype(np.int64)
    order = np.lexsort((height[rows], column[:, 1], column[:, 0]))
    column = column[order]
    last = np.append((np.diff(column, axis=0) != 0).any(axis=1), True)
    return np.asarray(rows[order[last]])
