"""Space around solids cut into cubes: closed where a surface passes through, open elsewhere (for `categories/liquid/leaks.py` and others)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....geometry.inside import contains, distance_to_surface
from ....geometry.launch import launch, warp
from ....worlds.arrays import F64
from .samples import triangles_by_parts
from .solids import Piece, pieces_of, rows_within

if TYPE_CHECKING:
    from .frames import Liquid

__all__ = ["OFF", "Barrier", "barriers_of", "liquid_space", "still_barrier"]

CUBE = 0.5
"""[spacings] Size of a cube."""
THICK = 0.35
"""[cubes] Surfaces are sampled on both sides at this distance too, so that no chain of cubes slips between samples."""
MOST_CUBES = 48_000_000
"""Own choice: larger spaces get larger cubes."""
POCKET = 64
"""[cubes] Open spaces smaller than this, between surfaces that nearly touch, count as closed: no liquid is resolved in them."""
MARGIN = 4.0
"""[spacings] of space around the places where liquid is."""
SKIN = 0.5
"""[cubes] A particle no deeper than this in a solid lies at its surface: how deep any may lie is judged by `categories/liquid/walls.py`."""
QUICK = 8192
"""Elements of a slice of the kernel that follows particles: most of them are far from any surface, and done in nanoseconds."""
LEAST_SHARE = 0.1
"""Own choice: of a barrier that turns so far within a frame every particle is followed."""
OFF = np.array([0.37, 0.41, 0.43])
"""[cubes] by which the corner of a space lies off the planes that people build on, so that slits do not fall between cubes."""


@dataclass(frozen=True, eq=False)
class Barrier:
    """Solids that keep their places among each other, in a frame of their own."""

    pieces: tuple[Piece, ...]
    low: F64
    """Least corner of the space around them [m], in their frame."""
    high: F64
    cube: float

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Cubes along each axis."""
        return tuple(int(n) for n in np.maximum(np.ceil((self.high - self.low) / self.cube), 1))

    @cached_property
    def closed(self) -> NDArray[np.bool_]:
        """Cubes that a surface passes through."""
        from .way_kernels import mark

        wp = warp()
        grid = np.zeros(self.shape, dtype=np.uint8)
        target = _on_device(grid)
        for piece in self.pieces:
            turn = piece.turn[0] if self.world else np.eye(3)
            at = piece.position[0] if self.world else np.zeros(3)
            for triangles, normals, parts in triangles_by_parts(piece.solid, 0.5 * self.cube, *self._local_box(piece)):
                given = [
                    *(wp.array(np.ascontiguousarray(a), dtype=wp.vec3d, device="cpu") for a in (triangles, normals)),
                    *(int(parts), wp.float64(THICK * self.cube), wp.mat33d(*turn.ravel()), wp.vec3d(*at)),
                    *(wp.vec3d(*self.low), wp.float64(self.cube), target),
                ]
                launch(mark, len(triangles), given, device="cpu")
        return _filled(grid.view(bool))

    @cached_property
    def outer(self) -> NDArray[np.bool_]:
        """Open cubes outside of solids."""
        from scipy.ndimage import find_objects, label

        marks, count = label(~self.closed)
        first = np.zeros((count, 3), dtype=np.intp)
        for number, box in enumerate(find_objects(marks)):
            at = np.unravel_index(int(np.argmax(marks[box] == number + 1)), marks[box].shape)
            first[number] = [k + side.start for k, side in zip(at, box, strict=True)]
        middle = self.low + (first + 0.5) * self.cube
        outside = np.ones(count + 1, dtype=bool)
        for piece in self.pieces:
            if piece.solid_through:
                outside[1:] &= ~contains(piece.solid, piece.local(middle, 0) if self.world else middle)
        outside[0] = False
        return np.asarray(outside[marks])

    @cached_property
    def ways(self) -> list[Any]:
        """Corner, size and state of the cubes, as kernels take them."""
        wp = warp()
        return [wp.vec3d(*self.low), wp.float64(self.cube), _on_device(self.closed.view(np.uint8))]

    def _local_box(self, piece: Piece) -> tuple[F64, F64]:
        if not self.world:
            return self.low, self.high
        corner = np.array([[(self.low, self.high)[k >> a & 1][a] for a in range(3)] for k in range(8)])
        local = piece.local(corner, 0)
        return local.min(axis=0), local.max(axis=0)

    @property
    def world(self) -> bool:
        """True if its frame is the world."""
        return self.pieces[0].still

    def pose(self, frame: int) -> tuple[F64, F64]:
        """Turn and place of its frame in the world at a frame."""
        return (np.eye(3), np.zeros(3)) if self.world else (self.pieces[0].turn[frame], self.pieces[0].position[frame])

    def met(self, now: F64, before: F64, longest: float, frame: int) -> NDArray[np.bool_]:
        """Which particles' ways, seen from it, may meet its space in the interval that ends at a frame, shape (n,); some others too.

        Args:
            now: places in the world at the frame [m], shape (n, 3).
            before: places at the frame before, NaN where there is none.
            longest: length of the longest way [m].
            frame: index of the frame.
        """
        (turn, at), (turned, was) = self.pose(frame), self.pose(max(frame - 1, 0))
        middle, radius = 0.5 * (self.low + self.high), 0.5 * float(np.linalg.norm(self.high - self.low))
        here, there = turn @ middle + at, turned @ middle + was
        # From the nearer end, at a distance d, the way leads at most half its length towards it: that is longer by d |turn - turned|.
        share = 1.0 - 0.5 * float(np.linalg.norm(turn - turned))
        if self.world or share < LEAST_SHARE:
            return np.ones(len(now), dtype=bool)
        reach = (radius + 0.5 * (longest + float(np.linalg.norm(here - there)))) / share
        found = np.zeros(len(now), dtype=bool)
        for ends, centre in ((now, here), (before, there)):
            found[rows_within(ends, centre - reach, centre + reach)] = True
        return found

    def cells(self, points: F64) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        """Cubes of points of its frame, shape (n, 3), and which lie in the space."""
        cell = np.floor((points - self.low) / self.cube).astype(np.intp)
        return cell, np.asarray(((cell >= 0) & (cell < np.array(self.shape))).all(axis=1))

    def beside(self, points: F64) -> F64:
        """Middle of the open cube nearest to each point; NaN where none is within two cubes."""
        from .way_kernels import beside

        wp = warp()
        found = wp.zeros(len(points), dtype=wp.vec3d, device="cpu")
        launch(beside, len(points), [_vectors(points), *self.ways, found], device="cpu")
        result: F64 = found.numpy()
        return result

    def deeper(self, points: F64, others: F64) -> NDArray[np.bool_]:
        """Where the other point lies inside a part and the point itself does not, or no deeper than `SKIN`."""
        found = np.zeros(len(points), dtype=bool)
        for piece in self.pieces if len(points) else ():
            if piece.solid_through:
                own, other = ((piece.local(x, 0) if self.world else x) for x in (points, others))
                rows = np.flatnonzero(contains(piece.solid, other))
                inside = contains(piece.solid, own[rows])
                inside[inside] = distance_to_surface(piece.solid, own[rows[inside]]).distance > SKIN * self.cube
                found[rows] |= ~inside
        return found

    def blocked(self, start: F64, end: F64) -> NDArray[np.bool_]:
        """Which straight ways lead through closed cubes."""
        from .way_kernels import blocked

        wp = warp()
        found = wp.zeros(len(start), dtype=wp.uint8, device="cpu")
        launch(blocked, len(start), [_vectors(start), _vectors(end), *self.ways, found], device="cpu")
        return np.asarray(found.numpy().view(bool))

    def follow(self, now: Any, before: Any, *, waiting: F64, frame: int) -> tuple[F64, F64, NDArray[np.bool_], NDArray[np.bool_]]:
        """Particles followed by one frame: where they are, where their way began, which are in closed cubes, which came through some.

        Args:
            now: world positions [m] on the device, shape (n,).
            before: those of the frame before, NaN where there is none.
            waiting: where those in closed cubes were last in an open one, in its frame; NaN elsewhere, shape (n, 3).
            frame: index of the present frame.
        """
        from .way_kernels import SHUT, THROUGH, follow

        wp = warp()
        low, cube, grid = self.ways
        here, start = (wp.empty(len(waiting), dtype=wp.vec3d, device="cpu") for _ in range(2))
        flags = wp.empty(len(waiting), dtype=wp.uint8, device="cpu")
        poses = [p for k in (frame, max(frame - 1, 0)) for p in self.pose(k)]
        turned = [wp.mat33d(*p.ravel()) if p.ndim == 2 else wp.vec3d(*p) for p in poses]
        spaces = [grid, _on_device((~self.outer).view(np.uint8))]
        given = [now, before, _vectors(waiting), *turned, low, wp.vec3d(*self.high), cube, *spaces, here, start, flags]
        launch(follow, len(waiting), given, device="cpu", slice_size=QUICK)
        flag = flags.numpy()
        return here.numpy(), start.numpy(), flag == int(SHUT), flag == int(THROUGH)

    def nearest(self, point: F64) -> Piece:
        """The piece whose surface is nearest to a point of the barrier's frame."""
        local = [(p.local(point[None], 0) if self.world else point[None]) for p in self.pieces]
        near = [
            p
            for p, x in zip(self.pieces, local, strict=True)
            if ((x[0] >= p.solid.lower - 8 * self.cube) & (x[0] <= p.solid.upper + 8 * self.cube)).all()
        ]
        chosen = near or list(self.pieces)
        return min(
            chosen,
            key=lambda p: float(distance_to_surface(p.solid, p.local(point[None], 0) if self.world else point[None]).distance[0]),
        )


def _vectors(points: F64) -> Any:
    """Points on the device."""
    wp = warp()
    return wp.array(np.ascontiguousarray(points, dtype=np.float64), dtype=wp.vec3d, device="cpu")


def _on_device(grid: NDArray[np.uint8]) -> Any:
    """The grid itself as the device sees it; what a kernel writes there is written into it."""
    wp = warp()
    return wp.array(grid, dtype=wp.uint8, device="cpu", copy=False)


def liquid_space(liquid: Liquid) -> tuple[F64, F64, float] | None:
    """Corners of the space about all places where a liquid's particles are [m], and the size of its cubes; None without any."""
    low, high = liquid.extent
    if not np.isfinite(low).all():
        return None
    margin = MARGIN * liquid.spacing
    low, high = (np.clip(x, liquid.lower - margin, liquid.upper + margin) for x in (low - margin, high + margin))
    return low, high, _size(low, high, CUBE * liquid.spacing)


def still_barrier(liquid: Liquid) -> Barrier | None:
    """All solids that stand still where the liquid gets to, made once per liquid; None where there are none."""
    return liquid.candidate.memo(("still barrier", liquid), lambda: _still_barrier(liquid))


def _still_barrier(liquid: Liquid) -> Barrier | None:
    space = liquid_space(liquid)
    still = () if space is None else tuple(p for p in pieces_of(liquid.candidate) if p.still and _meet(p.box(0), space[:2]))
    return Barrier(still, space[0] - OFF * space[2], space[1], space[2]) if space is not None and still else None


def barriers_of(liquid: Liquid) -> list[Barrier]:
    """Barriers that reach into the space that the liquid fills at some frame."""
    space = liquid_space(liquid)
    if space is None:
        return []
    low, high, cube = space
    margin = MARGIN * liquid.spacing
    still = still_barrier(liquid)
    made = [still] if still is not None else []
    pieces = pieces_of(liquid.candidate)
    for key in dict.fromkeys((p.entity, p.body) for p in pieces if not p.still):
        mine = tuple(p for p in pieces if (p.entity, p.body) == key)
        least = np.min([p.solid.lower for p in mine], axis=0) - margin
        most = np.max([p.solid.upper for p in mine], axis=0) + margin
        size = _size(least, most, cube)
        if any(_meet(p.box(k), (low, high)) for p in mine for k in range(0, liquid.frames, 4)):
            made.append(Barrier(mine, least - OFF * size, most, size))
    return made


def _size(low: F64, high: F64, wanted: float) -> float:
    return max(wanted, float(np.cbrt(np.prod(high - low) / MOST_CUBES)))


def _filled(grid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The grid with small open pockets closed."""
    from scipy.ndimage import label

    marks, count = label(~grid)
    small = np.bincount(marks.ravel(), minlength=count + 1) < POCKET
    small[0] = True
    return np.asarray(small[marks])


def _meet(a: tuple[F64, F64], b: tuple[F64, F64]) -> bool:
    return bool((a[0] <= b[1]).all() and (a[1] >= b[0]).all())
