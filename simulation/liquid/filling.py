"""Fill a volume with particles: a lattice that fits it, relaxed where walls or slopes would cut its cells.

Particles keep half a spacing from surfaces, and there are as many as the free volume holds cells of one spacing, so that the
liquid starts near its rest density with the volume that was declared.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.inside import contains
from ...geometry.launch import launch, warp
from ...geometry.solids import Solid
from ...worlds.arrays import F64, RigidPose, compose

__all__ = ["Filling", "PlacedSolid", "blocked_share", "boxes_meet", "fill"]

HALF = 0.5
"""Distance from surfaces in spacings."""
SNUG = 0.45
"""Own choice: particles at least so many spacings from every surface need no relaxation."""
PASSES = 40
"""Own choice: of the relaxation; movements fall below a hundredth of a spacing after some thirty."""
AGAIN = 5
"""Passes between looks for the particles that are near a surface."""
MANY = 200_000
"""From so many particles on, fewer passes are made."""
SIGHT = 3.0
"""Farther from a surface than so many spacings nothing needs to know how far."""
SUBSAMPLES = 2
"""Per axis of a cell, to measure how much of the volume lies in solids."""


@dataclass(frozen=True)
class PlacedSolid:
    """A closed surface at its place."""

    name: str
    solid: Solid
    """In its own frame."""
    pose: RigidPose

    @cached_property
    def box(self) -> tuple[F64, F64]:
        """Least and greatest corner in the world [m]."""
        low, high = self.solid.lower, self.solid.upper
        corners = np.array(
            [[(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
        )
        placed = self.pose.apply(corners)
        return placed.min(axis=0), placed.max(axis=0)

    def near(self, points: F64, reach: float) -> NDArray[np.intp]:
        """Indices of points within `reach` of the box."""
        low, high = self.box
        return np.flatnonzero(((points >= low - reach) & (points <= high + reach)).all(axis=1))

    def inside(self, points: F64) -> NDArray[np.bool_]:
        """True where points (n, 3) lie inside."""
        found = np.zeros(len(points), dtype=bool)
        close = self.near(points, 0.0)
        if len(close):
            found[close] = contains(self.solid, self.pose.inverse().apply(points[close]))
        return found

    def inside_lattice(self, axes: Sequence[F64]) -> NDArray[np.bool_]:
        """True where the points of an even lattice lie inside, shape (len(x), len(y), len(z)); one ray per column."""
        wp = warp()
        from .filling_kernels import columns

        found = np.zeros(tuple(len(a) for a in axes), dtype=bool)
        low, high = self.box
        spans = [slice(*np.searchsorted(a, (lo, hi))) for a, lo, hi in zip(axes, low, high, strict=True)]
        x, y, z = (a[k] for a, k in zip(axes, spans, strict=True))
        if not (len(x) and len(y) and len(z)):
            return found
        step = float(z[1] - z[0]) if len(z) > 1 else float(high[2] - low[2]) + 1e-9
        # Rays start below the box, a whole number of steps under the first point.
        more = int(np.ceil((float(z[0]) - float(low[2])) / step)) + 1
        mesh, middle = self.tree
        base = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        start = np.column_stack([base, np.full(len(base), float(z[0]) - (more + 0.5) * step)])
        inverse = self.pose.inverse()
        local = inverse.apply(start) - middle
        along = inverse.apply(np.array([[0.0, 0.0, 1.0]]))[0] - inverse.position
        count = more + len(z)
        change = wp.zeros(len(base) * count, dtype=wp.int8, device="cpu")
        origin = wp.array(local.astype(np.float32), dtype=wp.vec3, device="cpu")
        skip = 2e-6 * self.solid.size
        launch(columns, len(base), [mesh.id, origin, wp.vec3(*map(float, along)), step, count, skip, change], device="cpu")
        told = np.cumsum(change.numpy().reshape(len(x), len(y), count), axis=2, dtype=np.int8)[:, :, more:]
        found[np.ix_(*(np.arange(k.start, k.stop) for k in spans))] = told > 0
        return found

    def signed(self, points: F64, reach: float) -> tuple[F64, F64]:
        """Distance (n,), negative inside, and the direction away from the inside (n, 3); infinite farther than `reach`."""
        distance, away = np.full(len(points), np.inf), np.zeros((len(points), 3))
        close = self.near(points, reach)
        if not len(close):
            return distance, away
        local = self.pose.inverse().apply(points[close])
        nearest, face, within = self._nearest(local, reach)
        met = face >= 0
        close, local, nearest, face, within = close[met], local[met], nearest[met], face[met], within[met]
        step = local - nearest
        length = np.linalg.norm(step, axis=1)
        flat = length < 1e-6 * self.solid.size
        normal = np.where(flat[:, None], self.solid.face_normals[face], step / np.where(flat, 1.0, length)[:, None])
        turned = np.where((within & ~flat)[:, None], -normal, normal)
        origin = self.pose.apply(np.zeros((1, 3)))
        distance[close], away[close] = np.where(within, -length, length), self.pose.apply(turned) - origin
        return distance, away

    def _nearest(self, local: F64, reach: float) -> tuple[F64, NDArray[np.int32], NDArray[np.bool_]]:
        """Nearest points, faces (-1 beyond `reach`) and whether inside, in the solid's frame, by a tree in single precision."""
        wp = warp()
        from .filling_kernels import nearest_places

        count = len(local)
        mesh, middle = self.tree
        nearest, outward = (wp.zeros(count, dtype=wp.vec3, device="cpu") for _ in range(2))
        face = wp.zeros(count, dtype=wp.int32, device="cpu")
        points = wp.array((local - middle).astype(np.float32), dtype=wp.vec3, device="cpu")
        sign = wp.zeros(count, dtype=wp.float32, device="cpu")
        launch(nearest_places, count, [mesh.id, points, reach, nearest, face, sign, outward], device="cpu")
        return nearest.numpy().astype(np.float64) + middle, face.numpy(), sign.numpy() < 0.0

    @cached_property
    def tree(self) -> tuple[Any, F64]:
        """The surface as a mesh of Warp in its own frame, about a point, and that point [m]."""
        wp = warp()
        middle = self.solid.sphere_center
        mesh = wp.Mesh(
            points=wp.array((self.solid.vertices - middle).astype(np.float32), dtype=wp.vec3, device="cpu"),
            indices=wp.array(np.ascontiguousarray(self.solid.faces).ravel(), dtype=wp.int32, device="cpu"),
        )
        return mesh, middle


@dataclass(frozen=True)
class Filling:
    """Particles in one volume."""

    position: F64
    """(n, 3) [m]"""
    volume: float
    """Volume of each particle [m^3]."""
    blocked: float
    """Share of the volume that lies in solids."""


def fill(own: PlacedSolid, solids: Sequence[PlacedSolid], spacing: float) -> Filling:
    """Particles inside `own` and outside `solids`, about `spacing` apart.

    The lattice follows the sides of the volume's box and is stretched by less than half a cell over its length. Of a turned
    volume it is the box in its own frame, where a lattice fits there.
    """
    if abs(own.pose.quaternion[0]) < 1.0:
        back = own.pose.inverse()
        here = [PlacedSolid(s.name, s.solid, compose(back, s.pose)) for s in solids]
        made, fits = _lattice(PlacedSolid(own.name, own.solid, compose(back, own.pose)), here, spacing)
        if fits:
            return Filling(own.pose.apply(made.position), made.volume, made.blocked)
    return _lattice(own, solids, spacing)[0]


def _lattice(own: PlacedSolid, solids: Sequence[PlacedSolid], spacing: float) -> tuple[Filling, bool]:
    """A filling along the axes, and whether it is a lattice that fits; else it is relaxed."""
    low, high = own.box
    counts = np.maximum(1, np.round((high - low) / spacing)).astype(int)
    step = (high - low) / counts
    axes = [low[k] + step[k] * (np.arange(counts[k]) + 0.5) for k in range(3)]
    own_cells = own.inside_lattice(axes)
    near = [s for s in solids if boxes_meet(s.box, (low - spacing, high + spacing))]
    whole, blocked = abs(own.solid.volume), 0.0
    free_cells = own_cells.copy()
    if near:
        blocked = blocked_share(own, near, axes, step)
        for solid in near:
            free_cells &= ~solid.inside_lattice(axes)
    kept = np.flatnonzero(own_cells)
    index = np.unravel_index(kept, own_cells.shape)
    lattice = np.column_stack([axes[k][index[k]] for k in range(3)])
    free = free_cells.reshape(-1)[kept]
    volume = whole * (1.0 - blocked)
    cell = float(np.prod(step))
    points = lattice[free]
    fits = abs(len(points) * cell - volume) <= 1e-6 * whole
    if fits and _snug(points, [own, *near], own, spacing):
        return Filling(points, cell, blocked), True
    wanted = max(1, round(volume / spacing**3)) if volume > 0 else 0
    points = _matched(lattice, free, own, near, wanted, spacing)
    points = _relax(points, own, near, spacing)
    return Filling(points, volume / max(len(points), 1), blocked), False


def boxes_meet(a: tuple[F64, F64], b: tuple[F64, F64]) -> bool:
    """True if two boxes touch, each as its least and greatest corner."""
    return bool((a[0] <= b[1]).all() and (b[0] <= a[1]).all())


def blocked_share(own: PlacedSolid, solids: Sequence[PlacedSolid], axes: Sequence[F64], step: F64) -> float:
    """Share of the volume inside solids, by points of a lattice twice as fine."""
    shifts = (np.arange(SUBSAMPLES) + 0.5) / SUBSAMPLES - 0.5
    fine = [np.sort((a[:, None] + shifts * s).ravel()) for a, s in zip(axes, step, strict=True)]
    inside = own.inside_lattice(fine)
    within = np.zeros_like(inside)
    for solid in solids:
        within |= solid.inside_lattice(fine)
    return float((inside & within).sum()) / max(int(inside.sum()), 1)


def _snug(points: F64, solids: Sequence[PlacedSolid], own: PlacedSolid, spacing: float) -> bool:
    """True if all particles keep their distance from the surfaces."""
    return all(bool((_depth(s, own, points, spacing)[0] >= SNUG * spacing).all()) for s in solids)


def _depth(solid: PlacedSolid, own: PlacedSolid, points: F64, spacing: float) -> tuple[F64, F64]:
    """Distance to where a particle may not be, and the direction away from there; infinite from `SIGHT` spacings on."""
    distance, away = solid.signed(points, SIGHT * spacing)
    return (np.where(np.isinf(distance), np.inf, -distance), -away) if solid is own else (distance, away)


def _matched(
    lattice: F64, free: NDArray[np.bool_], own: PlacedSolid, solids: Sequence[PlacedSolid], wanted: int, spacing: float
) -> F64:
    """Lattice points with the deepest ones first, as many as wanted."""
    points = lattice[free]
    if len(points) == wanted:
        return points
    if len(points) > wanted:  # the outermost go
        order = np.argsort([-_room(own, solids, points, spacing)], axis=1, kind="stable")[0]
        return np.asarray(points[np.sort(order[:wanted])])
    # Split the deepest ones: the relaxation makes room.
    order = np.argsort(-_room(own, solids, points, spacing), kind="stable")[: wanted - len(points)]
    step = np.ptp(lattice, axis=0) / np.maximum(1, np.round(len(lattice) ** (1 / 3)))
    return np.concatenate([points, points[order] + 0.25 * step])


def _room(own: PlacedSolid, solids: Sequence[PlacedSolid], points: F64, spacing: float) -> F64:
    """Distance of points to the nearest surface [m], at most `SIGHT` spacings."""
    found = np.full(len(points), SIGHT * spacing)
    for solid in (own, *solids):
        found = np.minimum(found, _depth(solid, own, points, spacing)[0])
    return np.asarray(found)


def _relax(points: F64, own: PlacedSolid, solids: Sequence[PlacedSolid], spacing: float) -> F64:
    """Push particles off each other and off surfaces until they are evenly apart."""
    from scipy.spatial import cKDTree

    walls = [own, *solids]
    close = [np.arange(len(points)) for _ in walls]
    for sweep in range(PASSES if len(points) < MANY else PASSES // 4):
        pairs = cKDTree(points).query_pairs(spacing, output_type="ndarray")
        move = np.zeros_like(points)
        if len(pairs):
            apart = points[pairs[:, 0]] - points[pairs[:, 1]]
            length = np.linalg.norm(apart, axis=1)
            push = 0.25 * (spacing - length) / np.maximum(length, 1e-9 * spacing)
            for axis in range(3):
                step = push * apart[:, axis]
                move[:, axis] += np.bincount(pairs[:, 0], step, len(points)) - np.bincount(pairs[:, 1], step, len(points))
        length = np.linalg.norm(move, axis=1)
        points = points + move * np.minimum(1.0, 0.2 * spacing / np.maximum(length, 1e-12))[:, None]
        for k, wall in enumerate(walls):
            look = np.arange(len(points)) if sweep % AGAIN == 0 else close[k]
            distance, away = _depth(wall, own, points[look], spacing)
            if sweep % AGAIN == 0:
                close[k] = look[distance < 0.2 * AGAIN * spacing + spacing]
            lack = np.clip(np.nan_to_num(HALF * spacing - distance, neginf=0.0), 0.0, spacing)
            points[look] += lack[:, None] * away
    return points
