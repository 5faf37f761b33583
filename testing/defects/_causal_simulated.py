"""Simulated worlds of the causal suite, with checkpoints: only a run without the cause tells them apart."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.predicates import Contact, Displacement, Reaches
from ...worlds.spec import BoxRegion, CausalMargin, DetachDriver, Entity, ForceDriver, PathDriver, ReleaseDriver, WeldJoint
from ..worlds.simulated_worlds import SLICK, beat, simulate
from ..worlds.small_worlds import ball, box, ground, world
from .cases import Mechanism, World

__all__ = ["SIMULATED"]

FRAMES = 17
LAST = FRAMES - 1
Rng = np.random.Generator


def _blocks(rng: Rng, *, speed: float = 1.5) -> tuple[dict[str, Entity], float]:
    """A block slides towards another along x; the second one's coordinate."""
    gap = float(rng.uniform(0.05, 0.15))
    z = 0.051
    return {
        "floor": ground(),
        "a": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, z), velocity=(speed, 0, 0)),
        "b": box(0.1, 0.1, 0.1, motion="dynamic", at=(0.1 + gap, 0, z)),
    }, 0.1 + gap


HIT = beat("b", Contact(a="a", b="b"), frames=(1, LAST))


def _moves(name: str, least: float, *, causes: list[str], **more: Any) -> Any:
    return beat(name, Displacement(entity=name, min=least), frames=(1, LAST), causes=causes, **more)


def _wind_does_it(folder: Path, magnitude: float, rng: Rng) -> World:
    """A force `magnitude` times what is needed moves what was struck, struck or not."""
    entities, _ = _blocks(rng, speed=0.7)
    force = magnitude * (0.6 * 0.1 * 9.81 + 2 * 0.6 * 0.03 / (0.45 * LAST / 24) ** 2)
    wind = ForceDriver(entity="b", force=(force, 0, 0), start=float(rng.uniform(0.0, 0.1)), end=2.0)
    beats = {"hit": HIT, "slides": _moves("b", 0.03, causes=["hit"])}
    spec = world(entities, beats=beats, drivers={"wind": wind}, frames=FRAMES, materials=SLICK)
    return World(simulate(folder, spec), ("b",))


def _cut_by_the_clock(folder: Path, magnitude: float, rng: Rng) -> World:
    """A hanging ball is touched by a rolling one, and cut off `magnitude` seconds after."""
    height, gap = 0.3, float(rng.uniform(0.05, 0.1))
    entities = {
        "floor": ground(),
        "shelf": box(0.4, 0.2, 0.1, at=(-0.2, 0, height - 0.05)),
        "a": ball(0.03, motion="dynamic", at=(-0.011 - gap, 0, height + 0.031), velocity=(1.2, 0, 0)),
        "b": ball(0.03, motion="dynamic", at=(0.05, 0, height + 0.031)),
    }
    cut = DetachDriver(joint="glue", time=gap / 1.2 + magnitude)
    regions = {"low": BoxRegion(min=(-9, -9, -1), max=(9, 9, 0.25))}
    beats = {
        "touch": beat("b", Contact(a="a", b="b"), frames=(1, LAST)),
        "falls": beat("b", Reaches(entity="b", region="low"), frames=(1, LAST), causes=["touch"]),
    }
    joints = {"glue": WeldJoint(child="b", anchor=(0.05, 0, height + 0.03))}
    spec = world(entities, beats=beats, joints=joints, drivers={"cut": cut}, regions=regions, frames=FRAMES + 6)
    return World(simulate(folder, spec), ("b",))


def _brushed(folder: Path, magnitude: float, rng: Rng) -> World:
    """A ball runs over something `magnitude` metres small on its way to its goal."""
    entities = {
        "floor": ground(),
        "ball": ball(0.08, motion="dynamic", at=(0, 0, 0.081), velocity=(2, 0, 0)),
        "tuft": box(*(magnitude,) * 3, motion="dynamic", at=(float(rng.uniform(0.3, 0.5)), 0, magnitude / 2 + 1e-3)),
    }
    regions = {"goal": BoxRegion(min=(0.7, -1, 0), max=(9, 1, 2))}
    beats = {
        "brush": beat("ball", Contact(a="ball", b="tuft"), frames=(1, LAST)),
        "goal": beat("ball", Reaches(entity="ball", region="goal"), frames=(1, LAST), causes=["brush"]),
    }
    return World(simulate(folder, world(entities, beats=beats, regions=regions, frames=FRAMES, materials=SLICK)), ("ball",))


def _sweep(folder: Path, magnitude: float, rng: Rng) -> World:
    """A driven bar strikes one block and then another, `magnitude` metres on and to the side."""
    side = float(rng.choice((-1.0, 1.0))) * 0.16
    z = 0.051
    entities = {
        "floor": ground(),
        "bar": box(0.05, 0.6, 0.06, motion="kinematic", at=(-0.15, 0, 0.06)),
        "a": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, z)),
        "b": box(0.1, 0.1, 0.1, motion="dynamic", at=(magnitude, side, z)),
    }
    keys = {
        "s": {"time": 0.05, "pose": {"position": (-0.15, 0, 0.06)}},
        "e": {"time": 0.65, "pose": {"position": (0.35, 0, 0.06)}},
    }
    bar = PathDriver(entity="bar", keys=keys)
    beats = {
        "one": beat("a", Contact(a="bar", b="a"), frames=(1, LAST)),
        "two": _moves("b", 0.05, causes=["one"]),
    }
    return World(simulate(folder, world(entities, beats=beats, drivers={"go": bar}, frames=FRAMES, materials=SLICK)), ("b",))


def _together(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two balls fall side by side, `magnitude` metres apart, and land in the same frame."""
    height = float(rng.uniform(0.2, 0.4))
    entities = {"floor": ground()} | {
        n: ball(0.05, motion="dynamic", at=(x, 0, height + 0.05)) for n, x in (("a", 0.0), ("b", 0.1 + magnitude))
    }
    beats = {
        "one": beat("a", Contact(a="a", b="floor"), frames=(1, LAST)),
        "two": beat("b", Contact(a="b", b="floor"), frames=(1, LAST), causes=["one"]),
    }
    return World(simulate(folder, world(entities, beats=beats, frames=FRAMES)), ("b",))


# ---------------------------------------------------------------- clean


def _struck(folder: Path, magnitude: float, rng: Rng) -> World:
    """The struck body slides on; a wind too weak to move it blows all the while, at `magnitude` of its friction."""
    entities, _ = _blocks(rng)
    wind = ForceDriver(entity="b", force=(magnitude * 0.6 * 0.1 * 9.81, 0, 0), end=2.0)
    beats = {"hit": HIT, "slides": _moves("b", 0.05, causes=["hit"])}
    return World(simulate(folder, world(entities, beats=beats, drivers={"wind": wind}, frames=FRAMES, materials=SLICK)))


def _row(folder: Path, magnitude: float, rng: Rng) -> World:
    """A row of blocks with gaps of `magnitude` metres."""
    entities, x = _blocks(rng, speed=3.0)
    for k, name in enumerate("cd"):
        entities[name] = box(0.1, 0.1, 0.1, motion="dynamic", at=(x + (0.1 + magnitude) * (k + 1), 0, 0.051))
    beats = {"hit": HIT, "last": _moves("d", 0.02, causes=["hit"])}
    return World(simulate(folder, world(entities, beats=beats, frames=FRAMES, materials=SLICK)))


def _rebound(folder: Path, magnitude: float, rng: Rng) -> World:
    """A ball comes back from a wall at restitution `magnitude`."""
    far = float(rng.uniform(0.25, 0.4))
    entities = {
        "floor": ground(),
        "wall": box(0.1, 1.0, 0.6, at=(far + 0.1, 0, 0.3)),
        "ball": ball(0.05, motion="dynamic", at=(0, 0, 0.5), velocity=(2.5, 0, 0)),
    }
    matter = {"wood": SLICK["wood"].model_copy(update={"restitution": magnitude})}
    beats = {
        "bounce": beat("ball", Contact(a="ball", b="wall"), frames=(1, LAST)),
        "back": beat(
            "ball",
            Displacement(entity="ball", axis=(1, 0, 0), max=far - 0.06),
            frames=(6, LAST),
            causes=["bounce"],
        ),
    }
    return World(simulate(folder, world(entities, beats=beats, frames=FRAMES, materials=matter)))


def _let_go(folder: Path, magnitude: float, rng: Rng) -> World:
    """A ball is released over a block, falls `magnitude` metres and pushes it down a step."""
    entities = {
        "floor": ground(),
        "a": ball(0.05, motion="dynamic", at=(0, 0, 0.15 + magnitude)),
        "b": box(0.1, 0.1, 0.1, motion="dynamic", at=(float(rng.uniform(0.0, 0.01)), 0, 0.051)),
    }
    go = ReleaseDriver(entity="a", time=float(rng.uniform(0.0, 0.1)))
    beats = {
        "go": beat("a", Displacement(entity="a", min=0.01), frames=(1, LAST), owner="go"),
        "lands": beat("a", Contact(a="a", b="b", min_impulse=0.01), frames=(1, LAST), causes=["go"]),
    }
    return World(simulate(folder, world(entities, beats=beats, drivers={"go": go}, frames=FRAMES)))


def _hastened(folder: Path, magnitude: float, rng: Rng) -> World:
    """A force does it as well, but later: the beat says by how much the hit hastens it."""
    entities, _ = _blocks(rng)
    wind = ForceDriver(entity="b", force=(magnitude * 0.6 * 0.1 * 9.81, 0, 0), start=0.25, end=2.0)
    late = _moves("b", 0.04, causes=["hit"], margins={"hit": CausalMargin(frames=2)})
    beats = {"hit": HIT, "slides": late}
    return World(simulate(folder, world(entities, beats=beats, drivers={"wind": wind}, frames=FRAMES + 6, materials=SLICK)))


def _within_noise(folder: Path, magnitude: float, rng: Rng) -> World:
    """A ball of `magnitude` metres hits what a force moves anyway; the beat asks for next to no change."""
    entities = {
        "floor": ground(),
        "a": ball(magnitude, motion="dynamic", at=(float(rng.uniform(0.0, 0.02)), 0, 0.001 + magnitude), velocity=(1.0, 0, 0)),
        "b": box(0.1, 0.1, 0.1, motion="dynamic", at=(0.15, 0, 0.051)),
    }
    wind = ForceDriver(entity="b", force=(3.0, 0, 0), start=0.0, end=1.0)
    far = _moves("b", 0.05, causes=["hit"], margins={"hit": CausalMargin(value=1e-9)})
    spec = world(entities, beats={"hit": HIT, "slides": far}, drivers={"wind": wind}, frames=FRAMES, materials=SLICK)
    return World(simulate(folder, spec), ("b",))


def _strengthened(folder: Path, magnitude: float, rng: Rng) -> World:
    """A force does it as well, but less: the beat says by how much the hit strengthens it."""
    entities, _ = _blocks(rng)
    wind = ForceDriver(entity="b", force=(magnitude * 0.6 * 0.1 * 9.81, 0, 0), start=0.25, end=2.0)
    far = _moves("b", 0.04, causes=["hit"], margins={"hit": CausalMargin(value=0.01)})
    beats = {"hit": HIT, "slides": far}
    return World(simulate(folder, world(entities, beats=beats, drivers={"wind": wind}, frames=FRAMES + 6, materials=SLICK)))


SIMULATED = (
    Mechanism("wind-does-it", "struck, but a driver moves it anyway", True, _wind_does_it, 1.5, 10, "1"),
    Mechanism("cut-by-the-clock", "touched, but a driver lets it fall", True, _cut_by_the_clock, 0.05, 0.25, "s"),
    Mechanism("brushed", "what it brushes on its way does not bring it there", True, _brushed, 5e-3, 0.02, "m"),
    Mechanism("sweep", "one driven bar strikes both in turn", True, _sweep, 0.03, 0.15, "m"),
    Mechanism("together", "two fall side by side", True, _together, 1e-3, 0.5, "m"),
    Mechanism("within-noise", "a hit adds next to nothing, and no more is asked", True, _within_noise, 0.004, 0.012, "m"),
    Mechanism("strengthened", "a hit strengthens what comes anyway, and says so", False, _strengthened, 1.2, 1.8, "1"),
    Mechanism("struck", "struck in a wind that is too weak to move it", False, _struck, 0.1, 0.9, "1"),
    Mechanism("row", "a row of blocks, the last one moves", False, _row, 2e-3, 0.03, "m"),
    Mechanism("rebound", "a wall sends a ball back", False, _rebound, 0.4, 0.95, "1"),
    Mechanism("let-go", "a release makes a ball land", False, _let_go, 0.05, 0.3, "m"),
    Mechanism("hastened", "a hit hastens what comes later anyway, and says so", False, _hastened, 1.2, 1.8, "1"),
)
