"""Furniture that stands where nothing is in the way, and small things on it."""

from __future__ import annotations

import itertools
from typing import Literal

import numpy as np
import pytest
from worldagent.construction.assets.registry import GENERATORS
from worldagent.construction.interiors.arrangement import within
from worldagent.construction.interiors.build import build_interior
from worldagent.construction.interiors.fitting import everything, fitted
from worldagent.construction.interiors.fittings import windows_in
from worldagent.construction.interiors.floor_space import FloorSpace, Spot
from worldagent.construction.interiors.furnishing import Frame, Furnished, Standing, furnished
from worldagent.construction.interiors.pieces import Stock
from worldagent.construction.interiors.plans import Rect
from worldagent.construction.interiors.programs import KINDS
from worldagent.construction.interiors.swept import LIGHT
from worldagent.construction.interiors.walls import Opening, clear_rect, leaves
from worldagent.construction.interiors.wishes import RoomKind, Wish
from worldagent.worlds.spec import Interior

ROOM = Rect(0.0, 0.0, 5.0, 4.5)
WALL = 0.12
DOOR = Opening("door", "door", "x", (1.0, -WALL / 2), 0.95, 0.0, 2.07, ("room", "hall"))
WINDOW = Opening("window", "window", "y", (5.0 + WALL / 2, 2.0), 1.4, 0.9, 2.1, ("room", "outside"))
GAP = 1e-3
APART = ("corridor", "stairs", "barn", "museum")
"""Kinds that are no rooms of a flat: `test_storeys.py`, `test_kinds.py`."""


def _space() -> FloorSpace:
    return FloorSpace(ROOM, [DOOR, WINDOW], WALL)


def test_all_things_that_rooms_ask_for_have_generators() -> None:
    assert len(KINDS) >= 8
    for kind in KINDS.values():
        wanted = (
            {g for wish in kind.wishes for g in wish.generators}
            | {s["of"] for wish in kind.wishes for s in wish.sizes if "of" in s}
            | {g for c in kind.clutter.values() for g in c}
            | set(kind.loose)
        )
        assert wanted <= set(GENERATORS), wanted - set(GENERATORS)
        small = {g for c in kind.clutter.values() for g in c} | set(kind.loose)
        assert {g for g in small if not GENERATORS[g].stands} == set(), "what lies on others stands by itself"
        made = {g for wish in kind.wishes for g in wish.generators}
        assert {w.to for w in kind.wishes if w.to} <= made


@pytest.mark.parametrize(
    ("foot", "use", "height", "said"),
    [
        (Rect(1, 1, 2, 2), None, 1.0, None),
        (Rect(-0.1, 1, 1, 2), None, 1.0, "the walls"),
        (Rect(0.9, 0.1, 1.4, 0.5), None, 1.0, "the free space of a door"),
        (Rect(4.4, 1.6, 4.99, 2.2), None, 1.5, "a window"),
        (Rect(4.4, 1.6, 4.99, 2.2), None, 0.8, None),
        (Rect(1, 3.9, 2, 4.4), Rect(1, 3.0, 2, 3.9), 1.0, None),
        (Rect(1, 0.2, 2, 1.2), Rect(1, -0.7, 2, 0.2), 1.0, "the free space of a door"),
        (Rect(3, 0.2, 4, 1.2), Rect(3, -0.7, 4, 0.2), 1.0, "too little room before it"),
    ],
)
def test_what_stands_in_the_way_is_named(foot: Rect, use: Rect | None, height: float, said: str | None) -> None:
    assert _space().fits(foot, use, height) == said


def test_a_cupboard_that_bars_the_way_from_the_door_is_not_put_up() -> None:
    space = _space()
    assert space.add(Rect(0.0, 3.5, 1.0, 4.5), Rect(0.0, 2.8, 1.0, 3.5))
    assert not space.add(Rect(0.0, 1.8, 5.0, 2.4), None), "it leaves no way to the first one"
    assert len(space.solid) == 1
    assert space.add(Rect(0.0, 1.8, 4.2, 2.4), None)


def test_turning_a_spot_turns_its_footprint() -> None:
    foot = Rect(-0.5, -0.2, 0.5, 0.3)
    turned = Spot(2.0, 1.0, 1).rect(foot)
    assert (turned.x0, turned.x1, turned.y0, turned.y1) == pytest.approx((1.7, 2.2, 0.5, 1.5))


def _furnished(kind: RoomKind, *, space: FloorSpace | None = None, things: int | None = None, seed: int = 1) -> Furnished:
    rng = np.random.default_rng(seed)
    return furnished(Frame("room", 2.6, GAP), kind, space or _space(), Stock(rng), density=0.5, rng=rng, things=things)


def _foot(thing: Standing) -> Rect:
    assert thing.spot is not None
    return thing.spot.rect(thing.piece.foot)


def _meet(a: Rect, b: Rect) -> bool:
    return a.x0 < b.x1 and b.x0 < a.x1 and a.y0 < b.y1 and b.y0 < a.y1


@pytest.mark.parametrize("kind", [k for k in KINDS if k not in APART])
def test_a_room_is_furnished_without_overlap_and_from_many_generators(kind: str) -> None:
    found = _furnished(KINDS[kind])
    things = found.standing
    assert len({t.piece.generator for t in things}) >= 8
    assert found.lacking == []
    assert len({t.id for t in things}) == len(things)
    ground = [t for t in things if t.carrier == "floor" and t.piece.height > 0.03]
    assert len(ground) >= 3
    for a, b in itertools.combinations([_foot(t) for t in ground], 2):
        assert not _meet(a, b)
    heights = {t.id: t for t in things}
    for thing in things:
        if thing.spot is not None:
            foot = _foot(thing)
            assert foot.x0 >= ROOM.x0
            assert foot.x1 <= ROOM.x1
            assert foot.y0 >= ROOM.y0
            assert foot.y1 <= ROOM.y1
        if thing.carrier in heights:
            own = heights[thing.carrier]
            levels = [own.z + float(p.center[2]) + GAP for p in own.piece.made.places.values()]
            assert min(abs(thing.z - level) for level in levels) < 1e-9


@pytest.mark.parametrize("kind", ["hall", "bathroom", "kitchen"])
def test_surfaces_are_filled_up_to_the_number_of_things_that_is_asked_for(kind: str) -> None:
    found = _furnished(KINDS[kind], things=60)
    assert (len(found.standing), found.lacking) == (60, [])
    assert len({t.piece.generator for t in found.standing}) >= 15


def test_a_number_of_things_for_which_there_are_no_surfaces_is_told() -> None:
    bare = RoomKind(9.0, 2.0, 3.0, False, "oak", (Wish(("stool",)),), {})
    assert _furnished(bare, things=12).lacking == ["room: 1 of 12 things: its surfaces hold no more"]


def test_nothing_on_a_surface_reaches_up_to_what_hangs_above_it() -> None:
    beneath = 0
    for seed in range(3):
        things = {t.id: t for t in _furnished(KINDS["hall"], things=60, seed=seed).standing}
        hung = [t for t in things.values() if t.carrier == "walls"]
        for small in (t for t in things.values() if t.carrier in things):
            reach = max(small.piece.foot.x1 - small.piece.foot.x0, small.piece.foot.y1 - small.piece.foot.y0) / 3
            about = Rect(small.x - reach, small.y - reach, small.x + reach, small.y + reach)
            for other in hung:
                if other.id != small.carrier and other.z > small.z and _meet(about, _foot(other)):
                    beneath += 1
                    assert small.z + small.piece.height < other.z, (small.id, other.id)
    assert beneath > 0


def test_a_small_room_asks_for_less_and_says_so() -> None:
    frame, rng = Frame("room", 2.6, GAP), np.random.default_rng(0)
    small = FloorSpace(Rect(0.0, 0.0, 3.0, 2.6), [DOOR], WALL)
    tight, wide = (fitted(frame, KINDS["living"], s, Stock(rng), rng) for s in (small, _space()))
    names, more = ([i.pieces[i.size].generator for i in everything(f.items)] for f in (tight, wide))
    assert {"sofa", "table", "television"} <= set(names), "the most important ones stay"
    assert len(names) < len(more)
    assert len(tight.left_out) > len(wide.left_out)
    assert all(s.startswith("room: no ") for s in tight.left_out)
    assert any("too little floor left for it" in s for s in tight.left_out)
    sofas = [next(i for i in f.items if i.name == "sofa") for f in (tight, wide)]
    assert sofas[0].size > sofas[1].size == 0, "a smaller sofa"


def test_seats_stand_at_their_table_and_a_screen_on_its_cupboard_before_the_sofa() -> None:
    kitchen = _furnished(KINDS["kitchen"]).standing
    (table,) = (t for t in kitchen if t.piece.generator == "table")
    chairs = [t for t in kitchen if t.piece.generator == "chair"]
    assert len(chairs) >= 2
    for chair in chairs:
        # The front of what a generator made is its -y.
        ahead = (chair.x + 0.5 * np.sin(chair.yaw), chair.y - 0.5 * np.cos(chair.yaw))
        foot = _foot(table)
        assert foot.x0 <= ahead[0] <= foot.x1
        assert foot.y0 <= ahead[1] <= foot.y1
    living = _furnished(KINDS["living"]).standing
    screen, sofa = ({t.piece.generator: t for t in living}[n] for n in ("television", "sofa"))
    board = next(t for t in living if t.id == screen.carrier)
    assert board.piece.generator == "cupboard"
    assert abs((board.yaw - sofa.yaw) % (2 * np.pi) - np.pi) < 1e-9


def test_what_finds_no_place_is_told_with_what_stood_in_the_way() -> None:
    """A bench that is as long as the room's free wall, in front of which a second one has to be used."""
    room = Rect(0.0, 0.0, 2.6, 1.5)
    kind = RoomKind(
        4.0,
        1.0,
        3.0,
        False,
        "oak",
        (Wish(("bookcase",), parameters={"width": 1.8}, use=1.0), Wish(("sofa",), rule="free")),
        {},
        (),
        3.0,
    )
    found = _furnished(kind, space=FloorSpace(room, [], WALL))
    assert [s.piece.generator for s in found.standing] == ["sofa"] or [s.piece.generator for s in found.standing] == ["bookcase"]
    (said,) = found.lacking
    assert said.startswith("room: a ")
    assert "found no place: " in said
    assert said.endswith("stood in the way")


def test_rounds_find_a_place_for_what_a_first_one_leaves_out() -> None:
    """Law: whatever the seed, a sofa that fits along one wall only gets it from the chairs."""
    room = Rect(0.0, 0.0, 2.15, 3.0)
    door = Opening("door", "door", "y", (2.15 + WALL / 2, 1.5), 0.95, 0.0, 2.07, ("room", "hall"))
    kind = RoomKind(6.0, 1.8, 3.0, False, "oak", (Wish(("stool",)), Wish(("stool",)), Wish(("sofa",))), {}, (), 3.0)
    for seed in range(4):
        found = _furnished(kind, space=FloorSpace(room, [door], WALL), seed=seed)
        assert found.lacking == [], seed


def test_an_interior_is_a_specification_with_regions_routes_and_supports() -> None:
    asked = Interior.model_validate(
        {"rooms": {"hall": {"kind": "hall", "doors": ["outside"]}, "study": {"kind": "study", "doors": ["hall"]}}, "density": 0.2}
    )
    made = build_interior("house", asked, gap=GAP)
    assert set(made.regions) == {"house_hall", "house_study"}
    assert made.relations["house_study_to_hall"]["kind"] == "connects"
    assert {"house_floor", "house_walls", "house_hall_outside_door", "house_study_hall_door_leaf"} <= set(made.entities)
    assert "house_ceiling" not in made.entities
    carried = {r["b"] for r in made.relations.values() if r["kind"] == "supports"}
    hinged = {j["child"] for j in made.joints.values()}
    assert set(made.entities) - carried - hinged == {"house_floor"}
    again = build_interior("house", asked, gap=GAP)
    assert again.entities == made.entities
    other = build_interior("house", asked.model_copy(update={"seed": 4}), gap=GAP)
    assert other.entities != made.entities


def test_open_leaves_stand_where_ways_keep_clear_of_them() -> None:
    """Law: the leaf of the built door is where the floor says, towards the nearer wall of the room into which it opens."""
    asked = Interior.model_validate(
        {"rooms": {"hall": {"kind": "hall", "doors": ["outside"]}, "study": {"kind": "study", "doors": ["hall"]}}, "density": 0.0}
    )
    for seed in range(3):
        made = build_interior("house", asked.model_copy(update={"seed": seed}), gap=GAP)
        for room, door in (("hall", "hall_outside"), ("study", "study_hall")):
            frame, stands = made.entities[f"house_{door}_door"]["pose"], made.entities[f"house_{door}_door_leaf"]["pose"]
            own = made.plan.rooms[room]
            x, y = (float(frame["position"][k]) - made.corner[k] for k in (0, 1))
            along: Literal["x", "y"] = "x" if min(abs(y - own.y0), abs(y - own.y1)) < 1e-6 else "y"
            opening = Opening(door, "door", along, (x, y), 0.9502, 0.0, 2.07, (room, ""))
            (under,) = leaves(opening, clear_rect(own, WALL))
            at = [float(stands["position"][k]) - made.corner[k] for k in (0, 1)]
            assert under.x0 - 0.06 <= at[0] <= under.x1 + 0.06, (seed, door)
            assert under.y0 - 0.06 <= at[1] <= under.y1 + 0.06, (seed, door)


def test_a_gate_has_two_leaves_that_stand_open_at_both_sides_of_the_way_in() -> None:
    gate = Opening("gate", "door", "x", (2.5, -WALL / 2), 2.0, 0.0, 2.6, ("room", "outside"))
    left, right = leaves(gate, ROOM)
    assert (left.x0, right.x1) == pytest.approx((1.5, 3.5))
    assert right.x0 - left.x1 > 1.2
    assert 0.8 < left.y1 == right.y1 < 1.0
    space = FloorSpace(ROOM, [gate], WALL, name="room")
    assert (space.leaves, space.entries[0][0]) == ([left, right], 2.5)


def test_drawers_come_out_over_free_floor() -> None:
    """Law: before chests the floor is free for the whole travel of their drawers, however crowded the room is."""
    chests = (Wish(("chest_of_drawers",), count=(4, 4)), Wish(("barrel",), rule="free", count=(30, 30)))
    kind = RoomKind(9.0, 2.0, 3.0, False, "oak", chests, {}, floor_share=3.0)
    room = Rect(ROOM.x0 - 1e-9, ROOM.y0 - 1e-9, ROOM.x1 + 1e-9, ROOM.y1 + 1e-9)
    seen = 0
    for seed in range(3):
        things = _furnished(kind, seed=seed).standing
        for chest in (t for t in things if t.piece.generator == "chest_of_drawers" and t.spot is not None):
            travel = max(j.range[1] for j in chest.piece.made.joints.values() if j.kind == "slide" and j.range is not None)
            foot = chest.piece.foot
            drawn = chest.spot.rect(Rect(foot.x0, foot.y0 - travel, foot.x1, foot.y0)) if chest.spot else foot
            assert within(drawn, room), chest.id
            assert not any(_meet(drawn, _foot(other)) for other in things), chest.id
            seen += 1
    assert seen == 12, "barrels give way to what takes more floor"


def test_nothing_heavy_lies_where_a_sash_swings() -> None:
    """Law: heavy pots, which sashes do not push away, lie on tables wherever no window opens over them, and nowhere else."""
    tables = RoomKind(
        9.0, 2.0, 3.0, False, "oak", (Wish(("table",), rule="free", count=(4, 4)),), {"table": ("cooking_pot",)}, floor_share=1.0
    )
    windows = [
        Opening(f"window_{y}", "window", "y", (5.0 + WALL / 2, y), 1.4, 0.7, 2.1, ("room", "outside")) for y in (0.8, 2.3, 3.8)
    ]
    met = []
    for openings in ([], windows):
        sashes = [w.swept for w in windows_in(FloorSpace(ROOM, windows, WALL))]
        found = [_furnished(tables, space=FloorSpace(ROOM, openings, WALL), things=30, seed=s).standing for s in range(4)]
        pots = [t for things in found for t in things if t.piece.generator == "cooking_pot" and t.piece.mass > LIGHT]
        met.append(sum(any(sash.meets(t.solid) for sash in sashes) for t in pots))
    assert met[0] > 0, "without a window they lie there"
    assert met[1] == 0


def test_nothing_stands_on_a_rug_where_a_door_turns() -> None:
    rugs = RoomKind(
        9.0, 2.0, 3.0, False, "oak", (Wish(("rug",), rule="flat", parameters={"width": 3.2, "depth": 2.4}),), {"rug": ("basket",)}, floor_share=1.0
    )  # fmt: skip
    space = FloorSpace(Rect(0.0, 0.0, 3.6, 2.6), [DOOR], WALL)
    things = [t for s in range(4) for t in _furnished(rugs, space=space, things=12, seed=s).standing]
    baskets = [t for t in things if t.piece.generator == "basket"]
    assert len(baskets) > 20
    assert not any(space.before_door(Rect(t.x - 0.1, t.y - 0.1, t.x + 0.1, t.y + 0.1)) for t in baskets)
