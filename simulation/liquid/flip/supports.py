"""Bodies that something else than the liquid bears: they give way to a lift as far as it bears them, and to no load on it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ....worlds.arrays import F64
from ...boundaries import BodyState

__all__ = ["Support", "let_go", "supports"]

BORNE = 0.02
"""Share of gravity from which on a body counts as borne."""
HELD = 0.5
"""Own choice: what is borne by contacts answers a push along them with less than this share of 1/mass; one that a driver lifts does not."""


class Support(NamedTuple):
    """Force that bears a body without the liquid."""

    way: F64
    """Direction of its force, (3,)."""
    most: float
    """The force, which contacts can lose and not exceed [N]."""


def supports(bodies: BodyState, gravity: F64, rows: list[int]) -> dict[int, Support]:
    """Supports of the bodies that react and are borne, by row."""
    found = {}
    for row in rows:
        borne, light = bodies.acceleration[row] - gravity, float(bodies.inverse_mass[row])
        size = float(np.linalg.norm(borne))
        if size <= BORNE * float(np.linalg.norm(gravity)):
            continue
        way = borne / size
        if bodies.mobility is None or float(way @ bodies.mobility[row] @ way) < HELD * light:
            found[row] = Support(way, size / light)
    return found


def let_go(bodies: BodyState, rows: list[int], gravity: F64) -> BodyState:
    """The bodies, some of which nothing bears any more: these fall and answer as if alone."""
    free = bodies.copied_rows()
    assert free.mobility is not None
    assert free.turning is not None
    free.acceleration[rows] = gravity
    free.mobility[rows] = free.inverse_mass[rows, None, None] * np.eye(3)
    free.turning[rows] = free.inverse_inertia[rows]
    return free
