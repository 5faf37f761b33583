"""Small worlds with bodies that break, run by the engine once each: struck walls, beams that lose their prop, chains of breaks, falls.

Sizes, strengths, speeds and places are drawn per variant. Each world has a `witness`, a crate that stands aside and touches nothing else.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ...construction import build_entity
from ...worlds.spec import (
    Bond,
    Breakable,
    BrickPattern,
    Entity,
    Material,
    PathDriver,
    PathKey,
    Revolution,
    RigidPhysics,
    RigidSettings,
    VoronoiPattern,
    WorldSpec,
)
from ..worlds.small_worlds import ball, box, entity, ground, pose, world
from ._films import Film, copied, film_of

__all__ = ["KINDS", "VARIANTS", "film", "root_stress"]

VARIANTS = 3
FPS = 24
STONE = {
    "wood": Material(density=600.0, friction=0.4, substance="wood"),
    "brick": Material(density=1800.0, friction=0.6),
    "iron": Material(density=7200.0, friction=0.4),
}
SETTINGS = RigidSettings(step=5e-4, refine=0)


def _bond(rng: np.random.Generator, tension: float) -> Bond:
    return Bond(tension=tension, shear=tension * float(rng.uniform(1.2, 2.0)))


def _wall(rng: np.random.Generator, tension: float, *, foot: float = 0.0) -> Entity:
    """A brick wall that stands, and is bonded to the world, at a height `foot` [m]."""
    size = (float(rng.uniform(0.7, 1.0)), 0.12, float(rng.uniform(0.36, 0.5)))
    pattern = BrickPattern(size=(0.24, 0.11, float(rng.uniform(0.07, 0.09))), joint=0.01)
    at = (0.0, 0.0, foot + size[2] / 2 + 1e-3)
    return _breakable(size, at, Breakable(pattern=pattern, bond=_bond(rng, tension), fixed=["z-"]))


def _breakable(size: tuple[float, float, float], at: tuple[float, float, float], breakable: Breakable) -> Entity:
    made = box(*size, motion="dynamic", at=at, material="brick")
    return made.model_copy(update={"breakable": breakable})


def _shot(rng: np.random.Generator, wall: Entity, speed: float, *, side: float = -1.0) -> Entity:
    """An iron ball that flies at a wall along y, from the side given, and reaches it after three to six frames."""
    radius, height = float(rng.uniform(0.04, 0.06)), wall.dimensions.size[2]
    way = 0.06 + radius + speed * float(rng.uniform(3.0, 6.0)) / FPS
    foot = float(wall.pose.position[2]) - height / 2
    at = (float(rng.uniform(-0.2, 0.2)), side * way, foot + float(rng.uniform(0.45, 0.75)) * height + 0.02)
    made = ball(radius, motion="dynamic", at=at, material="iron")
    return made.model_copy(update={"physics": RigidPhysics(linear_velocity=(0.0, -side * speed, 0.0))})


def _scene(entities: dict[str, Entity], frames: int, **more: Any) -> WorldSpec:
    crate = box(0.3, 0.3, 0.3, motion="dynamic", at=(3.0, 3.0, 0.15 + 1e-3))
    made = {"floor": ground(), **entities, "witness": crate}
    return world(made, frames=frames, fps=FPS, materials=STONE, settings=SETTINGS, **more)


def _struck(rng: np.random.Generator) -> WorldSpec:
    """A ball breaks a wall on a ledge in part, and debris falls from it."""
    foot = float(rng.uniform(0.8, 1.5))
    wall = _wall(rng, float(rng.uniform(3e5, 6e5)), foot=foot)
    ledge = box(1.2, 0.14, foot, at=(0.0, 0.0, foot / 2))
    return _scene({"ledge": ledge, "wall": wall, "ball": _shot(rng, wall, float(rng.uniform(9.0, 15.0)))}, 16)


def _held(rng: np.random.Generator) -> WorldSpec:
    """A ball hits a wall softly, which holds."""
    wall = _wall(rng, float(rng.uniform(2e6, 4e6)))
    return _scene({"wall": wall, "ball": _shot(rng, wall, float(rng.uniform(0.5, 2.0)))}, 12)


def _crossfire(rng: np.random.Generator) -> WorldSpec:
    """Two balls from both sides, one after the other."""
    wall = _wall(rng, float(rng.uniform(3e5, 6e5)))
    shots = {
        "ball": _shot(rng, wall, float(rng.uniform(9.0, 13.0))),
        "other": _shot(rng, wall, float(rng.uniform(9.0, 13.0)), side=1.0),
    }
    return _scene({"wall": wall, **shots}, 12)


def _unpropped(rng: np.random.Generator) -> WorldSpec:
    """A beam that lies on three posts loses the middle one, and breaks under its weight."""
    section, length, height = (0.12, float(rng.uniform(0.06, 0.08))), 2.0, 0.6
    # Bending stress in the middle between two posts: 3 rho g L^2 / (4 h) over the span; with the third post a quarter of that.
    span = length - 0.2
    alone = 0.75 * 1800.0 * 9.81 * span**2 / section[1]
    pattern = BrickPattern(size=(length / float(rng.integers(7, 10)), *section), joint=0.0)
    breakable = Breakable(pattern=pattern, bond=Bond(tension=alone * float(rng.uniform(0.5, 0.7)), shear=1e7))
    beam = _breakable((length, *section), (0.0, 0.0, height + section[1] / 2 + 1e-3), breakable)
    posts = {f"post_{k}": box(0.1, 0.2, height, at=(side * span / 2, 0.0, height / 2)) for k, side in enumerate((-1.0, 1.0))}
    middle = box(0.1, 0.2, 0.2, motion="kinematic", at=(0.0, 0.0, height - 0.1))
    start = float(rng.uniform(3.0, 5.0)) / FPS
    way = {"here": (0.0, 0.0), "wait": (start, 0.0), "gone": (start + 0.1, -0.25)}
    keys = {k: PathKey(time=t, pose=pose((0.0, 0.0, height - 0.1 + z))) for k, (t, z) in way.items()}
    return _scene({"wall": beam, **posts, "prop": middle}, 16, drivers={"pull": PathDriver(entity="prop", keys=keys)})


def root_stress(beam: Entity) -> float:
    """Tension at the root of a beam that sticks out along x, under its own weight [Pa]: 3 rho g L^2 / h."""
    length, _, height = beam.dimensions.size
    return 3.0 * STONE["brick"].density * 9.81 * length**2 / height


def _propped(rng: np.random.Generator) -> WorldSpec:
    """A beam bonded to the world at one end bears most of what it can."""
    size = (float(rng.uniform(0.8, 1.5)), 0.12, float(rng.uniform(0.1, 0.2)))
    pattern = BrickPattern(size=(size[0] / float(rng.integers(3, 7)), *size[1:]), joint=0.0)
    beam = _breakable(size, (0.0, 0.0, 0.6), Breakable(pattern=pattern, bond=_bond(rng, 1e6), fixed=["x-"]))
    bond = Bond(tension=root_stress(beam) / float(rng.uniform(0.6, 0.95)), shear=1e7)
    made = beam.model_copy(update={"breakable": beam.breakable.model_copy(update={"bond": bond})})  # type: ignore[union-attr]
    lump = ball(0.03, motion="dynamic", at=(float(rng.uniform(-0.2, 0.2)), 0.0, 2.0))
    return _scene({"wall": made, "lump": lump}, 8)


def _chain(rng: np.random.Generator) -> WorldSpec:
    """A ball falls on a shelf, which breaks and falls on another, which breaks too."""
    size = (0.5, 0.25, 0.04)
    made = {}
    for name, height in (("upper", 0.8), ("wall", 0.5)):
        pattern = VoronoiPattern(pieces=int(rng.integers(6, 9)), seed=int(rng.integers(1000)))
        breakable = Breakable(pattern=pattern, bond=_bond(rng, float(rng.uniform(6e5, 9e5))), fixed=["x-"])
        made[name] = _breakable(size, (0.0, 0.0, height), breakable)
    falling = ball(0.06, motion="dynamic", at=(float(rng.uniform(0.05, 0.15)), 0.0, 0.8 + 0.02 + 0.06 + 0.05), material="iron")
    down = RigidPhysics(linear_velocity=(0.0, 0.0, -float(rng.uniform(1.0, 3.0))))
    return _scene({**made, "ball": falling.model_copy(update={"physics": down})}, 14)


def _dropped(rng: np.random.Generator) -> WorldSpec:
    """A free plate falls on a high post and breaks; its pieces scatter."""
    height = float(rng.uniform(1.5, 2.0))
    pattern = VoronoiPattern(pieces=int(rng.integers(6, 11)), seed=int(rng.integers(1000)))
    breakable = Breakable(pattern=pattern, bond=_bond(rng, float(rng.uniform(2e5, 5e5))))
    plate = _breakable((0.6, 0.3, 0.04), (float(rng.uniform(-0.1, 0.1)), 0.0, height + 0.25), breakable)
    falling = plate.model_copy(update={"physics": RigidPhysics(linear_velocity=(0.0, 0.0, -float(rng.uniform(2.0, 5.0))))})
    return _scene({"post": box(0.08, 0.08, height, motion="static", at=(0.0, 0.0, height / 2)), "wall": falling}, 16)


def _potted(rng: np.random.Generator) -> WorldSpec:
    """A hollow pot, a solid of revolution, falls on the floor and breaks."""
    wide, high, wall = float(rng.uniform(0.1, 0.15)), float(rng.uniform(0.15, 0.25)), float(rng.uniform(0.02, 0.025))
    profile = [(0.0, 0.0), (0.7 * wide, 0.0), (wide, high), (wide - wall, high), (0.7 * wide - wall, wall), (0.0, wall)]
    shape = Revolution(profile=profile, segments=int(rng.integers(10, 17)))
    pattern = VoronoiPattern(pieces=int(rng.integers(8, 13)), seed=int(rng.integers(1000)))
    breakable = Breakable(pattern=pattern, bond=_bond(rng, float(rng.uniform(1e5, 3e5))))
    euler = (0.0, float(rng.uniform(0.2, 0.8)), 0.0)
    falls = RigidPhysics(linear_velocity=(0.0, 0.0, -float(rng.uniform(0.5, 1.0))))
    size = (2 * wide, 2 * wide, high)
    pot = entity(shape, motion="dynamic", at=(0.0, 0.0, 0.3), euler=euler, size=size, material="brick", physics=falls)
    return _scene({"wall": pot.model_copy(update={"breakable": breakable})}, 12)


KINDS = {
    "struck": _struck,
    "held": _held,
    "crossfire": _crossfire,
    "unpropped": _unpropped,
    "propped": _propped,
    "chain": _chain,
    "dropped": _dropped,
    "potted": _potted,
}

WHOLE = ("held", "propped")
"""Kinds in which nothing breaks."""


@lru_cache(maxsize=64)
def _once(kind: str, variant: int) -> Film:
    spec = KINDS[kind](np.random.default_rng([variant, list(KINDS).index(kind)]))
    made = film_of(spec, {n: build_entity(spec, n, Path()) for n in spec.entities})
    if bool(made.frames[-1]["bond/broken"].any()) == (kind in WHOLE):
        raise RuntimeError(f"world {variant} of {kind!r} does not do what its kind says")
    return made


def film(kind: str, rng: np.random.Generator) -> Film:
    """A fresh copy of one of a kind's worlds."""
    return copied(_once(kind, int(rng.integers(VARIANTS))))
