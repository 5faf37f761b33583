"""Outlines that generators share: circles, rectangles with round corners, arcs of a path."""

from __future__ import annotations

import math
from collections.abc import Sequence

<<<<<<< HEAD
__all__ = ["arc", "circle", "convex_outline", "rectangle", "rounded"]
=======
__all__ = ["arc", "circle", "mitred", "rectangle", "rounded"]
>>>>>>> 0af2bfdea560ccb5ff770107f6acc23e83f50276

Outline = list[tuple[float, float]]


def circle(radius: float, sides: int = 12) -> Outline:
    """Regular polygon of the area of a circle [m], counter-clockwise: its corners stand a little outside of the circle."""
    reach = radius * math.sqrt(2 * math.pi / (sides * math.sin(2 * math.pi / sides)))
    return [(reach * math.cos(a), reach * math.sin(a)) for a in (2 * math.pi * (k + 0.5) / sides for k in range(sides))]


def rectangle(width: float, height: float) -> Outline:
    """Rectangle about the origin [m], counter-clockwise."""
    x, y = width / 2, height / 2
    return [(-x, -y), (x, -y), (x, y), (-x, y)]


def rounded(width: float, height: float, radius: float, steps: int = 3) -> Outline:
    """Rectangle about the origin with round corners of `steps` chords each [m], counter-clockwise."""
    x, y = width / 2 - radius, height / 2 - radius
    found = []
    for corner, (cx, cy) in enumerate(((x, y), (-x, y), (-x, -y), (x, -y))):
        angles = (math.pi / 2 * (corner + k / steps) for k in range(steps + 1))
        found += [(cx + radius * math.cos(a), cy + radius * math.sin(a)) for a in angles]
    return found


def arc(center: tuple[float, float], radius: float, start: float, end: float, steps: int) -> Outline:
    """Points of an arc in a plane from one angle to another [rad], both ends included."""
    angles = (start + (end - start) * k / steps for k in range(steps + 1))
    return [(center[0] + radius * math.cos(a), center[1] + radius * math.sin(a)) for a in angles]


<<<<<<< HEAD
def convex_outline(points: Sequence[tuple[float, float]]) -> Outline:
    """Convex hull of points in a plane [m], counter-clockwise."""
    from scipy.spatial import ConvexHull

    return [(float(points[k][0]), float(points[k][1])) for k in ConvexHull(points).vertices]
=======
def mitred(
    low: tuple[float, float, float, float], high: tuple[float, float, float, float], levels: tuple[float, float], thick: float
) -> dict[str, list[tuple[float, float, float]]]:
    """Corners of four leaning panels between two level rectangles (x0, y0, x1, y1), mitred where they meet [m].

    The rectangles are those of the outer faces; panels are `thick` towards the inside, measured level.
    """
    found: dict[str, list[tuple[float, float, float]]] = {"front": [], "right": [], "back": [], "left": []}
    for (x0, y0, x1, y1), z in zip((low, high), levels, strict=True):
        outer = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        inner = [(x0 + thick, y0 + thick), (x1 - thick, y0 + thick), (x1 - thick, y1 - thick), (x0 + thick, y1 - thick)]
        for k, side in enumerate(found):
            found[side] += [(*ring[j], z) for ring in (outer, inner) for j in (k, (k + 1) % 4)]
    return found
>>>>>>> 0af2bfdea560ccb5ff770107f6acc23e83f50276
