"""Joints and drivers whose change makes something that is asked of their bodies easier are weakenings; repairs are none (R157)."""

from __future__ import annotations

import math
from typing import Any

import pytest
from worldagent.tests.worlds.test_bound_fields import base, edited
from worldagent.worlds.patch import apply_patch, weakenings
from worldagent.worlds.spec import WorldSpec

STAYS: dict[str, Any] = {
    "text": "it stays",
    "predicate": {"kind": "displacement", "entity": "lamp", "max": 0.1, "when": "always"},
}
FALLS = {"text": "it falls", "predicate": {"kind": "falls", "entity": "lamp"}}
NEVER = {"text": "it never falls", "predicate": {"kind": "not", "predicate": {"kind": "falls", "entity": "lamp"}}}
WELD: dict[str, Any] = {"kind": "weld", "parent": "crate", "child": "lamp", "anchor": [1, 1, 0]}
WIND = {"kind": "field", "end": 1.0, "field": {"kind": "wind", "velocity": [8.0, 0.0, 0.0]}}
PUSH = {"kind": "force", "entity": "lamp", "force": [3.0, 0.0, 0.0], "end": 1.0}


def asking(item: dict[str, Any]) -> WorldSpec:
    spec = edited(base(), "/story/requirements/asked", item)
    return edited(edited(spec, "/simulation/drivers/wind", WIND), "/simulation/drivers/push", PUSH)


def told(item: dict[str, Any], *operations: dict[str, Any]) -> list[str]:
    before = asking(item)
    return [line for line in weakenings(before, apply_patch(before, list(operations))) if "easier to meet" in line]


def put(path: str, value: Any) -> dict[str, Any]:
    return {"op": "add", "path": path, "value": value}


def gone(path: str) -> dict[str, Any]:
    return {"op": "remove", "path": path}


HELPS_WHAT_STAYS = (
    put("/simulation/joints/hold", WELD),
    put("/simulation/joints/hold", {**WELD, "parent": None}),
    put("/simulation/joints/arm", WELD),
    put("/simulation/joints/arm/range", [-0.1, 0.1]),
    gone("/simulation/drivers/wind"),
    gone("/simulation/drivers/push"),
    put("/simulation/drivers/wind/field/velocity", [2.0, 0.0, 0.0]),
    put("/simulation/drivers/wind/entities", ["crate"]),
    put("/simulation/drivers/push/force", [1.0, 0.0, 0.0]),
    put("/simulation/drivers/push/end", 0.2),
)


@pytest.mark.parametrize("operation", HELPS_WHAT_STAYS, ids=lambda o: o["op"] + o["path"])
def test_what_holds_a_body_or_spares_it_helps_what_is_to_stay_and_not_what_is_to_happen(operation: dict[str, Any]) -> None:
    for item in (STAYS, NEVER):
        (line,) = told(item, operation)
        assert line.startswith("/".join(operation["path"].split("/")[:4]))
        assert line.endswith("by which requirement 'asked' may be easier to meet")
    assert told(FALLS, operation) == []


@pytest.mark.parametrize(
    "operation",
    [
        gone("/simulation/joints/arm"),
        put("/simulation/joints/arm", {**WELD, "kind": "hinge", "axis": [1, 0, 0], "friction": 0.2}),
    ],
    ids=["removed", "another axis"],
)
def test_a_joint_that_lets_go_helps_what_is_to_happen(operation: dict[str, Any]) -> None:
    (line,) = told(FALLS, operation)
    assert "/simulation/joints/arm (hinge of crate and lamp)" in line


REPAIRS = (
    put("/simulation/joints/arm/anchor", [1, 1, 0.1]),
    put("/simulation/joints/arm/damping", 0.5),
    put("/simulation/drivers/wind/field/velocity", [0.0, 9.0, 0.0]),
    put("/simulation/drivers/push/force", [5.0, 0.0, 0.0]),
    put("/simulation/drivers/pull", PUSH),
)


@pytest.mark.parametrize("item", [STAYS, FALLS], ids=["stays", "falls"])
@pytest.mark.parametrize("operation", REPAIRS, ids=lambda o: o["path"])
def test_another_place_or_a_stronger_push_is_a_repair(item: dict[str, Any], operation: dict[str, Any]) -> None:
    assert told(item, operation) == []


def test_another_name_or_a_body_that_nothing_asks_about_is_no_weakening() -> None:
    arm = asking(STAYS).model_dump()["simulation"]["joints"]["arm"]
    assert told(STAYS, gone("/simulation/joints/arm"), put("/simulation/joints/elbow", arm)) == []
    crate = {**STAYS, "predicate": {**STAYS["predicate"], "entity": "shelf"}}
    assert told(crate, put("/simulation/joints/hold", WELD)) == []


def test_a_push_that_owns_a_beat_may_be_tuned() -> None:
    before = edited(asking(STAYS), "/story/beats/pushed", {**FALLS, "owner": "push", "subject": "lamp", "frames": [0, 9]})
    weaker = apply_patch(before, [put("/simulation/drivers/push/force", [1.0, 0.0, 0.0])])
    assert not [line for line in weakenings(before, weaker) if "easier to meet" in line]
    calmer = apply_patch(before, [put("/simulation/drivers/wind/field/velocity", [1.0, 0.0, 0.0])])
    assert [line for line in weakenings(before, calmer) if "easier to meet" in line]


def test_a_joint_that_turns_with_its_bodies_is_the_same() -> None:
    """A quarter turn about the vertical of both bodies of a level hinge, with and without its axis."""
    level = put("/simulation/joints/arm/axis", [1, 0, 0])
    quarter = [put(f"/entities/{n}/pose/euler", [0, 0, math.pi / 2]) for n in ("crate", "lamp")]
    before = apply_patch(asking(STAYS), [level])
    along = apply_patch(before, [*quarter, put("/simulation/joints/arm/axis", [0, 1, 0])])
    assert not [line for line in weakenings(before, along) if "easier to meet" in line]
    left = apply_patch(before, quarter)
    assert [
        line for line in weakenings(before, apply_patch(before, [put("/simulation/joints/arm/axis", [0, 1, 0])])) if "arm" in line
    ]
    assert not [line for line in weakenings(before, left) if "arm" in line], "the joint is as written; its bodies turned"
