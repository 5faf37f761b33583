"""Share of a body that is under a liquid's surface, frame by frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from .about import COLUMN, Hull, Surroundings, hull_of, others_than
from .samples import shares_under

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from .frames import Liquid

__all__ = ["Submerged"]

NEAREST = 8
"""Columns of liquid about a body whose tops tell the level at a point of it."""


class Submerged:
    """Share of points inside an entity that are lower than the liquid that stands about it, with no solid between.

    `categories/liquid/about.py` says what stands about it.
    """

    def __init__(self, candidate: Candidate, entity: str, liquid: Liquid, member: int) -> None:
        self.candidate, self.entity, self.liquid, self.member = candidate, entity, liquid, member
        bodies = candidate.entity(entity).bodies
        self._hulls = {b.name: hull_of(liquid, f"{entity}/{b.name}") for b in bodies}
        self._walls = others_than(liquid, entity)
        self._step = float(np.cbrt(sum(b.volume for b in bodies) / sum(len(h.inside) for h in self._hulls.values())))

    def share(self, index: int) -> float:
        """The share at a frame, 0 to 1."""
        key = ("share under", self.entity, self.liquid.solver, self.member, index)
        return self.candidate.memo(key, lambda: self._share(index))

    def _share(self, index: int) -> float:
        frame = self.liquid.read(index)
        poses = {b: self.candidate.pose(self.entity, index, b) for b in self._hulls}
        hull = Hull(
            np.concatenate([poses[b].apply(h.inside) for b, h in self._hulls.items()]),
            np.concatenate([poses[b].apply(h.skin) for b, h in self._hulls.items()]),
        )
        position = frame.position[frame.fluid == self.member]
        return _under(self.liquid, position, Surroundings(self.liquid, self._walls, index, hull, position), self._step)


def _under(liquid: Liquid, position: F64, about: Surroundings, step: float) -> float:
    """Share of points inside a body that are wet: under the tops of the nearest columns of liquid that stand beside it."""
    from scipy.spatial import cKDTree

    s, points, skin = liquid.spacing, about.hull.inside, about.hull.skin
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    gap = np.maximum(low - position[:, :2], position[:, :2] - high).max(axis=1, initial=-np.inf)
    reach = max(4.0 * s, 0.25 * float((high - low).max()))
    rows = about.tops(position, position[:, :2], position[:, 2], np.flatnonzero(gap < reach), COLUMN * s)
    if not len(rows):
        return 0.0
    top = position[rows, 2]
    # Columns under the body end at its bottom; those beside it tell the level.
    middle = (np.floor(position[rows, :2] / (COLUMN * s)) + 0.5) * COLUMN * s
    beside = np.maximum(low - middle, middle - high).max(axis=1) > 0.25 * s
    if not beside.any():
        share, skinned = np.full(len(points), float((top > points[:, 2].max()).all())), np.ones(len(skin), dtype=bool)
    else:
        count, tree = min(NEAREST, int(beside.sum())), cKDTree(middle[beside])

        def level(places: F64) -> F64:
            at = np.asarray(tree.query(places[:, :2], k=count)[1]).reshape(len(places), count)
            return np.asarray(top[beside][at].mean(axis=1) + 0.5 * liquid.pitch)

        share, skinned = shares_under(points[:, 2], level(points), step), skin[:, 2] < level(skin)
    return float((share * about.wet(share > 0.0, skinned)).mean())
