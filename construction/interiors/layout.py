"""An interior as storeys: plans, heights, and the openings in their walls."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...worlds.errors import InputError
from ...worlds.spec import Interior, Room
from ..assets.stairs import StairsParameters, stairs_run
from ..assets.stairwells import WellStairsParameters, well_run
from .built import LOOSE, SLAB
from .planning import solve_plans
from .plans import OUTSIDE, STEPS, UPPER, WING, Need, Plan
from .programs import KINDS
from .walls import CORNER, Doorway, Opening, doors_of, passages_of, windows_of

__all__ = [
    "ARRIVAL",
    "DOOR_HEIGHT",
    "FLIGHT",
    "GOING",
    "JAMB",
    "RISER",
    "SILL",
    "STRIP",
    "Storey",
    "gate_of",
    "height_of",
    "room_of",
    "storeys_of",
    "straight_stairs",
    "well_stairs",
]

JAMB = 0.045
"""[m] Thickness of the frames of doors and windows, see `assets/openings.py`."""
DOOR_HEIGHT, SILL, WINDOW_HEAD = 2.03, 0.9, 2.1
"""[m] Clear height of doors (2.0 m of headroom: DIN 18101); lower and upper edge of windows in the wall (sill 0.9: SceneSmith)."""
HIGH_WINDOW = 1.3
"""[m] Own choice: height of windows under the ceiling."""
LINTEL, GATE_WALL = 0.3, 0.12
"""[m] Own choice: wall over a gate; thickness of the wall in which one hangs."""
RISER, GOING = 0.16, 0.3
"""[m] Steps in corridors: gentle ones, 2 R + G = 0.62 m (UK Approved Document K: 0.55 to 0.70)."""
STRIP = 1.1
"""[m] Own choice: floor before the stairs of a stairwell, so that the leaf of a door turns."""
FLIGHT, LANDING = 0.9, 0.95
"""[m] Own choice: width of the flights of a stairwell and depth of its landing, at least (homes: 0.8, DIN 18065)."""
GALLERY, ARRIVAL = 0.95, 0.95
"""[m] Own choice: floor beside a straight flight and behind its upper end, at least; a railing takes 0.12 m of the first."""
STRAIGHT = {"riser": 0.19, "going": 0.25}
"""[m] Own choice: steps of a straight flight, steep as in homes: 2 R + G about 0.62 m (UK Approved Document K)."""


@dataclass(frozen=True)
class Storey:
    """One storey: its rooms, and what is open in their walls."""

    number: int
    plan: Plan
    z: float
    """Its floor over the lowest one [m]."""
    height: float
    """Upper side of its walls over its floor [m]."""
    levels: Mapping[str, float]
    """Floors of rooms over that of the storey [m]; 0 of those that are not named."""
    doors: tuple[Opening, ...]
    passages: tuple[Opening, ...]
    windows: tuple[Opening, ...]

    @property
    def openings(self) -> tuple[Opening, ...]:
        """All of them."""
        return (*self.doors, *self.passages, *self.windows)


def room_of(interior: Interior, name: str) -> tuple[str, Room]:
    """The room of which a part of a plan is one, and its id."""
    if name in interior.rooms:
        return name, interior.rooms[name]
    own = next(name.removesuffix(f"_{end}") for end in (STEPS, UPPER, WING) if name.endswith(f"_{end}"))
    return own, interior.rooms[own]


def storeys_of(interior: Interior, rng: np.random.Generator) -> tuple[Storey, ...]:
    """Plan the storeys of an interior.

    Raises:
        InputError: there is no such plan.
    """
    _check_names(interior)
    needs = _needs(interior)
    opening = interior.door + 2 * JAMB + 2 * LOOSE
    door = opening + 2 * CORNER
    plans = solve_plans(needs, size=interior.size, wall=interior.wall, door=door, seed=interior.seed, entrance=interior.entrance)
    found: list[Storey] = []
    z = 0.0
    for number, plan in enumerate(plans):
        stepped = [k for k, r in interior.rooms.items() if r.steps and r.storey == number]
        rise = RISER * max((interior.rooms[k].steps for k in stepped), default=0)
        levels = dict.fromkeys(plan.raised, rise)
        parts = [p for k in stepped for p in ((k, f"{k}_{STEPS}"), (f"{k}_{STEPS}", f"{k}_{UPPER}"))]
        parts += [(k, f"{k}_{WING}") for k, r in interior.rooms.items() if r.shape == "L" and r.storey == number]
        height = height_of(interior) + rise
        passages = passages_of(plan, parts, wall=interior.wall, head=height)
        ways = [pair for pair in plan.doors if any(n in interior.rooms and interior.rooms[n].open for n in pair)]
        passages += passages_of(plan, ways, wall=interior.wall, head=height, kind="archway")
        doorways = [_doorway(interior, a, b, levels) for a, b in plan.doors if (a, b) not in ways]
        doors = doors_of(plan, doorways, wall=interior.wall, rng=rng)
        lit = {k: _lit(interior, k, levels.get(k, 0.0)) for k in plan.rooms if _has_windows(interior, k, needs)}
        windows = windows_of(plan, lit, doors, wall=interior.wall)
        found.append(Storey(number, plan, z, height, levels, tuple(doors), tuple(passages), tuple(windows)))
        z += height + SLAB
    return tuple(found)


def height_of(interior: Interior) -> float:
    """From floor to ceiling [m]."""
    return interior.height or max(KINDS[r.kind].height for r in interior.rooms.values())


def gate_of(interior: Interior, a: str, b: str) -> tuple[float, float] | None:
    """Clear width and height of a door with two leaves between two rooms [m]; None for a door with one."""
    return KINDS[room_of(interior, a)[1].kind].gate if b == OUTSIDE else None


def _has_windows(interior: Interior, part: str, needs: Mapping[str, Need]) -> bool:
    """True of a room with daylight, and of both parts of an L-shaped one."""
    own, room = room_of(interior, part)
    return needs[own].daylight and (part == own or room.shape == "L")


def _check_names(interior: Interior) -> None:
    stepped: dict[int, str] = {}
    for name, room in interior.rooms.items():
        if room.shape == "L" and f"{name}_{WING}" in interior.rooms:
            raise InputError(
                f"room {f'{name}_{WING}'!r} has the name of the shorter part of the L-shaped room {name!r}; name it otherwise"
            )
        if room.shape == "L" and not any(r.storey == room.storey for k, r in interior.rooms.items() if k != name):
            raise InputError(
                f"room {name!r} is an L and alone on storey {room.storey}; the outline is a rectangle: add a room that fills its corner, "
                "e.g. a hall with a door to it"
            )
        if room.steps:
            taken = [n for n in (f"{name}_{STEPS}", f"{name}_{UPPER}") if n in interior.rooms]
            if taken:
                raise InputError(
                    f"room {taken[0]!r} has the name of a part of the corridor {name!r} with steps; name it otherwise"
                )
            if room.storey in stepped:
                raise InputError(
                    f"corridors {stepped[room.storey]!r} and {name!r} of storey {room.storey} both have steps; one of a storey may"
                )
            stepped[room.storey] = name


def _doorway(interior: Interior, a: str, b: str, levels: Mapping[str, float]) -> Doorway:
    """A door opens into the room, not into the corridor or stairwell.

    Raises:
        InputError: the walls are too low or thin for a gate.
    """
    if b != OUTSIDE and room_of(interior, a)[1].kind in ("corridor", "stairs"):
        a, b = b, a
    gate = gate_of(interior, a, b)
    width, height = gate or (interior.door, DOOR_HEIGHT)
    if gate is not None and (height_of(interior) < height + LINTEL or interior.wall < GATE_WALL):
        raise InputError(
            f"the gate of room {a!r} is {height:g} m high: walls of {height_of(interior):g} m, {interior.wall:g} m thick, do not hold it; "
            f"give height >= {height + LINTEL:g} m and wall >= {GATE_WALL:g} m"
        )
    side = interior.entrance if b == OUTSIDE else None
    return Doorway(a, b, width + 2 * JAMB + 2 * LOOSE, height + JAMB + LOOSE, levels.get(a, 0.0), side)


def _lit(interior: Interior, name: str, level: float) -> tuple[float, float]:
    """Lower and upper edge of the windows of a room over the floor of the storey [m]."""
    if not KINDS[room_of(interior, name)[1].kind].high:
        return level + SILL, level + WINDOW_HEAD
    head = level + height_of(interior) - 0.3
    return max(level + SILL, head - HIGH_WINDOW), head


def _needs(interior: Interior) -> dict[str, Need]:
    rooms = interior.rooms
    return {name: _need(interior, name, room) for name, room in rooms.items()}


def _need(interior: Interior, name: str, room: Room) -> Need:
    own, doors = KINDS[room.kind], tuple(room.doors)
    daylight = own.daylight if room.windows is None else room.windows
    if room.kind == "stairs":
        storeys = _joined(interior, name, room)
        straight = room.stairs == "straight"
        sides = _straight_well(interior, storeys) if straight else _well(interior, storeys)
        return Need(own.area, own.width, own.aspect, doors, daylight, storeys, well=sides, straight=straight)
    if room.kind == "corridor":
        width = room.width or own.width
        beside = [r for k, r in interior.rooms.items() if k != name and (name in r.doors or k in room.doors)]
        length = sum(math.sqrt(r.area or KINDS[r.kind].area) for r in beside) / 2
        flight = room.steps * GOING
        area = room.area or width * max(2 * width, length + flight)
        return Need(area, width, own.aspect, doors, daylight, (room.storey,), False, True, flight)
    width = own.width if room.furniture or own.bare_width is None else own.bare_width
    asked, wing = room.area is not None, room.shape == "L"
    return Need(room.area or own.area, width, own.aspect, doors, daylight, (room.storey,), asked, wing=wing)


def _joined(interior: Interior, name: str, room: Room) -> tuple[int, ...]:
    """Storeys that stairs join, without a gap."""
    ends = {r.storey for k, r in interior.rooms.items() if r.kind != "stairs" and (name in r.doors or k in room.doors)}
    if len(ends) < 2:
        raise InputError(
            f"stairs {name!r} have doors to rooms of storeys {sorted(ends)}; they join storeys: give them a door to a room of another one"
        )
    missing = [s for s in range(min(ends), max(ends) + 1) if s not in ends]
    if missing:
        raise InputError(f"stairs {name!r} have no door on storey {missing[0]}; they have one on every storey that they pass")
    return tuple(sorted(ends))


def _rise(interior: Interior, storey: int) -> float:
    """From the floor of a storey to the next one [m]."""
    steps = max((r.steps for r in interior.rooms.values() if r.storey == storey), default=0)
    return height_of(interior) + RISER * steps + SLAB


def well_stairs(rise: float, width: float, landing: float = LANDING) -> WellStairsParameters:
    """Stairs that fill a stairwell.

    Args:
        rise: from floor to floor [m].
        width: between the walls [m].
        landing: its depth [m].
    """
    return WellStairsParameters(rise=round(rise, 6), width=round(width - 2 * LOOSE, 6), landing=landing)


def _well(interior: Interior, storeys: tuple[int, ...]) -> tuple[float, float]:
    """Clear sides of a stairwell across and along the climb [m]."""
    across = 2 * FLIGHT + 0.1
    rises = [_rise(interior, s) for s in storeys[:-1]]
    most = WellStairsParameters.model_json_schema()["properties"]["rise"]["maximum"]
    if max(rises) > most:
        raise InputError(f"storeys of {max(rises):.2f} m are too high for a stairwell, at most {most:g} m: lower height")
    return across, STRIP + max(well_run(well_stairs(r, across)) for r in rises) + LANDING


def straight_stairs(rise: float, railing: Literal["left", "right"] = "right") -> StairsParameters:
    """The straight flight of a stairwell.

    Args:
        rise: from floor to floor [m].
        railing: side that is open.
    """
    return StairsParameters(rise=round(rise, 6), width=FLIGHT, railing=railing, posts=False, **STRAIGHT)


def _straight_well(interior: Interior, storeys: tuple[int, ...]) -> tuple[float, float]:
    """Clear sides of a stairwell with a straight flight [m]."""
    rises = [_rise(interior, s) for s in storeys[:-1]]
    most = StairsParameters.model_json_schema()["properties"]["rise"]["maximum"]
    if max(rises) > most:
        raise InputError(
            f"storeys of {max(rises):.2f} m are too high for one straight flight, at most {most:g} m: lower height, or leave stairs out"
        )
    return FLIGHT + GALLERY, STRIP + max(stairs_run(straight_stairs(r)) for r in rises) + ARRIVAL
