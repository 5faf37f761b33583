"""Depth of points in a closed surface at its place."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ...geometry.solids import Solid
from ...worlds.arrays import F64, RigidPose
from ..liquid.filling import PlacedSolid

__all__ = ["Placed"]


class Placed:
    """A closed surface at its place."""

    def __init__(self, solid: Solid, pose: RigidPose) -> None:
        self.solid, self.pose = solid, pose
        self._placed = PlacedSolid("", solid, pose)

    @cached_property
    def box(self) -> tuple[F64, F64]:
        """Least and greatest corner in the world [m]."""
        return self._placed.box

    def depth(self, points: F64, reach: float) -> F64:
        """Depth of points below the surface (n,), negative outside, -inf outside and farther than `reach`, inf so far inside."""
        if not len(points):
            return np.zeros(0)
        distance, _ = self._placed.signed(points, reach)
        far = ~np.isfinite(distance)
        result = -distance
        if far.any():
            result[far] = np.where(self._placed.inside(points[far]), np.inf, -np.inf)
        return result
