"""Plans that tile their rectangle, walls without overlap, openings where doors and windows are asked for."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from worldagent.construction.interiors.faces import common_area
from worldagent.construction.interiors.planning import solve_plans
from worldagent.construction.interiors.plans import OUTSIDE, Need, Plan, Rect
from worldagent.construction.interiors.walls import (
    Doorway,
    clear_rect,
    doors_of,
    floor_blocks,
    leaves,
    swing,
    wall_blocks,
    windows_of,
)
from worldagent.geometry.booleans import union_volume
from worldagent.worlds.arrays import F64
from worldagent.worlds.errors import InputError

NEEDS = {
    "hall": Need(9.0, 1.2, 6.0, (OUTSIDE,)),
    "living": Need(24.0, 3.0, 2.0, ("hall",), True),
    "kitchen": Need(12.0, 2.2, 2.2, ("hall", "living"), True),
    "bedroom": Need(15.0, 2.8, 2.0, ("hall",), True),
    "bath": Need(6.0, 1.8, 2.2, ("hall",)),
}
PAIRS = [("hall", OUTSIDE), ("hall", "living"), ("kitchen", "hall"), ("kitchen", "living"), ("hall", "bedroom"), ("hall", "bath")]
WALL, DOOR = 0.12, 0.95


@pytest.fixture(scope="module", params=[0, 3])
def plan(request: pytest.FixtureRequest) -> Plan:
    (found,) = solve_plans(NEEDS, size=None, wall=WALL, door=DOOR + 0.24, seed=request.param)
    return found


def _doorways(pairs: list[tuple[str, str]], head: float) -> list[Doorway]:
    return [Doorway(a, b, DOOR, head) for a, b in pairs]


def _share(a: Rect, b: Rect) -> float:
    """Length of the wall that two rooms have in common [m]."""
    across = max(0.0, min(a.y1, b.y1) - max(a.y0, b.y0)) if a.x1 == b.x0 or b.x1 == a.x0 else 0.0
    along = max(0.0, min(a.x1, b.x1) - max(a.x0, b.x0)) if a.y1 == b.y0 or b.y1 == a.y0 else 0.0
    return max(across, along)


def test_rooms_tile_the_plan_with_the_areas_doors_and_daylight_that_are_asked_for(plan: Plan) -> None:
    assert sum(r.area for r in plan.rooms.values()) == pytest.approx(plan.width * plan.depth)
    for a, b in itertools.combinations(plan.rooms.values(), 2):
        assert a.x1 <= b.x0 or b.x1 <= a.x0 or a.y1 <= b.y0 or b.y1 <= a.y0
    for name, need in NEEDS.items():
        room = plan.rooms[name]
        sides = sorted((room.x1 - room.x0, room.y1 - room.y0))
        assert 0.65 * need.area < room.area < 1.35 * need.area, name
        assert sides[0] - WALL >= need.width - 1e-9, name
        assert sides[1] <= need.aspect * sides[0] + 1e-9, name
        outside = room.x0 == 0 or room.y0 == 0 or room.x1 == plan.width or room.y1 == plan.depth
        assert outside or not (need.daylight or OUTSIDE in need.doors), name
    for one, other in PAIRS:
        assert other == OUTSIDE or _share(plan.rooms[one], plan.rooms[other]) >= DOOR + 0.24 + WALL - 1e-9


def test_equal_seeds_make_equal_plans() -> None:
    first = solve_plans(NEEDS, size=None, wall=WALL, door=DOOR, seed=5)
    assert first == solve_plans(NEEDS, size=None, wall=WALL, door=DOOR, seed=5)


@pytest.mark.parametrize(
    ("needs", "size", "said"),
    [
        ({"a": Need(10.0, 2.0, 2.0, ("b",))}, None, "no room; there are"),
        ({"a": Need(10.0, 2.0, 2.0)}, (10.0, 8.0), "80.0 m.2, the rooms of storey 0 ask for 10.0"),
        ({"a": Need(4.0, 3.0, 2.0)}, None, "no plan of 1 rooms"),
    ],
)
def test_plans_that_cannot_be_are_refused_with_what_does_not_fit(
    needs: dict[str, Need], size: tuple[float, float] | None, said: str
) -> None:
    with pytest.raises(InputError, match=said):
        solve_plans(needs, size=size, wall=WALL, door=DOOR, seed=0)


def _corners(low: tuple[float, float, float], high: tuple[float, float, float]) -> F64:
    return np.array([[(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


def test_walls_fill_what_is_no_room_and_no_opening_without_overlap(plan: Plan) -> None:
    rng, height = np.random.default_rng(0), 2.6
    doors = doors_of(plan, _doorways(PAIRS, 2.07), wall=WALL, rng=rng)
    assert len(doors) == len(PAIRS)
    windows = windows_of(plan, dict.fromkeys(("living", "kitchen", "bedroom"), (0.9, 2.1)), doors, wall=WALL)
    assert {w.rooms[0] for w in windows} == {"living", "kitchen", "bedroom"}
    blocks = wall_blocks(plan, [*doors, *windows], wall=WALL, height=height)
    volume = sum(float(np.prod(np.subtract(b.high, b.low))) for b in blocks)
    assert union_volume([_corners(b.low, b.high) for b in blocks]) == pytest.approx(volume, rel=1e-6)
    clear = sum((r.x1 - r.x0 - WALL) * (r.y1 - r.y0 - WALL) for r in plan.rooms.values())
    holes = sum(o.width * WALL * (o.head - o.sill) for o in (*doors, *windows))
    whole = (plan.width + WALL) * (plan.depth + WALL) - clear
    assert volume == pytest.approx(whole * height - holes, rel=1e-9)
    floors = floor_blocks(plan, wall=WALL, thickness=0.2)
    area = sum((b.high[0] - b.low[0]) * (b.high[1] - b.low[1]) for b in floors.values())
    assert area == pytest.approx((plan.width + WALL) * (plan.depth + WALL))


def test_openings_of_a_wall_do_not_meet(plan: Plan) -> None:
    doors = doors_of(plan, _doorways(PAIRS, 2.07), wall=WALL, rng=np.random.default_rng(1))
    openings = [*doors, *windows_of(plan, dict.fromkeys(NEEDS, (0.9, 2.1)), doors, wall=WALL)]
    assert len(openings) > len(PAIRS)
    for a, b in itertools.combinations([o.plan(WALL) for o in openings], 2):
        assert a.x1 <= b.x0 or b.x1 <= a.x0 or a.y1 <= b.y0 or b.y1 <= a.y0


def test_a_door_where_rooms_share_no_wall_is_refused() -> None:
    plan = Plan(4.0, 2.0, {"a": Rect(0, 0, 1, 2), "b": Rect(1, 0, 3, 2), "c": Rect(3, 0, 4, 2)})
    with pytest.raises(InputError, match="'a' and 'c' share no wall"):
        doors_of(plan, _doorways([("a", "c")], 2.0), wall=WALL, rng=np.random.default_rng(0))


NARROW = {
    "beside each other": {
        "hall": Rect(3.75, 2.0, 10.25, 3.75),
        "bedroom": Rect(6.5, 3.75, 10.25, 7.75),
        "store": Rect(7.0, 0.0, 10.25, 2.0),
        "bathroom": Rect(3.75, 0.0, 7.0, 2.0),
    },
    "in a corner": {
        "hall": Rect(4.75, 0.0, 6.5, 7.5),
        "bedroom": Rect(0.0, 0.0, 4.75, 4.75),
        "store": Rect(6.5, 2.0, 10.0, 5.25),
        "bathroom": Rect(6.5, 0.0, 10.0, 2.0),
    },
}


@pytest.mark.parametrize("rooms", NARROW.values(), ids=NARROW)
def test_no_leaf_stands_before_another_door_of_a_narrow_hall(rooms: dict[str, Rect]) -> None:
    """Law: where floors before doors meet in any case, the leaf of the entrance stands before none of the others."""
    pairs = [("hall", OUTSIDE), ("bedroom", "hall"), ("store", "hall"), ("bathroom", "hall")]
    whole = Plan(max(r.x1 for r in rooms.values()), max(r.y1 for r in rooms.values()), rooms)
    met, barred = 0, []
    for seed in range(12):
        doors = doors_of(whole, _doorways(pairs, 2.07), wall=WALL, rng=np.random.default_rng(seed))
        (entrance,) = [d for d in doors if OUTSIDE in d.rooms]
        (leaf,) = leaves(entrance, clear_rect(rooms["hall"], WALL))
        before = {d.id: swing(d, WALL) for d in doors if d is not entrance}
        barred += [(seed, k) for k, r in before.items() if common_area(leaf, r) > 0.0]
        met += any(
            a.x0 < b.x1 and b.x0 < a.x1 and a.y0 < b.y1 and b.y0 < a.y1
            for a, b in itertools.combinations([swing(d, WALL) for d in doors], 2)
        )
    assert barred == []
    assert met > 0, "else there was a better place anyhow"
