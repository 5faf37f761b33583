"""A client declares a landscape, builds it, looks at its fields and stands a ball on it."""

from __future__ import annotations

import json
from typing import Any

import pytest
from worldagent.tests.stories.inline_jobs import run_jobs_inline

HANGS = "the ball hangs in the air above the yard; put it on the ground"
LAND: dict[str, Any] = {
    "extent": [400, 400],
    "cell": 5,
    "layers": {
        "rolling": {"kind": "noise", "amplitude": 6, "wavelength": 200, "octaves": 4, "order": 1},
        "basin": {"kind": "crater", "radius": 90, "depth": 9, "floor": 0.5, "order": 2, "late": True},
        "site": {"kind": "flatten", "zone": "yard", "falloff": 25, "order": 3},
    },
    "zones": {"yard": {"center": [150, 150], "radius": 20}},
    "erosion": {"years": 1000, "steps": 2},
    "hydrology": {"required": ["lake"]},
    "ground": {"low": {"material": "stone", "where": [{"field": "slope", "at_most": 0.05}]}},
    "vegetation": {"density": 0.2},
}


def _spec(**land: Any) -> dict[str, Any]:
    ball = {
        "role": "ball that rests on the yard",
        "motion": "dynamic",
        "material": "stone",
        "dimensions": {"size": [0.4, 0.4, 0.4]},
        "pose": {"position": [150, 150, 30]},
        "parts": {"body": {"shape": {"kind": "sphere", "radius": 0.2}}},
    }
    return {
        "spec_version": "2",
        "title": "Lake land",
        "claims": {
            "ball": {"quote": "ball", "type": "thing", "by": ["/entities/ball"]},
            "lake": {"quote": "lake", "type": "thing", "by": ["/terrains/land"]},
        },
        "materials": {"stone": {"density": 2600, "substance": "stone", "friction": 0.7, "rolling_friction": 0.01}},
        "entities": {"ball": ball},
        "terrains": {"land": {**LAND, **land}},
        "story": {
            "beats": {
                "rests": {"text": "rests", "owner": "rigid", "subject": "ball", "frames": [0, 20],
                          "predicate": {"kind": "speed", "entity": "ball", "max": 20}}
            }
        },
        "shots": {"only": {"frames": [0, 20], "covers": ["rests"], "subjects": ["ball"],
                           "keys": {"a": {"frame": 0, "position": [154, 140, 40], "target": [150, 150, 30], "fov_deg": 40}}}},
        "simulation": {"frames": 21, "fps": 24, "solvers": {"rigid": {"engine": "mujoco", "members": ["ball"]}}},
    }  # fmt: skip


@pytest.fixture(autouse=True)
def _inline(monkeypatch: pytest.MonkeyPatch) -> None:
    run_jobs_inline(monkeypatch)


def test_a_landscape_is_declared_built_seen_and_stood_upon(agent: Any) -> None:
    agent.call("edit_spec", world="w", prompt="A ball beside a lake.", spec=_spec())
    built = agent.call("build_terrain", world="w", terrain="land", size=[80, 80], center=[150, 150], cells=80, wait_s=120)
    assert built["built"]
    assert built["features"]["lakes"] >= 1
    assert built["lakes"][0]["depth"] > 1
    matrix = {r["id"]: r["status"] for r in agent.pages("rows", part="matrix")}
    assert {matrix[f"terrain:land:{n}"] for n in ("fill", "drainage", "water", "ledger", "plants", "ground:ground")} == {"pass"}
    for field in ("hillshade", "basin_depth", "cover", "accumulation"):
        answer = agent.result("render_shot", world="w", kind="field", field=field)
        assert not answer.is_error, answer.content[0].text
        assert [block.type for block in answer.content[:2]] == ["text", "image"]
    placed = agent.call("place_object", world="w", entity="ball", on="ground", at=[150, 150], hypothesis=HANGS)
    assert placed["counts"]["fail"] == 0, placed
    again = agent.call("build_terrain", world="w", terrain="land", size=[80, 80], center=[150, 150], cells=80, wait_s=120)
    assert not again["built"], "the same recipe is not built twice"
    assert "revision" not in again, "the same ground is no new revision"


def test_an_agent_asks_the_land_before_it_places_things(agent: Any) -> None:
    agent.call("edit_spec", world="w", prompt="A ball beside a lake.", spec=_spec())
    early = agent.result("inspect_world", world="w", part="terrain")
    assert early.is_error
    assert "build_terrain" in early.content[0].text
    built = agent.call("build_terrain", world="w", terrain="land", size=[80, 80], center=[150, 150], cells=40, wait_s=120)
    told = agent.call("inspect_world", world="w", part="terrain")
    assert told["waters"][0]["level"] == built["lakes"][0]["level"]
    assert told["balance"]["river_erosion"] <= 1e-6
    assert sum(told["plants"].values()) == built["features"]["plants"]
    flat = agent.call("inspect_world", world="w", part="terrain", find="flat", size=20, points=[[150, 150]])
    assert flat["places"][0]["distance"] < 15, "the yard is level"
    line = agent.call("inspect_world", world="w", part="terrain", points=[[-150, 0], [150, 0]], profile=31)
    assert [p["along"] for p in line["places"]] == [10.0 * k for k in range(31)]
    assert any(p.get("water") == "lake" for p in line["places"]), "the line crosses the lake"
    for arguments, words in (
        ({"find": "sea"}, "no sea"),
        ({"profile": 5}, "needs points"),
        ({"find": "flat", "points": [[0, 0], [1, 1]]}, "one point"),
        ({"terrain": "moon"}, "not one of"),
    ):
        answer = agent.result("inspect_world", world="w", part="terrain", **arguments)
        assert answer.is_error
        assert words in answer.content[0].text


def test_plants_leave_the_ground_as_it_is_and_layers_do_not(agent: Any) -> None:
    agent.call("edit_spec", world="w", prompt="A ball beside a lake.", spec=_spec())
    agent.call("build_terrain", world="w", terrain="land", size=[80, 80], center=[150, 150], cells=40, wait_s=120)
    denser = [{"op": "add", "path": "/terrains/land/vegetation/density", "value": 0.3}]
    edited = agent.call("edit_spec", world="w", patch=denser, hypothesis=HANGS)
    assert edited["groups"] == ["cover"]
    assert "terrain:land" in edited["stale"]
    assert not any(name.startswith(("built:", "motion")) for name in edited["stale"])
    matrix = {r["id"]: r["status"] for r in agent.pages("rows", part="matrix")}
    assert matrix["terrain:land:fill"] == "unverified"
    agent.call("place_object", world="w", entity="ball", on="ground", at=[150, 150], hypothesis=HANGS)
    lower = [{"op": "add", "path": "/terrains/land/layers/site/height", "value": 1.0}]
    assert agent.call("edit_spec", world="w", patch=lower, hypothesis=HANGS)["groups"] == ["terrain"]
    agent.call(
        "build_terrain", world="w", terrain="land", size=[80, 80], center=[150, 150], cells=40, hypothesis=HANGS, wait_s=120
    )
    spec = json.loads((agent.workspace / "w" / "world.json").read_text())
    assert spec["entities"]["ground"]["dimensions"]["size"][0] == 80


def test_trunks_on_the_ground_are_solid_when_asked_for(agent: Any) -> None:
    where = {"world": "w", "terrain": "land", "size": [80, 80], "center": [150, 150], "cells": 40, "wait_s": 120}
    agent.call("edit_spec", world="w", prompt="A ball beside a lake.", spec=_spec(vegetation={"density": 3}))
    assert "stems" not in agent.call("build_terrain", **where)
    built = agent.call("build_terrain", **where, stems=True, hypothesis=HANGS)
    shape = json.loads((agent.workspace / "w" / "world.json").read_text())["entities"]["ground"]["parts"]["stems"]["shape"]
    assert shape["count"] == built["stems"] > 10
    assert "revision" not in agent.call("build_terrain", **where, stems=True), "the same trunks are no new revision"
    rows = {"scale:ground", "terrain:land:ground:ground", "terrain:land:tight"}

    def matrix() -> dict[str, str]:
        return {r["id"]: r["status"] for r in agent.pages("rows", part="matrix") if r["id"] in rows}

    assert matrix() == dict.fromkeys(rows, "pass")
    denser = [{"op": "add", "path": "/terrains/land/vegetation/density", "value": 4}]
    agent.call("edit_spec", world="w", patch=denser, hypothesis=HANGS)
    bare = agent.call("build_terrain", **where, stems=True)
    assert bare["stems"] != built["stems"], "the same ground with other trunks follows the edit"
    assert matrix() == dict.fromkeys(rows, "pass")
    refused = agent.result("build_terrain", world="w", stems=True)
    assert refused.is_error
    assert "give terrain, too" in refused.content[0].text


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"terrain": "sea"}, "there is no terrain 'sea'"),
        ({"terrain": "land", "size": [900, 900]}, "leaves the landscape"),
        ({"terrain": "land", "center": [190, 0], "size": [50, 50]}, "leaves the landscape"),
        ({"terrain": "land", "material": "gold"}, "not declared"),
    ],
)
def test_what_cannot_be_built_says_why(agent: Any, arguments: dict[str, Any], words: str) -> None:
    agent.call("edit_spec", world="w", prompt="A ball beside a lake.", spec=_spec(vegetation=None))
    answer = agent.result("build_terrain", world="w", **arguments)
    assert answer.is_error
    assert words in answer.content[0].text


def test_a_height_file_that_was_changed_is_refused(agent: Any) -> None:
    agent.call("edit_spec", world="w", prompt="A ball beside a lake.", spec=_spec(vegetation=None))
    agent.call("build_terrain", world="w", terrain="land", size=[80, 80], center=[150, 150], cells=40, wait_s=120)
    file = next((agent.workspace / "w" / "assets").glob("land-*.npy"))
    data = bytearray(file.read_bytes())
    data[-1] ^= 1
    file.write_bytes(bytes(data))
    for built in (agent.workspace / "w" / "built").iterdir():
        built.unlink()
    answer = agent.result("run_checks", world="w", scope="static")
    assert answer.is_error
    assert "digest" in answer.content[0].text


def test_replies_about_a_landscape_name_calls_that_work_and_only_rows_that_changed(agent: Any) -> None:
    """From a world with nothing but land: build, find a place, stand something there."""
    bare = _spec() | {"entities": {}, "story": {}, "shots": {}, "claims": {}, "simulation": {"frames": 21}}
    made = agent.call("edit_spec", world="w", prompt="A ball beside a lake.", spec=bare)
    assert made["next"].startswith("build_terrain(world='w', terrain='land')")
    assert agent.call("inspect_world", world="w")["next"].startswith("build_terrain(world='w', terrain='land')")
    where = {"world": "w", "terrain": "land", "size": [80, 80], "center": [150, 150], "cells": 40, "wait_s": 120}
    built = agent.call("build_terrain", **where)
    told = {r["id"] for r in built["audit"]["open_rows"]}
    before = {r["id"] for r in made["audit"]["open_rows"]}
    assert before >= {"audit:claims", "audit:story"}
    assert not told & before
    assert set(built["audit"]["open_as_before"]) == before
    assert "find='flat'" in built["next"]
    assert "render_shot" in built["next"]
    flat = agent.call("inspect_world", world="w", part="terrain", find="flat", size=8, points=[[150, 150]])
    assert "place_object(world='w', entity='its id', on='ground', at=" in flat["next"]
    far = agent.call("inspect_world", world="w", part="terrain", points=[[-150, -150]])
    assert far["next"] == "build_terrain(world='w', terrain='land', center=[-150.0, -150.0], size=[120, 120])"
    edit = [{"op": "add", "path": "/terrains/land/vegetation/density", "value": 0.3}]
    again = agent.call("edit_spec", world="w", patch=edit)["next"]
    assert again.startswith(
        "build_terrain(world='w', terrain='land', entity='ground', center=[150.0, 150.0], size=[80.0, 80.0], cells=40)"
    )


def test_a_camera_below_the_land_is_told(agent: Any) -> None:
    agent.call("edit_spec", world="w", prompt="A ball beside a lake.", spec=_spec())
    agent.call("build_terrain", world="w", terrain="land", size=[80, 80], center=[150, 150], cells=40, wait_s=120)
    low, high = ({"position": [140, 140, z], "look_at": "ball"} for z in (-40, 40))
    told = [
        json.loads(agent.result("render_shot", world="w", camera=c, width=96, height=64).content[0].text) for c in (low, high)
    ]
    assert "inside the land 'land'" in told[0]["warnings"][0]
    assert told[1]["warnings"] == []


def test_a_ground_cut_elsewhere_is_one_group_after_a_failure(agent: Any) -> None:
    agent.call("edit_spec", world="w", prompt="A ball beside a lake.", spec=_spec())
    agent.call("build_terrain", world="w", terrain="land", size=[60, 60], center=[120, 120], cells=40, wait_s=120)
    hut = {"role": "hut", "motion": "static", "material": "stone", "dimensions": {"size": [2, 2, 2]}, "pose": {"position": [150, 150, 40]},
           "parts": {"walls": {"shape": {"kind": "box", "size": [2, 2, 2]}}}}  # fmt: skip
    patch = [
        {"op": "add", "path": "/entities/hut", "value": hut},
        {"op": "add", "path": "/simulation/solvers/rigid/members/-", "value": "hut"},
    ]
    agent.call("edit_spec", world="w", patch=patch, hypothesis=HANGS)
    assert agent.call("place_object", world="w")["counts"]["fail"], "the hut hangs beside the ground"
    moved = agent.call(
        "build_terrain", world="w", terrain="land", size=[60, 60], center=[150, 150], cells=40, hypothesis=HANGS, wait_s=120
    )
    assert {"placement", "shape"} <= set(moved["groups"])
    placed = agent.call("place_object", world="w", entity="hut", on="ground")
    assert placed["moved"], "its first placement is its own hypothesis"
