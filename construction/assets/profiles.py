"""Outlines that generators share: circles, rectangles with round corners, arcs of a path."""

from __future__ import annotations

import math

__all__ = ["arc", "circle", "rectangle", "rounded"]

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
