"""Seeded defects of liquids that are not resolved, or that stay where nothing bears them, and sound worlds that look like them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ...worlds.spec import Entity, OutflowDriver
from ..worlds import small_worlds as sw
from ..worlds.liquid_worlds import Flow, stream
from . import _liquid_scenes as scenes
from ._liquid_scenes import SPACING
from .cases import World

__all__ = [
    "apex", "clinging", "film", "ledge", "narrow_way", "parted", "slot", "slotted", "thin_pool", "thin_wall", "tight_drain", "tight_tap",
]  # fmt: skip


def parted(rng: np.random.Generator, width: float, wall: float = 0.04) -> Flow:
    """A pool that two posts part but for a way of `width` [m] between them, through which it stands at one level."""
    flow = scenes.pool(rng)
    points = flow.position[0]
    x, y, top = (np.unique(np.round(points[:, a], 9)) for a in range(3))
    at = 0.5 * (x[len(x) // 2 - 1] + x[len(x) // 2])
    lines = max(1, round(width / SPACING))
    first = (len(y) - lines) // 2 + int(rng.integers(-1, 2))
    middle = float(np.mean(y[first : first + lines]))
    side, height = float(y[-1]) + SPACING / 2, 2.0 * (float(top[-1]) + SPACING / 2)
    inside = (np.abs(points[:, 0] - at) < wall / 2) & (np.abs(points[:, 1] - middle) > width / 2)
    # The posts take as much room as the particles did that were there, so that what is left is what was declared.
    thick = round(wall / SPACING) * SPACING * (len(y) - lines) / (len(y) - width / SPACING)
    posts = {}
    for name, low, high in (("near_post", -side, middle - width / 2), ("far_post", middle + width / 2, side)):
        posts[name] = sw.box(thick, high - low, height, at=(at, (low + high) / 2, height / 2))
    return _without(flow, inside, posts)


def _without(flow: Flow, gone: np.ndarray, others: Mapping[str, Entity]) -> Flow:
    """A flow that stands still without some of its particles, with further solids."""
    points = flow.position[0][~gone]
    plan = flow.spec.simulation
    rigid = plan.solvers["rigid"]
    solvers = {**plan.solvers, "rigid": rigid.model_copy(update={"members": [*rigid.members, *others]})}
    spec = flow.spec.model_copy(
        update={"entities": {**flow.spec.entities, **others}, "simulation": plan.model_copy(update={"solvers": solvers})}
    )
    return flow.edited(
        spec=spec,
        position=[points.copy() for _ in range(flow.frames)],
        velocity=[np.zeros_like(points) for _ in range(flow.frames)],
        identity=[np.arange(len(points))] * flow.frames,
        colliders=(*flow.colliders, *(f"{n}/body" for n in others)),
    )


def narrow_way(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Water stands on both sides of a way of `magnitude` spacings."""
    return World(parted(rng, magnitude * SPACING).candidate(folder), ("near_post", "far_post"))


def slotted(rng: np.random.Generator, width: float) -> Flow:
    """A pool that stands in a tank whose floor has a slot of `width` [m], which its spacing does not see."""
    return scenes.pool(rng, gap=width)


def slot(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Nothing comes through a slot of `magnitude` [m] that liquid would run out of."""
    return World(slotted(rng, magnitude).candidate(folder), ("tank",))


def thin_pool(rng: np.random.Generator, layers: float) -> Flow:
    """A crate floats in water so many layers deep."""
    return scenes.crate_afloat(rng, depth=round(layers) * SPACING, density=100.0)


def film(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body floats on `magnitude` layers of water."""
    return World(thin_pool(rng, magnitude).candidate(folder), ("pool", "water"))


def thin_wall(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The tank's walls and floor are `magnitude` spacings thick."""
    return World(scenes.pool(rng, wall=magnitude * SPACING).candidate(folder), ("tank",))


def tight_tap(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The opening of an inflow is `magnitude` spacings wide."""
    flow = stream(width=magnitude * SPACING, speed=float(rng.uniform(0.5, 2.0)))
    return World(flow.candidate(folder), ("pool",))


def tight_drain(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The box of an outflow is `magnitude` spacings wide; it stands where no water is."""
    flow = scenes.pool(rng)
    size = (magnitude * SPACING, float(rng.uniform(0.5, 1.0)) * magnitude * SPACING, 0.1)
    drain = OutflowDriver(entity="pool", pose=sw.pose((0.0, 0.0, 0.4)), size=size)
    plan = flow.spec.simulation.model_copy(update={"drivers": {"drain": drain}})
    made = flow.edited(spec=flow.spec.model_copy(update={"simulation": plan}), outflow={"drain": np.zeros(flow.frames)})
    return World(made.candidate(folder), ("pool",))


def clinging(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """`magnitude` particles of the uppermost layer are on a wall over the water, or under a lid, and stay there."""
    flow = scenes.pool(rng)
    points = flow.position[0]
    count, side, top = round(magnitude), float(points[:, 0].max()), float(points[:, 2].max())
    upper = np.flatnonzero(points[:, 2] > top - 0.5 * SPACING)
    rows = upper[: min(count, len(upper))]
    lid = bool(rng.integers(2))
    made = flow
    if lid:
        high = 2.0 * top
        made = _without(
            flow, np.zeros(len(points), dtype=bool), {"lid": sw.box(0.6, 0.5, 0.04, at=(0, 0, high + 0.02 + SPACING / 2))}
        )
        place = points[rows] * [1, 1, 0] + [0, 0, high]
    else:
        lines = np.unique(np.round(points[:, 1], 6))
        place = np.array([[side, lines[k % len(lines)], top + (4.0 + k // len(lines)) * SPACING] for k in range(len(rows))])
        keep = place[:, 2] < 2.0 * (top + SPACING / 2)
        rows, place = rows[keep], place[keep]
    for k in range(made.frames):
        made.position[k] = made.position[k].copy()
        made.position[k][rows] = place
    return World(made.candidate(folder), ("lid", "tank"))


def ledge(rng: np.random.Generator, count: float) -> Flow:
    """Water lies on a ledge that sticks out of the tank's wall."""
    flow = scenes.pool(rng)
    points = flow.position[0]
    side, top = float(points[:, 0].max()) + SPACING / 2, float(points[:, 2].max())
    shelf = sw.box(0.08, 0.1, 0.02, at=(side - 0.04, 0.0, top + 3.0 * SPACING))
    made = _without(flow, np.zeros(len(points), dtype=bool), {"shelf": shelf})
    rows = np.flatnonzero(points[:, 2] > top - 0.5 * SPACING)[: round(count)]
    grid = np.stack(np.meshgrid(np.arange(4), np.arange(5), indexing="ij"), axis=-1).reshape(-1, 2)[: len(rows)]
    place = np.column_stack(
        [side - 0.07 + grid[:, 0] * SPACING, -0.04 + grid[:, 1] * SPACING, np.full(len(grid), top + 4.0 * SPACING)]
    )
    for k in range(made.frames):
        made.position[k][rows[: len(place)]] = place
    return made


def apex(rng: np.random.Generator, speed: float) -> Flow:
    """A block of water thrown upwards beside a wall, which turns round at the top of its way."""
    flow = scenes.falling(rng)
    made = flow.edited()
    for k in range(flow.frames):
        made.position[k] = made.position[k] + np.array([0.0, 0.0, speed * k / 24])
        made.velocity[k] = made.velocity[k] + np.array([0.0, 0.0, speed])
    pool = flow.spec.entities["pool"]
    physics = pool.physics.model_copy(update={"linear_velocity": (0.0, 0.0, speed)})
    side = float(np.abs(flow.position[0][:, 0]).max())
    wall = {"wall": sw.box(0.04, 0.4, 3.0, at=(side + SPACING / 2 + 0.02, 0.0, 1.5))}
    entities = {**flow.spec.entities, "pool": pool.model_copy(update={"physics": physics}), **wall}
    plan = flow.spec.simulation
    rigid = plan.solvers["rigid"]
    solvers = {**plan.solvers, "rigid": rigid.model_copy(update={"members": [*rigid.members, "wall"]})}
    spec = flow.spec.model_copy(update={"entities": entities, "simulation": plan.model_copy(update={"solvers": solvers})})
    return made.edited(spec=spec, colliders=(*flow.colliders, "wall/body"))
