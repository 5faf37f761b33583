"""Seeded defects of support out of doors: on slopes of landscapes, and past the edge of the ground."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...verifiers.support.bounds import HANGING, SUNK
from ...worlds.predicates import Crosses, Displacement, Reaches
from ...worlds.spec import Beat, Box, BoxRegion, Cylinder, Entity, Part, Sphere
from ..worlds.small_worlds import ball, box, entity, ground, make_candidate, pose, world
from ._lands import NAME, axes, declared, keep
from .cases import Mechanism, World

__all__ = ["LAND_MECHANISMS"]

RNG = np.random.Generator
GAP = 0.003
"""Default contact tolerance [m]."""
SIDE = 33
FRAMES, FPS = 30, 24
OVER, UNDER = 1.05, 0.95


class _Slope:
    """An even slope of a landscape, and a place on it."""

    def __init__(self, rng: RNG, steepest: float = 0.5) -> None:
        self.rng = rng
        self.cell = float(rng.choice([0.5, 2.0, 5.0]))
        self.tilt = rng.uniform(0.02, steepest) * np.array([np.cos(a := rng.uniform(0, 2 * np.pi)), np.sin(a)])
        self.level = float(rng.uniform(-200, 200))
        x, y = axes(SIDE, SIDE, self.cell)
        self.height = self.level + self.tilt[0] * x + self.tilt[1] * y
        self.place = rng.uniform(-0.15, 0.15, 2) * SIDE * self.cell

    def at(self, point: Any) -> float:
        """Height of the ground [m]."""
        return float(self.level + self.tilt @ np.asarray(point))

    def world(self, folder: Path, things: dict[str, Entity], *culprits: str) -> World:
        terrain = declared(SIDE, SIDE, self.cell)
        keep(folder, terrain, self.height)
        return World(make_candidate(folder, world(things, terrains={NAME: terrain})), culprits)


def _tree(slope: _Slope, lift: float) -> Entity:
    """A trunk and a crown whose foot stands `lift` over the ground; where that is negative, all of its rim is so deep in it."""
    radius, tall = float(slope.rng.uniform(0.1, 0.3)), float(slope.rng.uniform(2.0, 6.0))
    parts = [
        Part(shape=Cylinder(radius=radius, height=tall), pose=pose((0, 0, tall / 2))),
        Part(shape=Sphere(radius=0.4 * tall), pose=pose((0, 0, tall))),
    ]
    rise = radius * float(np.linalg.norm(slope.tilt))
    return entity(*parts, at=(*slope.place, slope.at(slope.place) + np.copysign(rise, lift) + lift))


def _house(slope: _Slope, lift: float) -> tuple[Entity, float]:
    """A level house whose middle stands `lift` over the ground, and the rise of the ground from its middle to a corner [m]."""
    size = slope.rng.uniform(0.1, 0.4, 2) * SIDE * slope.cell * 0.5
    tall = float(slope.rng.uniform(2.5, 6.0))
    rise = float(0.5 * np.abs(slope.tilt) @ size)
    return box(*size, tall, at=(*slope.place, slope.at(slope.place) + tall / 2 + lift)), rise


def _floating_tree(folder: Path, m: float, rng: RNG) -> World:
    slope = _Slope(rng)
    return slope.world(folder, {"tree": _tree(slope, m)}, "tree")


def _buried_house(folder: Path, m: float, rng: RNG) -> World:
    slope = _Slope(rng)
    slope.tilt, slope.height = np.zeros(2), 0.0 * slope.height + slope.level
    made, _ = _house(slope, -m)
    return slope.world(folder, {"house": made}, "house")


def _hanging_house(folder: Path, m: float, rng: RNG) -> World:
    """Its upper edge is 0.3 m in the slope, which a foundation may be; its lower edge m over it."""
    slope = _Slope(rng, 0.3)
    made, rise = _house(slope, 0.0)
    slope.tilt = slope.tilt * ((m + 0.3) / (2.0 * rise))
    x, y = axes(SIDE, SIDE, slope.cell)
    slope.height = slope.level + slope.tilt[0] * x + slope.tilt[1] * y
    z = slope.at(slope.place) + 0.5 * (m - 0.3) + made.dimensions.size[2] / 2
    return slope.world(folder, {"house": made.model_copy(update={"pose": pose((*slope.place, z))})}, "house")


def _standing_tree(folder: Path, m: float, rng: RNG) -> World:
    slope = _Slope(rng)
    return slope.world(folder, {"tree": _tree(slope, -m)})


def _founded_house(folder: Path, m: float, rng: RNG) -> World:
    """Level ground, a foundation m deep."""
    slope = _Slope(rng)
    slope.height = 0.0 * slope.height + slope.level
    slope.tilt = np.zeros(2)
    made, _ = _house(slope, -m)
    return slope.world(folder, {"house": made})


def _uneven(folder: Path, m: float, rng: RNG) -> World:
    """A slab across furrows m deep."""
    slope = _Slope(rng)
    slope.tilt = np.zeros(2)
    slope.height = slope.level - m * (np.arange(SIDE) % 2)[None] + 0.0 * slope.height
    size = slope.cell * rng.uniform(2.2, 6.0, 2)
    return slope.world(folder, {"slab": box(*size, 0.4, at=(*slope.place, slope.level + 0.2))})


def _on_posts(folder: Path, m: float, rng: RNG) -> World:
    """A hut on four posts that reach m into a slope."""
    slope = _Slope(rng)
    half, tall = float(rng.uniform(1.0, 3.0)), 3.0
    parts = [Part(shape=Box(size=(2.2 * half, 2.2 * half, 0.3)), pose=pose((0, 0, tall)))]
    for x in (-half, half):
        for y in (-half, half):
            foot = float(slope.tilt @ np.array([x, y])) - m
            parts.append(Part(shape=Box(size=(0.2, 0.2, tall - foot)), pose=pose((x, y, 0.5 * (tall + foot)))))
    return slope.world(folder, {"hut": entity(*parts, at=(*slope.place, slope.at(slope.place)))})


# ---------------------------------------------------------------- past the edge


def _leaving(rng: RNG, beyond: float, *, start: int) -> tuple[dict[str, Entity], dict[str, Any]]:
    """A ball rolls off a floor of 4 m and falls, its surface `beyond` the edge."""
    radius, k = float(rng.uniform(0.05, 0.2)), np.arange(FRAMES)
    x, time = 2.0 + radius + beyond, np.maximum(np.arange(FRAMES) - start, 0) / FPS
    path = np.stack([np.where(k < start, x * k / start, x), 0.0 * time, radius + 1e-3 - 0.5 * 9.81 * time**2], axis=1)
    things = {
        "floor": ground(4.0, float(rng.uniform(0.1, 1.0))),
        "ball": ball(radius, motion="dynamic", at=path[0], velocity=(x / start * FPS, 0, 0)),
    }
    return things, {"ball": (path, (1.0, 0.0, 0.0, 0.0))}


def _falls_off(folder: Path, m: float, rng: RNG) -> World:
    things, tracks = _leaving(rng, m, start=int(rng.integers(4, 20)))
    return World(make_candidate(folder, world(things, frames=FRAMES, fps=FPS), tracks=tracks), ("ball",))


def _sent_away(folder: Path, m: float, rng: RNG) -> World:
    """The story wants it."""
    things, tracks = _leaving(rng, m, start=8)
    x = 2.2 + m
    regions = {"pit": BoxRegion(min=(x - 0.1, -1, -20), max=(x + 1, 1, -2))}
    wish = [
        Reaches(entity="ball", region="pit"),
        Crosses(entity="ball", point=(x, 0, -1), normal=(0, 0, -1)),
        Displacement(entity="ball", axis=(0, 0, -1), min=2.5),
    ][int(rng.integers(3))]
    beats = {"falls": Beat(text="the ball falls off", owner="rigid", subject="ball", frames=(8, FRAMES - 1), predicate=wish)}
    spec = world(things, frames=FRAMES, fps=FPS, regions=regions, beats=beats)
    return World(make_candidate(folder, spec, tracks=tracks), ())


def _caught(folder: Path, m: float, rng: RNG) -> World:
    """A lower floor lies beneath, or it is caught in time."""
    things, tracks = _leaving(rng, m, start=12)
    deep = float(rng.uniform(-40, -8))
    things["below"] = box(12 + 4 * m, 6, 0.2, at=(0, 0, deep))
    things["pillar"] = box(0.2, 0.2, -deep, at=(0, 0, deep / 2 - 0.05))
    rolls = Displacement(entity="ball", min=0.5)
    beats = {"rolls": Beat(text="the ball rolls", owner="rigid", subject="ball", frames=(0, FRAMES - 1), predicate=rolls)}
    return World(make_candidate(folder, world(things, frames=FRAMES, fps=FPS, beats=beats), tracks=tracks), ())


LAND_MECHANISMS = (
    Mechanism("floating-tree", "a static tree over a slope", True, _floating_tree, OVER * GAP, 5.0, "m", GAP),
    Mechanism("buried-house", "its ground floor is in the slope", True, _buried_house, OVER * SUNK, 4.0, "m", SUNK),
    Mechanism("hanging-house", "its lower edge hangs over the slope", True, _hanging_house, OVER * HANGING, 2.0, "m", HANGING),
    Mechanism("falls-off", "past the edge of all ground", True, _falls_off, 0.01, 2.0, "m"),
    Mechanism("standing-tree", "rooted in a slope", False, _standing_tree, 1e-3, 0.15, "m"),
    Mechanism("founded-house", "a foundation", False, _founded_house, 1e-3, UNDER * SUNK, "m"),
    Mechanism("uneven-ground", "small hollows under its base", False, _uneven, 1e-3, UNDER * HANGING, "m"),
    Mechanism("on-posts", "of different length on a slope", False, _on_posts, 0.01, 0.4, "m"),
    Mechanism("sent-away", "the story has it fall", False, _sent_away, 0.01, 1.0, "m"),
    Mechanism("caught", "a lower floor beneath", False, _caught, 0.01, 1.0, "m"),
)
"""Mechanisms of the suite `support` that need land or its edge."""
