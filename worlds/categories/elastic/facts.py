"""Facts that the specification alone tells about elastic bodies: numbers of cells and of steps (R62, R64)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .models import ElasticPhysics

if TYPE_CHECKING:
    from ...spec import Entity, WorldSpec

__all__ = ["cell_count", "elastic_seconds"]

CELL_STEPS = 2.5e3
"""Quadratic cells times steps a second of the engine: a usual rate. Own measurement."""
HALF = 0.5
"""Cells over the smallest extent where none are asked for: two."""


def cell_count(entity: Entity) -> int:
    """Cells of the box that an elastic body fills; 0 for any other entity."""
    if not isinstance(entity.physics, ElasticPhysics):
        return 0
    size = entity.dimensions.size
    edge = entity.physics.resolution or HALF * min(size)
    return math.prod(max(1, round(extent / edge)) for extent in size)


def elastic_seconds(spec: WorldSpec) -> float | None:
    """Seconds that the elastic bodies of a world will take by a usual rate; None without any."""
    plan = spec.simulation
    seconds = plan.lead + (plan.frames - 1) / plan.fps
    work = 0.0
    for solver in plan.rigid.values():
        cells = sum(cell_count(spec.entities[m]) for m in solver.members if m in spec.entities)
        work += cells * seconds / solver.settings.step
    return work / CELL_STEPS or None
