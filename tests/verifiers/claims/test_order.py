"""Claims of order: the order that is told holds, and the reverse and simultaneity are found where they are the truth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.verifiers.claims.claimed import rows
from worldagent.verifiers.claims.bounds import AT_ONCE, ORDER_SEEN

HITS = {"kind": "hits", "entity": "hitter", "other": "box"}
SLIDES = {"kind": "slides", "entity": "box", "other": "floor"}
FALLS, LANDS = {"kind": "falls", "entity": "ball"}, {"kind": "lands", "entity": "ball"}
SPINS = {"kind": "spins", "entity": "box"}


def ordered(folder: Path, world: str, first: Any, second: Any, **more: Any) -> Any:
    beats = {"a": (first["entity"], first), "b": (second["entity"], second)}
    claims = {"then": {"quote": "then", "type": "order", "by": ["/story/beats/a", "/story/beats/b"]}}
    return rows(folder, world, claims, beats={**beats, **more})["then"]


@pytest.mark.parametrize(("world", "first", "second"), [("hit", HITS, SLIDES), ("drop", FALLS, LANDS)])
def test_an_order_holds_one_way_round_alone(world: str, first: Any, second: Any, tmp_path: Path) -> None:
    row = ordered(tmp_path / "told", world, first, second)
    assert (row.status, row.unit) == ("pass", "s"), row.evidence
    assert row.measured is not None
    assert row.measured >= 1 / 24 > ORDER_SEEN
    turned = ordered(tmp_path / "turned", world, second, first)
    assert turned.status == "fail"
    assert "b before a is what is true" in turned.evidence["true_rivals"][0]


def test_two_events_at_once_are_in_no_order(tmp_path: Path) -> None:
    row = ordered(tmp_path, "drop", FALLS, FALLS)
    assert (row.status, row.measured) == ("fail", 0.0)
    assert "both at once" in row.evidence["true_rivals"][0]


def test_what_comes_at_the_same_time_begins_together_and_a_second_apart_fails(tmp_path: Path) -> None:
    """A drop and its landing are half a second apart; a slide and its slowing begin at once."""

    def once(folder: str, world: str, first: Any, second: Any) -> Any:
        beats = {"a": (first["entity"], first), "b": (second["entity"], second)}
        thing = {"quote": "a ball", "type": "thing", "by": [f"/entities/{first['entity']}"]}
        claims = {"c": {"quote": "At the same time", "type": "order", "by": ["/story/beats/a", "/story/beats/b"]}, "thing": thing}
        return rows(tmp_path / folder, world, claims, beats=beats, prompt="At the same time, a ball and the other begin.")["c"]

    apart = once("apart", "drop", FALLS, LANDS)
    assert (apart.status, apart.comparison) == ("fail", "<="), apart.evidence
    assert apart.measured is not None
    assert apart.measured > AT_ONCE + 1 / 24
    for folder, second in (("at once", {"kind": "slows", "entity": "box"}), ("turned", SLIDES)):
        row = once(folder, "slide", {"kind": "slides", "entity": "box"}, second)
        assert row.status == "pass", row.evidence
        assert row.measured == 0.0


def test_an_event_that_begins_with_another_does_not_come_after_it(tmp_path: Path) -> None:
    # It slides from frame 0 on and slows all the while: half of its speed is gone later than half of its size is gone by.
    slides, slows = {"kind": "slides", "entity": "box"}, {"kind": "slows", "entity": "box"}
    row = ordered(tmp_path / "at once", "slide", slides, slows)
    assert row.status == "fail"
    assert "both begin at once" in row.evidence["true_rivals"][0]
    caused = {"b": {"subject": "box", "predicate": slows, "causes": ["a"]}}
    assert ordered(tmp_path / "caused", "slide", slides, slows, **caused).status == "pass"


def test_what_was_true_before_did_not_come_after(tmp_path: Path) -> None:
    moves = {"kind": "speed", "entity": "box", "min": 0.5}
    stops = {"kind": "stops", "entity": "box"}
    row = ordered(tmp_path, "slide", {"kind": "slides", "entity": "box"}, moves, b={"subject": "box", "predicate": moves, "frames": [5, 35]})  # fmt: skip
    assert row.status == "fail"
    assert "is true as well" in row.evidence["true_rivals"][0]
    assert ordered(tmp_path / "honest", "slide", moves, stops).status == "pass"


def test_a_state_that_ends_and_comes_back_came_after(tmp_path: Path) -> None:
    # It touches the floor, leaves it and touches it again.
    touches = {"kind": "contact", "a": "box", "b": "floor"}
    jumps = {"kind": "jumps", "entity": "box"}
    beats = {"b": {"subject": "box", "predicate": touches, "frames": [13, 35]}}
    row = ordered(tmp_path, "jump", jumps, {**touches, "entity": "box"}, **beats)
    assert row.status == "pass", row.evidence


def inside(folder: Path, world: str, predicate: Any, subject: str, beats: dict[str, Any] | None = None, **beat: Any) -> Any:
    """The row of an order that stands in one requirement."""
    claims = {"then": {"quote": "then", "type": "order", "by": ["/story/requirements/r"]}}
    return rows(folder, world, claims, beats=beats, requirements={"r": {"predicate": predicate, **beat}})["then"]


BEFORE = {"kind": "before", "beat": "b", "predicate": HITS}
AFTER = {"kind": "after", "beat": "a", "predicate": SLIDES}
WITHIN = {"kind": "within", "beat": "a", "frames": 20, "predicate": SLIDES}


@pytest.mark.parametrize("predicate", [BEFORE, AFTER, WITHIN], ids=["before", "after", "within"])
def test_an_order_inside_a_predicate_is_judged(predicate: Any, tmp_path: Path) -> None:
    beats = {"a": ("hitter", HITS), "b": ("box", SLIDES)}
    row = inside(tmp_path / "told", "hit", predicate, "box", beats)
    assert row.status == "pass", row.evidence
    turned = {"a": ("box", SLIDES), "b": ("hitter", HITS)}
    other = {**predicate, "predicate": SLIDES if predicate is BEFORE else HITS}
    assert inside(tmp_path / "turned", "hit", other, "box", turned).status == "fail"


def test_within_does_not_mean_at_once(tmp_path: Path) -> None:
    at_once = {"kind": "within", "beat": "a", "frames": 5, "predicate": FALLS}
    row = inside(tmp_path, "drop", at_once, "ball", {"a": ("ball", FALLS)})
    assert row.status == "fail"
    assert "both at once" in row.evidence["true_rivals"][0]


def test_until_ends_with_its_goal(tmp_path: Path) -> None:
    rests = {"kind": "speed", "entity": "box", "max": 0.01}
    lasting = {"kind": "until", "hold": {**rests, "max": 100.0}, "goal": HITS}
    honest = {"kind": "until", "hold": rests, "goal": SLIDES}
    row = inside(tmp_path / "lasting", "hit", lasting, "box")
    assert row.status == "fail"
    assert "holds throughout" in row.evidence["true_rivals"][0]
    goal = {"kind": "speed", "entity": "box", "min": 0.011}
    assert inside(tmp_path / "honest", "hit", {**honest, "goal": goal}, "box").status == "pass"
    assert inside(tmp_path / "at once", "hit", {**honest, "hold": goal, "goal": rests}, "box").status == "fail"
