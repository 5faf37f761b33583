"""Which failing rows one edit may answer at once: those of other bodies, and what is drawn beside what moves (R113)."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.workflow.arguments import Repair
from worldagent.workflow.joint_repairs import Joint, grouped, joint_objections
from worldagent.workflow.repair_rules import causal_groups
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import apply_patch, differences, parse_spec
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import WorldSpec

SPRING = {"kind": "spring", "child": "b3", "parent_point": [0, 0, 0], "child_point": [0.2, 0, 0.33], "stiffness": 0.5}
ROD = {"shape": {"kind": "box", "size": [0.3, 0.01, 0.01]}, "collides": False}
FASTER = {"op": "add", "path": "/entities/b3/physics/linear_velocity", "value": [0.1, 0, 0]}
FALL = ("beat:fall", "initial_state")
GONE = {"op": "remove", "path": "/simulation/joints/pull"}


def failing(row: str, *entities: str) -> Row:
    """A row that failed, as the ledger keeps it."""
    question = row if row.startswith("claim") else row.partition(":")[0]
    check: Any = row.partition(":")[0]
    return Row(id=row, question=question, check=check, group="temporal", predicate="p", status="fail", entities=entities)


ROWS = [failing("beat:fall", "b3"), failing("claim:unseen", "b3"), failing("beat:strike", "b3", "ball")]


def told(patch: list[dict[str, Any]], *repairs: tuple[str, str]) -> list[str]:
    """Objections to a patch of a world whose last block a spring pulls, of which there is a run without any contact."""
    document = small_spec()
    document["simulation"]["joints"] = {"pull": SPRING}
    spec = parse_spec({**document, "prompt": PROMPT})
    after = apply_patch(spec, patch)
    run = SimpleNamespace(spec=spec, last_frame=30, rigid_caches={}, caches={}, stage="probe")
    places = list(differences(_document(spec), _document(after)))
    asked = (Repair(row=r, group=g, expect="lower", hypothesis="it is so because") for r, g in repairs)
    joint = Joint(tuple(asked), cast("Candidate", run))
    return joint_objections(joint, ROWS, grouped(places, causal_groups(places)), {}, after)


def _document(spec: WorldSpec) -> dict[str, Any]:
    return spec.model_dump(mode="json")


def added(place: str, part: dict[str, Any]) -> dict[str, Any]:
    return {"op": "add", "path": place, "value": part}


@pytest.mark.parametrize(
    "drawn",
    [
        added("/entities/shelf/parts/rod", ROD),
        added("/entities/rod", {"role": "rod", "motion": "static", "material": "steel", "pose": {"position": [0, 0, 0.2]}, "dimensions": {"size": [0.3, 0.01, 0.01]}, "parts": {"body": ROD}}),
    ],
)  # fmt: skip
def test_what_is_drawn_is_mended_beside_a_motion_of_the_same_body(drawn: dict[str, Any]) -> None:
    assert told([FASTER, drawn], FALL, ("claim:unseen", "shape")) == []


def test_rows_of_two_motions_of_one_body_wait_for_each_other() -> None:
    (first, *_) = told([FASTER, GONE], FALL, ("beat:strike", "joints"))
    assert first.startswith("beat:fall and beat:strike are not independent: b3 had to do with both")


@pytest.mark.parametrize(
    ("change", "group"),
    [
        (GONE, "joints"),
        (added("/entities/shelf/parts/rod", {**ROD, "collides": True}), "shape"),
        (added("/entities/b3/parts/rod", ROD), "shape"),
        ({"op": "replace", "path": "/entities/b3/material", "value": "steel"}, "material"),
    ],
)
def test_what_answers_it_moves_nothing_that_another_row_is_about(change: dict[str, Any], group: str) -> None:
    found = told([FASTER, change], FALL, ("claim:unseen", group))
    assert any(f"the change of {group} may move" in line and "which beat:fall is about" in line for line in found), found
    assert not any("not independent" in line for line in found)
