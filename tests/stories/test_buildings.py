"""Buildings that a client asks for: a corridor with steps, storeys joined by stairs, a hut on a slope; and the same broken on purpose."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.stories.inline_jobs import run_jobs_inline

BARE = {"furniture": False, "windows": False}
HOTEL: dict[str, Any] = {
    "rooms": {
        "lobby": {"kind": "hall", "area": 9, "doors": ["outside", "corridor"], **BARE},
        "corridor": {"kind": "corridor", "steps": 3},
        "left": {"kind": "bedroom", "area": 10, "doors": ["corridor"], **BARE},
        "right": {"kind": "bedroom", "area": 10, "doors": ["corridor"], **BARE},
    },
    "density": 0.0,
}
HOUSE: dict[str, Any] = {
    "rooms": {
        "hall": {"kind": "hall", "doors": ["outside", "stairs"], **BARE},
        "stairs": {"kind": "stairs"},
        "living": {"kind": "living", "area": 12, "doors": ["hall"], **BARE},
        "landing": {"kind": "hall", "storey": 1, "doors": ["stairs"], **BARE},
        "bedroom": {"kind": "bedroom", "storey": 1, "doors": ["landing"], **BARE},
    }
}
HUT: dict[str, Any] = {
    "rooms": {
        "hall": {"kind": "hall", "area": 8, "doors": ["outside"], **BARE},
        "store": {"kind": "store", "doors": ["hall"], **BARE},
    },
    "on": "hill",
    "at": [1.0, 0.5, 0.0],
    "entrance": "south",
}


def _hill(slope: float) -> dict[str, Any]:
    """Rough ground that rises to the north."""
    rows = [[1.0 + slope * y + 0.06 * ((3 * x + 5 * y) % 4) / 4 for x in range(21)] for y in range(21)]
    return {
        "role": "ground",
        "motion": "static",
        "material": "limestone",
        "dimensions": {"size": [20, 20, 0.1 + max(map(max, rows)) - min(map(min, rows))]},
        "parts": {"top": {"shape": {"kind": "heightfield", "size": [20, 20], "heights": rows}}},
    }


def _hilly(slope: float) -> dict[str, Any]:
    solvers = {"rigid": {"engine": "mujoco", "members": ["hill"]}}
    return {"entities": {"hill": _hill(slope)}, "simulation": {"frames": 24, "solvers": solvers}}


@pytest.fixture(autouse=True)
def _inline(monkeypatch: pytest.MonkeyPatch) -> None:
    run_jobs_inline(monkeypatch)


def _built(agent: Any, prompt: str, plan: dict[str, Any]) -> dict[str, Any]:
    agent.call("edit_spec", world="w", prompt=prompt, spec={"simulation": {"frames": 24}})
    made: dict[str, Any] = agent.call("build_interior", world="w", interior="b", plan=plan, wait_s=240)
    assert made["open_rows"] == []
    return made


def _row(agent: Any, name: str) -> dict[str, Any]:
    (found,) = [r for r in agent.pages("rows", part="matrix") if r["id"] == name]
    return dict(found)


def _spec(agent: Any, pointer: str) -> Any:
    return agent.call("inspect_world", world="w", part="spec", pointer=pointer)["value"]


def _without(agent: Any, *paths: str) -> None:
    agent.call("edit_spec", world="w", patch=[{"op": "remove", "path": p} for p in paths])
    agent.call("run_checks", world="w", scope="static")


def _lower(agent: Any, entity: str, by: float) -> None:
    x, y, z = _spec(agent, f"/entities/{entity}/pose/position")
    agent.call(
        "edit_spec", world="w", patch=[{"op": "add", "path": f"/entities/{entity}/pose/position", "value": [x, y, z - by]}]
    )
    agent.call("run_checks", world="w", scope="static")


@pytest.mark.slow
def test_a_corridor_with_steps_is_walked_on_both_levels_and_not_without_its_steps(agent: Any) -> None:
    made = _built(agent, "A hotel corridor has a landing of three steps.", HOTEL)
    assert {"corridor", "corridor_upper"} <= set(made["rooms"])
    assert made["rooms"]["corridor_upper"]["level"] == 0.48
    assert _row(agent, "navigability:b_corridor_steps_up")["status"] == "pass"
    _without(agent, *(f"/entities/b_floor/parts/corridor_steps_{k}" for k in (1, 2)))
    row = _row(agent, "navigability:b_corridor_steps_up")
    assert row["status"] == "fail"
    assert row["measured"] == pytest.approx(0.48, abs=0.01)


def test_a_building_made_anew_leaves_nothing_of_its_storeys_and_steps(agent: Any) -> None:
    _built(agent, "A house has an upper storey.", HOUSE)
    small = {"rooms": {"hall": {"kind": "hall", "doors": ["outside"], **BARE}}}
    agent.call("build_interior", world="w", interior="b", plan=small, wait_s=240)
    assert set(_spec(agent, "/graph/regions")) == {"b_hall"}
    assert {n for n in _spec(agent, "/entities") if "_1" in n or "stairs" in n} == set()
    assert {n for n, r in _spec(agent, "/graph/relations").items() if r["kind"] == "connects"} == set()


def test_a_size_beside_the_grid_of_plans_is_told(agent: Any) -> None:
    plan = {"rooms": {"hall": {"kind": "hall", "doors": ["outside"], "area": 15.0, **BARE}}, "size": [4.4, 3.6]}
    made = _built(agent, "A hall.", plan)
    assert made["plan"] != plan["size"]
    assert made["size_rounded"] == "asked [4.4, 3.6] m; outer walls stand on a grid of 0.25 m"
    again = agent.call("build_interior", world="w", interior="b", plan={**plan, "size": made["plan"]}, wait_s=240)
    assert (again["plan"], "size_rounded" in again) == (made["plan"], False)


@pytest.mark.slow
def test_storeys_are_walked_up_the_stairs_and_not_without_them(agent: Any) -> None:
    made = _built(agent, "A house has an upper storey.", HOUSE)
    assert made["rooms"]["landing"]["storey"] == 1
    assert _row(agent, "navigability:b_stairs_up_1")["status"] == "pass"
    _without(agent, "/entities/b_stairs_flights/parts/upper_step_4")
    assert _row(agent, "navigability:b_stairs_up_1")["status"] == "fail"


@pytest.mark.slow
def test_a_hut_on_a_slope_is_entered_over_its_steps_and_stands_on_its_plinth(agent: Any) -> None:
    agent.call("edit_spec", world="w", prompt="A hut stands on a hill.", spec=_hilly(0.1))
    made = agent.call("build_interior", world="w", interior="b", plan=HUT, wait_s=240)
    assert made["open_rows"] == []
    assert made["ground"]["steps"]["hall"] >= 2
    assert 0.3 < made["ground"]["plinth"] < 1.5
    assert _row(agent, "navigability:b_hall_outside_to_hall")["status"] == "pass"
    _lower(agent, "b_hall_steps_outside", 0.25)
    assert _row(agent, "navigability:b_hall_outside_to_hall")["status"] == "fail"
    again = {**HUT, "at": [1.0, 0.5, 0.0], "entrance": "north"}
    steep = [{"op": "add", "path": "/entities/hill", "value": _hill(0.4)}]
    agent.call("edit_spec", world="w", patch=steep, hypothesis="the hill is to be steeper for another try")
    said = agent.refused("build_interior", world="w", interior="b", plan=again)
    assert "its plinth would be" in said
    assert "flatten" in said


def test_a_building_whose_floor_is_above_its_plinth_hangs_in_the_air(agent: Any) -> None:
    agent.call("edit_spec", world="w", prompt="A hut stands on a hill.", spec=_hilly(0.05))
    agent.call("build_interior", world="w", interior="b", plan=HUT, wait_s=240)
    _lower(agent, "b_plinth", 0.2)
    failed = {
        r["id"]: r["measured"] for r in agent.pages("rows", part="matrix") if r["status"] == "fail" and r["check"] == "support"
    }
    assert failed["support:b_floor_lies:b_floor"] == pytest.approx(0.2, abs=0.01), failed


@pytest.mark.parametrize(
    ("kind", "more"),
    [("barn", {"roof": "gable", "density": 0.2}), ("museum", {"density": 0.2, "ceiling": True})],
)
def test_a_barn_and_a_museum_hall_pass_the_static_checks(agent: Any, kind: str, more: dict[str, Any]) -> None:
    made = _built(agent, "A large building.", {"rooms": {"r": {"kind": kind, "doors": ["outside"]}}, **more})
    assert made["rooms"]["r"]["things"] >= 10
    assert made["rooms"]["r"]["generators"] >= 3


STREET: dict[str, Any] = {
    "extent": [120, 120],
    "cell": 2,
    "layers": {
        "slope": {"kind": "ramp", "rise": 6, "direction_deg": 75, "order": 1},
        "relief": {"kind": "noise", "amplitude": 0.4, "wavelength": 50, "octaves": 3, "order": 2},
        "street": {"kind": "road", "line": [[-50, 0], [50, 0]], "width": 5, "falloff": 4, "order": 3},
    },
    "erosion": {"years": 500, "steps": 2},
    "hydrology": {"rivers": 0, "streams": 0},
    "vegetation": {"density": 0},
}


@pytest.mark.slow
def test_houses_stand_along_a_street_on_a_landscape_and_one_walks_from_door_to_door(agent: Any) -> None:
    soil = {"soil": {"density": 1800, "substance": "soil", "friction": 0.7}}
    spec = {"materials": soil, "terrains": {"land": STREET}, "simulation": {"frames": 24}}
    agent.call("edit_spec", world="w", prompt="Two houses stand along a street.", spec=spec)
    agent.call("build_terrain", world="w", terrain="land", size=[50, 40], center=[0, 0], cells=50, material="soil", wait_s=240)
    for name, at, side, roof in (("inn", [-8, 9, 0], "south", "gable"), ("shop", [4, -9, 0], "north", "hipped")):
        house = {**HUT, "on": "ground", "at": at, "entrance": side, "roof": roof}
        made = agent.call("build_interior", world="w", interior=name, plan=house, wait_s=240)
        assert made["open_rows"] == []
        assert made["ground"]["plinth"] > 0.2
    way = {"kind": "connects", "a": "inn_hall", "b": "shop_hall", "width": 0.7, "headroom": 1.95}
    agent.call("edit_spec", world="w", patch=[{"op": "add", "path": "/graph/relations/across", "value": way}])
    agent.call("run_checks", world="w", scope="static")
    assert {
        _row(agent, f"navigability:{n}")["status"] for n in ("inn_hall_outside_to_hall", "shop_hall_outside_to_hall", "across")
    } == {"pass"}
    assert _row(agent, "terrain:land:ground:ground")["status"] == "pass"


ELL: dict[str, Any] = {
    "rooms": {
        "living": {"kind": "living", "shape": "L", "area": 22, "doors": ["outside"], "windows": False},
        "store": {"kind": "store", "doors": ["living"], **BARE},
    },
    "density": 0.1,
}


def test_an_l_shaped_room_is_walked_round_its_corner_and_not_through_a_wall_across_it(agent: Any) -> None:
    made = _built(agent, "A living room is L-shaped.", ELL)
    assert made["rooms"]["living"]["wing"]
    assert made["rooms"]["living"]["things"] > 10
    assert _row(agent, "navigability:b_living_to_wing")["status"] == "pass"
    one, two = (_spec(agent, f"/graph/regions/b_living{end}") for end in ("", "_wing"))
    low = [max(one["min"][k], two["min"][k]) for k in (0, 1)]
    high = [min(one["max"][k], two["max"][k]) for k in (0, 1)]
    size, middle = [abs(h - a) for a, h in zip(low, high, strict=True)], [(a + h) / 2 for a, h in zip(low, high, strict=True)]
    wall = {"shape": {"kind": "box", "size": [*size, 2.0]}, "pose": {"position": [*middle, 1.01]}}
    entity = {
        "role": "a wall",
        "motion": "static",
        "material": "oak",
        "dimensions": {"size": [*size, 2.0]},
        "parts": {"all": wall},
    }
    members = _spec(agent, "/simulation/solvers/rigid/members")
    agent.edit(("/entities/bar", entity), ("/simulation/solvers/rigid/members", [*members, "bar"]))
    agent.call("run_checks", world="w", scope="static")
    assert _row(agent, "navigability:b_living_to_wing")["status"] == "fail"


def _straight(**more: Any) -> dict[str, Any]:
    rooms = {**HOUSE["rooms"], "stairs": {"kind": "stairs", "stairs": "straight", **more}}
    return {"rooms": {k: {**r, "furniture": False, "windows": False} if k != "stairs" else r for k, r in rooms.items()}}


@pytest.mark.slow
def test_a_straight_flight_in_an_open_well_is_walked_and_not_with_its_well_closed(agent: Any) -> None:
    _built(agent, "A house has a straight stair in a well.", _straight(open=True))
    for name in ("b_stairs_up_1", "b_hall_to_stairs", "b_landing_to_stairs"):
        assert _row(agent, f"navigability:{name}")["status"] == "pass"
    front, back = (_spec(agent, f"/entities/b_floor_1/parts/stairs{end}") for end in ("", "_back"))
    place = _spec(agent, "/entities/b_stairs_flights/pose/position")
    own = _spec(agent, "/entities/b_floor_1/pose/position")
    slab = {**front, "shape": {"kind": "box", "size": [0.8, 0.8, 0.19]}}
    slab["pose"] = {"position": [place[0] - own[0], place[1] - own[1], back["pose"]["position"][2]]}
    agent.edit(("/entities/b_floor_1/parts/lid", slab))
    agent.call("run_checks", world="w", scope="static")
    assert _row(agent, "navigability:b_stairs_up_1")["status"] == "fail"


@pytest.mark.slow
def test_a_straight_flight_is_not_walked_without_a_tread_nor_past_a_railing_across_it(agent: Any) -> None:
    _built(agent, "A house has a straight stair in a well.", _straight())
    assert _row(agent, "navigability:b_stairs_up_1")["status"] == "pass"
    x, y, z = _spec(agent, "/entities/b_stairs_railing_1_front/pose/position")
    flight = _spec(agent, "/entities/b_stairs_flights/pose/position")
    over = [2 * flight[0] - x, 2 * flight[1] - y, z]
    agent.edit(("/entities/b_stairs_railing_1_front/pose/position", over))
    agent.call("run_checks", world="w", scope="static")
    assert _row(agent, "navigability:b_stairs_up_1")["status"] == "fail", "the railing stands across the arrival"
    back = ("/entities/b_stairs_railing_1_front/pose/position", [x, y, z])
    agent.edit(back, hypothesis="the railing stands across the arrival; at the front edge it bars no way")
    agent.call("run_checks", world="w", scope="static")
    assert _row(agent, "navigability:b_stairs_up_1")["status"] == "pass"
    _without(agent, "/entities/b_stairs_flights/parts/tread_6", "/entities/b_stairs_flights/parts/riser_6")
    row = _row(agent, "navigability:b_stairs_up_1")
    assert row["status"] == "fail"
