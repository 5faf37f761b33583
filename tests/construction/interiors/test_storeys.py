"""Corridors with steps, storeys over each other, and the stairs that join them."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from worldagent.construction.assets.stairwells import WellStairsParameters, well_run
from worldagent.construction.interiors.build import build_interior
from worldagent.construction.interiors.built import BuiltInterior
from worldagent.construction.interiors.layout import GOING, RISER, Storey, storeys_of
from worldagent.construction.interiors.walls import Doorway, doors_of
from worldagent.geometry.booleans import union_volume
from worldagent.worlds.arrays import F64
from worldagent.worlds.errors import InputError
from worldagent.worlds.spec import Interior

GAP = 1e-3
BARE = {"furniture": False, "windows": False}
STEPPED: dict[str, Any] = {
    "rooms": {
        "hall": {"kind": "hall", "doors": ["outside", "way"], **BARE},
        "way": {"kind": "corridor", "steps": 3, "width": 1.5, "furniture": False},
        **{f"room_{k}": {"kind": "study", "doors": ["way"], **BARE} for k in range(3)},
    }
}
TALL: dict[str, Any] = {
    "rooms": {
        "hall": {"kind": "hall", "doors": ["outside", "well"], "furniture": False},
        "well": {"kind": "stairs"},
        "study": {"kind": "study", "doors": ["hall"], **BARE},
        "landing": {"kind": "hall", "storey": 1, "doors": ["well"], "furniture": False},
        "bedroom": {"kind": "bedroom", "storey": 1, "doors": ["landing"], **BARE},
        "loft": {"kind": "hall", "storey": 2, "doors": ["well"], "furniture": False},
        "attic": {"kind": "store", "storey": 2, "doors": ["loft"], "furniture": False},
        "box": {"kind": "store", "storey": 2, "doors": ["loft"], "furniture": False},
    }
}


def _storeys(document: dict[str, Any]) -> tuple[Storey, ...]:
    return storeys_of(Interior.model_validate(document), np.random.default_rng(0))


@pytest.fixture(scope="module")
def stepped() -> BuiltInterior:
    return build_interior("inn", Interior.model_validate(STEPPED), gap=GAP)


@pytest.fixture(scope="module")
def tall() -> BuiltInterior:
    return build_interior("house", Interior.model_validate(TALL), gap=GAP)


def _boxes(found: BuiltInterior, entity: str) -> dict[str, tuple[F64, F64]]:
    """Least and greatest corner of the boxes of an entity in the world [m]."""
    document = found.entities[entity]
    own = np.array(document["pose"]["position"])
    return {
        k: (own + np.array(p["pose"]["position"]) - np.array(p["shape"]["size"]) / 2, own + np.array(p["pose"]["position"]) + np.array(p["shape"]["size"]) / 2)
        for k, p in document["parts"].items()
    }  # fmt: skip


def _corners(box: tuple[F64, F64]) -> F64:
    return np.array([[box[i][0], box[j][1], box[k][2]] for i, j, k in itertools.product((0, 1), repeat=3)])


def _apart(boxes: list[tuple[F64, F64]]) -> None:
    volume = sum(float(np.prod(b[1] - b[0])) for b in boxes)
    assert union_volume([_corners(b) for b in boxes]) == pytest.approx(volume, rel=1e-6)


def test_parts_of_a_corridor_lie_in_a_row_and_rooms_open_on_their_own_level() -> None:
    (storey,) = _storeys(STEPPED)
    parts = [storey.plan.rooms[p] for p in ("way", "way_steps", "way_upper")]
    across = {(round(r.y0, 6), round(r.y1, 6)) for r in parts} if parts[0].y0 == parts[1].y0 else {(r.x0, r.x1) for r in parts}
    assert len(across) == 1
    raised = {n for n in storey.plan.raised if n != "way_upper"}
    assert raised
    assert raised != {"hall", "room_0", "room_1", "room_2"}
    for door in storey.doors:
        if "outside" in door.rooms:
            assert door.sill == 0.0
            continue
        room, part = door.rooms
        assert (part == "way_upper") == (room in raised)
        assert door.sill == pytest.approx(3 * RISER if room in raised else 0.0)
    assert {o.rooms for o in storey.passages} == {("way", "way_steps"), ("way_steps", "way_upper")}


def test_floor_steps_and_walls_of_two_levels_do_not_overlap(stepped: BuiltInterior) -> None:
    floor, walls = _boxes(stepped, "inn_floor"), _boxes(stepped, "inn_walls")
    _apart([*floor.values(), *walls.values()])
    tops = sorted(floor[k][1][2] for k in ("way", "way_steps_1", "way_steps_2", "way_upper"))
    assert np.diff(tops) == pytest.approx([RISER] * 3)
    treads = [floor[f"way_steps_{k}"] for k in (1, 2)]
    assert all(min(GOING, float(np.min((b[1] - b[0])[:2]))) == pytest.approx(GOING) for b in treads)
    assert stepped.relations["inn_way_steps_up"] | {"width": 0.6} == {
        "kind": "connects", "a": "inn_way", "b": "inn_way_upper", "width": 0.6, "headroom": 2.0,
    }  # fmt: skip
    assert stepped.regions["inn_way_upper"]["min"][2] == pytest.approx(3 * RISER)


def test_a_stairwell_is_in_the_same_place_on_every_storey_with_one_door_at_its_front() -> None:
    storeys = _storeys(TALL)
    assert len(storeys) == 3
    assert len({s.plan.rooms["well"] for s in storeys}) == 1
    assert len({s.plan.fronts["well"] for s in storeys}) == 1
    well, front = storeys[0].plan.rooms["well"], storeys[0].plan.fronts["well"]
    for storey in storeys:
        (door,) = [d for d in storey.doors if "well" in d.rooms]
        assert door.rooms[1] == "well", "its leaf turns into the other room"
        value, axis = {"west": (well.x0, 0), "east": (well.x1, 0), "south": (well.y0, 1), "north": (well.y1, 1)}[front]
        assert door.center[axis] == pytest.approx(value)


def test_storeys_are_joined_by_legal_stairs_through_an_opening_with_a_railing(tall: BuiltInterior) -> None:
    for below, above in (("", "_1"), ("_1", "_2")):
        flights = f"house_well_flights{below}"
        asset = tall.entities[flights]["asset"]
        rise = asset["parameters"]["rise"]
        count = sum("step_" in k for k in tall.entities[flights]["parts"]) + 2
        assert 0.14 < rise / count <= 0.19
        steps = [p["shape"]["points"] for k, p in tall.entities[flights]["parts"].items() if "step_" in k]
        assert all(np.ptp(np.array(s)[:, 1]) >= 0.25 - 1e-9 for s in steps)
        top = max(b[1][2] for b in _boxes(tall, f"house_floor{above}").values())
        foot = tall.entities[flights]["pose"]["position"][2]
        assert top - foot == pytest.approx(rise, abs=2e-4)
        hole = _boxes(tall, f"house_floor{above}")
        _apart([*hole.values()])
        middle = np.array(tall.entities[flights]["pose"]["position"][:2])
        assert not any((b[0][:2] < middle).all() and (middle < b[1][:2]).all() for b in hole.values()), (
            "the floor is open over the stairs"
        )
        assert tall.relations[f"house_well_up{above}"]["headroom"] == 2.0
    assert "house_well_railing" in tall.entities
    assert tall.relations["house_well_railing_stands"]["a"] == "house_floor_2"
    assert "house_well_1_railing" not in tall.entities, "there the next flight begins"


def test_walls_of_all_storeys_and_their_floors_do_not_overlap(tall: BuiltInterior) -> None:
    names = [f"house_{n}{e}" for n in ("floor", "walls") for e in ("", "_1", "_2")]
    _apart([b for n in names for b in _boxes(tall, n).values()])


def _changed(document: dict[str, Any], **rooms: dict[str, Any]) -> dict[str, Any]:
    return {"rooms": {**document["rooms"], **rooms}}


@pytest.mark.parametrize(
    ("document", "said"),
    [
        (_changed(TALL, tower={"kind": "store", "storey": 2, "doors": ["hall"]}), "are on storeys 2 and 0; a door leads to stairs"),
        (_changed(TALL, tower={"kind": "store", "storey": 2, "doors": ["outside"]}), "only storey 0 has"),
        (_changed(TALL, annex={"kind": "store", "doors": ["well"]}), "one fits: let it lead to a hall"),
        ({"rooms": {"a": {"kind": "hall", "doors": ["s"]}, "s": {"kind": "stairs"}}}, "they join storeys: give them a door"),
        ({"rooms": {"a": {"kind": "hall", "doors": ["s"]}, "s": {"kind": "stairs"}, "b": {"kind": "hall", "storey": 2, "doors": ["s"]}}},
         "no door on storey 1"),
        ({"rooms": {"a": {"kind": "hall", "doors": ["s"]}, "s": {"kind": "stairs"}, "b": {"kind": "hall", "storey": 1, "doors": ["s"]}}},
         "storey 0 has 1 rooms beside its stairs"),
        (_changed(STEPPED, way_upper={"kind": "store", "doors": ["way"]}), "has the name of a part of the corridor"),
        (_changed(STEPPED, other={"kind": "corridor", "steps": 2, "doors": ["hall"]}), "both have steps; one of a storey may"),
        (_changed(TALL, study={"kind": "study", "area": 40, "doors": ["hall"]}, bedroom={"kind": "bedroom", "storey": 1, "area": 9, "doors": ["landing"]}), "the rooms of storey 1 ask for"),
    ],
)  # fmt: skip
def test_storeys_that_cannot_be_are_refused_with_what_does_not_fit(document: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        _storeys(document)


def test_stairs_of_a_well_are_as_long_as_they_are_said_to_be() -> None:
    p = WellStairsParameters(rise=2.8, riser=0.18, going=0.27)
    assert well_run(p) == pytest.approx(7 * 0.27)
    steep = WellStairsParameters(rise=2.99, riser=0.15, going=0.25)
    assert well_run(steep) == pytest.approx(9 * 0.25, rel=0.02)


def test_wide_doors_stand_in_the_middle_of_their_wall() -> None:
    (storey,) = _storeys({"rooms": {"hall": {"kind": "hall", "area": 30, "doors": ["outside"], "furniture": False}}})
    (door,) = doors_of(storey.plan, [Doorway("hall", "outside", 1.5, 2.2)], wall=0.12, rng=np.random.default_rng(0))
    axis = 0 if door.along == "x" else 1
    assert door.center[axis] == pytest.approx((storey.plan.width, storey.plan.depth)[axis] / 2)
