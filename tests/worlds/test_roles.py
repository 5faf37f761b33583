"""Who does it to whom: worlds that turn the words around are refused or warned of, honest ones are neither (R131, R155)."""

from __future__ import annotations

import re
from typing import Any

import pytest
from worldagent.tests.stories.small_run import small_spec
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.claim_marks import claim_operations
from worldagent.worlds.claims import reading_of
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.predicates import Contact
from worldagent.worlds.spec import WorldSpec

BALL, BLOCK, SHELF = "[ball](thing ball)", "[block](thing b3)", "[shelf](thing shelf)"


def world(marked: str, *, doer: str = "ball", other: str = "b3", never: bool = False) -> WorldSpec:
    spec: dict[str, Any] = small_spec()
    hits = {"kind": "hits", "entity": doer, "other": other}
    spec["story"]["beats"]["fall"]["predicate"] = hits
    if never:
        spec["story"]["requirements"] = {"no": {"text": "it never hits", "predicate": hits, "never": True}}
    prompt = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", marked)
    made = parse_spec({**spec, "claims": {}, "spec_version": "2", "prompt": prompt})
    return apply_patch(made, claim_operations(marked, made))


def refused(spec: WorldSpec) -> list[str]:
    return [p.text for p in claim_problems(spec) if "say the reverse" in p.text or "stands behind it is" in p.text]


def warned(spec: WorldSpec) -> list[str]:
    return [w for w in reading_of(spec).warnings if "say the reverse" in w or "stands behind it is" in w]


HITS = "[hits](event fall)"
HONEST = {
    "active": f"A {BALL} rolls off a {SHELF} and {HITS} a {BLOCK}.",
    "into": f"A {BALL} [slams into](event fall) a {BLOCK}.",
    "passive": f"A {BLOCK} is [hit](event fall) by a {BALL}.",
    "passive in the span": f"A {BLOCK} [is hit by](event fall) a {BALL}.",
    "inverted": f"Into the {BLOCK} [crashes](event fall) a {BALL}.",
    "another clause": f"A {BLOCK} is [hit](event fall) when the {BALL} comes.",
    "pronoun": f"A {BLOCK} waits until the {BALL} comes and {HITS} it on the {SHELF}.",
    "German object first": f"Gegen den {BLOCK} auf dem Boden [stößt](event fall) dann und mit Wucht von rechts ein {BALL}.",
    "German": f"Die {BALL} rollt und [trifft](event fall) einen {BLOCK} auf dem Boden.",
}


@pytest.mark.parametrize("name", list(HONEST))
def test_honest_words_are_not_refused(name: str) -> None:
    assert refused(world(HONEST[name])) == []


@pytest.mark.parametrize("name", ["active", "into", "inverted", "passive", "passive in the span", "another clause", "German"])
def test_plain_honest_words_are_not_warned_of_either(name: str) -> None:
    assert warned(world(HONEST[name])) == []


def test_what_stands_before_an_inverted_clause_is_what_is_hit() -> None:
    assert warned(world(HONEST["inverted"], doer="b3", other="ball"))


@pytest.mark.parametrize("name", ["active", "into", "passive"])
def test_the_reverse_of_the_words_is_refused(name: str) -> None:
    assert "its words say the reverse" in refused(world(HONEST[name], doer="b3", other="ball"))[0]


def test_the_reverse_in_a_language_without_lexicon_is_a_warning() -> None:
    spec = world(HONEST["German"], doer="b3", other="ball")
    assert refused(spec) == []
    assert "its words say the reverse" in warned(spec)[0]


def test_what_stands_beside_what_is_hit_is_not_hit() -> None:
    marked = f"A {BALL} {HITS} a {BLOCK} beside a [cube](thing b2)."
    assert refused(world(marked)) == []
    assert "what stands behind it is b3" in refused(world(marked, other="b2"))[0]


def test_a_negation_denies_what_its_own_words_say() -> None:
    marked = f"A {BALL} [rolls](event roll) on a {SHELF} and [never hits](negation no) a {BLOCK}."
    assert refused(world(marked, never=True)) == []
    assert "its words say the reverse" in refused(world(marked, doer="b3", other="ball", never=True))[0]
    assert any("not the reverse" in w for w in reading_of(world(marked, never=True)).warnings)


def test_a_touch_of_the_two_that_stand_before_is_told_with_their_names() -> None:
    """The ball and the shelf stand before the words, the block behind them: the warning names whom the touch is judged of."""
    spec = world(f"A {BALL} on a {SHELF} [falls into](event fall) a {BLOCK}.")
    touched = spec.story.beats["fall"].model_copy(update={"predicate": Contact(a="ball", b="shelf")})
    story = spec.story.model_copy(update={"beats": {**spec.story.beats, "fall": touched}})
    told = warned(spec.model_copy(update={"story": story}))
    assert "is judged by a touch of ball, shelf, and what stands behind it is b3" in told[0]
    assert warned(spec) == []
