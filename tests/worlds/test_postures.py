"""Words of an upright posture are judged by how a body is turned, and not by where it is (R131, R155)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.worlds.audits.test_bindings import BALL, BLOCK, ROLLS, said

LINE = "nothing that it names measures how it is turned"
TILTS: dict[str, Any] = {"kind": "tilts", "entity": "b3", "max": 0.2, "when": "end"}


def asked(predicate: dict[str, Any], *, never: bool = False) -> tuple[str, Any]:
    return "/story/requirements", {"up": {"text": "it stands", "predicate": predicate, "never": never}}


PLACED = {
    "place": f"A {BALL} {ROLLS} against a {BLOCK}, which [stands upright at the end](place /graph/relations/on_shelf_b3).",
    "property": f"A {BALL} {ROLLS} against a {BLOCK}, which [stays upright](property b3).",
    "event": f"A {BALL} {ROLLS} against a {BLOCK}, which [remains upright](event fall).",
    "German": "Eine [Kugel](thing ball) [rollt](event roll) gegen den [Klotz](thing b3), der [am Ende aufrecht steht](place /graph/relations/on_shelf_b3).",
    "French": "Une [bille](thing ball) [roule](event roll) sur le sol, et le [cube](thing b3) [reste debout](property b3).",
}


@pytest.mark.parametrize("name", PLACED)
def test_a_place_a_body_or_a_fall_does_not_say_that_it_stands(name: str) -> None:
    assert LINE in said(PLACED[name])


@pytest.mark.parametrize(
    ("predicate", "never", "right"),
    [
        (TILTS, False, True),
        ({**TILTS, "when": "always"}, False, True),
        ({"kind": "tilts", "entity": "b3", "min": 1.4, "when": "end"}, False, True),
        ({"kind": "topples", "entity": "b3"}, True, True),
        ({"kind": "tips", "entity": "b3"}, True, True),
        ({**TILTS, "max": 2.0}, False, False),
        ({**TILTS, "when": "eventually"}, False, False),
        ({"kind": "topples", "entity": "b3", "min_angle": 3.0}, True, False),
        ({"kind": "falls", "entity": "b3"}, True, False),
        ({"kind": "supported", "entity": "b3"}, False, False),
    ],
)
def test_what_measures_how_it_is_turned_does(predicate: dict[str, Any], *, never: bool, right: bool) -> None:
    kind = "negation" if never else "property"
    marked = f"A {BALL} {ROLLS} against a {BLOCK}, which [stays upright]({kind} up)."
    assert (LINE not in said(marked, asked(predicate, never=never))) is right


def test_it_is_the_posture_of_the_body_before_its_words() -> None:
    for predicate, right in ((TILTS, True), ({**TILTS, "entity": "ball"}, False)):
        marked = f"A {BALL} {ROLLS} on. A {BLOCK} [stands upright at the end](property up)."
        assert ("its words are about 'b3'" not in said(marked, asked(predicate))) is right


@pytest.mark.parametrize(
    "marked",
    [
        f"A {BALL} {ROLLS} against an [upright](property b3) {BLOCK}.",
        f"A {BALL} {ROLLS} against a {BLOCK} that [stands at the end](place /graph/relations/on_shelf_b3) of a shelf.",
        f"A {BALL} {ROLLS} past a [piano](thing b3).",
    ],
)
def test_descriptions_and_places_are_left_alone(marked: str) -> None:
    assert LINE not in said(marked)
