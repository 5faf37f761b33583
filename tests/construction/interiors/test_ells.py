"""L-shaped rooms: two flush rectangles without a wall between them, furnished as one."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from worldagent.construction.interiors.arrangement import Arrangement
from worldagent.construction.interiors.faces import common_area, wall_lines
from worldagent.construction.interiors.floor_space import FloorSpace, Spot
from worldagent.construction.interiors.furnishing import Frame, Furnished, furnished
from worldagent.construction.interiors.layout import Storey, storeys_of
from worldagent.construction.interiors.pieces import Stock
from worldagent.construction.interiors.plans import Rect
from worldagent.construction.interiors.programs import KINDS
from worldagent.construction.interiors.spots import along_walls
from worldagent.construction.interiors.walls import Opening, clear_rect, wall_blocks
from worldagent.worlds.errors import InputError
from worldagent.worlds.spec import Interior

WALL = 0.12
FLAT: dict[str, Any] = {
    "hall": {"kind": "hall", "doors": ["outside"]},
    "living": {"kind": "living", "shape": "L", "area": 30, "doors": ["hall"]},
    "kitchen": {"kind": "kitchen", "doors": ["hall", "living"]},
    "bedroom": {"kind": "bedroom", "doors": ["hall"]},
    "bath": {"kind": "bathroom", "doors": ["hall"]},
}
MAIN, WING = Rect(0.0, 0.0, 4.0, 5.0), Rect(4.12, 0.0, 7.0, 2.6)
DOOR = Opening("door", "door", "x", (6.0, 2.66), 0.95, 0.0, 2.07, ("room_wing", "hall"))


def _storey(seed: int, rooms: dict[str, Any] = FLAT) -> Storey:
    (found,) = storeys_of(Interior.model_validate({"rooms": rooms, "seed": seed}), np.random.default_rng(0))
    return found


def _turned(r: Rect, quarter: int) -> Rect:
    return Spot(0.0, 0.0, quarter).rect(r)


def _space(quarter: int = 0) -> FloorSpace:
    """An L with a door in the inner wall of its wing, turned by quarters."""
    (x, y), c, s = DOOR.center, round(math.cos(quarter * math.pi / 2)), round(math.sin(quarter * math.pi / 2))
    at = (c * x - s * y, s * x + c * y)
    door = Opening("door", "door", "x" if quarter % 2 == 0 else "y", at, 0.95, 0.0, 2.07, DOOR.rooms)
    return FloorSpace.of_wing(_turned(MAIN, quarter), _turned(WING, quarter), [door], WALL, names=("room", "room_wing"))


@pytest.mark.parametrize("seed", range(3))
def test_an_l_is_two_flush_rectangles_without_a_wall_between_them(seed: int) -> None:
    storey = _storey(seed)
    main, wing = (storey.plan.rooms[n] for n in ("living", "living_wing"))
    flush = [abs(a - b) < 1e-9 for a, b in ((main.x0, wing.x0), (main.x1, wing.x1), (main.y0, wing.y0), (main.y1, wing.y1))]
    assert sum(flush) == 1
    assert main.area + wing.area == pytest.approx(30, rel=0.3)
    (passage,) = [o for o in storey.passages if set(o.rooms) == {"living", "living_wing"}]
    between = passage.plan(WALL)
    assert passage.width >= 1.5
    blocks = wall_blocks(storey.plan, storey.openings, wall=WALL, height=storey.height)
    assert sum(common_area(Rect(*b.low[:2], *b.high[:2]), between) for b in blocks) == pytest.approx(0.0, abs=1e-9)
    whole = wall_blocks(storey.plan, [*storey.doors, *storey.windows], wall=WALL, height=storey.height)
    assert sum(common_area(Rect(*b.low[:2], *b.high[:2]), between) for b in whole) > 0.9 * between.area, "walls are there else"


def test_doors_lead_to_the_part_of_an_l_that_is_beside_the_other_room() -> None:
    parts = set()
    for seed in range(4):
        storey = _storey(seed)
        (door,) = [d for d in storey.doors if d.rooms[0] == "kitchen" and d.rooms[1].startswith("living")]
        inside = clear_rect(storey.plan.rooms[door.rooms[1]], -2 * WALL)
        x, y = door.center
        assert inside.x0 < x < inside.x1
        assert inside.y0 < y < inside.y1
        parts.add(door.rooms[1])
    assert "living_wing" in parts


@pytest.mark.parametrize("quarter", range(4))
def test_walls_of_an_l_go_all_round_it_and_face_it(quarter: int) -> None:
    space = _space(quarter)
    lines = wall_lines(space.room, space.notch)
    assert len(lines) == 6
    assert sum(w.end - w.start for w in lines) == pytest.approx(2 * (7.0 + 5.0))
    for line in lines:
        middle = (line.start + line.end) / 2
        inward = {0: (middle, line.across - 0.2), 2: (middle, line.across + 0.2), 1: (line.across + 0.2, middle), 3: (line.across - 0.2, middle)}[line.quarter]  # fmt: skip
        assert space.holds(Rect(inward[0] - 0.1, inward[1] - 0.1, inward[0] + 0.1, inward[1] + 0.1)), line
    assert space.area == pytest.approx(4.0 * 5.0 + 3.0 * 2.6)


def _furnished(space: FloorSpace, seed: int) -> Furnished:
    rng = np.random.default_rng(seed)
    return furnished(Frame("room", 2.6, 1e-3), KINDS["living"], space, Stock(rng), density=0.2, rng=rng)


def _feet(found: Furnished) -> list[Rect]:
    return [s.spot.rect(s.piece.foot) for s in found.standing if s.spot is not None]


@pytest.mark.parametrize("quarter", range(4))
def test_an_l_is_furnished_as_one_room_and_nothing_reaches_into_the_corner_it_leaves_out(quarter: int) -> None:
    """Law: a rectangle without the corner has things there, so that the rule is what keeps them away."""
    space = _space(quarter)
    assert space.notch is not None
    made, plain = _furnished(space, 3), _furnished(FloorSpace(space.room, [], WALL), 3)
    assert made.lacking == []
    feet = _feet(made)
    assert max(common_area(f, space.notch) for f in feet) < 1e-9
    assert sum(common_area(f, space.notch) for f in _feet(plain)) > 0.1
    shares = [sum(common_area(f, part) for f in feet) for part in space.parts.values()]
    assert min(shares) > 0.1, "things stand in both parts"


def test_things_stand_with_their_backs_to_the_inner_walls_too() -> None:
    space, rng = _space(), np.random.default_rng(0)
    made = _furnished(space, 3)
    room, own = Arrangement(Frame("room", 2.6, 1e-3), space, rng), made.standing[0].piece
    assert space.notch is not None
    at_back = {0: 0, 3: 0}
    for spot in along_walls(room, own):
        foot = spot.rect(own.foot)
        at_back[0] += spot.quarter == 0 and abs(foot.y1 - space.notch.y0) < 0.02
        at_back[3] += spot.quarter == 3 and abs(foot.x1 - space.notch.x0) < 0.02
    assert min(at_back.values()) > 3


@pytest.mark.parametrize(
    ("rooms", "said"),
    [
        ({"living": {"kind": "living", "shape": "L", "doors": ["outside"]}}, "alone on storey 0"),
        ({**FLAT, "living_wing": {"kind": "store", "doors": ["living"]}}, "name of the shorter part"),
    ],
)
def test_an_l_that_cannot_be_is_refused(rooms: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        _storey(0, rooms)


@pytest.mark.parametrize("kind", ["barn", "museum", "corridor", "stairs"])
def test_rooms_that_need_one_rectangle_are_no_l(kind: str) -> None:
    with pytest.raises(ValueError, match=f"a {kind} is a rectangle"):
        Interior.model_validate({"rooms": {"r": {"kind": kind, "shape": "L"}}})
