"""Seeded defects of interiors: what cannot open, stands in the way, lacks support, or has not the size of its kind."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...construction.build import build_entity
from ...worlds.built import BuiltPart
from ...worlds.spec import Connects
from ._rooms import GAP, RNG, Room, room
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

NEEDED = math.radians(60.0)
"""[rad] By how much a door has to turn."""
TRAVEL, DRAWN = 0.322125, 0.7
"""[m] Travel of the drawers of a chest; [1] share of it that has to be free."""
FRONT = 0.2564
"""[m] From the middle of the chest to its knobs."""
STEP = 0.0095
"""[m] By how much steps of a flight may differ."""
SEAT, LEAST_SEAT = 0.45, 0.35
"""[m] Height of the chair's seat, and the least of its kind."""
WAY = Connects(a="a", b="b", width=0.6, headroom=1.95)
AJAR = 1.4
"""[rad] So that one can walk through."""


def _blocked_door(folder: Path, m: float, rng: RNG) -> World:
    """A post stands in the way of the leaf, so that it turns by `m` less than it has to."""
    found = room(rng)
    found.post(NEEDED * (1.0 - m))
    return found.world(folder, "post")


def _threshold(folder: Path, m: float, rng: RNG) -> World:
    """A sill right behind the doorway is just too high."""
    found = room(rng, ajar=AJAR)
    found.sill(WAY.max_step + m)
    return found.world(folder, "sill", way=WAY)


def _malformed_stair(folder: Path, m: float, rng: RNG) -> World:
    """One tread of a flight lies too high, the step after it is as much lower."""
    found = _stairs(rng)
    treads = [p for p in found.documents["stairs"]["parts"] if p.startswith("tread_")]
    odd = found.documents["stairs"]["parts"][str(rng.choice(treads[1:-2]))]
    odd["pose"]["position"][2] += m / 2
    return found.world(folder, "stairs")


def _stairs(rng: RNG) -> Room:
    found = room(rng)
    riser = float(rng.uniform(0.16, 0.19))
    found.put("stairs", "stairs", (-1.6, 0.0, GAP), rise=1.2, width=0.9, riser=riser, railing="none")
    return found


def _bed_through_table(folder: Path, m: float, rng: RNG) -> World:
    """A table stands in the headboard of a bed."""
    found = room(rng)
    found.put("bed", "bed", (1.5, 0.6, GAP), facing=math.pi)
    found.put("table", "table", (1.5, 0.6 - 1.07 - 0.3 + m, GAP), width=1.6, depth=0.6)
    return found.world(folder, "bed", "table")


def _pipe(rng: RNG, away: float) -> Room:
    """A pipe on two brackets before the wall, with their ends `away` from it [m]."""
    found = room(rng)
    x, y, z = 0.0599 + away, float(rng.uniform(0.7, 0.9)), float(rng.uniform(0.3, 1.8))
    clips = {f"bracket_{k}": ((x, y + s, z), (x + 0.05, y + s + 0.03, z + 0.03)) for k, s in enumerate((0.1, 0.6))}
    found.blocks("pipe", "heating pipe", {"pipe": ((x + 0.05, y, z), (x + 0.08, y + 0.8, z + 0.03)), **clips}, material="copper")
    return found


def _pipe_without_support(folder: Path, m: float, rng: RNG) -> World:
    """A pipe with its brackets hangs in the air before the wall."""
    return _pipe(rng, m).world(folder, "pipe")


def _doll_chair(folder: Path, m: float, rng: RNG) -> World:
    """A chair of the size of a doll, which nothing says it is for."""
    found = room(rng)
    found.put("chair", "chair", (1.2, float(rng.uniform(-0.5, 0.5)), GAP))
    found.resized("chair", 1.0 / m)
    return found.world(folder, "chair")


def _stuck_drawer(folder: Path, m: float, rng: RNG) -> World:
    """A cupboard before a chest of drawers leaves `m` less than a drawer has to come out by."""
    found = room(rng)
    _chest(found, DRAWN * TRAVEL * (1.0 - m))
    return found.world(folder, "cupboard")


def _chest(found: Room, gap: float) -> None:
    """A chest of drawers, and a cupboard before it [m]."""
    found.put("chest", "chest_of_drawers", (1.4, 0.6, GAP))
    y = 0.6 - FRONT - gap
    found.blocks("cupboard", "cupboard", {"body": ((0.9, y - 0.4, GAP), (1.9, y, 1.1))}, motion="dynamic")


def _lamp_on_nothing(folder: Path, m: float, rng: RNG) -> World:
    """A lamp hangs over the table on which it should stand."""
    found = _table(rng)
    found.put("lamp", "table_lamp", (1.3, 0.0, 0.74 + 2 * GAP + m))
    return found.world(folder, "lamp")


def _table(rng: RNG) -> Room:
    found = room(rng)
    found.put("table", "table", (1.3, 0.0, GAP))
    return found


def _other_shape(folder: Path, m: float, rng: RNG) -> World:
    """A plate of a table collides as one that is larger by `m` times what is allowed."""
    found = _table(rng)
    sound = found.world(folder).candidate
    built = build_entity(sound.spec, "table", folder)
    part = max(built.parts, key=lambda p: float(np.ptp(p.render.vertices, axis=0).max()))
    return found.world(folder, "table", parts={"table": _grown(part, m)})


def _grown(part: BuiltPart, m: float) -> BuiltPart:
    size = np.ptp(part.render.vertices, axis=0)
    by = 0.02 * float(np.linalg.norm(size)) * m
    (piece,) = part.collision
    axis = int(np.argmax(size))
    if piece.kind == "box":
        params = tuple(p + (by if k == axis else 0.0) for k, p in enumerate(piece.params))
        return replace(part, collision=(replace(piece, params=params),))
    middle = piece.points.mean(axis=0)
    grown = piece.points + np.where(np.arange(3) == axis, by * np.sign(piece.points - middle), 0.0)
    return replace(part, collision=(replace(piece, points=grown),))


def _furnished(rng: RNG) -> Room:
    """A room in which all is right: the door turns, drawers come out, the lamp stands, things are of their sizes."""
    found = _pipe(rng, 1e-4)
    found.put("chest", "chest_of_drawers", (1.4, 1.4, GAP))
    found.put("table", "table", (1.5, -0.9, GAP), width=1.0, depth=0.6)
    found.put("lamp", "table_lamp", (1.6, -0.9, 0.74 + 2 * GAP))
    found.put("mug", "mug", (1.2, -0.8, 0.74 + 2 * GAP))
    found.put("chair", "chair", (1.5, -0.25, GAP))
    found.put("bed", "bed", (-1.7, -0.6, GAP), facing=math.pi)
    return found


def _sound(folder: Path, m: float, rng: RNG) -> World:
    return _furnished(rng).world(folder)


def _just_opens(folder: Path, m: float, rng: RNG) -> World:
    """A post lets the door turn a little further than it has to."""
    found = room(rng)
    found.post(NEEDED * (1.0 + m))
    return found.world(folder)


def _light_stool(folder: Path, m: float, rng: RNG) -> World:
    """A light stool stands before the door, which pushes it away."""
    found = room(rng)
    found.put("stool", "stool", (-0.35 - 0.3 * m, 0.1, GAP))
    return found.world(folder)


def _just_drawn(folder: Path, m: float, rng: RNG) -> World:
    """A cupboard leaves the drawers a little more than they have to come out by."""
    found = room(rng)
    _chest(found, DRAWN * TRAVEL * (1.0 + m) + 0.006)
    return found.world(folder)


def _full_drawer(folder: Path, m: float, rng: RNG) -> World:
    """Things lie on a drawer that stands open: they go along, and hit nothing."""
    found = room(rng)
    found.put("chest", "chest_of_drawers", (1.4, 0.6, GAP), positions={"drawer_2": 0.3})
    y, z = 0.6 - 0.24 - 0.3 + 0.13, 0.541 + GAP + 0.012
    found.put("book", "book", (1.4, y, z + m))
    return found.world(folder)


def _low_sill(folder: Path, m: float, rng: RNG) -> World:
    """A sill behind the doorway is as high as one can step."""
    found = room(rng, ajar=AJAR)
    found.sill(WAY.max_step - m)
    return found.world(folder, way=WAY)


def _legal_stairs(folder: Path, m: float, rng: RNG) -> World:
    """Treads of a flight lie off their places by less than steps may differ."""
    found = _stairs(rng)
    odd = found.documents["stairs"]["parts"]["tread_3"]
    odd["pose"]["position"][2] += 0.5 * (STEP - m)
    return found.world(folder)


def _toy_chair(folder: Path, m: float, rng: RNG) -> World:
    """A chair of the size of a doll that is said to be a toy."""
    found = room(rng)
    found.put("chair", "chair", (1.2, 0.0, GAP))
    found.documents["chair"]["role"] = str(rng.choice(["toy chair", "chair of a doll's house", "miniature chair, a model"]))
    found.resized("chair", 1.0 / m)
    return found.world(folder)


SUITE = Suite(
    "navigability",
    (
        Mechanism("blocked door", "something heavy stands where the leaf turns", True, _blocked_door, 0.02, 0.9, "1", bound=0.0),
        Mechanism("oversized threshold", "a sill behind the doorway is too high", True, _threshold, 0.002, 0.3, "m", bound=1e-4),
        Mechanism("malformed stair", "one tread too high", True, _malformed_stair, 0.0097, 0.12, "m", bound=STEP, check="scale"),
        Mechanism("bed through table", "", True, _bed_through_table, 0.002, 0.25, "m", check="interpenetration"),
        Mechanism("pipe without support", "off the wall", True, _pipe_without_support, 0.012, 0.4, "m", check="support"),
        Mechanism(
            "doll-size chair", "and no word of a doll", True, _doll_chair, 1.01 * SEAT / LEAST_SEAT, 20.0, "1", check="scale"
        ),
        Mechanism("stuck drawer", "something heavy before it", True, _stuck_drawer, 0.02, 0.9, "1", bound=0.0),
        Mechanism("lamp on nothing", "over the table", True, _lamp_on_nothing, 0.012, 0.5, "m", check="support"),
        Mechanism("other shape", "collides as is not seen", True, _other_shape, 1.02, 5.0, "1", bound=1.0, check="scale"),
        Mechanism("door and drawers", "a furnished room", False, _sound, 0.1, 1.0, "1"),
        Mechanism("of its kind", "a furnished room", False, _sound, 0.1, 1.0, "1", check="scale"),
        Mechanism("held", "a furnished room", False, _sound, 0.1, 1.0, "1", check="support"),
        Mechanism("apart", "a furnished room", False, _sound, 0.1, 1.0, "1", check="interpenetration"),
        Mechanism("just opens", "a post at the limit", False, _just_opens, 0.03, 0.5, "1"),
        Mechanism("light stool", "a door pushes it away", False, _light_stool, 0.01, 1.0, "1"),
        Mechanism("just drawn", "a cupboard at the limit", False, _just_drawn, 0.02, 0.3, "1"),
        Mechanism("full drawer", "things in it go along", False, _full_drawer, 1e-4, 5e-4, "m"),
        Mechanism("threshold at the limit", "as high as one can step", False, _low_sill, 1e-4, 0.1, "m"),
        Mechanism("legal stairs", "steps differ as they may", False, _legal_stairs, 2e-4, 0.009, "m", check="scale"),
        Mechanism("toy chair", "its role says so", False, _toy_chair, 2.0, 20.0, "1", check="scale"),
    ),
)
"""Worlds of interiors: rows of the checks `navigability`, `scale`, `support` and `interpenetration` about things."""
