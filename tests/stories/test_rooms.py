"""Rooms and things made by the client alone: generators found by words, a table with a stool on it, a hall with a store, one thing made anew."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.worlds.arrays import RigidPose, compose

PROMPT = "A jar stands on a table beside a chair."
FLOOR: dict[str, Any] = {
    "role": "floor",
    "motion": "static",
    "material": "oak",
    "dimensions": {"size": [6, 6, 0.1]},
    "pose": {"position": [0, 0, -0.05]},
    "parts": {"slab": {"shape": {"kind": "box", "size": [6, 6, 0.1]}}},
}
ROOMS = {
    "rooms": {"hall": {"kind": "hall", "area": 8.0, "doors": ["outside"]}, "store": {"kind": "store", "doors": ["hall"]}},
    "density": 0.15,
    "seed": 2,
}


@pytest.fixture
def world(agent: Any) -> Any:
    solvers = {"rigid": {"engine": "mujoco", "members": ["floor"]}}
    agent.call(
        "edit_spec",
        world="w",
        prompt=PROMPT,
        spec={"entities": {"floor": FLOOR}, "simulation": {"frames": 24, "solvers": solvers}},
    )
    return agent


def _spec(agent: Any, pointer: str) -> Any:
    return agent.call("inspect_world", world="w", part="spec", pointer=pointer)["value"]


def test_things_are_found_by_words_made_put_onto_surfaces_and_made_anew(world: Any) -> None:
    found = world.call("inspect_world", part="assets", query="dining table")["generators"]
    assert next(iter(found)) == "table"
    assert found["table"]["parameters"]["width"].startswith("1.4 in 0.5..3.0")
    table = world.call("place_object", world="w", entity="table", asset={"generator": "table"}, on="floor")
    assert table["static_passed"], table["open_rows"]
    assert table["asset"]["surfaces"]["top"]["height"] == 0.74
    assert table["next"].startswith("place_object for more"), "beats and claims come later"
    jar = world.call(
        "place_object", world="w", entity="jar", asset={"generator": "jar", "seed": 3}, on="table", surface="top", at=[0.3, 0.1]
    )
    assert jar["static_passed"], jar["open_rows"]
    assert jar["pose"]["position"] == pytest.approx([0.3, 0.1, 0.742], abs=2e-3)
    assert jar["asset"]["bodies"] == ["jar", "jar_lid"]
    relation = _spec(world, "/graph/relations/jar_stands")
    assert (relation["kind"], relation["a"], relation["b"]) == ("supports", "table", "jar")
    beside = {"entity": "table", "side": "front", "gap": 0.1}
    chair = world.call(
        "place_object", world="w", entity="chair", asset={"generator": "chair"}, on="floor", beside=beside, yaw_deg=180
    )
    assert chair["static_passed"], chair["open_rows"]
    assert chair["pose"]["position"][1] < -0.2, "the front of what a generator made is its -y"
    mine = [{"op": "add", "path": "/entities/chair/parts/crest/material", "value": "walnut"}]
    world.call(
        "edit_spec",
        world="w",
        patch=[*mine, {"op": "add", "path": "/materials/walnut", "value": {"of": "walnut", "density": 600}}],
    )
    taller = {"generator": "chair", "parameters": {"height": 1.0, "slats": 5}}
    again = world.call("place_object", world="w", entity="chair", asset=taller)
    assert again["kept_as_changed_by_hand"] == ["chair/crest"]
    assert _spec(world, "/entities/chair/parts/slat_5/shape/kind") == "hull"
    assert _spec(world, "/entities/chair/pose/position") == pytest.approx(chair["pose"]["position"])


def test_what_hangs_gets_its_height_with_its_bodies_and_joints(world: Any) -> None:
    clock = {"generator": "wall_clock", "motion": "static"}
    low = world.call("place_object", world="w", entity="clock", asset=clock, at=[0, 0], strict=False)
    bodies = ["clock", *_spec(world, "/entities/clock/asset").get("bodies", [])]
    before = {b: _spec(world, f"/entities/{b}/pose/position")[2] for b in bodies}
    high = world.call(
        "place_object", world="w", entity="clock", at=[0.5, 0.2], height=1.7, strict=False, hypothesis="it hangs higher"
    )
    assert high["pose"]["position"] == pytest.approx([0.5, 0.2, 1.7])
    lift = 1.7 - low["pose"]["position"][2]
    assert {b: _spec(world, f"/entities/{b}/pose/position")[2] for b in bodies} == pytest.approx(
        {b: z + lift for b, z in before.items()}
    )


def test_a_table_is_laid_in_one_call_and_what_has_no_place_is_told(world: Any) -> None:
    """Laying a table took fifteen calls, each with all static checks; one that was refused lost nothing but itself."""
    things = [
        {"entity": "table", "asset": {"generator": "table", "motion": "static"}, "on": "floor"},
        {"entity": "plate", "asset": {"generator": "plate"}, "on": "table", "surface": "top", "at": [-0.2, 0.15]},
        {"entity": "mug", "asset": {"generator": "mug"}, "on": "table", "surface": "top", "at": [-0.2, 0.15]},
        {"entity": "jar", "asset": {"generator": "jar", "motion": "static"}, "on": "table", "surface": "top", "at": [0.4, 0.1]},
        {
            "entity": "chair",
            "asset": {"generator": "chair"},
            "on": "floor",
            "beside": {"entity": "table", "side": "front", "gap": 0.1},
        },
    ]
    laid = world.call("place_object", world="w", things=things)
    assert laid["static_passed"], laid["open_rows"]
    assert [p["id"] for p in laid["placed"]] == ["table", "plate", "jar", "chair"]
    assert laid["placed_total"] == 4
    (missing,) = laid["not_placed"]
    assert missing["thing"] == "things[2]: mug"
    assert "overlap 'plate'" in missing["why"]
    assert "1 without a place" in laid["summary"]
    assert any("jar_lid" in said for said in laid["still_moving"])
    assert laid["revision"] == 2, "all of it is one revision"
    assert _spec(world, "/graph/relations/plate_stands/a") == "table"
    blocks = {"generator": "building_blocks", "motion": "static"}
    more = [{"entity": "blocks", "asset": blocks, "on": "floor", "at": [1.5, 1.5]}]
    added = world.call("place_object", world="w", things=more)
    assert added["static_passed"], added["open_rows"]


def test_things_of_which_none_has_a_place_are_refused(world: Any) -> None:
    things = [{"entity": "t", "asset": {"generator": "tabel"}}, {"entity": "mug", "asset": {"generator": "mug"}, "on": "table"}]
    said = world.refused("place_object", world="w", things=things)
    assert "none of the 2 things has a place, nothing was changed" in said
    assert "did you mean 'table'" in said
    assert "unknown entity 'table'" in said
    assert "give one of them" in world.refused("place_object", world="w", entity="floor", things=things)
    assert set(_spec(world, "/entities")) == {"floor"}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"entity": "floor", "asset": {"generator": "table"}}, "made by no generator"),
        ({"entity": "t", "asset": {"generator": "tabel"}}, "did you mean 'table'"),
        ({"entity": "t", "asset": {"generator": "table", "parameters": {"width": 9}}}, "'width' of table"),
        ({"entity": "t", "asset": {"generator": "table"}, "on": "floor", "surface": "top"}, "names no surfaces"),
        ({"entity": "t", "asset": {"generator": "table"}, "surface": "top"}, "give on"),
        ({"entity": "t", "asset": {"generator": "table"}, "on": "floor", "height": 1.0}, "both say how high"),
    ],
)
def test_what_cannot_be_made_is_refused_and_nothing_is_lost(world: Any, arguments: dict[str, Any], said: str) -> None:
    assert said in world.refused("place_object", world="w", **arguments)
    assert set(_spec(world, "/entities")) == {"floor"}


def test_rooms_are_made_checked_and_made_again(agent: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    run_jobs_inline(monkeypatch)
    agent.call("edit_spec", world="w", prompt="A hall leads to a store.", spec={"simulation": {"frames": 24}})
    made = agent.call("build_interior", world="w", interior="house", plan=ROOMS, wait_s=120)
    assert set(made["rooms"]) == {"hall", "store"}
    assert made["open_rows"] == [], "no row about shots either, while no beat says what they shall show"
    regions = _spec(agent, "/graph/regions")
    assert set(regions) == {"house_hall", "house_store"}
    first = set(_spec(agent, "/interiors/house/entities"))
    again = agent.call("build_interior", world="w", interior="house", plan={**ROOMS, "seed": 5, "density": 0.0}, wait_s=120)
    assert again["entities"] < made["entities"]
    second = set(_spec(agent, "/interiors/house/entities"))
    assert second != first
    members = _spec(agent, "/simulation/solvers/rigid/members")
    assert sorted(members) == sorted(second)
    agent.call("edit_spec", world="w", patch=[{"op": "remove", "path": f"/entities/{max(second)}"}])
    agent.call("build_interior", world="w", interior="house", plan={**ROOMS, "seed": 5, "density": 0.0}, wait_s=120)
    members = _spec(agent, "/simulation/solvers/rigid/members")
    assert sorted(members) == sorted(second), "what was taken out by hand is there again, and a member once"
    shut = agent.refused("build_interior", world="w", interior="hut", plan={"rooms": {"a": {"kind": "cellar"}}})
    assert "plan/rooms/a/kind" in shut
    assert "there is no interior 'hut'" in agent.refused("build_interior", world="w", interior="hut")


def test_a_thing_of_a_room_is_taken_out_in_one_patch_and_the_reply_says_what_followed(world: Any) -> None:
    made = {"rooms": {"hall": {"kind": "hall"}}, "entities": ["floor", "jar", "jug"]}
    things = {name: {**FLOOR, "role": name} for name in ("jar", "jug")}
    members = {"op": "add", "path": "/simulation/solvers/rigid/members", "value": ["floor", "jug"]}
    there = [{"op": "add", "path": f"/entities/{n}", "value": e} for n, e in things.items()]
    listed = {"op": "add", "path": "/interiors", "value": {"house": made}}
    world.call("edit_spec", world="w", patch=[*there, listed, {**members, "value": ["floor", "jar", "jug"]}])
    gone = world.call("edit_spec", world="w", patch=[{"op": "remove", "path": "/entities/jar"}, members])
    assert gone["interiors_list_no_more"] == {"house": ["jar"]}
    assert "/interiors/house/entities" in gone["changed"]
    assert "audit:references" not in {r["id"] for r in gone["audit"]["open_rows"]}
    assert _spec(world, "/interiors/house/entities") == ["floor", "jug"]


def test_a_thing_that_is_made_anew_on_a_surface_keeps_its_turn(world: Any) -> None:
    """The table is turned too: what was put along it lies along it, and what was turned on it stays turned."""
    world.call("place_object", world="w", entity="table", asset={"generator": "table"}, on="floor", yaw_deg=30)
    on = {"on": "table", "surface": "top", "at": [0.2, 0.1]}

    def turn(**more: Any) -> float:
        world.call(
            "place_object",
            world="w",
            entity="mug",
            asset={"generator": "mug", "parameters": {"height": more.pop("height")}},
            **on,
            **more,
        )
        w, _, _, z = _spec(world, "/entities/mug/pose/quaternion")
        return float(np.degrees(2 * np.arctan2(z, w)))

    assert turn(height=0.10) == pytest.approx(30.0, abs=1e-6)
    assert turn(height=0.10, yaw_deg=-90.0) == pytest.approx(-60.0, abs=1e-6)
    assert turn(height=0.12) == pytest.approx(-60.0, abs=1e-6)


def test_a_thing_on_the_surface_of_one_that_stands_on_a_slope_lies_along_it(world: Any) -> None:
    """Seven degrees, turned by a quarter: `at` and the lie of the thing are in the frame of what carries it."""
    slope = {
        **FLOOR,
        "role": "ramp",
        "pose": {"position": [0, 0, 0.6], "euler": [0.0, 0.122, 0.0]},
        "parts": {"slab": FLOOR["parts"]["slab"]},
    }
    patch = [
        {"op": "add", "path": "/entities/ramp", "value": slope},
        {"op": "add", "path": "/simulation/solvers/rigid/members/-", "value": "ramp"},
    ]
    world.call("edit_spec", world="w", patch=patch)
    world.call(
        "place_object", world="w", entity="table", asset={"generator": "table"}, on="ramp", at=[0, 0], tilt=True, yaw_deg=90
    )
    crate = {"generator": "wooden_crate", "parameters": {"width": 0.5, "depth": 0.3, "height": 0.28}}
    told = world.call("place_object", world="w", entity="crate", asset=crate, on="table", surface="top", at=[0.3, 0.1])
    table, placed = (_spec(world, f"/entities/{n}/pose") for n in ("table", "crate"))
    pose = {n: RigidPose(np.array(p["position"]), np.array(p["quaternion"])) for n, p in (("table", table), ("crate", placed))}
    within = compose(pose["table"].inverse(), pose["crate"])
    assert within.position == pytest.approx([0.3, 0.1, 0.742], abs=3e-3)
    assert abs(within.quaternion[0]) == pytest.approx(1.0, abs=1e-9)
    assert not [r for r in told["open_rows"] if r["id"].startswith(("interpenetration", "support:balance:crate"))]
