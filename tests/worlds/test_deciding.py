"""Words that decide what a sentence says, and that nothing judges, stand in the verdict; where something judges them they do not (R2, R155)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.worlds.audits.test_bindings import BALL, BLOCK, FALLS, ROLLS, told
from worldagent.worlds.claims import reading_of

HITS = "[hits](event strike)"
ALONG = {"kind": "displacement", "entity": "ball", "axis": [1, 0, 0], "min": 0.1}
CLOSE = {**ALONG, "max": 0.105}
KUGEL, KLOTZ, ROLLT = "[Kugel](thing ball)", "[Klotz](thing b3)", "[rollt](event roll)"


def lines(marked: str, predicate: dict[str, Any] | None = None) -> str:
    way = {"way": {"text": "it goes", "predicate": predicate or ALONG}}
    return "\n".join(
        w
        for w in reading_of(told(marked, ("/story/requirements", way))).warnings
        if any(t in w for t in (" is filler", "is part of", "takes it up: mark", "items of a list"))
    )


OPEN: dict[str, tuple[str, str]] = {
    "nearly": (f"A {BALL} nearly {HITS} a {BLOCK}.", "'nearly' is filler beside 'hits'"),
    "nearly, inside": (f"A {BALL} [almost hits](event strike) a {BLOCK}.", "'almost' is part of 'almost hits'"),
    "another": (f"A {BLOCK} {FALLS}. Another {BALL} {ROLLS}.", "'Another' is filler beside 'ball'"),
    "every": (f"A {BALL} {HITS} every {BLOCK}.", "'every' is filler beside 'block'"),
    "all the": (f"A {BALL} {HITS} all the [blocks](thing b1 b2 b3).", "'all' is filler beside 'blocks'"),
    "only": (f"Only the [red](property b3) {BALL} {ROLLS}.", "'Only' is filler beside 'ball'"),
    "having": (f"Having {HITS} a {BLOCK}, the {BALL} {ROLLS}.", "'Having' is filler beside 'hits'"),
    "exactly": (f"A {BALL} {ROLLS} exactly [10 cm](quantity /story/requirements/way/predicate/min).", "'exactly' is filler beside '10 cm'"),
    "exactly, inside": (f"A {BALL} {ROLLS} [exactly 10 cm](quantity /story/requirements/way/predicate/min).", "'exactly' is part of"),
    "left": (f"A {BALL} {ROLLS} to the left and {HITS} a {BLOCK}.", "'to the left' is filler beside 'rolls'"),
    "left, inside": (f"A {BALL} [rolls to the left](event roll) and {HITS} a {BLOCK}.", "'to the left' is part of"),
    "north": (f"A {BALL} {ROLLS} over the floor northwards.", "'northwards' is filler beside 'rolls'"),
    "rain": (f"In heavy rain a {BALL} {ROLLS}.", "'rain' is weather"),
    "night": (f"A {BALL} {ROLLS} at night.", "'at night' is a time of day"),
    "a list": (f"1. A {BALL} {ROLLS}. 2. A {BLOCK} {FALLS}.", "2 numbers mark the items of a list"),
    "beinahe": (f"Eine {KUGEL} {ROLLT} und beinahe [fällt](event fall) ein {KLOTZ} vom Regal.", "'beinahe' is filler beside 'fällt'"),
    "jeder": (f"Eine {KUGEL} {ROLLT} auf dem Regal und jeder {KLOTZ} [fällt](event fall) auf den Boden.", "'jeder' is filler beside 'Klotz'"),
    "nur": (f"Nur die {KUGEL} {ROLLT} auf dem Regal, und der {KLOTZ} [fällt](event fall).", "'Nur' is filler beside 'Kugel'"),
    "nach links": (f"Eine {KUGEL} {ROLLT} nach links, und der {KLOTZ} [fällt](event fall) auf den Boden.", "'nach links' is filler beside 'rollt'"),
    "nachts": (f"Eine {KUGEL} {ROLLT} nachts im Regen auf dem Regal gegen den {KLOTZ}.", "'nachts' is a time of day"),
}  # fmt: skip


@pytest.mark.parametrize("name", OPEN)
def test_a_word_that_decides_and_is_not_judged_is_named_with_what_it_takes(name: str) -> None:
    marked, line = OPEN[name]
    assert line in lines(marked)


HONEST: dict[str, tuple[str, dict[str, Any] | None]] = {
    "nearly, denied": (f"A {BALL} [nearly hits](negation /story/requirements/way) a {BLOCK}.", None),
    "another beside one": (f"A {BALL} {ROLLS} into a [block](thing b1) and another {BLOCK} {FALLS}.", None),
    "a list in order": (f"[1](order roll fall). A {BALL} {ROLLS}. [2](order same_as=1). A {BLOCK} {FALLS}.", None),
    "another, alone": (f"A [block](thing b1) {FALLS} onto [another](thing b3).", None),
    "having a handle, twice": (f"A {BLOCK} having a handle {FALLS} and a {BALL} {ROLLS}.", None),
    "every, counted": (f"A {BALL} {HITS} [every](count b1 b2 b3) [block](thing b1 b2 b3).", None),
    "not at all": (f"A {BALL} {ROLLS} at all times past a {BLOCK}.", None),
    "all the way": (f"A {BALL} {ROLLS} all the way to a {BLOCK}.", None),
    "not only": (f"Not only the {BALL} {ROLLS}, a {BLOCK} {FALLS} too.", None),
    "having a handle": (f"A {BLOCK} having a handle {FALLS}.", None),
    "exactly, between two bounds": (f"A {BALL} {ROLLS} exactly [10 cm](quantity /story/requirements/way/predicate/min).", CLOSE),
    "exactly, a size": (f"A {BALL} {HITS} a {BLOCK} exactly [5 cm](quantity /entities/b3/dimensions/size/2) tall.", None),
    "left, along an axis": (f"A {BALL} {ROLLS} [to the left](route /story/requirements/way) and {HITS} a {BLOCK}.", None),
    "the left one": (f"A {BALL} {ROLLS} into the left {BLOCK}.", None),
    "links": (f"Eine {KUGEL} {ROLLT} [nach links](route /story/requirements/way), und der linke {KLOTZ} [fällt](event fall).", None),
}  # fmt: skip


@pytest.mark.parametrize("name", HONEST)
def test_the_same_words_where_they_are_judged_or_say_something_else_are_not_named(name: str) -> None:
    assert lines(*HONEST[name]) == ""
