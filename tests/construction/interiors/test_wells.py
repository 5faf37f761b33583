"""Straight stairs in wells: openings with railings, a legal flight with headroom, doors where the floor is."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from worldagent.construction.interiors.build import build_interior
from worldagent.construction.interiors.built import BuiltInterior
from worldagent.construction.interiors.floor_space import FloorSpace
from worldagent.construction.interiors.layout import Storey, storeys_of
from worldagent.construction.interiors.plans import Rect
from worldagent.construction.interiors.walls import Opening
from worldagent.construction.interiors.wells import Well, well_of
from worldagent.worlds.errors import InputError
from worldagent.worlds.spec import Interior

WALL = 0.12
BARE = {"furniture": False, "windows": False}


def _house(*, storeys: int = 3, **stairs: Any) -> dict[str, Any]:
    """A house of so many storeys about a well with a straight flight."""
    rooms: dict[str, Any] = {"well": {"kind": "stairs", "stairs": "straight", **stairs}}
    for k in range(storeys):
        rooms[f"hall{k}"] = {"kind": "hall", "storey": k, "doors": ["well", *(["outside"] if k == 0 else [])], **BARE}
        rooms[f"room{k}"] = {"kind": "study", "storey": k, "doors": [f"hall{k}"], **BARE}
    return {"rooms": rooms}


def _storeys(document: dict[str, Any], seed: int) -> tuple[Storey, ...]:
    return storeys_of(Interior.model_validate({**document, "seed": seed}), np.random.default_rng(0))


@pytest.fixture(scope="module", params=range(4))
def house(request: pytest.FixtureRequest) -> tuple[BuiltInterior, Well]:
    asked = {**_house(), "seed": request.param}
    return build_interior("h", Interior.model_validate(asked), gap=1e-3), well_of(_storeys(asked, request.param)[0], "well", WALL)


def _plan_rect(found: BuiltInterior, entity: str, part: str) -> Rect:
    own = found.entities[entity]
    shape, at = own["parts"][part]["shape"], np.array(own["parts"][part]["pose"]["position"])
    low, high = at - np.array(shape["size"]) / 2, at + np.array(shape["size"]) / 2
    return Rect(*(float(v) for v in (*low[:2], *high[:2])))


def _within(r: Rect, x: float, y: float, margin: float = 0.0) -> bool:
    return r.x0 - margin < x < r.x1 + margin and r.y0 - margin < y < r.y1 + margin


def _open(found: BuiltInterior, storey: int, x: float, y: float) -> bool:
    """True where the floor of a storey has an opening at a point of the plan."""
    floor = f"h_floor_{storey}"
    return not any(_within(_plan_rect(found, floor, p), x, y) for p in found.entities[floor]["parts"])


def _turned(found: BuiltInterior, key: str, points: np.ndarray) -> np.ndarray:
    """Points of a thing's frame in the plan, with heights over the lowest floor."""
    pose = found.entities[key]["pose"]
    w, _, _, z = pose.get("quaternion", (1.0, 0.0, 0.0, 0.0))
    c, s = w * w - z * z, 2 * w * z
    at = np.array(pose["position"]) - np.array(found.corner)
    return np.array([(c * x - s * y, s * x + c * y, h) for x, y, h in points]) + at


def _treads(found: BuiltInterior, key: str) -> list[np.ndarray]:
    """Middles of the treads of a flight, lowest first."""
    parts = found.entities[key]["parts"]
    own = [p for k, p in parts.items() if k.startswith("tread_")]
    middles = [(*p["pose"]["position"][:2], p["pose"]["position"][2] + p["shape"]["size"][2] / 2) for p in own]
    return sorted(_turned(found, key, np.array(middles)), key=lambda p: float(p[2]))


def test_a_straight_flight_is_legal_and_ends_level_with_the_floor_above(house: tuple[BuiltInterior, Well]) -> None:
    found, _ = house
    for end, above in (("", "_1"), ("_1", "_2")):
        treads = _treads(found, f"h_well_flights{end}")
        rises = np.diff([t[2] for t in treads])
        goings = [float(np.linalg.norm(b[:2] - a[:2])) for a, b in itertools.pairwise(treads[:-1])]
        assert rises == pytest.approx(np.full(len(rises), rises[0]), abs=1e-6)
        assert 0.14 <= rises[0] <= 0.19
        assert min(goings) >= 0.25 - 1e-6
        assert 0.55 <= 2 * rises[0] + goings[0] <= 0.70
        level = found.regions[f"h_well{above}"]["min"][2]
        assert treads[-1][2] == pytest.approx(level, abs=2e-4)
        assert treads[0][2] - found.regions[f"h_well{end}"]["min"][2] == pytest.approx(rises[0], abs=2e-4)


def test_there_is_headroom_over_every_tread(house: tuple[BuiltInterior, Well]) -> None:
    """Law: where the floor above is closed over a tread, its underside is 2 m higher at least."""
    found, _ = house
    for storey, end in ((1, ""), (2, "_1")):
        under = found.regions[f"h_well_{storey}"]["min"][2] - 0.2
        free = [
            _open(found, storey, float(t[0]), float(t[1])) or under - t[2] >= 2.0 for t in _treads(found, f"h_well_flights{end}")
        ]
        assert all(free)
        assert sum(_open(found, storey, float(t[0]), float(t[1])) for t in _treads(found, f"h_well_flights{end}")) > 10


def test_railings_stand_at_all_edges_of_the_opening_but_the_arrival(house: tuple[BuiltInterior, Well]) -> None:
    """Law: from each edge with floor beside it one meets a railing, the next flight, or steps off the stairs."""
    found, well = house
    step = 0.05
    for storey in (1, 2):
        names = [k for k in found.entities if k.startswith(f"h_well_railing_{storey}")]
        assert len(names) == storey, "the next flight begins at the front edge of the lower opening"
        rails = [p for k in names for p in _rail_line(found, k)]
        edges, met = 0, 0
        for u in np.arange(step, well.across, step):
            for v in np.arange(step, well.along, step):
                x, y = well.at(float(u), float(v))
                for du, dv in ((step, 0.0), (0.0, -step)):
                    a, b = well.at(float(u + du), float(v + dv))
                    if _open(found, storey, x, y) and not _open(found, storey, a, b):
                        beside = min(float(np.hypot(a - p[0], b - p[1])) for p in rails) < 0.16
                        onto_next = storey == 1 and dv < 0
                        edges, met = edges + 1, met + (beside or onto_next)
        assert edges > 60
        assert met == edges


def _rail_line(found: BuiltInterior, key: str) -> list[np.ndarray]:
    length = found.entities[key]["asset"]["parameters"]["length"]
    return list(_turned(found, key, np.array([(x, 0.0, 0.0) for x in np.linspace(-length / 2, length / 2, 60)])))


def test_railings_stand_on_the_floor_and_flights_too(house: tuple[BuiltInterior, Well]) -> None:
    found, _ = house
    railings = [k for k in found.entities if "railing" in k]
    flights = [k for k in found.entities if "flights" in k]
    assert (len(railings), len(flights)) == (3, 2)
    carriers = {k: found.relations[f"{k}_stands"]["a"] for k in (*railings, *flights)}
    assert set(carriers.values()) == {"h_floor", "h_floor_1", "h_floor_2"}
    over = [
        k for k in railings if any(_open(found, int(carriers[k][-1]), float(p[0]), float(p[1])) for p in _rail_line(found, k))
    ]
    assert over == []
    assert not any(p.startswith("post_") for k in flights for p in found.entities[k]["parts"]), "posts would hang in the openings"


@pytest.mark.parametrize("seed", range(4))
def test_doors_of_a_well_are_where_its_floor_is_and_never_beside_the_flight(seed: int) -> None:
    storeys = _storeys(_house(), seed)
    assert len(storeys) == 3
    for storey in storeys:
        well = well_of(storey, "well", WALL)
        (door,) = [d for d in storey.doors if "well" in d.rooms]
        x, y = door.center
        beside = [well.at(0.0, v) for v in np.linspace(0.0, well.along, 200)]
        assert min(float(np.hypot(x - a, y - b)) for a, b in beside) > 0.3


@pytest.mark.parametrize("stairs", ["straight", "two_flights"])
def test_an_open_well_has_an_archway_instead_of_a_wall_and_a_door(stairs: str) -> None:
    rooms: dict[str, Any] = {
        "hall": {"kind": "hall", "doors": ["outside", "well"], **BARE},
        "well": {"kind": "stairs", "stairs": stairs, "open": True},
        "living": {"kind": "living", "area": 12, "doors": ["hall"], **BARE},
        "landing": {"kind": "hall", "storey": 1, "doors": ["well"], **BARE},
        "bedroom": {"kind": "bedroom", "storey": 1, "doors": ["landing"], **BARE},
    }
    storeys = _storeys({"rooms": rooms}, 0)
    assert len(storeys) == 2
    for storey in storeys:
        assert not [d for d in storey.doors if "well" in d.rooms]
        (way,) = [o for o in storey.passages if "well" in o.rooms]
        assert way.kind == "archway"
        assert way.width > 1.2
        assert (way.sill, way.head) == (0.0, storey.height)


def test_nothing_is_placed_before_an_archway_and_one_walks_in_through_it() -> None:
    room = Rect(0.0, 0.0, 5.0, 4.5)
    way = Opening("way", "archway", "x", (2.5, -WALL / 2), 2.0, 0.0, 2.6, ("hall", "well"))
    space = FloorSpace(room, [way], WALL, name="hall")
    assert space.fits(Rect(2.0, 0.1, 2.6, 0.6), None, 1.0) == "the free space of a door"
    assert space.fits(Rect(2.0, 1.2, 2.6, 1.6), None, 1.0) is None
    assert not space.add(Rect(0.0, 1.0, 5.0, 1.5), Rect(1.0, 1.5, 2.0, 2.0)), "it bars the way in"
    assert FloorSpace(room, [], WALL, name="hall").add(Rect(0.0, 1.0, 5.0, 1.5), Rect(1.0, 1.5, 2.0, 2.0))


def test_several_rooms_may_lead_to_a_straight_flight_and_high_storeys_are_refused() -> None:
    rooms = _house(storeys=2)["rooms"]
    more = {**rooms, "store": {"kind": "store", "doors": ["well"], **BARE}}
    (below, _) = _storeys({"rooms": more}, 0)
    assert len([d for d in below.doors if "well" in d.rooms]) == 2
    with pytest.raises(InputError, match=r"too high for one straight flight, at most 3\.4 m"):
        _storeys({"rooms": rooms, "height": 3.4}, 0)


@pytest.mark.parametrize("field", [{"stairs": "straight"}, {"open": True}])
def test_fields_of_stairwells_are_refused_elsewhere(field: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="stairs and open are those of a room of kind stairs, not of a hall"):
        Interior.model_validate({"rooms": {"r": {"kind": "hall", **field}}})
