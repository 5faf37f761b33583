"""Inflows and outflows that hold a level, and what passes them while the surface is on the wrong side of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...worlds.spec import OutflowDriver
from ..worlds import small_worlds as sw
from ..worlds.liquid_worlds import DENSITY, Flow, stream
from . import _liquid_scenes as scenes
from ._liquid_scenes import SPACING
from .cases import World

__all__ = ["feeding", "overdrained", "overfilled"]


def _holding(flow: Flow, name: str, **more: object) -> Flow:
    """A copy whose driver holds a level."""
    plan = flow.spec.simulation
    drivers = {**plan.drivers, name: plan.drivers[name].model_copy(update=more)}
    return flow.edited(spec=flow.spec.model_copy(update={"simulation": plan.model_copy(update={"drivers": drivers})}))


def overfilled(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A tap runs though the water over its gauge, its own jet, stands `magnitude` [m] above the level that it is to hold."""
    height = 0.8
    flow = stream(speed=float(rng.uniform(2.0, 3.0)), height=height)
    return World(_holding(flow, "tap", level=height - magnitude).candidate(folder), ("water",))


def feeding(rng: np.random.Generator, level: float) -> Flow:
    """The same tap with its gauge where no water is yet."""
    flow = stream(speed=float(rng.uniform(0.8, 2.0)))
    return _holding(flow, "tap", level=level, gauge=(0.2, float(rng.uniform(-0.2, 0.2))))


def overdrained(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A drain takes water out of a pool whose surface is `magnitude` spacings below the level that it is to hold."""
    flow = scenes.pool(rng)
    points = flow.position[0]
    size = (4.0 * SPACING, 4.0 * SPACING, 3.0 * SPACING)
    taken = (np.abs(points - [0.0, 0.0, 0.5 * size[2]]) < 0.5 * np.array(size)).all(axis=1)
    first = int(rng.integers(2, flow.frames - 2))
    level = float(points[:, 2].max()) + (0.5 + magnitude) * SPACING
    drain = OutflowDriver(entity="pool", pose=sw.pose((0.0, 0.0, 0.5 * size[2])), size=size, level=level)
    plan = flow.spec.simulation.model_copy(update={"drivers": {"drain": drain}})
    mass = np.where(np.arange(flow.frames) >= first, int(taken.sum()) * flow.volume * DENSITY, 0.0)
    made = flow.edited(spec=flow.spec.model_copy(update={"simulation": plan}), outflow={"drain": mass})
    for k in range(first, flow.frames):
        made.position[k], made.velocity[k], made.identity[k] = (
            x[~taken] for x in (made.position[k], made.velocity[k], made.identity[k])
        )
    return World(made.candidate(folder), ("water",))
