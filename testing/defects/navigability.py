"""Seeded defects of navigability: ways that are blocked, narrow, low, steep or interrupted, and ways that only look so."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from ...verifiers.routes.bounds import CELLS_ACROSS, GAP, OPENING_NOISE, PITCH, RASTER_NOISE, SAME_HEIGHT
from ...worlds.spec import Box, BoxRegion, Connects, Cylinder, Part, Sphere
from ..worlds.small_worlds import entity, pose
from ._land_ways import LAND_MECHANISMS
from ._route_people import no_person, small_carrier, tall_person
from ._routes import EAST, WEST, Site, block, carrier, flight, furniture, prism, ramp, site, stairs, tanks
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

RNG = np.random.Generator


def _doors(hall: Site, width: float, narrow: float) -> None:
    """One to three walls; one door is `narrow`, the others are wide enough."""
    count = int(hall.rng.integers(1, 4))
    worst = int(hall.rng.integers(count))
    for k in range(count):
        door = narrow if k == worst else width * float(hall.rng.uniform(1.05, 1.2))
        room = max(0.0, hall.half - door / 2 - 0.05)
        name = "wall" if k == worst else f"other{k}"
        hall.wall(name, -1.6 + 1.6 * k, door, middle=float(hall.rng.uniform(-room, room)))


# ---------------------------------------------------------------- broken


def _narrow_door(folder: Path, m: float, rng: RNG) -> World:
    hall, way = site(rng), carrier(rng)
    way = way.model_copy(update={"headroom": min(way.headroom, 2.2)})
    _doors(hall, way.width, max(way.width - m, 0.02))
    hall.ends()
    hall.clutter()
    return hall.world(folder, way, "wall")


def _crate_in_door(folder: Path, m: float, rng: RNG) -> World:
    """Furniture reaches into a wide door, in front of it or behind it, out of sight from the other side."""
    hall, way = site(rng, half=1.6), carrier(rng, headroom=1.8)
    door = float(rng.uniform(1.3, 1.6))
    hall.wall("wall", 0.0, door)
    clear = way.width - m
    size = float(rng.uniform(0.4, 0.7))
    behind = float(rng.choice([-1.0, 1.0]))
    # Its side stands `clear` away from the far jamb, its face against the wall.
    y = door / 2 - clear - size / 2
    depth = float(hall.things["wall"].parts["p0"].shape.size[0])  # type: ignore[union-attr]
    x = depth / 2 + behind * (depth / 2 + size / 2)
    fill = [block(x - size / 2, x + size / 2, -hall.half, y - size / 2, 0, 1.2)] if y - size / 2 > -hall.half + 0.05 else []
    if fill:
        hall.add("sideboard", *fill)
    hall.put("crate", furniture(rng, (size, size + 1e-6, 1.0)), (x, y, 0.5))
    hall.ends()
    return hall.world(folder, way, "crate")


def _low_beam(folder: Path, m: float, rng: RNG) -> World:
    """A beam, ball or board hangs too low across a door; the rest of the way is high."""
    hall, way = site(rng), carrier(rng)
    hall.wall("wall", 0.0, way.width * 1.3, lintel=2.55)
    height = max(way.headroom - m, 1.3 * way.max_step + 0.05)
    thick = float(rng.choice([0.003, 0.05, 0.2]))
    x = float(rng.uniform(-0.6, 0.6))
    hall.add("beam", block(x, x + thick, -hall.half, hall.half, height, height + 0.1))
    hall.ends()
    return hall.world(folder, way, "beam")


def _high_riser(folder: Path, m: float, rng: RNG) -> World:
    """One riser in the middle of a flight is too high."""
    hall, way = site(rng, half=1.2), Connects(a="a", b="b", max_step=float(rng.uniform(0.1, 0.2)))
    count, going = int(rng.integers(4, 7)), float(rng.uniform(0.25, 0.3))
    rises = [float(rng.uniform(0.8, 0.99)) * way.max_step] * count
    rises[int(rng.integers(1, count))] = way.max_step + m
    stairs(hall, rises, going, solid=bool(rng.random() < 0.5))
    return hall.world(folder, way, "stairs", "deck")


def _missing_tread(folder: Path, m: float, rng: RNG) -> World:
    """A board of the flight is missing: twice the rise, and a hole."""
    hall, way = site(rng, half=1.2), Connects(a="a", b="b")
    count, going = int(rng.integers(5, 8)), float(rng.uniform(0.25, 0.3))
    rise = (way.max_step + m) / 2
    solid = bool(rng.random() < 0.5)
    parts = flight([rise] * count, going, 1.4, solid=solid)
    del parts[int(rng.integers(0, count - 1))]
    hall.add("stairs", *parts)
    hall.add("deck", block(count * going, count * going + 2.5, -1.2, 1.2, count * rise - 0.05, count * rise))
    hall.ends(rise=count * rise, far=count * going + 2.5)
    return hall.world(folder, way, "stairs", "deck", "floor", "way")


def _tiny_treads(folder: Path, m: float, rng: RNG) -> World:
    """Low risers, but treads so short that the flight is a ladder."""
    hall, way = site(rng, half=1.2), Connects(a="a", b="b")
    rise = float(rng.uniform(0.15, 0.2))
    stairs(hall, [rise] * 12, rise / (PITCH * m), solid=True)
    return hall.world(folder, way, "stairs", "deck", "floor")


def _steep_piece(folder: Path, m: float, rng: RNG) -> World:
    """A ramp is too steep on a short stretch."""
    hall = site(rng, half=0.9, floor=False)
    hall.add("floor", block(WEST, 0.0, -hall.half, hall.half, -0.1, 0.0))
    way = carrier(rng, width=0.8, max_slope=float(rng.uniform(0.08, 0.6)))
    good = 0.9 * way.max_slope
    short = float(rng.uniform(0.16, 0.5))
    ramp(hall, [(float(rng.uniform(0.3, 1.0)), good), (short, min(way.max_slope + m, 1.3)), (float(rng.uniform(0.3, 1.0)), good)])
    return hall.world(folder, way, "ramp", "deck", "way")


def _threshold(folder: Path, m: float, rng: RNG) -> World:
    """A sill in a door is just too high; it may be a thin blade, and stand on a ramp's foot."""
    hall, way = site(rng), carrier(rng, headroom=1.9)
    hall.wall("wall", 0.0, way.width * 1.2, lintel=2.5)
    thick = float(rng.choice([0.002, 0.03, 0.2]))
    x, height = float(rng.uniform(-0.3, 0.3)), way.max_step + m
    hall.add("sill", block(x, x + thick, -hall.half, hall.half, 0.0, height))
    hall.ends()
    return hall.world(folder, way, "sill")


def _kerb_at_ramp(folder: Path, m: float, rng: RNG) -> World:
    """A ramp begins above the floor: a step too high for wheels, hidden in the bend of the slopes."""
    hall = site(rng, half=0.9, floor=False)
    hall.add("floor", block(WEST, 0.0, -hall.half, hall.half, -0.1, 0.0))
    step = float(rng.uniform(0.013, 0.05))
    way = Connects(a="a", b="b", carrier="object", max_step=step, max_slope=float(rng.uniform(0.1, 0.6)), headroom=1.5)
    rise, run = step + m, float(rng.uniform(0.8, 1.5))
    end = rise + run * math.tan(0.95 * way.max_slope)
    hall.add("ramp", prism([(0.0, -0.1), (run, -0.1), (run, end), (0.0, rise)], -hall.half, hall.half))
    hall.add("deck", block(run, run + 2.5, -hall.half, hall.half, end - 0.05, end))
    hall.ends(rise=end, far=run + 2.5)
    return hall.world(folder, way, "ramp", "floor", "way")


def _gap(folder: Path, m: float, rng: RNG) -> World:
    """A bridge ends short of the other side."""
    hall = site(rng, floor=False)
    way = carrier(rng)
    gap = min(GAP, way.width / 8.0) * m
    x = float(rng.uniform(-0.5, 0.5))
    hall.add("floor", block(WEST, -1.0, -hall.half, hall.half, -0.2, 0.0))
    hall.add("bridge", block(-1.0, x, -hall.half, hall.half, -0.1, 0.0))
    hall.add("east", block(x + gap, EAST, -hall.half, hall.half, -0.2, 0.0))
    hall.ends()
    return hall.world(folder, way, "bridge", "east", "floor", "way")


def _leaf(hall: Site, door: float) -> None:
    """A door leaf hung at the jamb y = -door / 2 of the wall x = 0, in a frame at its hinge, closed along +y."""
    thick = 0.04
    leaf = Part(shape=Box(size=(thick, door, 1.95)), pose=pose((thick / 2, door / 2, 0.98)))
    hall.things["door"] = entity(leaf, motion="dynamic", at=hall.out((0, -door / 2, 0)).tolist(), euler=(0, 0, hall.yaw))


def _swing(hall: Site, door: float, turns: list[float]) -> Any:
    """Motion of the leaf; positive turns open it to +x, where its face moves away from the way."""
    return hall.track([(0, -door / 2, 0)] * len(turns), [-t for t in turns])


def _door_site(rng: RNG) -> tuple[Site, Connects, float]:
    hall, way = site(rng, half=1.3), Connects(a="a", b="b", width=float(rng.uniform(0.7, 0.9)), headroom=1.9)
    door = way.width * float(rng.uniform(1.05, 1.3))
    depth = float(rng.choice([0.01, 0.05, 0.1]))
    left, right = -door / 2, door / 2
    hall.add(
        "wall",
        block(-depth, 0.0, -hall.half, left, 0, 2.5),
        block(-depth, 0.0, right, hall.half, 0, 2.5),
        block(-depth, 0.0, left, right, 2.0, 2.5),
    )
    # The leaf cannot be walked around on its hinge side.
    _leaf(hall, door)
    hall.ends()
    return hall, way, door


def _door_ajar(folder: Path, m: float, rng: RNG) -> World:
    """A door opens until the demanded frame, but too little, or not at all: clear width = width of the door x sine."""
    hall, way, door = _door_site(rng)
    clear = max(way.width - m, 0.0)
    turn = math.asin(clear / door)
    frames = int(rng.integers(4, 9))
    turns = [turn * k / (frames - 1) for k in range(frames)]
    asked = way.model_copy(update={"frames": (frames - 1, frames - 1)})
    return hall.world(folder, asked, "door", tracks={"door": _swing(hall, door, turns)}, frames=frames)


def _falls_shut(folder: Path, m: float, rng: RNG) -> World:
    """The door stands open at both ends of the interval and falls shut for a frame between."""
    hall, way, door = _door_site(rng)
    frames = int(rng.integers(9, 24))
    turns = [float(rng.uniform(1.571, 1.9))] * frames
    turns[int(rng.integers(3, frames - 2))] = math.asin(max(way.width - m, 0.0) / door)
    asked = way.model_copy(update={"frames": (1, frames - 1)})
    return hall.world(folder, asked, "door", tracks={"door": _swing(hall, door, turns)}, frames=frames)


def _moved_obstacle(folder: Path, m: float, rng: RNG) -> World:
    """A crate slides into the only door, at the last frame, or passes through it between the ends of the interval."""
    hall, way = site(rng, half=1.6), carrier(rng, carrier="walker", headroom=1.9)
    door = way.width * 1.1
    hall.wall("wall", 0.0, door)
    size, frames = float(rng.uniform(0.5, 0.8)), int(rng.integers(6, 20))
    hit = frames - 1 if rng.random() < 0.5 else int(rng.integers(2, frames - 1))
    aside, inside = (-1.2, hall.half - size / 2 - 0.02, 0.45), (-0.05 - size / 2, door / 2 - way.width + m + size / 2, 0.45)
    hall.put("crate", Box(size=(size, size, 0.9)), aside, motion="dynamic")
    points = [inside if k == hit else aside for k in range(frames)]
    asked = way.model_copy(update={"frames": (0, frames - 1)})
    hall.ends()
    return hall.world(folder, asked, "crate", tracks={"crate": hall.track(points)}, frames=frames)


def _lamp(folder: Path, m: float, rng: RNG) -> World:
    """A small thing hangs, or a wire stands, in a corridor; neither side of it is wide enough."""
    hall, way = site(rng), carrier(rng, headroom=1.9)
    radius = float(rng.choice([0.001, 0.02, 0.15]))
    clear = way.width - m
    door, y = 2.0 * clear + 2.0 * radius, float(rng.uniform(-0.1, 0.1))
    depth = 0.3
    hall.half = max(hall.half, door / 2 + 0.3)
    hall.add("floor", block(WEST, EAST, -hall.half, hall.half, -0.2, 0.0))
    hall.add(
        "wall",
        block(0, depth, -hall.half, y - door / 2, 0, 2.6),
        block(0, depth, y + door / 2, hall.half, 0, 2.6),
    )
    if rng.random() < 0.5:
        low = 1.1 * way.max_step + radius
        hall.put("lamp", Sphere(radius=radius), (depth / 2, y, float(rng.uniform(low, 1.6))))
    else:
        hall.put("lamp", Cylinder(radius=radius, height=2.6), (depth / 2, y, 1.3))
    hall.ends()
    return hall.world(folder, way, "lamp", "wall")


def _ghost_bridge(folder: Path, m: float, rng: RNG) -> World:
    """The bridge over a pit is only drawn: it carries nothing."""
    hall, way = site(rng, floor=False), carrier(rng)
    hall.add("floor", block(WEST, -m / 2, -hall.half, hall.half, -0.2, 0.0))
    hall.add("bridge", block(-m / 2 - 0.1, m / 2 + 0.1, -hall.half, hall.half, -0.05, 0.001, collides=False))
    hall.add("east", block(m / 2, EAST, -hall.half, hall.half, -0.2, 0.0))
    hall.ends()
    return hall.world(folder, way, "bridge", "east", "floor", "way")


def _floating_region(folder: Path, m: float, rng: RNG) -> World:
    """A region hangs above the floor by more than a step, or lies within a block."""
    hall, way = site(rng), carrier(rng)
    hall.wall("wall", 0.0, way.width * 1.3)
    hall.ends()
    name = str(rng.choice(["a", "b"]))
    x = -2.4 if name == "a" else 2.4
    if rng.random() < 0.7:
        hall.region(name, (x - 0.4, -0.6, way.max_step + m), (x + 0.4, 0.6, way.max_step + m + 0.5))
    else:
        hall.add("plinth", block(x - 0.5, x + 0.5, -hall.half, hall.half, -0.1, way.max_step + m))
        hall.region(name, (x - 0.4, -0.6, 0.0), (x + 0.4, 0.6, min(0.5 * m, 0.1)))
    return hall.world(folder, way, "way")


def _through_the_wall(folder: Path, m: float, rng: RNG) -> World:
    """Region `a` reaches through a wall without a door, so that a piece of it lies on the side of `b`."""
    hall, way = site(rng, half=1.4), carrier(rng)
    x = -0.5
    hall.add("wall", block(x, x + 0.1, -hall.half, hall.half, 0, 2.6))
    hall.regions["a"] = BoxRegion(min=(-3.1, -1.2, 0), max=(x + 0.1 + m, 1.2, 0.5), relative_to="floor")
    hall.region("b", (2.1, -1.2, 0), (3.1, 1.2, 0.5))
    return hall.world(folder, way, "wall")


def _narrow_opening(folder: Path, m: float, rng: RNG) -> World:
    """The opening between two basins is too small for the fluid, or a gate closes a part of it."""
    width = float(rng.uniform(0.2, 0.3))
    if rng.random() < 0.5:
        hall, way = tanks(rng, width, width * (1.0 - m), width / 10)
    else:
        hall, way = tanks(rng, width, width * 1.2, width / 10, gate=width * (0.2 + m))
    return hall.world(folder, way, "wall", "gate")


def _unresolved_opening(folder: Path, m: float, rng: RNG) -> World:
    """The opening is wide enough, but the fluid's cells are too coarse for it."""
    width = float(rng.uniform(0.2, 0.3))
    hall, way = tanks(rng, width, 1.01 * width, 1.01 * width / CELLS_ACROSS * m)
    return hall.world(folder, way, "water")


# ---------------------------------------------------------------- clean


def _opening(folder: Path, m: float, rng: RNG) -> World:
    width = float(rng.uniform(0.2, 0.3))
    hall, way = tanks(rng, width, width * (1.0 + m), width / (1.1 * CELLS_ACROSS), gate=None if m < 0.05 else 0.8 * m * width)
    return hall.world(folder, way)


def _wide_enough(folder: Path, m: float, rng: RNG) -> World:
    hall, way = site(rng), carrier(rng)
    way = way.model_copy(update={"headroom": min(way.headroom, 2.2)})
    _doors(hall, way.width, way.width + m)
    hall.ends()
    hall.clutter()
    return hall.world(folder, way)


def _high_enough(folder: Path, m: float, rng: RNG) -> World:
    """A beam that just clears the head; and one that is too low, with a way beside it."""
    hall, way = site(rng, half=1.6), carrier(rng)
    hall.wall("wall", -1.5, way.width * 1.3, lintel=2.55)
    hall.add("beam", block(0.2, 0.4, -hall.half, hall.half, way.headroom + m, way.headroom + m + 0.1))
    side = float(rng.choice([-1.0, 1.0]))
    low, high = sorted((side * hall.half, -side * (hall.half - way.width - 0.01)))
    hall.add("low", block(1.2, 1.3, low, high, 1.2 * way.max_step, 2.4))
    hall.ends()
    return hall.world(folder, way)


def _legal_stairs(folder: Path, m: float, rng: RNG) -> World:
    """Every riser at the limit, treads as short as the steepest pitch allows; sometimes with a passage below the deck."""
    hall, way = site(rng, half=1.2), Connects(a="a", b="b")
    rise = way.max_step - m
    count = int(rng.integers(4, 13))
    going = float(rng.uniform(1.12, 1.6)) * rise / PITCH
    stairs(hall, [rise] * count, going, solid=bool(rng.random() < 0.5))
    return hall.world(folder, way)


def _legal_ramp(folder: Path, m: float, rng: RNG) -> World:
    hall = site(rng, half=0.9, floor=False)
    hall.add("floor", block(WEST, 0.0, -hall.half, hall.half, -0.1, 0.0))
    way = carrier(rng, width=0.8, max_slope=float(rng.uniform(0.08, 0.6)))
    ramp(hall, [(float(rng.uniform(0.2, 1.0)), way.max_slope * (1 - m)) for _ in range(int(rng.integers(1, 4)))])
    return hall.world(folder, way)


def _open_door(folder: Path, m: float, rng: RNG) -> World:
    """Closed at first and at last, open by the way's width at the demanded frames."""
    hall, way, door = _door_site(rng)
    frames = int(rng.integers(8, 16))
    turn = math.asin(min((way.width + m) / door, 1.0)) if rng.random() < 0.5 else float(rng.uniform(1.58, 2.2))
    if turn < 1.57 and way.width + m > door:
        turn = 1.58
    turns = [0.0, 0.3 * turn, *[turn] * (frames - 4), 0.4 * turn, 0.0]
    asked = way.model_copy(update={"frames": (2, frames - 3)})
    return hall.world(folder, asked, tracks={"door": _swing(hall, door, turns)}, frames=frames)


def _detour(folder: Path, m: float, rng: RNG) -> World:
    """Clutter everywhere; a winding way of the right width is left."""
    hall, way = site(rng, half=1.6), carrier(rng, headroom=1.8)
    way = way.model_copy(update={"width": min(way.width, 0.8)})
    clear = way.width + m
    for k, x in enumerate((-1.5, -0.2, 1.1)):
        side = 1.0 if k % 2 else -1.0
        edge = hall.half - clear  # from -side x half to side x edge
        low, high = sorted((-side * hall.half, side * edge))
        hall.add(f"shelf{k}", block(x, x + 0.25, low, high, 0, float(rng.uniform(1.2 * way.max_step + 0.05, 2.0))))
    hall.ends()
    hall.clutter()
    return hall.world(folder, way)


def _bridge(folder: Path, m: float, rng: RNG) -> World:
    """A way under a bridge, or over it, or up to a landing that joins two floors."""
    hall, way = site(rng, half=1.5), Connects(a="a", b="b", headroom=1.9)
    rise, going = 0.18, 0.28
    count = 12
    top = _headroom_flight(hall, rise, going, count, way.headroom + m)
    if rng.random() < 0.5:  # under the deck
        hall.region("b", (count * going + 0.6, -0.9, 0), (count * going + 1.4, 0.9, 0.5))
    del top
    return hall.world(folder, way)


def _headroom_flight(hall: Site, rise: float, going: float, count: int, clear: float) -> float:
    """A flight up to a deck that leaves `clear` below; the floor runs on underneath."""
    top = count * rise
    under = min(top - 0.02, max(clear, 0.0))
    hall.add("floor", block(WEST, count * going + 2.5, -hall.half, hall.half, -0.2, 0.0))
    hall.add("stairs", *flight([rise] * count, going, 1.0, solid=False))
    hall.add("deck", block(count * going, count * going + 2.5, -hall.half, hall.half, under, top))
    hall.ends(rise=top, far=count * going + 2.5)
    return top


def _cracks(folder: Path, m: float, rng: RNG) -> World:
    """A floor of boards with cracks narrower than allowed."""
    hall, way = site(rng, floor=False), carrier(rng)
    gap = min(GAP, way.width / 8.0) * m
    x, k = WEST, 0
    while x < EAST:
        end = min(x + float(rng.uniform(0.3, 1.0)), EAST)
        hall.add("floor" if k == 0 else f"board{k}", block(x, end, -hall.half, hall.half, -0.1, 0.0))
        x, k = end + gap, k + 1
    hall.ends()
    return hall.world(folder, way)


def _low_sill(folder: Path, m: float, rng: RNG) -> World:
    """Sills at the limit, rugs that are only drawn, pebbles, and a lamp above the head."""
    hall, way = site(rng), carrier(rng, headroom=1.9)
    hall.wall("wall", 0.0, way.width * 1.2, lintel=2.5)
    hall.add("sill", block(0.0, float(rng.choice([0.002, 0.05, 0.2])), -hall.half, hall.half, 0.0, way.max_step - m))
    hall.add("rug", block(-1.2, -0.4, -0.5, 0.5, 0.0001, min(0.01, 0.5 * way.max_step), collides=False))
    hall.put("pebble", Sphere(radius=0.4 * way.max_step), (-0.7, 0.1, 0.4 * way.max_step), motion="dynamic")
    hall.put("lamp", Sphere(radius=0.2), (0.5, 0.0, way.headroom + 0.2 + m))
    hall.ends()
    return hall.world(folder, way)


def _passing_by(folder: Path, m: float, rng: RNG) -> World:
    """A crate slides past the door and leaves the width, or stands in it only at frames that nobody asks for."""
    hall, way = site(rng, half=1.6), carrier(rng, carrier="walker", headroom=1.9)
    door = way.width + 0.3
    hall.wall("wall", 0.0, door)
    size, frames = float(rng.uniform(0.5, 0.8)), 12
    beside = (-0.05 - size / 2, door / 2 - way.width - m - size / 2, 0.45)
    inside = (-0.05 - size / 2, 0.0, 0.45)
    points = [beside if 2 <= k <= 8 else inside for k in range(frames)]
    hall.put("crate", Box(size=(size, size, 0.9)), beside, motion="dynamic")
    hall.ends()
    # Behind the crate there is no way along the wall either.
    asked = way.model_copy(update={"frames": (2, 8)})
    return hall.world(folder, asked, tracks={"crate": hall.track(points)}, frames=frames)


SUITE = Suite(
    "navigability",
    (
        Mechanism("narrow door", "one of several doors", True, _narrow_door, 0.004, 0.5, "m", bound=RASTER_NOISE),
        Mechanism("crate in door", "furniture reaches in", True, _crate_in_door, 0.004, 0.5, "m", bound=RASTER_NOISE),
        Mechanism("low beam", "too low at one place", True, _low_beam, 0.001, 0.5, "m", bound=SAME_HEIGHT),
        Mechanism("high riser", "one riser in the middle", True, _high_riser, 0.001, 0.3, "m", bound=SAME_HEIGHT),
        Mechanism("missing tread", "a hole in the flight", True, _missing_tread, 0.002, 0.19, "m", bound=0.0),
        Mechanism("tiny treads", "a flight like a ladder", True, _tiny_treads, 1.2, 2.5, "1"),
        Mechanism("steep piece", "too steep on a short stretch", True, _steep_piece, 0.002, 0.6, "rad", bound=0.0),
        Mechanism("threshold", "a sill just too high", True, _threshold, 0.001, 0.3, "m", bound=SAME_HEIGHT),
        Mechanism("kerb at ramp", "a step where a ramp begins", True, _kerb_at_ramp, 0.002, 0.1, "m", bound=SAME_HEIGHT),
        Mechanism("gap", "a bridge ends short", True, _gap, 1.02, 30.0, "1", bound=1.0),
        Mechanism("door ajar", "a door that opens too little", True, _door_ajar, 0.004, 0.9, "m", bound=RASTER_NOISE),
        Mechanism("falls shut", "shut for one frame", True, _falls_shut, 0.004, 0.9, "m", bound=RASTER_NOISE),
        Mechanism("moved obstacle", "in the door for one frame", True, _moved_obstacle, 0.004, 0.4, "m", bound=RASTER_NOISE),
        Mechanism("lamp", "hangs between the layers, or a wire", True, _lamp, 0.004, 0.3, "m", bound=RASTER_NOISE),
        Mechanism("ghost bridge", "only drawn", True, _ghost_bridge, 0.1, 2.0, "m"),
        Mechanism("floating region", "no floor under it", True, _floating_region, 0.001, 1.0, "m", bound=0.0),
        Mechanism("through the wall", "a region on both sides", True, _through_the_wall, 0.05, 1.1, "m"),
        Mechanism("narrow opening", "for a fluid", True, _narrow_opening, 1.1 * OPENING_NOISE, 0.97, "1", bound=OPENING_NOISE),
        Mechanism("unresolved opening", "cells as coarse as it", True, _unresolved_opening, 1.02, 4.0, "1", bound=1.0),
        Mechanism("no person", "a walker smaller than people are", True, no_person, 1.001, 40.0, "1", bound=1.0),
        Mechanism("small carrier", "no person, and it says so", False, small_carrier, 1.01, 4.0, "1"),
        Mechanism("least person", "as narrow as people are", False, tall_person, 1.0, 2.0, "1"),
        Mechanism("opening", "just wide enough for a fluid", False, _opening, 0.0001, 0.3, "1"),
        Mechanism("wide enough", "just as wide as needed, turned", False, _wide_enough, 0.0001, 0.1, "m"),
        Mechanism("high enough", "just clears the head", False, _high_enough, 0.0001, 0.1, "m"),
        Mechanism("legal stairs", "risers at the limit", False, _legal_stairs, 0.0001, 0.05, "m"),
        Mechanism("legal ramp", "slopes at the limit", False, _legal_ramp, 1e-6, 0.1, "1"),
        Mechanism("open door", "open when it matters", False, _open_door, 0.001, 0.2, "m"),
        Mechanism("detour", "a winding way is left", False, _detour, 0.0001, 0.2, "m"),
        Mechanism("bridge", "two floors above each other", False, _bridge, 0.0001, 0.2, "m"),
        Mechanism("cracks", "boards with cracks", False, _cracks, 0.02, 0.9, "1"),
        Mechanism("low sill", "sills at the limit, rugs, pebbles", False, _low_sill, 0.0001, 0.01, "m"),
        Mechanism("passing by", "moves, and leaves the width", False, _passing_by, 0.001, 0.1, "m"),
        *LAND_MECHANISMS,
    ),
)
"""Worlds of the check `navigability`."""
