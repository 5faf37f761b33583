"""Outlines of bodies as seen along gravity, and which of two lies under the other.

Columns along gravity are laid through the smaller of both outlines. One body is under another in a column where the other has its highest
surface at or above the highest of the one, and its lowest at or above the lowest: what stands on a shelf has the shelf's bottom below it, and
is not under it. It is under the other if that holds in the column of the smaller one's centre, or in half of its columns.

Gaps in an outline that are narrower than the smaller body count as closed (a morphological closing: Serra, J. (1982), Image analysis and
mathematical morphology): that body could not be seen whole through them, as through a tree's crown or a net.

What hangs upright, as a window, is too thin to have anything within its outline: under it is what lies wholly lower, before its width, near it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.ndimage import grey_closing, grey_opening
from scipy.spatial import ConvexHull, QhullError

from .bounds import BENEATH, PLATE, REVEAL

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ....worlds.arrays import F64

__all__ = ["Seen", "frame_along", "in_hull", "is_under"]

COLUMNS = 24
"""Own choice: columns along each side of the smaller outline's rectangle; shares of it are known within a few hundredths."""
AT_ONCE = 1000
"""Triangles that are spread over columns together; it bounds the memory."""


class Seen(NamedTuple):
    """A body with its heights along the third axis."""

    triangles: F64
    """[m], shape (n, 3, 3)."""
    center: F64
    """Centre of mass [m], shape (3,)."""

    @property
    def ends(self) -> tuple[float, float]:
        """Least and greatest height [m]."""
        return float(self.triangles[..., 2].min()), float(self.triangles[..., 2].max())


def frame_along(gravity: F64) -> F64:
    """Rotation that brings the way against gravity to the third axis, shape (3, 3); none where nothing weighs anything."""
    strength = float(np.linalg.norm(gravity))
    up = np.array([0.0, 0.0, 1.0]) if strength == 0.0 else -gravity / strength
    if up[2] >= 1.0:
        return np.eye(3)
    first = np.cross(np.eye(3)[int(np.argmin(np.abs(up)))], up)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(up, first), up])


def is_under(lower: Seen, upper: Seen, slack: float) -> bool:
    """True where one body lies under another.

    Args:
        lower: the one.
        upper: the other.
        slack: depth that touching surfaces may reach into each other [m].
    """
    one, two = (_rectangle(s.triangles[..., :2].reshape(-1, 2)) for s in (lower, upper))
    for rectangle, plate in ((one, lower), (two, upper)):
        if _plate(rectangle[1], plate) and _before(lower, upper, plate, rectangle, slack):
            return True
    by_lower = float(np.prod(one[1])) <= float(np.prod(two[1]))
    own = lower if by_lower else upper
    turn, size, low = one if by_lower else two
    if not size.min() > 0.0:
        return False
    flat = np.array([[turn[0], turn[1], 0.0], [-turn[1], turn[0], 0.0], [0.0, 0.0, 1.0]])
    grid = _Grid(low, size / COLUMNS, 0.5 * float(size.min()))
    below, above = (grid.heights(s.triangles @ flat.T) for s in (lower, upper))
    under = np.isfinite(below[1]) & np.isfinite(above[1]) & (above[1] >= below[1] - slack) & (above[0] >= below[0] - slack)
    whole = np.isfinite((below if by_lower else above)[1])
    return grid.at(under, flat @ own.center) or bool(whole.any() and under.sum() >= BENEATH * whole.sum())


def in_hull(points: F64, center: F64) -> bool:
    """True where a point lies in the convex hull of others; False of what is flat."""
    try:
        planes = ConvexHull(points).equations
    except QhullError:
        return False
    return bool((planes[:, :3] @ center + planes[:, 3] <= 0.0).all())


def _rectangle(points: F64) -> tuple[F64, F64, F64]:
    """Least rectangle around points of a plane: direction of its first side, its sides [m] and its least corner along them, shapes (2,).

    Freeman, H. and Shapira, R. (1975), Communications of the ACM 18(7): one of its sides lies along one of the convex hull.
    """
    try:
        hull = points[ConvexHull(points).vertices]
    except QhullError:
        hull = points[[int(np.argmin(points.sum(axis=1))), int(np.argmax(points.sum(axis=1)))]]
    sides = np.roll(hull, -1, axis=0) - hull
    length = np.linalg.norm(sides, axis=1, keepdims=True)
    sides = np.concatenate([np.array([[1.0, 0.0]]), sides[length[:, 0] > 0.0] / length[length[:, 0] > 0.0]])
    across = np.stack([-sides[:, 1], sides[:, 0]], axis=1)
    along, over = hull @ sides.T, hull @ across.T
    size = np.stack([np.ptp(along, axis=0), np.ptp(over, axis=0)], axis=1)
    best = int(np.argmin(size.prod(axis=1)))
    return sides[best], size[best], np.array([along[:, best].min(), over[:, best].min()])


def _plate(size: F64, body: Seen) -> bool:
    """True of what stands or hangs upright and is thin, as a window or a banner."""
    low, high = body.ends
    return float(size.min()) <= PLATE * min(float(size.max()), high - low)


def _before(lower: Seen, upper: Seen, plate: Seen, rectangle: tuple[F64, F64, F64], slack: float) -> bool:
    """True where one body lies wholly lower than another, and both stand at the same stretch of the upright plate that one of them is."""
    if lower.ends[1] > upper.ends[0] + slack:
        return False
    turn, size, low = rectangle
    high, thin = low + size, int(np.argmin(size))
    points = (lower if plate is upper else upper).triangles[..., :2].reshape(-1, 2) @ np.array([turn, [-turn[1], turn[0]]]).T
    start, end = points.min(axis=0), points.max(axis=0)
    own, its = 0.5 * (start + end)[1 - thin], 0.5 * (low + high)[1 - thin]
    abreast = low[1 - thin] <= own <= high[1 - thin] or start[1 - thin] <= its <= end[1 - thin]
    gap = max(float(start[thin] - high[thin]), float(low[thin] - end[thin]), 0.0)
    reach = min(REVEAL, 0.5 * float(size.max()))
    if plate is upper:
        reach += 0.5 * float(end[thin] - start[thin])
    return bool(abreast and gap <= reach)


class _Grid:
    """Columns through a rectangle and around it by the width of the gaps that are closed."""

    def __init__(self, low: F64, step: F64, reach: float) -> None:
        self.step, self.reach = step, reach
        self.pad = np.ceil(reach / step).astype(int) + 1
        self.low = low - self.pad * step
        self.count = COLUMNS + 2 * self.pad

    def at(self, mask: NDArray[np.bool_], center: F64) -> bool:
        """Value of a mask at a point; False outside."""
        i = np.floor((center[:2] - self.low) / self.step).astype(int)
        return bool((i >= 0).all() and (i < self.count).all() and mask[i[0], i[1]])

    def heights(self, triangles: F64) -> tuple[F64, F64]:
        """Lowest and highest surface in each column [m], gaps closed; infinite where there is none."""
        lowest, highest = np.full(self.count, np.inf), np.full(self.count, -np.inf)
        cells = (triangles[..., :2] - self.low) / self.step - 0.5
        first = np.maximum(np.ceil(cells.min(axis=1)), 0).astype(int)
        last = np.minimum(np.floor(cells.max(axis=1)), self.count - 1).astype(int)
        some = np.flatnonzero((last >= first).all(axis=1))
        for chunk in np.array_split(some, max(1, -(-len(some) // AT_ONCE))):
            self._spread(cells[chunk], triangles[chunk, :, 2], first[chunk], last[chunk], lowest, highest)
        disc = self._disc()
        pad = [(int(p), int(p)) for p in self.pad]
        inner = tuple(slice(a, -a) for a, _ in pad)
        low = grey_opening(np.pad(lowest, pad, constant_values=np.inf), footprint=disc)[inner]
        high = grey_closing(np.pad(highest, pad, constant_values=-np.inf), footprint=disc)[inner]
        return low, high

    def _spread(self, cells: F64, height: F64, first: F64, last: F64, lowest: F64, highest: F64) -> None:
        """Enter the heights of triangles at the columns that they meet."""
        count = last - first + 1
        total = count.prod(axis=1)
        which = np.repeat(np.arange(len(cells)), total)
        k = np.arange(len(which)) - np.repeat(np.cumsum(total) - total, total)
        i, j = first[which, 0] + k // count[which, 1], first[which, 1] + k % count[which, 1]
        a, b, c = cells[which, 0], cells[which, 1], cells[which, 2]
        one, two, way = b - a, c - a, np.stack([i, j], axis=1) - a
        det = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
        inverse = np.where(np.abs(det) > 1e-12, 1.0 / np.where(det == 0.0, 1.0, det), np.nan)
        u = (way[:, 0] * two[:, 1] - way[:, 1] * two[:, 0]) * inverse
        v = (one[:, 0] * way[:, 1] - one[:, 1] * way[:, 0]) * inverse
        met = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1.0 + 1e-9)
        h = height[which]
        z = (h[:, 0] + u * (h[:, 1] - h[:, 0]) + v * (h[:, 2] - h[:, 0]))[met]
        np.minimum.at(lowest, (i[met], j[met]), z)
        np.maximum.at(highest, (i[met], j[met]), z)

    def _disc(self) -> F64:
        radius = np.floor(self.reach / self.step).astype(int)
        x, y = np.meshgrid(*(np.arange(-r, r + 1) for r in radius), indexing="ij")
        return np.asarray((x * self.step[0]) ** 2 + (y * self.step[1]) ** 2 <= self.reach**2 * (1.0 + 1e-9))
