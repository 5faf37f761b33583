"""Outlines that generators share: circles, rectangles with round corners, arcs of a path."""

from __future__ import annotations

import math
from collections.abc import Sequence

__all__ = ["arc", "circle", "convex_outline", "inset", "mitred", "oval", "rectangle", "rounded"]

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


def oval(width: float, depth: float, sides: int = 20, *, middle: float = 0.0) -> Outline:
    """Polygon on an ellipse about (0, `middle`) with level edges at its ends [m], counter-clockwise."""
    angles = (2 * math.pi * (k + 0.5) / sides for k in range(sides))
    return [(width / 2 * math.cos(a), middle + depth / 2 * math.sin(a)) for a in angles]


def inset(outline: Outline, way: float) -> Outline:
    """Polygon whose edges are moved inwards by a way [m], mitred as a swept profile is; counter-clockwise, outwards where negative."""
    found = []
    for k, (x, y) in enumerate(outline):
        (a, b), (c, d) = outline[k - 1], outline[(k + 1) % len(outline)]
        before, after = math.hypot(x - a, y - b), math.hypot(c - x, d - y)
        n, m = (-(y - b) / before, (x - a) / before), (-(d - y) / after, (c - x) / after)
        share = way / (1 + n[0] * m[0] + n[1] * m[1])
        found.append((x + share * (n[0] + m[0]), y + share * (n[1] + m[1])))
    return found


def convex_outline(points: Sequence[tuple[float, float]]) -> Outline:
    """Convex hull of points in a plane [m], counter-clockwise."""
    from scipy.spatial import ConvexHull

    return [(float(points[k][0]), float(points[k][1])) for k in ConvexHull(points).vertices]
