"""Volumes of unions of convex solids, by manifold3d."""

from __future__ import annotations

from collections.abc import Sequence

from ..worlds.arrays import F64

__all__ = ["union_volume"]


def union_volume(pieces: Sequence[F64]) -> float:
    """Volume [m^3] of the union of the convex hulls of point sets, each of shape (n, 3)."""
    from manifold3d import Manifold, OpType

    hulls = [Manifold.hull_points(p) for p in pieces]
    return float(Manifold.batch_boolean(hulls, OpType.Add).volume())
