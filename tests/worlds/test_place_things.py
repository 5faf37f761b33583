"""A place is where the thing is that its noun says, and no other body that the prompt calls something else."""

from __future__ import annotations

import pytest
from worldagent.tests.worlds.audits.test_bindings import BALL, BLOCK, told
from worldagent.worlds.claims import reading_of


def lines(marked: str) -> str:
    return "".join(w for w in reading_of(told(marked)).warnings if "is judged against" in w)


@pytest.mark.parametrize("place", ["[Under a table](place b3)", "[Beside the old table](place b3)"])
def test_a_place_of_another_noun_than_its_body_is_told(place: str) -> None:
    said = lines(f"{place}, a {BALL} lies before a {BLOCK}.")
    assert "b3, which the prompt calls 'block', no 'table'" in said
    assert "give it a body of its own" in said


def test_a_place_that_is_another_body_than_the_thing_of_its_noun_is_told() -> None:
    said = lines(f"A [table](thing shelf) stands there. A {BALL} lies [on the table](place b3) before a {BLOCK}.")
    assert "claims of things call shelf so: name that one" in said


@pytest.mark.parametrize(
    "marked",
    [
        f"A {BALL} lies [beside a block](place b3), the last {BLOCK}.",
        f"A {BALL} and two {BLOCK.replace('block', 'blocks')} lie [on the shelf](place shelf).",
        f"A [shelf](thing shelf) holds a {BALL} and a {BLOCK}, [on top of it](place shelf).",
        f"Ein {BALL} liegt [unter dem Tisch](place b3), vor dem {BLOCK}.",
    ],
)
def test_honest_places_and_those_of_other_languages_are_not_told(marked: str) -> None:
    assert lines(marked) == ""
