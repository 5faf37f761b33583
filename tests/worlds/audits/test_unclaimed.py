"""Bodies that no claim speaks of satisfy nothing: neither events, nor counts of them, nor what is denied (R156)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.stories.small_run import MARKED, small_spec
from worldagent.tests.worlds.test_by_claim import Edit, at, world
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.audits.unclaimed import unclaimed_problems
from worldagent.worlds.spec import WorldSpec

CRATE = small_spec()["entities"]["b1"] | {"pose": {"position": [2.0, 0, 0.1]}}
HITS = {"kind": "hits", "entity": "ball", "other": "crate"}
FALL = {"kind": "falls", "entity": "each"}


def with_crate(pointer: str, value: Any, *, motion: str = "dynamic", marked: str = MARKED) -> WorldSpec:
    """The small world with a crate, of which something else is told than of its blocks."""

    def edit(spec: dict[str, Any]) -> None:
        at("/entities/crate", CRATE | {"motion": motion})(spec)
        at(pointer, value)(spec)

    made: Edit = edit
    return world(made, marked=marked)


def told(spec: WorldSpec) -> list[str]:
    return [f"{p.pointer} {p.text}" for p in unclaimed_problems(spec)]


@pytest.mark.parametrize("motion", ["dynamic", "static"])
def test_an_event_that_a_body_without_a_claim_makes_true_is_an_error(motion: str) -> None:
    spec = with_crate("/story/beats/roll/predicate", HITS, motion=motion)
    (line,) = told(spec)
    assert line.startswith(
        "/claims/rolls/by 'rolls' is judged by beat 'roll', which is told of 'crate', a body that no claim names"
    )
    assert line in [f"{p.pointer} {p.text}" for p in claim_problems(spec)]
    assert told(with_crate("/story/beats/roll/predicate", HITS | {"other": "b1"}, motion=motion)) == []


def test_a_count_is_not_met_by_bodies_without_a_claim() -> None:
    of = {"kind": "count", "entities": ["b1", "b3", "crate"], "min": 2, "predicate": FALL}
    (line,) = told(with_crate("/story/beats/fall/predicate", of))
    assert "'fall', which is told of 'crate'" in line
    assert told(with_crate("/story/beats/fall/predicate", of | {"entities": ["b1", "b3"]})) == []


def test_still_ground_needs_no_word_where_a_body_only_touches_it_and_one_where_it_is_denied() -> None:
    lands = {"kind": "lands", "entity": "b3", "other": "floor"}
    assert told(with_crate("/story/beats/fall/predicate", lands)) == []
    never = {"text": "it stays off", "predicate": {"kind": "contact", "a": "b1", "b": "crate"}, "never": True}
    denied = MARKED.replace(" into ", " [into](negation stays_off) ")
    for motion in ("dynamic", "static"):
        (line,) = told(with_crate("/story/requirements/stays_off", never, motion=motion, marked=denied))
        assert line.startswith("/claims/into/by 'into' is judged by requirement 'stays_off', which is told of 'crate'")


def test_a_body_that_a_joint_ties_to_a_claimed_one_belongs_to_it() -> None:
    spec = with_crate("/story/beats/roll/predicate", HITS)
    arm = {"kind": "hinge", "parent": "b1", "child": "crate", "anchor": [1, 1, 0], "axis": [0, 0, 1]}
    joined = spec.model_dump(mode="json", exclude_none=True)
    joined["simulation"]["joints"] = {"arm": arm}
    assert told(WorldSpec.model_validate(joined)) == []
