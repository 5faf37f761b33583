"""Trunks and boulders that bodies meet, against those of the landscape: two routes to the same solids."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64, RigidPose
from ...worlds.landscape import SavedLandscape
from ...worlds.stems import ROCK_MIDDLE, SINK, Stems, stems_of
from .grounds import patches, solid_stems

if TYPE_CHECKING:
    from ...worlds.built import Convex
    from ...worlds.candidate import Candidate
    from ...worlds.spec import WorldSpec

__all__ = ["plant_lines", "stem_gap"]

AWAY = 1e9
"""Gap where there is nothing to compare with [m]."""


def stem_gap(candidate: Candidate, entity: str, name: str, land: SavedLandscape) -> float | None:
    """Largest difference of the solid trunks and boulders of a ground from the landscape's [m]; None where it has none.

    Place, radius and height of each against the nearest of the other side, both ways: one too many or too few counts as far as
    the next one is away.
    """
    names = {part for owner, part in solid_stems(candidate.spec, name) if owner == entity}
    if not names:
        return None
    pose = candidate.pose(entity, 0)
    pieces = [p for part in candidate.entity(entity).parts if part.part in names for p in part.collision]
    found = np.array([_measured(piece, pose) for piece in pieces]).reshape(-1, 5)
    stems = stems_of(land)
    grounds = [p for p in patches(candidate.spec, name) if p.entity == entity]
    wanted = np.concatenate([np.zeros((0, 5)), *(_wanted(stems.standing(p.low, p.high)) for p in grounds)])
    return max(_farthest(found, wanted), _farthest(wanted, found))


def _wanted(stems: Stems) -> F64:
    """Middle, radius and height of each, shape (n, 5)."""
    middle = stems.foot[:, 2] + np.where(stems.rock, ROCK_MIDDLE * stems.top, 0.5 * (stems.top - SINK))
    tall = np.where(stems.rock, 2.0 * (1.0 - ROCK_MIDDLE) * stems.top, stems.top + SINK)
    return np.column_stack([stems.foot[:, :2], middle, stems.radius, tall])


def _measured(piece: Convex, pose: RigidPose) -> list[float]:
    """Middle, radius and height of an upright solid in the world."""
    if piece.kind == "cylinder":
        return [*pose.apply(piece.pose.position[None])[0], piece.params[0], 2.0 * piece.params[1]]
    points = pose.apply(piece.pose.apply(piece.points))
    low, high = points.min(axis=0), points.max(axis=0)
    return [*(0.5 * (low + high)), 0.5 * float(high[0] - low[0]), float(high[2] - low[2])]


def _farthest(points: F64, others: F64) -> float:
    """Largest distance of a point from the nearest of others; `AWAY` without any."""
    from scipy.spatial import cKDTree

    if not len(points):
        return 0.0
    return float(cKDTree(others).query(points)[0].max()) if len(others) else AWAY


def plant_lines(spec: WorldSpec, name: str) -> list[dict[str, str]]:
    """Lines of the approximation register about plants of a landscape that bodies pass through."""
    solid = [entity for entity, _ in solid_stems(spec, name)]
    if not solid:
        return [{"what": f"plants of the landscape {name!r} are drawn only", "effect": "bodies pass through them"}]
    return [
        *(
            {
                "what": f"trunks and boulders within the ground {n!r} are solid, as cylinders and hulls of its material",
                "effect": "crowns, shrubs and saplings are not: bodies pass through them",
            }
            for n in solid
        ),
        {"what": f"other plants of the landscape {name!r} are drawn only", "effect": "bodies pass through them"},
    ]
