"""Faces of the walls of a room: which way they look, and how much of them is free for furniture (R95)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from .plans import Rect

__all__ = ["WallLine", "common_area", "free_wall", "wall_lines"]

STRIP = 0.35
"""[m] Own choice: depth before a wall that has to be free for furniture along it."""
LEAST_WALL = 0.45
"""[m] Own choice: shorter pieces of wall are of no use to furniture."""


class WallLine(NamedTuple):
    """The face of a wall seen from its room."""

    quarter: int
    """Quarter turns of what stands with its back to it: 0 for a wall towards +y, then -x, -y, +x."""
    across: float
    """Where it is across its run [m]."""
    start: float
    end: float
    """Its ends along its run [m]."""


def common_area(a: Rect, b: Rect) -> float:
    """Area of what two rectangles have in common [m^2]."""
    return max(0.0, min(a.x1, b.x1) - max(a.x0, b.x0)) * max(0.0, min(a.y1, b.y1) - max(a.y0, b.y0))


def wall_lines(r: Rect, notch: Rect | None = None) -> list[WallLine]:
    """Faces of the walls of a room of clear size `r`, by quarter; of one without the corner `notch` six."""
    around = [
        WallLine(0, r.y1, r.x0, r.x1),
        WallLine(1, r.x0, r.y0, r.y1),
        WallLine(2, r.y0, r.x0, r.x1),
        WallLine(3, r.x1, r.y0, r.y1),
    ]
    if notch is None:
        return around
    n, found = notch, []
    for line in around:
        sides, (low, high) = ((n.y0, n.y1), (n.x0, n.x1)) if line.quarter % 2 == 0 else ((n.x0, n.x1), (n.y0, n.y1))
        if line.across in sides:
            line = line._replace(start=high) if low <= line.start else line._replace(end=low)
        found.append(line)
    level = WallLine(0, n.y0, n.x0, n.x1) if n.y0 > r.y0 else WallLine(2, n.y1, n.x0, n.x1)
    upright = WallLine(3, n.x0, n.y0, n.y1) if n.x0 > r.x0 else WallLine(1, n.x1, n.y0, n.y1)
    return [*found, level, upright]


def free_wall(r: Rect, taken: Sequence[Rect], *, notch: Rect | None = None) -> float:
    """Length of the walls of a room before which nothing is, in pieces that furniture fits [m].

    Args:
        r: its clear size [m].
        taken: what is before them.
        notch: corner that it leaves out.
    """
    lines, total = wall_lines(r, notch), 0.0
    for quarter, across, start, end in (lines[k] for k in (2, 0, 1, 3, *range(4, len(lines)))):
        level = quarter % 2 == 0
        low, high = across - STRIP, across + STRIP
        strip = Rect(start, low, end, high) if level else Rect(low, start, high, end)
        cuts = sorted((t.x0, t.x1) if level else (t.y0, t.y1) for t in taken if common_area(t, strip) > 0)
        for low, high in [*cuts, (end, end)]:
            total += max(0.0, low - start) if low - start >= LEAST_WALL else 0.0
            start = max(start, high)
    return total
