"""Facts of breakable bodies that the specification alone tells: numbers of pieces, and how far they crumble (R61)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ...spec import Breakable, Entity

__all__ = ["CRUMBLE", "SHARES", "least_piece", "piece_count"]

CRUMBLE = 0.01
"""Default thickness of what crumbles at a broken face, in parts of the middle piece's size."""
SHARES = (0.125, 1.0)
"""Parts of the contact time at which a blow is looked at: early, when it is felt near where it hits only, and at its end. What
it breaks early it cannot use to bend the rest."""


def piece_count(entity: Entity) -> int:
    """About how many pieces a breakable entity is cut into; at most a few more for concave bodies."""
    if entity.breakable is None:
        return 0
    pattern = entity.breakable.pattern
    if pattern.kind == "glass":
        return pattern.radial * (pattern.rings + 1)
    if pattern.kind != "bricks":
        return pattern.pieces
    x, y, z = entity.dimensions.size
    along, through = (x, y) if pattern.along == "x" else (y, x)
    pitch = [s + pattern.joint for s in pattern.size]
    return max(1, round(along / pitch[0] + 0.5)) * max(1, round(through / pitch[1])) * max(1, round(z / pitch[2]))


def least_piece(entity: Entity, breakable: Breakable) -> float:
    """Least size of a piece [m], as far as the specification tells it."""
    pattern, box = breakable.pattern, np.array(entity.dimensions.size)
    if pattern.kind == "bricks":
        return float(min(pattern.size))
    if pattern.kind == "glass":
        return float(box.min())
    return float(min(box.min(), (box.prod() / pattern.pieces) ** (1 / 3)))
