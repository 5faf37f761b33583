"""Outlines of turned things: hollow walls, smooth curves, and where a handle or a spout meets a wall.

Outer outlines are lists of (r, z) [m] from the foot upwards. A turned part has flat facets between its segments; what joins it
meets the middle of a facet, so the part is turned by half a segment (`half`) and the joint lies at the angle 0.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ..polygons import convex_partition
from .made import Body, Point
from .profiles import Outline

__all__ = [
    "TRIM",
    "Facet",
    "breaking",
    "bulged",
    "curve",
    "drawn",
    "facet",
    "grip",
    "half",
    "hollow",
    "lying",
    "moved",
    "ring",
    "solid",
    "stacked",
    "vessel",
]

TRIM = 0.0005
"""[m] The default skin of a collision: trimmings that are drawn only stand out so far, so that they sink into nothing that comes near.
As pieces of their own that collide, a millimetre or two thick, they would ask for steps of a tenth of a millisecond of what falls or rolls."""
BONDS = {
    "soda_lime_glass": (7e5, 1.1e6),
    "borosilicate_glass": (8e5, 1.3e6),
    "porcelain": (5e5, 9e5),
    "terracotta": (3e5, 6e5),
}
"""Own choice: effective tension and shear [Pa] of thin walls with flaws, below those of sound samples."""


def curve(points: Sequence[Point], steps: int = 3) -> list[tuple[float, ...]]:
    """Points of a Catmull-Rom curve through points of any dimension, `steps` chords between each two, ends included."""
    p = np.array([np.array(q, dtype=np.float64) for q in points])
    p = np.concatenate([[2 * p[0] - p[1]], p, [2 * p[-1] - p[-2]]])
    found = []
    for k in range(1, len(p) - 2):
        a, b, c, d = p[k - 1 : k + 3]
        for t in np.arange(steps) / steps:
            found.append(b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a))))
    return [tuple(float(v) for v in q) for q in [*found, p[-2]]]


def bulged(outer: Sequence[Point], steps: int = 2) -> Outline:
    """An outer outline with more points where it bulges outwards, along a Catmull-Rom curve; elsewhere it stays as it is.

    With the given points as its inner outline, a wall of it takes no more convex pieces than before.
    """
    given = [(float(r), float(z)) for r, z in outer]
    fine = [(r, z) for r, z in curve(given, steps)]
    found = [given[0]]
    for k, ((r0, z0), (r1, z1)) in enumerate(itertools.pairwise(given)):
        found += [
            (r, z)
            for r, z in fine[k * steps + 1 : (k + 1) * steps]
            if z0 <= z <= z1 and (r - r0) * (z1 - z0) - (z - z0) * (r1 - r0) > 1e-7
        ]
        found.append((r1, z1))
    return found


def solid(outer: Sequence[Point]) -> Outline:
    """Closed outline of a full body of revolution from its outer outline."""
    rings = [(float(r), float(z)) for r, z in outer]
    low = [] if rings[0][0] <= 0 else [(0.0, rings[0][1])]
    high = [] if rings[-1][0] <= 0 else [(0.0, rings[-1][1])]
    return [*low, *rings, *high]


def hollow(outer: Sequence[Point], wall: float, floor: float, *, fine: Sequence[Point] | None = None) -> Outline:
    """Closed outline of a vessel as `vessel` makes it, begun at the point from which it is cut into fewest convex pieces."""
    ring = vessel(outer, wall, floor, fine=fine)
    starts = [[*ring[k:], *ring[:k]] for k in range(len(ring))]
    return min(starts, key=lambda found: len(convex_partition(found)))


def vessel(outer: Sequence[Point], wall: float, floor: float, *, fine: Sequence[Point] | None = None) -> Outline:
    """Closed outline of a vessel: walls of one thickness, measured across, and a level floor [m].

    Args:
        outer: outer outline from the foot to the rim, which the inner side follows.
        wall: thickness of the wall at these points.
        floor: thickness of the floor over the lowest point.
        fine: visible outer outline, see `bulged`.
    """
    p = np.array(outer, dtype=np.float64)
    way = np.diff(p, axis=0)
    normal = np.stack([-way[:, 1], way[:, 0]], 1) / np.linalg.norm(way, axis=1)[:, None]
    ends = np.concatenate([normal[:1], normal, normal[-1:]])
    mean = ends[:-1] + ends[1:]
    inner = p + wall * 2 * mean / (mean**2).sum(1)[:, None]
    inner[-1] = (p[-1, 0] - wall / max(abs(normal[-1, 0]), 0.3), p[-1, 1])
    level = p[:, 1].min() + floor
    found: Outline = []
    for (r0, z0), (r1, z1) in itertools.pairwise(inner):
        if not found and z0 < z1 and level < z1:
            found = [(float(r0 + (r1 - r0) * (level - z0) / (z1 - z0)), float(level))]
        if z1 > level + 1e-4 and found:
            found.append((float(r1), float(z1)))
    return [(0.0, float(p[0, 1])), *((float(r), float(z)) for r, z in fine or outer), *reversed(found), (0.0, float(level))]


def stacked(
    body: Body, name: str, outer: Sequence[Point], at: Point = (0, 0, 0), *, segments: int = 32, material: str | None = None
) -> None:
    """Add a full turned thing as one part for each stretch of its outline that is convex: one collision piece each."""
    rows = [(float(r), float(z)) for r, z in outer]
    start, number = 0, 1
    for k in range(1, len(rows)):
        done = k == len(rows) - 1
        if not done:
            (r0, z0), (r1, z1), (r2, z2) = rows[k - 1 : k + 2]
            done = (r1 - r0) * (z2 - z1) - (z1 - z0) * (r2 - r1) < 0
        if done:
            body.turned(f"{name}_{number}", solid(rows[start : k + 1]), at, segments=segments, material=material)
            start, number = k, number + 1


def ring(radius: float, low: float, high: float, thick: float) -> Outline:
    """Rectangular outline of a hoop [m]: inner radius, least and greatest z, thickness outwards."""
    return [(radius, low), (radius + thick, low), (radius + thick, high), (radius, high)]


def half(segments: int) -> tuple[float, float, float]:
    """Euler angles [rad] that bring the middle of a facet to the angle 0."""
    return (0.0, 0.0, math.pi / segments)


def lying(segments: int, angle: float = 0.0) -> tuple[float, float, float]:
    """Euler angles [rad] that lay the axis z along x, turned by an angle about z, a facet below (segments in fours)."""
    return (-math.pi / 2, math.pi / segments, angle - math.pi / 2)


class Facet(NamedTuple):
    """Where something joins a turned wall at the angle 0: point and outward direction in the xz plane."""

    x: float
    z: float
    across: float
    up: float

    def out(self, way: float, side: float = 0.0) -> F64:
        """Point a way outwards [m], and along y."""
        return np.array([self.x + way * self.across, side, self.z + way * self.up])


def facet(outer: Sequence[Point], z: float, segments: int) -> Facet:
    """The middle of the facet at the angle 0 of an outer outline, at the height z [m]."""
    flat = math.cos(math.pi / segments)
    for (r0, z0), (r1, z1) in itertools.pairwise(outer):
        if z0 < z1 and z0 <= z <= z1:
            across, up = z1 - z0, -flat * (r1 - r0)
            length = math.hypot(across, up)
            return Facet(flat * (r0 + (r1 - r0) * (z - z0) / (z1 - z0)), z, across / length, up / length)
    raise ValueError(f"no facet at z = {z}")


def grip(low: Facet, high: Facet, reach: float, *, lead: float = 0.004, steps: int = 7) -> list[F64]:
    """Path of a handle from one place of a wall to a higher one, bulging outwards by about `reach` [m]."""
    a, d = high.out(lead), low.out(lead)
    b, c = high.out(lead + 1.33 * reach), low.out(lead + 1.33 * reach)
    t = np.linspace(0, 1, steps + 1)[:, None]
    bow = (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t**2 * (1 - t) * c + t**3 * d
    return [high.out(0), *bow, low.out(0)]


def moved(points: Sequence[Point], by: Point = (0, 0, 0), turn: float = 0.0) -> list[F64]:
    """Points turned about the z axis [rad], then shifted [m]."""
    c, s = math.cos(turn), math.sin(turn)
    rows = np.array([np.asarray(q, dtype=np.float64) for q in points])
    return list(rows @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + np.asarray(by, dtype=np.float64))


def drawn(body: Body, *names: str) -> None:
    """Make parts drawn only: labels, pips, tapes, thinner than the skin of a collision."""
    for name in names:
        body.parts[name] = body.parts[name].model_copy(update={"collides": False})


def breaking(material: str, pieces: int, seed: int, wall: float) -> dict[str, Any]:
    """The field `breakable` of a thin-walled body that shatters into about `pieces` pieces."""
    tension, shear = BONDS.get(material, (7e5, 1.1e6))
    return {
        "pattern": {"kind": "voronoi", "pieces": pieces, "seed": seed},
        "bond": {"tension": tension, "shear": shear, "young_modulus": 5e10, "crumble": max(0.001, round(0.25 * wall, 6))},
    }
