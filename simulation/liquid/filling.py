"""Fill a volume with particles: a lattice that fits it, relaxed where walls or slopes would cut its cells.

Particles keep half a spacing from surfaces, and there are as many as the free volume holds cells of one spacing, so that the
liquid starts near its rest density with the volume that was declared.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.inside import contains, nearest_faces
from ...geometry.solids import Solid
from ...worlds.arrays import F64, RigidPose

__all__ = ["Filling", "PlacedSolid", "fill"]

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
SUBSAMPLES = 2
"""Per axis of a cell, to measure how much of the volume lies in solids."""


@dataclass(frozen=True)
class PlacedSolid:
    """A closed surface at its place."""

    name: str
    solid: Solid
    """In its own frame."""
    pose: RigidPose

    @property
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
        """Whether points (n, 3) lie inside."""
        found = np.zeros(len(points), dtype=bool)
        close = self.near(points, 0.0)
        if len(close):
            found[close] = contains(self.solid, self.pose.inverse().apply(points[close]))
        return found

    def signed(self, points: F64, reach: float) -> tuple[F64, F64]:
        """Distance (n,), negative inside, and the direction away from the surface's inside (n, 3); infinite beyond `reach`."""
        distance, away = np.full(len(points), np.inf), np.zeros((len(points), 3))
        close = self.near(points, reach)
        if not len(close):
            return distance, away
        local = self.pose.inverse().apply(points[close])
        far, nearest, face = nearest_faces(self.solid, local)
        within = contains(self.solid, local)
        step = local - nearest
        length = np.linalg.norm(step, axis=1)
        flat = length < 1e-9 * self.solid.size
        normal = np.where(flat[:, None], self.solid.face_normals[face], step / np.where(flat, 1.0, length)[:, None])
        turned = np.where((within & ~flat)[:, None], -normal, normal)
        origin = self.pose.apply(np.zeros((1, 3)))
        distance[close], away[close] = np.where(within, -far, far), self.pose.apply(turned) - origin
        return distance, away


@dataclass(frozen=True)
class Filling:
    """Particles in one volume."""

    position: F64
    """(n, 3) [m]"""
    volume: float
    """Of each [m^3]."""
    blocked: float
    """Share of the volume that lies in solids."""


def fill(own: PlacedSolid, solids: Sequence[PlacedSolid], spacing: float) -> Filling:
    """Particles inside `own` and outside `solids`, about `spacing` apart.

    The lattice follows the sides of the volume's box and is stretched by less than half a cell over its length.
    """
    low, high = own.box
    counts = np.maximum(1, np.round((high - low) / spacing)).astype(int)
    step = (high - low) / counts
    axes = [low[k] + step[k] * (np.arange(counts[k]) + 0.5) for k in range(3)]
    lattice = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    inside = own.inside(lattice)
    near = [s for s in solids if _meets(s.box, (low - spacing, high + spacing))]
    whole, blocked = abs(own.solid.volume), 0.0
    free = inside.copy()
    if near:
        blocked = _blocked(own, near, lattice, step)
        for solid in near:
            free[free] &= ~solid.inside(lattice[free])
    volume = whole * (1.0 - blocked)
    cell = float(np.prod(step))
    points = lattice[free]
    fits = abs(len(points) * cell - volume) <= 1e-6 * whole
    if fits and _snug(points, [own, *near], own, spacing):
        return Filling(points, cell, blocked)
    wanted = max(1, round(volume / spacing**3)) if volume > 0 else 0
    points = _matched(lattice, free, own, near, wanted)
    points = _relax(points, own, near, spacing)
    return Filling(points, volume / max(len(points), 1), blocked)


def _meets(a: tuple[F64, F64], b: tuple[F64, F64]) -> bool:
    return bool((a[0] <= b[1]).all() and (b[0] <= a[1]).all())


def _blocked(own: PlacedSolid, solids: Sequence[PlacedSolid], lattice: F64, step: F64) -> float:
    """Share of the volume inside solids, by points of a lattice twice as fine."""
    total = hit = 0
    shifts = (np.arange(SUBSAMPLES) + 0.5) / SUBSAMPLES - 0.5
    for shift in np.stack(np.meshgrid(shifts, shifts, shifts), axis=-1).reshape(-1, 3):
        points = lattice + shift * step
        points = points[own.inside(points)]
        within = np.zeros(len(points), dtype=bool)
        for solid in solids:
            within |= solid.inside(points)
        total, hit = total + len(points), hit + int(within.sum())
    return hit / max(total, 1)


def _snug(points: F64, solids: Sequence[PlacedSolid], own: PlacedSolid, spacing: float) -> bool:
    """Whether all particles keep their distance from the surfaces."""
    return all(bool((_depth(s, own, points, spacing)[0] >= SNUG * spacing).all()) for s in solids)


def _depth(solid: PlacedSolid, own: PlacedSolid, points: F64, spacing: float) -> tuple[F64, F64]:
    """Distance to where a particle may not be, and the direction away from there."""
    distance, away = solid.signed(points, 2.0 * spacing)
    return (-distance, -away) if solid is own else (distance, away)


def _matched(lattice: F64, free: NDArray[np.bool_], own: PlacedSolid, solids: Sequence[PlacedSolid], wanted: int) -> F64:
    """Lattice points with the deepest ones first, as many as wanted."""
    points = lattice[free]
    if len(points) == wanted:
        return points
    if len(points) > wanted:  # the outermost go
        order = np.argsort([-_room(own, solids, points)], axis=1, kind="stable")[0]
        return np.asarray(points[np.sort(order[:wanted])])
    # Split the deepest ones: the relaxation makes room.
    order = np.argsort(-_room(own, solids, points), kind="stable")[: wanted - len(points)]
    step = np.ptp(lattice, axis=0) / np.maximum(1, np.round(len(lattice) ** (1 / 3)))
    return np.concatenate([points, points[order] + 0.25 * step])


def _room(own: PlacedSolid, solids: Sequence[PlacedSolid], points: F64) -> F64:
    """Distance of points to the nearest surface [m], at most the size of the volume."""
    found = -own.signed(points, 0.0)[0]
    for solid in solids:
        found = np.minimum(found, solid.signed(points, own.solid.size)[0])
    return np.asarray(np.minimum(found, own.solid.size))


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
