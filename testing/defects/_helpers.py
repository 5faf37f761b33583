"""Worlds in which something helps a block along: a loaded spring, or a body on a path that pushes it, directly or through others."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ...worlds.candidate import Candidate
from ...worlds.predicates import Displacement, Speed
from ...worlds.spec import Beat, ForceDriver, PathDriver, PathKey, Pose, ReleaseDriver, RigidSettings, SlideJoint, SpringJoint
from ..worlds.simulated_worlds import SLICK, beat, simulate
from ..worlds.small_worlds import box, ground, world

__all__ = ["guided_block", "pushed_row", "sprung_block"]

SIDE = 0.2
FRAMES = 30
STIFFNESS = 30.0
"""[N/m]"""


def _far(name: str, least: float) -> Displacement:
    return Displacement(entity=name, axis=(1, 0, 0), min=least)


def _block(x: float, *, speed: float = 0.0, y: float = 0.0) -> Any:
    return box(SIDE, SIDE, SIDE, motion="dynamic", at=(x, y, SIDE / 2), velocity=(speed, 0, 0))


def _run(folder: Path, entities: dict[str, Any], beats: dict[str, Beat], **more: Any) -> Candidate:
    spec = world(
        {"floor": ground(20), **entities}, frames=FRAMES, beats=beats, materials=SLICK, settings=RigidSettings(step=1e-3), **more
    )
    return simulate(folder, spec)


def sprung_block(folder: Path, *, load: float, told: str = "") -> Candidate:
    """A hitter sends a block off, and a spring from the floor pushes the block on.

    Args:
        folder: for the run.
        load: by how much the spring is shorter at frame 0 than at rest [m].
        told: `release`: a release that a beat owns lets the block go; `first`: a first beat is about the block; else nothing tells of it.
    """
    hits = beat("block", Speed(entity="block", min=0.05), frames=(1, 20), causes=() if told == "first" else ("comes",))
    beats = {
        "comes": beat("hitter", _far("hitter", 0.05), frames=(0, 10)),
        "hit": hits,
        "goes": beat(
            "block", _far("block", 0.2), frames=(2, FRAMES - 1), causes=("hit", "comes") if told == "first" else ("hit",)
        ),
    }
    drivers = {}
    if told == "release":
        drivers = {"latch": ReleaseDriver(entity="block", time=0.1)}
        beats["freed"] = beat("block", Speed(entity="block", min=0.02), frames=(1, 20), owner="latch")
        beats["hit"] = hits.model_copy(update={"causes": ["comes", "freed"]})
    spring = SpringJoint(
        parent="floor", child="block", parent_point=(-1, 0, 0), child_point=(0, 0, SIDE / 2), stiffness=STIFFNESS
    )
    spring = spring.model_copy(update={"rest_length": (1 + (SIDE / 2) ** 2) ** 0.5 + load})
    entities = {"hitter": _block(-0.4, speed=2.5), "block": _block(0.0)}
    return _run(folder, entities, beats, joints={"k": spring}, drivers=drivers)


def guided_block(folder: Path, *, speed: float, friction: float) -> Candidate:
    """A block that a hitter sends along the floor, on a slide that bears it.

    Args:
        folder: for the run.
        speed: of the hitter [m/s].
        friction: of the slide, as share of what the surfaces would have.
    """
    beats = {
        "comes": beat("hitter", _far("hitter", 0.05), frames=(0, 10)),
        "hit": beat("block", Speed(entity="block", min=0.05), frames=(1, 20), causes=("comes",)),
        "goes": beat("block", _far("block", 0.1), frames=(2, FRAMES - 1), causes=("hit",)),
    }
    weight = SLICK["wood"].density * SIDE**3 * 9.81
    rail = SlideJoint(
        parent="floor", child="block", anchor=(0, 0, 0), axis=(1, 0, 0), friction=friction * SLICK["wood"].friction * weight
    )
    return _run(folder, {"hitter": _block(-0.4, speed=speed), "block": _block(0.0)}, beats, joints={"rail": rail})


def pushed_row(folder: Path, *, between: int, told: bool, aside: bool = False, force: float = 0.0) -> Candidate:
    """A hand on a path pushes a block, through others that stand before it; another block has sent the first off.

    Args:
        folder: for the run.
        between: blocks between the hand and the last.
        told: whether the path owns a beat that leads to the last block's.
        aside: the hand pushes a block that nobody speaks of instead.
        force: a force on the first block in place of the hand [N].
    """
    row = [f"b{k}" for k in range(between)] + ["last"]
    entities = {name: _block(0.25 * k) for k, name in enumerate(row)}
    entities["other"] = _block(0.0, y=2.0)
    lane = 2.0 if aside else 0.0
    entities["hand"] = box(SIDE, SIDE, SIDE, motion="kinematic", at=(-0.3, lane, SIDE / 2))
    keys = {
        "a": PathKey(time=0.0, pose=Pose(position=(-0.3, lane, SIDE / 2))),
        "b": PathKey(time=1.2, pose=Pose(position=(1.0, lane, SIDE / 2))),
    }
    if aside:
        entities["last"] = _block(0.0, speed=2.0)
    beats = {
        "starts": beat("last", Speed(entity="last", min=0.05), frames=(0, FRAMES - 1), **({"owner": "p"} if told else {})),
        "moves": beat("last", _far("last", 0.2), frames=(1, FRAMES - 1), causes=("starts",)),
    }
    if force:
        del entities["hand"]
        push = ForceDriver(entity=row[0], force=(force, 0.0, 0.0), start=0.0, end=1.0)
        return _run(folder, entities, beats, drivers={"f": push})
    return _run(folder, entities, beats, drivers={"p": PathDriver(entity="hand", keys=keys)})
