"""Estimate of how many bodies stand in each other, before every pair of them is measured exactly."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..worlds.arrays import F64, pose_of
from ..worlds.built import BuiltEntity
from ..worlds.limits import check_cap
from ..worlds.spec import WorldSpec

__all__ = ["check_crowding", "crowded_pairs"]

SHARE = 0.5
"""Boxes that share this part of the smaller one's volume count as standing in each other."""
ALIKE = 100.0
"""Boxes whose volumes differ by more do not: things stand in the box of a room or a bowl by right."""
SAMPLED = 256


def check_crowding(spec: WorldSpec, built: Mapping[str, BuiltEntity]) -> None:
    """Refuse a scene in which too many entities stand in each other: each such pair takes milliseconds to measure.

    Raises:
        LimitError: with the estimated number of pairs.
    """
    if len(built) > SAMPLED:
        check_cap("crowded_pairs", crowded_pairs(spec, built), what="entities that stand in each other")


def crowded_pairs(spec: WorldSpec, built: Mapping[str, BuiltEntity]) -> float:
    """Pairs of entities whose boxes at frame 0 mostly coincide, estimated from a sample of entities."""
    boxes = np.array([_box(spec, name, built[name]) for name in sorted(built)])
    low, high = boxes[:, 0], boxes[:, 1]
    volumes = np.prod(high - low, axis=1)
    chosen = np.unique(np.linspace(0, len(boxes) - 1, min(SAMPLED, len(boxes))).astype(int))
    found = 0
    for k in chosen:
        shared = np.prod(np.clip(np.minimum(high, high[k]) - np.maximum(low, low[k]), 0.0, None), axis=1)
        smaller, larger = np.minimum(volumes, volumes[k]), np.maximum(volumes, volumes[k])
        found += int(((shared > SHARE * smaller) & (larger < ALIKE * smaller)).sum()) - 1
    return 0.5 * max(0, found) * len(boxes) / len(chosen)


def _box(spec: WorldSpec, name: str, entity: BuiltEntity) -> tuple[F64, F64]:
    poses = {body.name: body.pose for body in entity.bodies}
    place = pose_of(spec.entities[name].pose)
    points = np.concatenate([place.apply(poses[part.body].apply(part.render.vertices)) for part in entity.parts])
    return points.min(axis=0), points.max(axis=0)
