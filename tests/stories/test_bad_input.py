"""Bad input is refused with its value, the allowed range and the next step, and nothing is lost."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec

Patch = Callable[..., list[dict[str, Any]]]
BALL = "/entities/ball"
BOW_TIE = [[0, 0], [0.1, 0.1], [0.1, 0], [0, 0.1]]
TEXTS: dict[str, tuple[tuple[str, Any], list[str]]] = {
    "NaN": ((f"{BALL}/pose/position/0", "NaN"), ["/entities/ball/pose/position/0", "finite", "NaN"]),
    "infinity": ((f"{BALL}/physics/linear_velocity/1", "Infinity"), ["linear_velocity", "finite", "Infinity"]),
    "minus infinity": (("/simulation/preroll", -math.inf), ["/simulation/preroll", "valid number"]),
    "a number beyond all sense": ((f"{BALL}/pose/position/0", 1e12), ["1e9", "1000000000000.0"]),
    "a negative size": (("/entities/b1/parts/body/shape/size/0", -0.03), ["greater than 0", "-0.03"]),
    "a zero radius": ((f"{BALL}/parts/body/shape/radius", 0), ["greater than 0", "got 0"]),
    "a wrong type": ((f"{BALL}/parts/body/shape/radius", "thick"), ["valid number", "'thick'"]),
    "a boolean for a vector": ((f"{BALL}/pose/position", True), ["tuple", "True"]),
    "an unknown field of what is called like its kind": (
        (
            "/simulation/drivers/wind",
            {"kind": "field", "field": {"kind": "wind", "velocity": [1, 0, 0]}, "region": {"kind": "box", "center": 1}},
        ),
        ["/simulation/drivers/wind/region/center", "there is no field 'center'"],
    ),
    "an unknown field": ((f"{BALL}/colour", "red"), ["/entities/ball/colour", "there is no field", "material"]),
    "an unknown shape": (("/entities/b1/parts/body/shape", {"kind": "torus"}), ["torus", "no kind of Shape", "box"]),
    "an id with a path in it": (("/entities/..~1..~1etc", small_spec()["entities"]["b1"]), ["pattern", "../../etc"]),
    "an empty id": (("/story/beats/", small_spec()["story"]["beats"]["fall"]), ["pattern"]),
    "too many frames": (("/simulation/frames", 10**9), ["less than or equal to 20000", "1000000000"]),
    "too small a step": (("/simulation/solvers/rigid/settings/step", 1e-9), ["greater than or equal to 0.00002", "1e-09"]),
    "frames backwards": (("/story/beats/fall/frames", [20, 4]), ["last must be >= first", "[20, 4]"]),
    "a zero quaternion": ((f"{BALL}/pose", {"quaternion": [0, 0, 0, 0]}), ["quaternion must not be zero"]),
    "a mesh outside by an absolute path": (
        ("/entities/b1/parts/body/shape", {"kind": "mesh", "file": "C:\\x.obj"}),
        ["pattern", "C:"],
    ),
}


@pytest.mark.parametrize("name", TEXTS)
def test_a_value_out_of_range_is_named_with_its_range(accepted: Any, patch: Patch, name: str) -> None:
    operation, words = TEXTS[name]
    text = accepted.refused("edit_spec", world="w", patch=patch(operation))
    assert text.startswith("invalid: ")
    assert "worldagent://schema/world" in text
    for word in words:
        assert word in text


AUDIT: dict[str, tuple[list[tuple[str, Any]], str, str]] = {
    "an unknown material": ([(f"{BALL}/material", "stel")], "references", "did you mean 'steel'?"),
    "an unknown beat": ([("/story/beats/fall/causes", ["roll", "bang"])], "references", "unknown beat 'bang'"),
    "an unknown entity": ([("/graph/relations/hits/b", "b9")], "references", "unknown entity 'b9'"),
    "support in a circle": (
        [("/graph/relations/x", {"kind": "supports", "a": "b1", "b": "b2"}), ("/graph/relations/y", {"kind": "supports", "a": "b2", "b": "b1"})],
        "graph",
        "support runs in a circle",
    ),
    "support of itself": ([("/graph/relations/x", {"kind": "supports", "a": "b1", "b": "b1"})], "graph", "related to itself"),
    "causes in a circle": ([("/story/beats/roll/causes", ["fall"])], "story", "causes form a cycle"),
    "a beat after the end": ([("/story/beats/fall/frames", [4, 99])], "story", "end after the last frame 35"),
    "an impossible density": ([("/materials/wood/density", 9000)], "density:wood", "allowed 120 to 1200"),
    "a gas in the engine of bodies": (
        [(f"{BALL}/physics", {"category": "gas", "resolution": 0.01})],
        "ownership",
        "'ball' is gas, which engine 'mujoco' does not move",
    ),
    "a liquid in the engine of bodies": (
        [(f"{BALL}/physics", {"category": "liquid", "resolution": 0.01})],
        "ownership",
        "'ball' is liquid, which engine 'mujoco' does not move",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", AUDIT)
def test_what_only_the_audit_sees_stops_the_loop_and_says_where(accepted: Any, name: str) -> None:
    operations, row, words = AUDIT[name]
    data = accepted.edit(*operations)
    assert not data["audit"]["passed"]
    found = next(r for r in data["audit"]["open_rows"] if r["id"] == f"audit:{row}")
    assert words in str(found)
    assert "pointers" in found["corrections"][0] or "patch" in found["corrections"][0]
    for tool in ("place_object", "probe_sim"):
        assert words in accepted.refused(tool, world="w")


GEOMETRY: dict[str, tuple[Any, list[str]]] = {
    "a polygon that crosses itself": (
        {"kind": "extrusion", "polygon": BOW_TIE, "height": 0.1},
        ["/entities/b1/parts/body/shape", "polygon"],
    ),
    "a mesh that is not there": ({"kind": "mesh", "file": "ghost.obj"}, ["ghost.obj", "assets"]),
    "a mesh with faces out of range": (
        {"kind": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "faces": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 9]]},
        ["/entities/b1/parts/body/shape", "9"],
    ),
    "an open mesh": (
        {"kind": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "faces": [[0, 2, 1], [0, 1, 3], [0, 3, 2]]},
        ["/entities/b1/parts/body/shape", "closed"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", GEOMETRY)
def test_a_shape_that_cannot_be_built_is_refused_by_every_tool_that_builds(accepted: Any, name: str) -> None:
    shape, words = GEOMETRY[name]
    accepted.edit(("/entities/b1/parts/body/shape", shape))
    for tool, more in (("place_object", {}), ("probe_sim", {}), ("bake_sim", {}), ("render_shot", {"kind": "preview"})):
        text = accepted.refused(tool, world="w", **more)
        assert text.startswith(("invalid: ", "evidence: "))
        for word in words:
            assert word in text


CALLS: list[tuple[str, dict[str, Any], list[str]]] = [
    ("edit_spec", {"world": "w", "pach": []}, ["no argument 'pach'", "did you mean 'patch'"]),
    ("edit_spec", {"world": "w"}, ["patch"]),
    ("edit_spec", {"world": "w", "patch": []}, ["patch"]),
    ("edit_spec", {"world": "w", "patch": "no list"}, ["patch = 'no list'"]),
    ("edit_spec", {"world": "w", "spec": {}}, ["prompt"]),
    ("edit_spec", {"world": "../w", "patch": []}, ["world id '../w' must match"]),
    ("edit_spec", {"world": "/etc", "prompt": "A ball."}, ["world id '/etc' must match"]),
    ("edit_spec", {"world": "W w", "prompt": "A ball."}, ["must match"]),
    ("edit_spec", {"world": "v", "prompt": ""}, ["at least 1 character"]),
    ("edit_spec", {"world": "w", "patch": [{"op": "remove", "path": "/title"}], "expected_revision": -1}, ["-1", ">= 0"]),
    ("place_object", {"world": "ghost"}, ["no world 'ghost'", "edit_spec", "'w'"]),
    ("place_object", {"world": "w", "entity": "ghost"}, ["unknown entity 'ghost'", "ball"]),
    ("place_object", {"world": "w", "on": "floor"}, ["need entity"]),
    ("place_object", {"world": "w", "entity": "b1", "on": "b1"}, ["cannot rest on itself"]),
    ("place_object", {"world": "w", "entity": "b1", "on": "shelf", "at": [50, 50]}, ["not above 'shelf'", "50"]),
    ("place_object", {"world": "w", "entity": "b1", "at": [math.nan, 0]}, ["null, as which JSON gives NaN", "valid number"]),
    ("place_object", {"world": "w", "entity": "b1", "at": [1e300, 0]}, ["within 1e+06 m"]),
    ("place_object", {"world": "w", "entity": "b1", "yaw_deg": 720}, ["720", "<= 360"]),
    ("place_object", {"world": "w", "entity": "b1", "at": [0.17, 0]}, ["overlap 'b2'", "strict=false"]),
    ("probe_sim", {"world": "w", "wait_s": 1e9}, ["wait_s", "<= 240"]),
    ("run_checks", {"world": "w", "scope": "everything"}, ["scope", "'acceptance'"]),
    ("run_checks", {"world": "w", "scope": "acceptance", "only": ["beat"]}, ["whole world"]),
    ("render_shot", {"world": "w", "kind": "painting"}, ["kind", "'preview'"]),
    ("render_shot", {"world": "w", "frame": 36}, ["frame 36", "0..35"]),
    ("render_shot", {"world": "w", "shot": "ghost"}, ["unknown shot 'ghost'", "only"]),
    ("render_shot", {"world": "w", "width": 10**6}, ["1000000", "<= 1920"]),
    ("render_shot", {"world": "w", "kind": "contact_sheet", "frames": [-1]}, ["-1", "0..35"]),
    ("inspect_world", {"world": "w", "part": "row", "row": "ghost"}, ["no row 'ghost'", "matrix"]),
    ("inspect_world", {"world": "w", "part": "spec", "pointer": "/entities/../x"}, ["leads nowhere at '..'"]),
    ("inspect_world", {"world": "w", "part": "state", "frames": [40, 99]}, ["[40, 99]", "0..35"]),
    ("inspect_world", {"world": "w", "part": "state", "entities": ["x"]}, ["unknown entities ['x']"]),
    ("inspect_world", {"part": "spec"}, ["needs world"]),
    ("inspect_world", {"world": "w", "limit": 10**9}, ["<= 200"]),
    ("build_terrain", {"world": "w", "cells": 10**9}, ["cells", "<= 512"]),
    ("build_terrain", {"world": "w", "size": [math.nan, 5]}, ["valid number"]),
    ("build_terrain", {"world": "w", "entity": "ball"}, ["is no terrain"]),
    ("build_terrain", {"world": "w", "entity": "../x"}, ["../x"]),
    ("job", {"action": "wait"}, ["needs job_id"]),
    ("job", {"action": "status", "job_id": "../../x"}, ["../../x"]),
    ("job", {"action": "cancel", "job_id": "job_000000000000"}, ["job_000000000000"]),
    ("no_such_tool", {}, ["no tool 'no_such_tool'", "edit_spec"]),
]


def test_every_bad_call_is_answered_with_what_to_do(accepted: Any) -> None:
    for tool, arguments, words in CALLS:
        text = accepted.refused(tool, **arguments)
        for word in words:
            assert word in text, (tool, arguments, text)
    assert sorted(p.name for p in accepted.workspace.iterdir() if p.is_dir() and not p.name.startswith(".")) == ["w"]


def test_too_many_bodies_are_refused_before_any_work(accepted: Any) -> None:
    block = {**small_spec()["entities"]["b1"]}
    many = [{"op": "add", "path": f"/entities/x{i}", "value": block} for i in range(1999)]
    text = accepted.refused("edit_spec", world="w", patch=many)
    assert text.startswith("over the limit: bodies: estimated 2,003 bodies")
    assert "cap 2,000" in text
    assert "Knob" in text


def test_a_deep_or_long_document_is_refused_without_a_crash(agent: Any) -> None:
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=small_spec())
    for depth in (60, 120, 240):
        deep: dict[str, Any] = {"kind": "speed", "entity": "b3", "min": 1}
        for _ in range(depth):
            deep = {"kind": "not", "predicate": deep}
        change = [{"op": "replace", "path": "/story/beats/fall/predicate", "value": deep}]
        answer = agent.result("edit_spec", world="w", patch=change)
        assert not answer.content[0].text.startswith("internal error"), depth
    long_text = [{"op": "replace", "path": "/entities/ball/role", "value": "x" * 5000}]
    assert "2000 characters" in agent.refused("edit_spec", world="w", patch=long_text)


def test_a_hand_edit_over_the_caps_is_not_adopted(accepted: Any) -> None:
    path: Path = accepted.workspace / "w" / "world.json"
    document = json.loads(path.read_text())
    document["simulation"]["solvers"]["rigid"]["settings"]["step"] = 2e-5
    document["simulation"]["frames"] = 20000
    document["simulation"]["fps"] = 1
    path.write_text(json.dumps(document))
    assert "over the limit: steps" in accepted.refused("edit_spec", world="w", on_hand_edit="adopt")


def test_numbers_that_json_does_not_have_are_not_adopted(accepted: Any) -> None:
    path: Path = accepted.workspace / "w" / "world.json"
    document = json.loads(path.read_text())
    document["entities"]["ball"]["pose"]["position"][2] = math.nan
    path.write_text(json.dumps(document))
    assert "NaN" in path.read_text()
    assert "/entities/ball/pose/position/2" in accepted.refused("inspect_world", world="w")
    assert "finite" in accepted.refused("edit_spec", world="w", on_hand_edit="adopt")
    accepted.call("edit_spec", world="w", on_hand_edit="restore")
