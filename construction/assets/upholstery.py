"""Cushions, mattresses and pillows: a core of foam in a closed cover."""

from __future__ import annotations

import math

import numpy as np

from .made import Body, Point

__all__ = ["padded"]

SOFT = 0.045
"""[m] By which corners of cushions are cut."""


def padded(
    body: Body,
    name: str,
    center: Point,
    size: Point,
    cover: str,
    *,
    edge: float = 0.5,
    lean: float = 0.0,
    plain: bool = False,
) -> None:
    """Add a cushion: a core of foam with a cover of plane pieces about it.

    Args:
        body: gets the parts.
        name: of the parts.
        center: of the cushion [m].
        size: full extents [m] before it leans.
        cover: material of the cover.
        edge: height of the rim, from 0 in the middle to 1 at the upper side: below 1 it bulges.
        lean: angle about the x axis [rad] by which its upper side turns towards -y.
        plain: flat below and with sharp corners, of fewer parts.
    """
    x, y, z = (c / 2 for c in np.asarray(size, dtype=np.float64))
    soft = min(0.25 * min(x, y), SOFT)
    flat = min(0.5 * min(x, y), 2.2 * (1 - edge) * z + 0.9 * soft)
    cut = 0.0 if plain else soft
    rings = [(x - soft / 2, y - soft / 2, -z), (x, y, edge * z), (x - flat, y - flat, z)]
    if not plain:
        rings[:1] = [(x - flat, y - flat, -z), (x - soft / 2, y - soft / 2, -edge * z), (x, y, 0.0)]
        rings[3:4] = [(x - soft / 2, y - soft / 2, edge * z)]
    shells = [_ring(a, b, cut, c) for a, b, c in rings]
    shrink = 1 - max(0.035, 0.004 / z)
    turn = np.array([[1, 0, 0], [0, math.cos(lean), -math.sin(lean)], [0, math.sin(lean), math.cos(lean)]])

    def placed(points: list[tuple[float, float, float]], *scales: float) -> list[Point]:
        return [np.asarray(center) + scale * (turn @ np.array(p)) for scale in scales for p in points]

    body.hull(f"{name}_core", placed([p for ring in shells for p in ring], shrink), material="soft_foam")
    for label, ring in (("under", shells[0]), ("over", shells[-1])):
        body.hull(f"{name}_{label}", placed(ring, 1.0, shrink), material=cover)
    for level, (low, high) in enumerate(zip(shells[:-1], shells[1:], strict=True), start=1):
        for side in range(len(low)):
            quad = [low[side], low[side - 1], high[side], high[side - 1]]
            body.hull(f"{name}_{level}_{side}", placed(quad, 1.0, shrink), material=cover)


def _ring(x: float, y: float, cut: float, z: float) -> list[tuple[float, float, float]]:
    """Rectangle at a height, with corners that are cut off."""
    if cut <= 0:
        return [(x, y, z), (-x, y, z), (-x, -y, z), (x, -y, z)]
    c = min(cut, 0.6 * x, 0.6 * y)
    corners = ((x, y - c), (x - c, y), (-x + c, y), (-x, y - c), (-x, -y + c), (-x + c, -y), (x - c, -y), (x, -y + c))
    return [(a, b, z) for a, b in corners]
