"""Velocities of a liquid at frame 0: one for all of it, and streams along declared courses (R57)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64, RigidPose

if TYPE_CHECKING:
    from ...worlds.spec import LiquidPhysics

__all__ = ["start_velocity"]

FINE = 16
"""Points per stretch of a course between which the nearest place is looked for: a sixteenth of a stretch turns little."""


def start_velocity(physics: LiquidPhysics, pose: RigidPose, points: F64) -> F64:
    """Velocity of every particle at frame 0 (n, 3) [m/s].

    Within half its width from the course of a current, seen from above, a particle has the speed and direction of the nearest place
    on it; where two currents meet, those of the nearer one. Everywhere else it has `linear_velocity`.

    Args:
        physics: of the liquid.
        pose: of its entity.
        points: of the particles, world (n, 3) [m].
    """
    from scipy.spatial import cKDTree

    found = np.tile(np.array(physics.linear_velocity, dtype=np.float64), (len(points), 1))
    nearest = np.full(len(points), np.inf)
    for current in physics.currents.values():
        line = pose.apply(np.array(current.line, dtype=np.float64))
        known = np.arange(len(line))
        at = np.linspace(0, len(line) - 1, FINE * (len(line) - 1) + 1)
        places = np.column_stack([np.interp(at, known, line[:, k]) for k in range(3)])
        along = np.gradient(line, axis=0)
        along = np.column_stack([np.interp(at, known, along[:, k]) for k in range(3)])
        along /= np.maximum(np.linalg.norm(along, axis=1), 1e-12)[:, None]
        away, which = cKDTree(places[:, :2]).query(points[:, :2])
        runs = (away <= 0.5 * current.width) & (away < nearest)
        nearest[runs] = away[runs]
        found[runs] = np.interp(at, known, current.speeds)[which[runs], None] * along[which[runs]]
    return found
