"""Frequent mistakes of agents: each answer names the value, what is allowed or was meant, and the call that mends it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec


def _with(pointer: str, value: Any) -> dict[str, Any]:
    """The small specification with one value changed."""
    spec: Any = json.loads(json.dumps(small_spec()))
    *steps, last = pointer.split("/")[1:]
    node = spec
    for step in steps:
        node = node[step]
    node[last] = value
    return spec


def _create(pointer: str, value: Any) -> tuple[str, dict[str, Any]]:
    return "edit_spec", {"world": "n", "prompt": PROMPT, "spec": _with(pointer, value)}


def _patch(*operations: Any) -> tuple[str, dict[str, Any]]:
    return "edit_spec", {"world": "w", "patch": list(operations)}


def _look(**arguments: Any) -> tuple[str, dict[str, Any]]:
    return "inspect_world", {"world": "w", **arguments}


BALL = "/entities/ball"
MISTAKES: dict[str, tuple[tuple[str, dict[str, Any]], list[str]]] = {
    "a world in capitals": (_look(world="W"), ["'W'", "e.g. 'w'"]),
    "a world that is not there": (_look(world="w2"), ["'w2'", "did you mean 'w'?", "edit_spec"]),
    "another word for the world": (("inspect_world", {"world_id": "w"}), ["'world_id'", "did you mean 'world'?"]),
    "no world": (("inspect_world", {"part": "matrix"}), ["needs world", "['w']"]),
    "a part in the plural": (_look(part="rows"), ["'rows'", "part='row' with its", "part='matrix'"]),
    "a row without its id": (_look(part="row"), ["needs row", "inspect_world(part='matrix')"]),
    "a world of clauses": (("edit_spec", {"world": "n", "prompt": PROMPT, "spec": {"clauses": {"c1": {"met_by": ["/entities/ball"]}}}}), ["version '1'", "claims='A [ball](thing ball)"]),
    "clauses added": (_patch({"op": "add", "path": "/clauses", "value": {"c1": {"unmet": "no time for it"}}}), ["a world of version 2 has claims instead"]),
    "back to version 1": (_patch({"op": "replace", "path": "/spec_version", "value": "1"}, {"op": "remove", "path": "/claims"}), ["can no longer be written", "claims='A [ball](thing ball)"]),
    "a row that is misspelt": (_look(part="row", row="audit:clams"), ["did you mean 'audit:claims'", "part='matrix'"]),
    "a pointer with dots": (_look(part="spec", pointer="entities.ball"), ["did you mean /entities?"]),
    "a pointer with a slip": (_look(part="spec", pointer="/entities/bal"), ["did you mean /entities/ball?", "'b1'"]),
    "frames that are not there": (_look(part="state", frames=[0, 99]), ["[0, 99]", "0..0", "probe_sim"]),
    "one name for a list": (_look(part="state", entities="ball"), ["'ball'", "brackets"]),
    "an entity in capitals": (_look(part="state", entities=["Ball"]), ["did you mean 'ball'?"]),
    "events before a probe": (_look(part="events"), ["probe_sim"]),
    "a type that is none": (_look(part="schema", pointer="Spheres"), ["did you mean Sphere"]),
    "a place that is none": (_look(part="schema", pointer="/entity"), ["/entity", "entities"]),
    "a guide without its folder": (_look(part="guide", pointer="predicates.md"), ["world-building/reference/predicates.md"]),
    "an offset past the end": (_look(part="matrix", offset=5000), ["5000", "offset is 0 to"]),
    "a word for a number": (_look(limit="lots"), ["'lots'", ">= 1 and <= 200"]),
    "baking before probing": (("bake_sim", {"world": "w"}), ["passing probe", "call probe_sim"]),
    "acceptance before baking": (("run_checks", {"world": "w", "scope": "acceptance"}), ["complete bake", "bake_sim"]),
    "checks of a probe that is not there": (("run_checks", {"world": "w", "scope": "probe"}), ["no probe", "call probe_sim"]),
    "checks of a bake that is not there": (("run_checks", {"world": "w", "scope": "full"}), ["no bake", "call bake_sim"]),
    "checks of everything": (("run_checks", {"world": "w", "scope": "all"}), ["'all'", "'full'", "'acceptance'"]),
    "checks without scope": (("run_checks", {"world": "w"}), ["scope is missing", "acceptance:"]),
    "a film before acceptance": (("render_shot", {"world": "w", "kind": "final"}), ["not accepted", "scope='acceptance'"]),
    "another word for a picture": (("render_shot", {"world": "w", "kind": "perspective"}), ["'perspective'", "'preview'"]),
    "a camera without a target": (("render_shot", {"world": "w", "camera": [0, 0, 1]}), ["3 items, it needs 6", "look_at"]),
    "a shot that is none": (("render_shot", {"world": "w", "shot": "onyl"}), ["did you mean 'only'?"]),
    "a frame below 0": (("render_shot", {"world": "w", "frame": -1}), ["-1", ">= 0"]),
    "a frame after the end": (("render_shot", {"world": "w", "frame": 9999}), ["9999", "0..0"]),
    "an entity with a slip": (("place_object", {"world": "w", "entity": "bal"}), ["did you mean 'ball'?"]),
    "a place without an entity": (("place_object", {"world": "w", "on": "shelf"}), ["need entity"]),
    "a place off the support": (("place_object", {"world": "w", "entity": "ball", "on": "shelf", "at": [9, 9]}), ["not above", "`at`"]),
    "a place in space": (("place_object", {"world": "w", "entity": "ball", "at": [0, 0, 1]}), ["3 items, it needs 2", "x, y"]),
    "a number with its unit": (("place_object", {"world": "w", "entity": "ball", "yaw_deg": "90 deg"}), ["'90 deg'", "number"]),
    "a job without its id": (("job", {"action": "wait"}), ["needs job_id", "job(action='list')"]),
    "a job that is none": (("job", {"action": "wait", "job_id": "job_1"}), ["'job_1'", "job(action='list')"]),
    "creating twice": (("edit_spec", {"world": "w", "prompt": PROMPT}), ["exists already", "patch"]),
    "a world with a title for its id": (("edit_spec", {"world": "My World!", "prompt": PROMPT}), ["e.g. 'my_world'"]),
    "a spec without a prompt": (("edit_spec", {"world": "n", "spec": {}}), ["prompt"]),
    "nothing to do": (("edit_spec", {"world": "w"}), ["give patch", "prompt"]),
    "an operation without brackets": (("edit_spec", {"world": "w", "patch": {"op": "remove", "path": "/x"}}), ["brackets"]),
    "an operation that is none": (_patch({"op": "set", "path": "/title", "value": "x"}), ["'set'", "replace"]),
    "a path without a slash": (_patch({"op": "replace", "path": "title", "value": "x"}), ["'title'", "'/entities/ball/pose'"]),
    "a path with a slip": (_patch({"op": "replace", "path": "/entities/bal/pose", "value": {}}), ["did you mean 'ball'?", "b1"]),
    "an operation without its value": (_patch({"op": "replace", "path": "/title"}), ["needs a value"]),
    "an easier prompt": (_patch({"op": "replace", "path": "/prompt", "value": "x"}), ["immutable"]),
    "a number out of range": (_patch({"op": "replace", "path": "/simulation/fps", "value": 2400}), ["2400", ">= 1 and <= 240"]),
    "a field with a slip": (
        _patch({"op": "add", "path": f"{BALL}/physics/mas", "value": 1}),
        [f"{BALL}/physics/mas:", "did you mean 'mass'?", "pointer='/entities/ball/physics'"],
    ),
    "a shape that is none": (_create(f"{BALL}/parts/body/shape", {"kind": "ball"}), ["'ball' is no kind of Shape", "sphere"]),
    "a predicate with a slip": (
        _create("/story/beats/roll/predicate", {"kind": "rest_on"}),
        ["no kind of Predicate", "did you mean 'rests_on'?"],
    ),
    "a number for an object": (_create(f"{BALL}/dimensions", 0.06), ["0.06", "Dimensions"]),
    "a field of another engine": (_create(f"{BALL}/pose", {"rotation": [0, 0, 90]}), ["'rotation'", "quaternion, euler"]),
    "text for a number": (_create("/simulation/fps", "24fps"), ["'24fps'", "integer"]),
    "an edit of an older revision": (
        ("edit_spec", {"world": "w", "expected_revision": 7, "patch": [{"op": "remove", "path": "/title"}]}),
        ["revision 1, not 7", "read it again"],
    ),
    "ground of a kind that is none": (("build_terrain", {"world": "w", "kind": "hill"}), ["did you mean 'hills'?"]),
    "ground of a material that is none": (("build_terrain", {"world": "w", "material": "grass"}), ["'grass'", "'stone'", "edit_spec"]),
    "a tool by half its name": (("probe", {"world": "w"}), ["did you mean 'probe_sim'?"]),
}  # fmt: skip


@pytest.fixture(scope="module")
def client(agent_of: Callable[[Path], Any], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """A client of a world that is placed and not yet probed."""
    with agent_of(tmp_path_factory.mktemp("mistakes")) as made:
        made.call("edit_spec", world="w", prompt=PROMPT, spec=small_spec())
        made.call("place_object", world="w")
        yield made


@pytest.mark.parametrize("name", MISTAKES)
def test_the_answer_to_a_mistake_says_how_to_mend_it(client: Any, name: str) -> None:
    (tool, arguments), words = MISTAKES[name]
    text = client.refused(tool, **arguments)
    for word in words:
        assert word in text
    assert len(text) < 1500
    assert str(client.workspace) not in text


def test_json_in_a_string_is_taken_for_what_it_says(client: Any) -> None:
    found = client.call("inspect_world", world="w", part="state", entities='["ball"]')
    assert list(found["entities"]) == ["ball"]


def test_names_of_the_schema_are_found_in_any_case(client: Any) -> None:
    assert client.call("inspect_world", part="schema", pointer="entity")["type"] == "Entity"
