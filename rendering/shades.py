"""How much of its material's colour a surface shows: patterns at points for previews, tones of bricks for all pictures."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..worlds.arrays import F64

if TYPE_CHECKING:
    from ..worlds.spec import WorldSpec

__all__ = ["brick_tone", "pattern_shade"]

TONES = (0.8, 0.92, 1.0, 1.08)
"""Of bricks, which no two kiln loads give one colour; own choice. Without them courses show only where a wall has moved."""

DARK = 0.25
"""Share of the colour in a checker's dark squares, as in the rendered tile."""
GRAIN = 8.0
"""Lines of wood grain across one period."""


def pattern_shade(
    pattern: Literal["plain", "wood", "checker", "concrete"], points: F64, normals: F64, *, scale: float, extent: F64
) -> F64:
    """Share of the material's colour at points of one part, shape (n,): squares for a checker, lines along the grain for wood.

    Args:
        pattern: name of the pattern; plain and concrete are even.
        points: in the part's own frame [m], shape (n, 3).
        normals: there, shape (n, 3); the pattern is seen along the axis that is nearest to them.
        scale: size of one pattern period [m].
        extent: size of the part [m], shape (3,); a period is never larger than it still reads on the part.
    """
    if pattern not in ("checker", "wood") or not len(points):
        return np.ones(len(points))
    period = min(scale, 1.2 * max(float(np.sort(extent)[1]), 1e-4))
    axis = np.abs(normals).argmax(1)
    if pattern == "checker":
        cells = np.floor(2 * points / period + 1e-6).astype(np.int64)
        cells[np.arange(len(points)), axis] = 0
        return np.where(cells.sum(1) % 2 == 0, DARK, 1.0)
    grain = int(np.argmax(extent))
    across = [k for k in range(3) if k != grain]
    seen = np.where(axis == across[0], across[1], across[0])
    phase = GRAIN * points[np.arange(len(points)), seen] / period
    return np.asarray(0.86 + 0.14 * np.cos(2 * np.pi * phase))


def brick_tone(spec: WorldSpec, entity: str, part: str) -> float:
    """Share of the material's colour that a part shows; 1 for all but the bricks of a wall."""
    breakable = spec.entities[entity].breakable
    if breakable is None or breakable.pattern.kind != "bricks":
        return 1.0
    return TONES[hashlib.blake2b(f"{entity}/{part}".encode(), digest_size=1).digest()[0] % len(TONES)]
