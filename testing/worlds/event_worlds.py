"""Small worlds in each of which one kind of event happens to a body, or something near it: run by the engine, named by what is true."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from ...worlds.spec import (
    Entity,
    ForceDriver,
    Material,
    PathDriver,
    PathKey,
    Pose,
    ReleaseDriver,
    RigidSettings,
    WorldSpec,
)
from ...worlds.vocabulary import SpecModel
from .small_worlds import ball, box, ground, world

__all__ = ["EVENT_WORLDS", "event_world"]

SETTINGS = RigidSettings(step=1e-3)
SLIPPERY = {"wood": Material(density=600.0, friction=0.05, restitution=0.0, substance="wood")}
BOUNCY = {"wood": Material(density=600.0, friction=0.4, restitution=0.7, substance="wood")}
GRIPPY = {"wood": Material(density=600.0, friction=0.9, restitution=0.0, substance="wood")}


def _path(name: str, keys: Sequence[tuple[float, Sequence[float]]], euler: Sequence[Sequence[float]] | None = None) -> PathDriver:
    turns = euler or [(0.0, 0.0, 0.0)] * len(keys)
    made = {
        f"k{i}": PathKey(time=t, pose=Pose(position=tuple(map(float, at)), euler=tuple(map(float, turn))))
        for i, ((t, at), turn) in enumerate(zip(keys, turns, strict=True))
    }
    return PathDriver(entity=name, keys=made)


def _world(
    entities: Mapping[str, Entity], *, frames: int = 36, drivers: Mapping[str, SpecModel] | None = None, **more: object
) -> WorldSpec:
    return world({"floor": ground(20.0), **entities}, frames=frames, settings=SETTINGS, drivers=dict(drivers or {}), **more)  # type: ignore[arg-type]


def drop() -> WorldSpec:
    """A ball falls 1 m onto the floor and stays."""
    return _world({"ball": ball(0.1, motion="dynamic", at=(0, 0, 1.1))}, materials=GRIPPY)


def bounce() -> WorldSpec:
    """A ball falls 1 m onto the floor, bounces off it and comes down again."""
    return _world({"ball": ball(0.1, motion="dynamic", at=(0, 0, 1.1))}, materials=BOUNCY)


def rest() -> WorldSpec:
    """A box stands on another throughout."""
    lower, upper = (box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, z)) for z in (0.101, 0.302))
    return _world({"lower": lower, "box": upper})


def lowered() -> WorldSpec:
    """A platform on a path takes a box down by 0.8 m in 1.2 s."""
    platform = box(0.4, 0.4, 0.05, motion="kinematic", at=(0, 0, 1.0))
    return _world(
        {"hand": platform, "box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 1.126))},
        drivers={"path": _path("hand", [(0.0, (0, 0, 1.0)), (0.3, (0, 0, 0.96)), (1.2, (0, 0, 0.2))])},
    )


def lifted() -> WorldSpec:
    """A platform on a path takes a box up by 0.8 m in 1.2 s."""
    platform = box(0.4, 0.4, 0.05, motion="kinematic", at=(0, 0, 0.2))
    return _world(
        {"hand": platform, "box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.326))},
        drivers={"path": _path("hand", [(0.0, (0, 0, 0.2)), (0.3, (0, 0, 0.24)), (1.2, (0, 0, 1.0))])},
    )


def roll() -> WorldSpec:
    """A ball rolls along the floor."""
    start = ball(0.1, motion="dynamic", at=(0, 0, 0.101), velocity=(1.0, 0, 0))
    physics = start.physics.model_copy(update={"angular_velocity": (0.0, 10.0, 0.0)})
    return _world({"ball": start.model_copy(update={"physics": physics})}, materials=GRIPPY)


def slide() -> WorldSpec:
    """A box slides along the floor until friction stops it."""
    return _world({"box": box(0.2, 0.2, 0.1, motion="dynamic", at=(0, 0, 0.051), velocity=(2.0, 0, 0))})


def slip() -> WorldSpec:
    """A ball slides along a slippery floor and hardly turns."""
    return _world({"ball": ball(0.1, motion="dynamic", at=(0, 0, 0.101), velocity=(1.5, 0, 0))}, materials=SLIPPERY, frames=20)


def topple() -> WorldSpec:
    """A slab gets a turn at the start, passes its balance and falls flat."""
    slab = box(0.04, 0.1, 0.3, motion="dynamic", at=(0, 0, 0.151))
    physics = slab.physics.model_copy(update={"angular_velocity": (0.0, 2.5, 0.0), "linear_velocity": (0.375, 0.0, 0.0)})
    return _world({"slab": slab.model_copy(update={"physics": physics})}, materials=GRIPPY)


def rock() -> WorldSpec:
    """A slab gets a turn at the start, does not reach its balance and rocks back."""
    slab = box(0.1, 0.1, 0.3, motion="dynamic", at=(0, 0, 0.151))
    physics = slab.physics.model_copy(update={"angular_velocity": (0.0, 1.5, 0.0), "linear_velocity": (0.22, 0.0, 0.0)})
    return _world({"slab": slab.model_copy(update={"physics": physics})}, materials=GRIPPY)


def laid_down() -> WorldSpec:
    """A plank stands with one edge on the floor; a platform on a path takes its other end down."""
    lean = math.asin(0.5)
    plank = box(1.0, 0.2, 0.04, motion="dynamic", at=(0, 0, 0.5 * 0.5 + 0.03), euler=(0, -lean, 0))
    hand = box(0.06, 0.2, 0.1, motion="kinematic", at=(0.36, 0, 0.38))
    keys = [(0.0, (0.36, 0, 0.38)), (0.4, (0.36, 0, 0.33)), (1.5, (0.36, 0, 0.06))]
    return _world({"plank": plank, "hand": hand}, frames=48, materials=GRIPPY, drivers={"path": _path("hand", keys)})


def push() -> WorldSpec:
    """A hand on a path pushes a box 0.6 m along the floor."""
    hand = box(0.1, 0.2, 0.2, motion="kinematic", at=(-0.16, 0, 0.12))
    return _world(
        {"hand": hand, "box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.101))},
        drivers={"path": _path("hand", [(0.0, (-0.16, 0, 0.12)), (1.2, (0.5, 0, 0.12))])},
    )


def hit() -> WorldSpec:
    """A box slides into another that rests and sends it off."""
    one, two = (box(0.2, 0.2, 0.2, motion="dynamic", at=(x, 0, 0.101), velocity=(v, 0, 0)) for x, v in ((-0.5, 3.0), (0.0, 0.0)))
    return _world({"hitter": one, "box": two}, materials={"wood": BOUNCY["wood"].model_copy(update={"friction": 0.2})})


def shove() -> WorldSpec:
    """A force moves a box sideways along the floor."""
    return _world(
        {"box": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.101))},
        drivers={"wind": ForceDriver(entity="box", force=(40.0, 0.0, 0.0), start=0.1, end=0.8)},
    )


def held() -> WorldSpec:
    """A ball is held in the air throughout."""
    return _world(
        {"ball": ball(0.1, motion="dynamic", at=(0, 0, 1.1))}, drivers={"latch": ReleaseDriver(entity="ball", time=100.0)}
    )


def spin() -> WorldSpec:
    """A disc of a box turns on the spot, about the upright axis, in the air without gravity."""
    disc = box(0.2, 0.2, 0.05, motion="dynamic", at=(0, 0, 1.0))
    physics = disc.physics.model_copy(update={"angular_velocity": (0.0, 0.0, 12.0)})
    return _world({"box": disc.model_copy(update={"physics": physics})}, gravity=(0.0, 0.0, 0.0))


EVENT_WORLDS: Mapping[str, Callable[[], WorldSpec]] = {
    make.__name__: make
    for make in (
        drop,
        bounce,
        rest,
        lowered,
        lifted,
        roll,
        slide,
        slip,
        topple,
        rock,
        laid_down,
        push,
        hit,
        shove,
        held,
        spin,
    )
}
"""By name."""


def event_world(name: str) -> WorldSpec:
    """The specification of a world."""
    return EVENT_WORLDS[name]()
