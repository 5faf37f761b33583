"""A crate that goes up and down in a tank as told, with the impulses on it worked out from that way: who carries it is told too."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec import Material
from . import small_worlds as sw
from .liquid_worlds import Flow, G, pool_in_tank

__all__ = ["EDGE", "crate_in_tank"]

EDGE = 0.1
"""Edge of the crate [m]."""
SPACING = 0.02
FPS = 24


def crate_in_tank(
    heights: F64 | Sequence[float],
    *,
    density: float = 500.0,
    depth: float = 0.2,
    tank_share: F64 | float = 0.0,
    other_share: F64 | float = 0.0,
) -> Flow:
    """A crate whose middle is at some heights over the tank's floor, frame by frame; still water makes room for it.

    Args:
        heights: [m], shape (frames,).
        density: of the crate [kg/m^3].
        depth: of the water [m].
        tank_share: share of its weight that the tank's floor carries over each interval; the log of contacts tells of it.
        other_share: share of its weight that something else carries which no log tells of, as a rope does; negative: it presses down.
    """
    z = np.asarray(heights, dtype=np.float64)
    frames = len(z)
    crate = sw.box(EDGE, EDGE, EDGE, motion="dynamic", at=(0.0, 0.0, float(z[0]))).model_copy(update={"material": "cork"})
    flow = pool_in_tank(
        size=(0.36, 0.32, depth), spacing=SPACING, frames=frames, others={"crate": crate}, two_way=True, below=0.1
    )
    spec = flow.spec.model_copy(update={"materials": {**flow.spec.materials, "cork": Material(density=density)}})
    points, ids = flow.position[0], np.asarray(flow.identity[0])
    kept = [~(np.abs(points - (0.0, 0.0, float(h))) < EDGE / 2).all(axis=1) for h in z]
    mass, step = density * EDGE**3, 1.0 / FPS
    speed = np.gradient(z, step)
    needed = np.concatenate([[0.0], mass * np.diff(speed) + mass * G * step])
    floor, other = (
        np.broadcast_to(np.asarray(s, dtype=np.float64), (frames,)) * mass * G * step for s in (tank_share, other_share)
    )
    push = np.zeros((frames, 6))
    push[1:, 2] = (needed - floor - other)[1:]
    row = flow.colliders.index("crate/body")
    touches = [sw.Touch(k, "tank", "crate", float(floor[k])) for k in range(1, frames) if floor[k] > 0.0]
    return flow.edited(
        spec=spec,
        position=[points[k] for k in kept],
        velocity=[np.zeros_like(points[k]) for k in kept],
        identity=[ids[k] for k in kept],
        share={row: push},
        tracks={"crate": (np.stack([0 * z, 0 * z, z], axis=1), sw.IDENTITY)},
        rigid={"exchange/impulse": push[:, None]},
        touches=touches,
    )
