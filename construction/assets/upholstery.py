"""Cushions, mattresses and pillows: a core of foam in a closed cover."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec import Hull, Sweep
from .made import Body, Point

__all__ = ["covered", "padded"]

SOFT = 0.045
"""[m] By which corners of cushions are cut."""
COVER = 0.005
"""[m] Thickness of covers."""


def padded(
    body: Body,
    name: str,
    center: Point,
    size: Point,
    cover: str,
    *,
    form: Literal["box", "sharp", "lens"] = "box",
    bevel: tuple[float, float] = (0.06, 0.04),
    lean: float = 0.0,
) -> None:
    """Add a cushion: a core of foam in a cover.

    Args:
        body: gets the parts.
        name: of the parts.
        center: of the cushion [m].
        size: full extents [m] before it leans.
        cover: material of the cover.
        form: a box with a bevelled upper side and cut corners; one with sharp corners, of fewer pieces; or a lens, thick in the
            middle and thin at its edges, as a pillow.
        bevel: width and height of the bevel [m].
        lean: angle about the x axis [rad] by which its upper side turns towards -y.
    """
    x, y, z = (float(c) / 2 for c in np.asarray(size, dtype=np.float64))
    t, cut = min(COVER, 0.2 * z), 0.0 if form != "box" else min(0.25 * min(x, y), SOFT)
    if form == "lens":
        wide = 0.45 * min(x, y)
        half = [(0.0, 0.0), (0.22 * wide, 0.62 * z), (wide, z)]
        core = [(1.6 * t, 0.0), (0.22 * wide + t, 0.62 * z - t), (wide, z - t)]
        outer = [(d, -v) for d, v in half[:0:-1]] + half
        inner = [(d, -v) for d, v in core[:0:-1]] + core
    else:
        wide, high = min(bevel[0], 1.6 * cut if cut else 0.5 * min(x, y)), min(bevel[1], 1.2 * z)
        outer = [(0.0, t - z), (0.0, z - high), (wide, z)]
        inner = [(t, t - z), (t, z - high - t / 2), (wide, z - t)]
    turn = (lean, 0.0, 0.0)
    rings = {p: _ring(x, y, cut, p) for p in {*outer, *inner, outer[0], (outer[0][0], -z)}}
    around = [(a, b, 0.0) for a, b, _ in _ring(x, y, cut, (0.0, 0.0))]
    band = [(-d, v) for d, v in (*outer, *inner[::-1])]
    body.add(f"{name}_cover", Sweep(path=around, profile=band, closed=True), center, euler=turn, material=cover)
    shells = [
        ("core", [q for p in inner for q in rings[p]], "soft_foam"),
        ("over", [*rings[outer[-1]], *_ring(x, y, cut, (outer[-1][0], z - t))], cover),
        ("under", [*rings[outer[0][0], -z], *_ring(x, y, cut, (outer[0][0], t - z))], "soft_foam"),
    ]
    for part, points, own in shells:
        body.add(f"{name}_{part}", Hull(points=points), center, euler=turn, material=own)


def covered(body: Body, name: str, foot: Sequence[Point], head: Sequence[Point], cover: str, *, core: str = "rigid_foam") -> None:
    """Add a six-sided upholstered block: a core of foam in a cover.

    Args:
        body: gets the parts.
        name: of the parts.
        foot: four corners of a plane lower side, in order [m].
        head: the corners of the upper side over them.
        cover: material of the cover.
        core: material within.
    """
    low, high = np.asarray(foot, dtype=np.float64), np.asarray(head, dtype=np.float64)
    center = np.concatenate([low, high]).mean(0)
    extent = np.ptp(np.concatenate([low, high]), axis=0)
    shrink = 1 - max(0.02, 0.008 / float(extent.min()))

    def patch(points: F64) -> list[Point]:
        return [*points, *(center + shrink * (points - center))]

    body.hull(f"{name}_core", [center + shrink * (q - center) for q in (*low, *high)], material=core)
    body.hull(f"{name}_under", patch(low), material=core)
    body.hull(f"{name}_over", patch(high), material=cover)
    for side in range(4):
        body.hull(f"{name}_{side}", patch(np.array([low[side], low[side - 1], high[side], high[side - 1]])), material=cover)


def _ring(x: float, y: float, cut: float, level: tuple[float, float]) -> list[tuple[float, float, float]]:
    """Rectangle of half sides x, y with corners that are cut off, moved inwards by a way to a height, counter-clockwise."""
    way, z = level
    x, y, c = x - way, y - way, cut - way * (2 - math.sqrt(2))
    if cut <= 0:
        return [(x, y, z), (-x, y, z), (-x, -y, z), (x, -y, z)]
    corners = ((x, y - c), (x - c, y), (-x + c, y), (-x, y - c), (-x, -y + c), (-x + c, -y), (x - c, -y), (x, -y + c))
    return [(a, b, z) for a, b in corners]
