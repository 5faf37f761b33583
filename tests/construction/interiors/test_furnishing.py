"""Furniture that stands where nothing is in the way, and small things on it."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from worldagent.construction.assets.registry import GENERATORS
from worldagent.construction.interiors.build import build_interior
from worldagent.construction.interiors.floor_space import FloorSpace, Spot
from worldagent.construction.interiors.furnishing import Frame, furnished
from worldagent.construction.interiors.pieces import Stock
from worldagent.construction.interiors.plans import Rect
from worldagent.construction.interiors.programs import KINDS
from worldagent.construction.interiors.walls import Opening
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
            {g for wish in kind.wishes for g in wish.generators} | {g for c in kind.clutter.values() for g in c} | set(kind.loose)
        )
        assert wanted <= set(GENERATORS), wanted - set(GENERATORS)
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


@pytest.mark.parametrize("kind", [k for k in KINDS if k not in APART])
def test_a_room_is_furnished_without_overlap_and_from_many_generators(kind: str) -> None:
    rng = np.random.default_rng(1)
    space = _space()
    things, lacking = furnished(Frame("room", 2.6, GAP), KINDS[kind], space, Stock(rng), density=0.5, rng=rng)
    assert len({t.piece.generator for t in things}) >= 8
    assert len(lacking) <= 3, lacking
    assert len({t.id for t in things}) == len(things)
    ground = [t for t in things if t.carrier == "floor" and t.piece.height > 0.03]
    assert len(ground) >= 3
    for a, b in itertools.combinations([Spot(t.x, t.y, round(t.yaw / (np.pi / 2))).rect(t.piece.foot) for t in ground], 2):
        assert a.x1 <= b.x0 or b.x1 <= a.x0 or a.y1 <= b.y0 or b.y1 <= a.y0
    heights = {t.id: t for t in things}
    for thing in things:
        if thing.carrier in heights:
            own = heights[thing.carrier]
            levels = [own.z + float(p.center[2]) + GAP for p in own.piece.made.places.values()]
            assert min(abs(thing.z - level) for level in levels) < 1e-9


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
