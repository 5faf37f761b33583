"""Films that solids carry from one surface to another: the tracks of wet wheels and boots (declared law in `worlds/categories/liquid/wet.py`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, RigidPose, rotation_matrix

if TYPE_CHECKING:
    from .wet import WetPart

__all__ = ["Tracks", "sweeps"]

LEAST = 0.05
"""Own choice: thinner films are not carried on."""
FACING = -0.5
"""Largest cosine between the normals of places that meet."""
MOST_LOOKS = 16
"""Between two frames; bodies that move farther leave tracks with gaps."""


def sweeps(parts: Sequence[WetPart], reach: tuple[F64, F64], frames: int, margin: float) -> list[tuple[F64, F64]]:
    """Boxes, with a margin [m], through which bodies that came into reach of the liquid went on: their films may be carried that far."""
    found = []
    for part in (p for p in parts if not p.still):
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        wet = False
        for frame in range(frames):
            pose = part.place(frame)
            if pose is None:
                continue
            points = pose.apply(part.mesh.vertices)
            least, most = points.min(axis=0), points.max(axis=0)
            wet |= bool((most >= reach[0]).all() and (least <= reach[1]).all())
            if wet:
                low, high = np.minimum(low, least), np.maximum(high, most)
        if wet and ((low < reach[0]).any() or (high > reach[1]).any()):
            found.append((low - margin, high + margin))
    return found


class Tracks:
    """Films on all places, frame by frame.

    Args:
        texels: the places.
        groups: rows of each part's.
        parts: of the solids.
        size: distance of places [m].
        gap: surfaces this near to each other touch [m].
        drying: of the film of each liquid [s].
        step: between frames [s].
    """

    def __init__(
        self, texels: dict[str, Any], groups: Sequence[NDArray[np.intp]], parts: Sequence[WetPart],
        *, size: float, gap: float, drying: F64, step: float,
    ) -> None:  # fmt: skip
        self._position = texels["texel/position"].astype(np.float64)
        self._normal = texels["texel/normal"].astype(np.float64)
        self._groups, self._parts = groups, parts
        self._size, self._gap, self._drying, self._step = size, gap, drying, step
        count = len(self._position)
        self._film, self._fluid = np.zeros(count), np.full(count, -1, dtype=np.int32)
        self._moving = [k for k, p in enumerate(parts) if not p.still and len(groups[k])]
        self._kept: dict[int, F64] = {}
        self._corners = {k: _corners(parts[k].mesh.vertices) for k in self._moving}

    def take(self, found: dict[str, Any]) -> None:
        """Take over a frame that was made before, after all frames before it."""
        self._fade()
        self._wetted(found)
        self._film[found["track/texel"]] = found["track/film"]
        self._fluid[found["track/texel"]] = found["track/fluid"]

    def follow(self, frame: int, found: dict[str, Any]) -> dict[str, Any]:
        """Track channels of the next frame, whose wet places are `found`."""
        self._fade()
        before = self._film.copy()
        under = np.zeros(len(before), dtype=bool)
        under[found["wet/texel"]] = True
        self._wetted(found)
        met = np.zeros(len(before), dtype=bool)
        if self._moving and (self._film > LEAST).any():
            for share in self._looks(frame):
                self._meet(frame, share, under, met)
        # What the channel holds is read back in single precision.
        rows = np.flatnonzero(met & ~under).astype(np.int32)
        self._film[rows] = self._film[rows].astype(np.float32)
        return {"track/texel": rows, "track/film": self._film[rows].astype(np.float32), "track/fluid": self._fluid[rows]}

    def _fade(self) -> None:
        self._film *= np.exp(-self._step / self._drying[np.maximum(self._fluid, 0)])

    def _wetted(self, found: dict[str, Any]) -> None:
        self._film[found["wet/texel"]], self._fluid[found["wet/texel"]] = 1.0, found["wet/fluid"]

    def _looks(self, frame: int) -> F64:
        """Shares of the way from the frame before at which to look, so that nothing goes farther than a place in between."""
        farthest = 0.0
        for k in self._moving:
            a, b = self._parts[k].place(max(frame - 1, 0)), self._parts[k].place(frame)
            if a is not None and b is not None:
                way = b.apply(self._corners[k]) - a.apply(self._corners[k])
                farthest = max(farthest, float(np.linalg.norm(way, axis=1).max()))
        count = int(np.clip(np.ceil(farthest / self._size), 1, MOST_LOOKS))
        return np.asarray((np.arange(count) + 1) / count)

    def _pose(self, k: int, frame: int, share: float) -> RigidPose | None:
        part = self._parts[k]
        last, now = part.place(max(frame - 1, 0)), part.place(frame)
        if part.still or last is None or now is None or share >= 1.0:
            return now
        turn = now.quaternion if last.quaternion @ now.quaternion >= 0 else -now.quaternion
        between = (1.0 - share) * last.quaternion + share * turn
        return RigidPose((1.0 - share) * last.position + share * now.position, between / np.linalg.norm(between))

    def _meet(self, frame: int, share: float, under: NDArray[np.bool_], met: NDArray[np.bool_]) -> None:
        """Share films between surfaces that touch at one time; marks the places that they changed on."""
        from scipy.spatial import cKDTree

        poses = [self._pose(k, frame, share) if len(g) else None for k, g in enumerate(self._groups)]
        placed = {k: self._placed(k, pose) for k, pose in enumerate(poses) if pose is not None}
        boxes = {k: (p.min(axis=0) - self._size, p.max(axis=0) + self._size) for k, p in placed.items()}
        for a in (k for k in self._moving if k in placed):
            for b in placed:
                if b == a or (b in self._moving and b < a) or self._parts[b].names[:2] == self._parts[a].names[:2]:
                    continue
                if (boxes[a][0] > boxes[b][1]).any() or (boxes[b][0] > boxes[a][1]).any():
                    continue
                near = np.flatnonzero(((placed[b] >= boxes[a][0]) & (placed[b] <= boxes[a][1])).all(axis=1))
                mine = np.flatnonzero(((placed[a] >= boxes[b][0]) & (placed[a] <= boxes[b][1])).all(axis=1))
                if len(near) and len(mine):
                    tree = cKDTree(placed[a][mine])
                    distance, at = tree.query(placed[b][near], distance_upper_bound=1.5 * self._size)
                    close = np.isfinite(distance)
                    self._split(a, b, poses, placed, mine[at[close]], near[close], under, met)

    def _placed(self, k: int, pose: RigidPose) -> F64:
        """Places of a part in the world; those of parts that stay are kept."""
        if k in self._kept:
            return self._kept[k]
        found = pose.apply(self._position[self._groups[k]])
        if self._parts[k].still:
            self._kept[k] = found
        return found

    def _split(
        self, a: int, b: int, poses: Sequence[RigidPose | None], placed: dict[int, F64], mine: NDArray[np.intp],
        theirs: NDArray[np.intp], under: NDArray[np.bool_], met: NDArray[np.bool_],
    ) -> None:  # fmt: skip
        pose_a, pose_b = poses[a], poses[b]
        assert pose_a is not None
        assert pose_b is not None
        rows_a, rows_b = self._groups[a][mine], self._groups[b][theirs]
        out_a = self._normal[rows_a] @ rotation_matrix(pose_a.quaternion).T
        out_b = self._normal[rows_b] @ rotation_matrix(pose_b.quaternion).T
        apart = np.abs(((placed[a][mine] - placed[b][theirs]) * out_b).sum(axis=1))
        touch = (apart <= self._gap) & ((out_a * out_b).sum(axis=1) <= FACING)
        rows_a, rows_b, apart = rows_a[touch], rows_b[touch], apart[touch]
        # Each place meets one other: that nearest to it.
        for rows in (0, 1):
            pick = np.lexsort((apart, (rows_a, rows_b)[rows]))
            kept = np.unique((rows_a, rows_b)[rows][pick], return_index=True)[1]
            rows_a, rows_b, apart = rows_a[pick][kept], rows_b[pick][kept], apart[pick][kept]
        film_a, film_b = self._film[rows_a], self._film[rows_b]
        wet = np.maximum(film_a, film_b) > LEAST
        rows_a, rows_b, film_a, film_b = rows_a[wet], rows_b[wet], film_a[wet], film_b[wet]
        both = 0.5 * (film_a + film_b)
        kind = np.where(film_a >= film_b, self._fluid[rows_a], self._fluid[rows_b])
        for rows in (rows_a, rows_b):
            dry = ~under[rows]
            self._film[rows[dry]], self._fluid[rows[dry]] = both[dry], kind[dry]
            met[rows] = True


def _corners(points: F64) -> F64:
    """Corners of the box around points (8, 3)."""
    ends = np.stack([points.min(axis=0), points.max(axis=0)])
    return np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
