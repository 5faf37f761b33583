"""Where a liquid does not get under a body that lies on something: gaps that are too narrow for its particles.

Real water fills the wedge under a ball on a floor and lifts it by all that it displaces. Particles keep a distance from every surface,
so that under the lowest part of the ball nothing presses upwards. What that takes of its lift is bounded from the shapes alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....geometry import distance_to_surface
from ....worlds.arrays import F64
from .samples import scattered
from .solids import pieces_of

if TYPE_CHECKING:
    from .frames import Liquid
    from .solids import Piece

__all__ = ["NARROW", "unwetted"]

NARROW = 0.5
"""[spacings] Own choice: particles stay a quarter of a spacing from each of two surfaces, so that a gap narrower than twice that holds none."""


def unwetted(liquid: Liquid, name: str, index: int, level: float) -> float:
    """Liquid that would stand between a level and the parts of a body's underside that it cannot reach, at a frame [m^3].

    Its weight is the most that the liquid's push on the body may lack there.

    Args:
        liquid: the instance.
        name: the body, as `entity/body`.
        index: the frame.
        level: height of the surface along `liquid.up` [m].
    """
    entity, body = name.split("/")
    pieces = pieces_of(liquid.candidate)
    own = [p for p in pieces if (p.entity, p.body) == (entity, body)]
    others = [p for p in pieces if (p.entity, p.body) != (entity, body)]
    reach, total = NARROW * liquid.spacing, 0.0
    for piece in own:
        points, normals = scattered(piece.solid, liquid.spacing, piece.solid.lower, piece.solid.upper)
        if not len(points):
            continue
        area = piece.solid.area / len(points)
        under = -(normals @ piece.turn[index].T) @ liquid.up
        place = piece.world(points, index)
        below = np.flatnonzero((under > 0.0) & (place @ liquid.up < level))
        place, under = place[below], under[below]
        tight = _beside_walls(liquid, place, reach) | _beside(others, place, index, reach)
        total += float((area * under * (level - place @ liquid.up))[tight].sum())
    return total


def _beside_walls(liquid: Liquid, place: F64, reach: float) -> NDArray[np.bool_]:
    """Which points lie nearer to a closed side of the domain."""
    gaps = np.stack([place - liquid.lower, liquid.upper - place], axis=2).reshape(-1, 6)
    return np.asarray((gaps[:, np.array(liquid.closed)] < reach).any(axis=1))


def _beside(others: list[Piece], place: F64, index: int, reach: float) -> NDArray[np.bool_]:
    """Which points lie nearer to a surface."""
    found = np.zeros(len(place), dtype=bool)
    for piece in others:
        low, high = piece.box(index)
        near = np.flatnonzero(((place >= low - reach) & (place <= high + reach)).all(axis=1) & ~found)
        if len(near):
            found[near] = distance_to_surface(piece.solid, piece.local(place[near], index)).distance < reach
    return found
