"""Negations of motion as such are judged by how far or how fast a body goes, not by one kind of motion (R131, R155)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.worlds.audits.test_bindings import BALL, BLOCK, ROLLS, said, told
from worldagent.worlds.claims import prompt_record, reading_of

LINE = "that it does not move"
NEVER_ROLLS: dict[str, Any] = {"kind": "rolls", "entity": "b3"}
STAYS: dict[str, Any] = {"kind": "displacement", "entity": "b3", "min": 0.003}


def never(predicate: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    return "/story/requirements", {"stays": {"text": "it never does", "predicate": predicate, "never": True}}


def marked(words: str, rest: str = "") -> str:
    return f"A {BALL} {ROLLS}. The {BLOCK} [{words}](negation stays){rest}."


WORDS = [
    "does not move",
    "doesn't budge",
    "never moves at all",
    "does not shift",
    "stays still",
    "remains where it is",
    "stays put",
]


@pytest.mark.parametrize("words", WORDS)
def test_what_does_not_move_may_not_slide_either(words: str) -> None:
    assert LINE in said(marked(words), never(NEVER_ROLLS))
    assert LINE not in said(marked(words), never(STAYS))
    assert words not in prompt_record(told(marked(words), never(STAYS)))["readings"]


@pytest.mark.parametrize(
    ("predicate", "right"),
    [
        ({"kind": "speed", "entity": "b3", "min": 0.05}, True),
        ({"kind": "or", "of": [NEVER_ROLLS, STAYS]}, True),
        ({"kind": "count", "entities": ["b2", "b3"], "min": 1, "predicate": {**STAYS, "entity": "each"}}, True),
        ({**STAYS, "min": 0.19}, False),
        ({**STAYS, "axis": [0, 1, 0]}, False),
        ({"kind": "and", "of": [NEVER_ROLLS, STAYS]}, False),
        ({"kind": "falls", "entity": "b3"}, False),
        ({"kind": "speed", "entity": "b3", "min": 2.0}, False),
    ],
)
def test_bounds_on_all_motion_are_what_rest_means(predicate: dict[str, Any], *, right: bool) -> None:
    assert (LINE not in said(marked("does not move"), never(predicate))) is right


@pytest.mark.parametrize("rest", [" far", " on to the edge", " more than a little", " away from the shelf"])
def test_verbs_of_motion_with_a_way_behind_them_are_read_by_the_agent(rest: str) -> None:
    crossing = {"kind": "crosses", "entity": "b3", "point": [1, 0, 0], "normal": [1, 0, 0]}
    assert LINE not in said(marked("does not move", rest), never(crossing))
    assert LINE not in "".join(reading_of(told(marked("does not move", rest), never(crossing))).warnings)


def test_where_the_rule_cannot_be_sure_the_verdict_warns() -> None:
    """A rest until something happens is no rest throughout; of other languages one verb is known, and not all that may follow it."""
    german = "Eine [Kugel](thing ball) [rollt](event roll) in das Regal. Der [Klotz](thing b3) {0}."
    texts = [
        f"A {BALL} {ROLLS}. The {BLOCK} [does not move](negation stays) until it is hit.",
        german.format("[bewegt sich nicht](negation stays)"),
    ]
    for text in texts:
        assert LINE not in said(text, never(NEVER_ROLLS))
        assert LINE in "".join(reading_of(told(text, never(NEVER_ROLLS))).warnings)
        assert LINE not in "".join(reading_of(told(text, never(STAYS))).warnings)


def test_rest_that_is_claimed_as_a_place_is_warned_of_where_nothing_bounds_the_motion() -> None:
    text = f"A {BALL} {ROLLS}. The {BLOCK} [stays in place](%s)."
    kept = (
        "/story/requirements",
        {"stays": {"text": "it stays", "predicate": {**STAYS, "min": None, "max": 0.003, "when": "always"}}},
    )
    for by, given, right in (
        ("place /graph/relations/on_shelf_b3", kept, False),
        ("property stays", kept, True),
        ("property b3", kept, False),
    ):
        assert (LINE not in "".join(reading_of(told(text % by, given)).warnings)) is right
    assert LINE not in "".join(reading_of(told(text % "negation stays", never(STAYS))).warnings)
