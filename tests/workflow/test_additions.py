"""Edits that only build on, against those that change what was there."""

from __future__ import annotations

import copy
from typing import Any

import pytest
from worldagent.tests.stories.yard import PROMPT, yard_spec
from worldagent.workflow.additions import only_builds_on

BEFORE: dict[str, Any] = {**yard_spec(), "prompt": PROMPT}


def with_lamp() -> dict[str, Any]:
    """The yard with a lamp on its table."""
    after = copy.deepcopy(BEFORE)
    after["entities"]["lamp"] = copy.deepcopy(after["entities"]["stone"])
    after["materials"]["brass"] = {"density": 8500}
    after["simulation"]["solvers"]["rigid"]["members"].append("lamp")
    after["graph"]["relations"]["lamp_stands"] = {"kind": "supports", "a": "table", "b": "lamp"}
    after["simulation"]["joints"]["lamp_arm"] = {"kind": "weld", "child": "lamp"}
    return after


def test_a_new_entity_with_what_belongs_to_it_only_builds_on() -> None:
    assert only_builds_on(BEFORE, with_lamp())


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("entities", "stone", "pose", "position"), [0, 0, 5]),
        (("materials", "oak", "friction"), 0.9),
        (("graph", "relations", "held"), {"kind": "supports", "a": "table", "b": "stone"}),
        (("simulation", "joints", "held"), {"kind": "weld", "child": "stone"}),
        (("simulation", "solvers", "rigid", "settings", "skin"), 0.001),
        (("simulation", "frames"), 50),
        (("story", "beats", "more"), {"subject": "lamp"}),
    ],
)
def test_anything_else_beside_it_is_a_change(path: tuple[str, ...], value: Any) -> None:
    after = with_lamp()
    at = after
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    assert not only_builds_on(BEFORE, after)


@pytest.mark.parametrize(
    "path", [("entities", "stone"), ("graph", "relations", "carries"), ("simulation", "drivers", "drive_bl"), ("story",)]
)
def test_what_takes_something_away_is_a_change(path: tuple[str, ...]) -> None:
    after = with_lamp()
    at = after
    for key in path[:-1]:
        at = at[key]
    del at[path[-1]]
    assert not only_builds_on(BEFORE, after)


def test_without_a_new_entity_nothing_is_built() -> None:
    assert not only_builds_on(BEFORE, copy.deepcopy(BEFORE))
