"""Seeded defects of pins and bonded sides at points of space: held where nothing is drawn, at what is drawn, and said to float."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...worlds.spec import (
    Bond,
    Box,
    Breakable,
    BrickPattern,
    ClothPhysics,
    ClothPin,
    ElasticPhysics,
    Limits,
    Pin,
    RigidSettings,
    Sheet,
)
from ._support_worlds import RNG, Scene, turn
from .cases import Mechanism, World

__all__ = ["BONDED_MECHANISMS"]

EDGE = 0.1
"""Edge of the sheet's triangles: a pin of it reaches that far [m]."""
REACH = Limits().contact_gap + 2.0 * RigidSettings().skin
"""Largest distance of a bonded side or an elastic body's pin from what holds it [m]."""
REASON = "a spell of the tale keeps it in the air there"
OVER, UNDER = 1.05, 0.95


def _flag(folder: Path, m: float, rng: RNG, *culprits: str, afloat: str | None = None) -> World:
    """A flag whose hoist is held m beside its pole."""
    scene, length = Scene(rng, crowd=False), EDGE * int(rng.integers(4, 9))
    physics = ClothPhysics(
        area_density=0.2, thickness=0.001, stretch_stiffness=100, bend_stiffness=1e-5, pins={"hoist": ClothPin(edge="-x")}
    )
    scene.add("pole", Box(size=(0.06, 0.06, 2.0)), at=(0, 0, 1.0))
    at = (0.03 + m + length / 2, 0, 1.5)
    sheet, size = Sheet(size=(length, 0.4), resolution=1.0000001 * EDGE), (length, 0.4, 0.001)
    scene.add("thing", sheet, at=at, rotation=turn("x", np.pi / 2), motion="dynamic", physics=physics, size=size, afloat=afloat)
    return scene.world(folder, *culprits, still=True)


def _board(folder: Path, m: float, rng: RNG, *culprits: str, afloat: str | None = None) -> World:
    """A springboard, or a wall of bricks on the floor, of which one end is held m beside a post."""
    scene, length = Scene(rng, crowd=False), float(rng.uniform(0.3, 0.6))
    scene.add("pole", Box(size=(0.1, 0.1, 2.0)), at=(0, 0, 1.0))
    x = 0.05 + m + length / 2
    if rng.random() < 0.5:
        pins = {"foot": Pin(center=(-length / 2, 0, 0), size=(1e-3, 1, 1))}
        soft = ElasticPhysics(young_modulus=1e7, resolution=0.1, pins=pins)
        scene.add("thing", Box(size=(length, 0.3, 0.05)), at=(x, 0, 1.0), motion="dynamic", physics=soft, afloat=afloat)
    else:
        pattern = BrickPattern(size=(length / 3, 0.3, 0.1), joint=0.0)
        broken = Breakable(pattern=pattern, bond=Bond(tension=1e6, shear=1.5e6), fixed=["x-"])
        wall = Box(size=(length, 0.3, 0.4))
        scene.add("thing", wall, at=(x, 0, 0.2 + 1e-4), motion="dynamic", breakable=broken, afloat=afloat)
    return scene.world(folder, *culprits, still=True)


def _flag_in_the_air(folder: Path, m: float, rng: RNG) -> World:
    return _flag(folder, m, rng, "thing")


def _flag_at_its_pole(folder: Path, m: float, rng: RNG) -> World:
    return _flag(folder, m, rng)


def _board_in_the_air(folder: Path, m: float, rng: RNG) -> World:
    return _board(folder, m, rng, "thing")


def _board_at_its_post(folder: Path, m: float, rng: RNG) -> World:
    return _board(folder, m, rng)


def _said_to_hang(folder: Path, m: float, rng: RNG) -> World:
    made = _flag if rng.random() < 0.5 else _board
    return made(folder, m, rng, afloat=REASON)


BONDED_MECHANISMS = (
    Mechanism("pinned-to-the-air", "cloth pinned where nothing is", True, _flag_in_the_air, OVER * EDGE, 1.0, "m", EDGE),
    Mechanism(
        "bonded-to-the-air", "a side or pin of a board held by nothing", True, _board_in_the_air, OVER * REACH, 1.0, "m", REACH
    ),
    Mechanism("pinned-at-its-pole", "cloth pinned in space where its pole is", False, _flag_at_its_pole, 1e-4, UNDER * EDGE, "m"),
    Mechanism("bonded-at-its-post", "a side or pin of a board at its post", False, _board_at_its_post, 1e-6, UNDER * REACH, "m"),
    Mechanism("said-to-hang", "held by nothing, and says so", False, _said_to_hang, 0.2, 1.0, "m"),
)
"""Mechanisms of the suite `support` about pins and bonded sides at points of space."""
