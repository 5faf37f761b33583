"""Whether there is room where a correction would put something, and which parts may move without the rest of their entity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...geometry import signed_clearance
from ...worlds.arrays import F64, RigidPose

if TYPE_CHECKING:
    from .surfaces import Surfaces

__all__ = ["in_the_way", "moves_alone"]


def in_the_way(surfaces: Surfaces, rows: Sequence[int], offset: F64, but: Sequence[str] = ()) -> str | None:
    """An entity that some parts would overlap, or overlap deeper, after a move at frame 0; None where there is room.

    Args:
        surfaces: of the candidate.
        rows: the parts, by their places in `surfaces.parts`.
        offset: the move [m], shape (3,).
        but: entities that may be overlapped, since the move is away from them.
    """
    low, high = (box[:, 0] for box in surfaces.boxes(np.zeros(1, dtype=np.intp)))
    others = [j for j, p in enumerate(surfaces.parts) if j not in rows and p.entity not in but]
    for i in rows:
        one = surfaces.parts[i]
        here = surfaces.track(one.entity, one.body).at(0)
        there = RigidPose(here.position + offset, here.quaternion)
        for j in others:
            if (low[j] > high[i] + offset).any() or (high[j] < low[i] + offset).any():
                continue
            two = surfaces.parts[j]
            if two.entity == one.entity and _depth(surfaces, i, j, here) <= 0.0:
                continue  # parts that are joined stay so
            most = surfaces.noise(one.entity, two.entity) + surfaces.allowed_depth(one.entity, two.entity)
            after = _depth(surfaces, i, j, there)
            if after < -most and after < _depth(surfaces, i, j, here) - most:
                return two.entity
    return None


def moves_alone(surfaces: Surfaces, row: int) -> bool:
    """Whether a part is no whole entity and touches no other part of its own: it may be moved without them."""
    part = surfaces.parts[row]
    siblings = [j for j in surfaces.parts_of[part.entity] if j != row]
    if not siblings or part.part not in surfaces.candidate.spec.entities[part.entity].parts:
        return False
    gap, here = surfaces.candidate.spec.simulation.limits.contact_gap, surfaces.track(part.entity, part.body).at(0)
    low, high = (box[:, 0] for box in surfaces.boxes(np.zeros(1, dtype=np.intp)))
    near = [j for j in siblings if (low[j] <= high[row] + gap).all() and (high[j] >= low[row] - gap).all()]
    return all(_depth(surfaces, row, j, here) > gap for j in near)


def _depth(surfaces: Surfaces, i: int, j: int, pose: RigidPose) -> float:
    """Signed clearance of part i at a pose from part j where it is at frame 0 [m]."""
    two = surfaces.parts[j]
    solids = surfaces.shapes.solid(i, 0), surfaces.shapes.solid(j, 0)
    return float(signed_clearance(solids[0], pose, solids[1], surfaces.track(two.entity, two.body).at(0)).distance)
