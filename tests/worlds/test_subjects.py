"""Events and negations are told of the body that their words are about; honest worlds are not refused (R131, R155)."""

from __future__ import annotations

import re
from typing import Any

import pytest
from worldagent.tests.stories.small_run import small_spec
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.claim_marks import claim_operations
from worldagent.worlds.claims import reading_of
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.spec import WorldSpec

BALL, BLOCK, OTHER = "[ball](thing ball)", "[block](thing b3)", "[tower](thing b2)"
BEATS: dict[str, dict[str, Any]] = {
    "block_tips": {"kind": "topples", "entity": "b3"},
    "ball_rolls": {"kind": "rolls", "entity": "ball"},
    "block_rolls": {"kind": "rolls", "entity": "b3"},
    "hit": {"kind": "hits", "entity": "ball", "other": "b3"},
}
NEVER: dict[str, dict[str, Any]] = {
    "apart": {"kind": "contact", "a": "ball", "b": "b3"},
    "others_apart": {"kind": "contact", "a": "b3", "b": "b2"},
    "ball_falls": {"kind": "falls", "entity": "ball"},
    "block_falls": {"kind": "falls", "entity": "b3"},
    "block_never_rolls": {"kind": "rolls", "entity": "b3"},
    "ball_never_rolls": {"kind": "rolls", "entity": "ball"},
}


def world(marked: str) -> WorldSpec:
    spec: dict[str, Any] = small_spec()
    fall = spec["story"]["beats"]["fall"]
    spec["story"]["beats"] = {n: {**fall, "predicate": p, "subject": p["entity"], "causes": []} for n, p in BEATS.items()}
    spec["story"]["requirements"] = {n: {"text": "it never does", "predicate": p, "never": True} for n, p in NEVER.items()}
    prompt = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", marked)
    made = parse_spec({**spec, "claims": {}, "spec_version": "2", "prompt": prompt})
    return apply_patch(made, claim_operations(marked, made))


def refused(marked: str) -> list[str]:
    return [p.text for p in claim_problems(world(marked)) if "its words are about" in p.text]


HONEST = {
    "subject": f"A {BALL} [rolls](event ball_rolls) and a {BLOCK} [tips over](event block_tips).",
    "object of an active verb": f"A {BALL} [knocks over](event block_tips) a {BLOCK}.",
    "passive": f"A {BLOCK} is [knocked over](event block_tips) by a {BALL}.",
    "elided subject": f"A {BALL} [hits](event hit) a {BLOCK} and [rolls](event ball_rolls) on.",
    "relative clause": f"A {BALL} that [hits](event hit) a {BLOCK} [rolls](event ball_rolls) on.",
    "relative object": f"A {BALL} [hits](event hit) a {BLOCK}, which [tips over](event block_tips).",
    "pronoun": f"A {BALL} [hits](event hit) a {BLOCK} until it [tips over](event block_tips).",
    "inverted": f"Into a {BLOCK} [rolls](event ball_rolls) a {BALL}.",
    "behind a preposition": f"A {BALL} beside the {BLOCK} [rolls](event ball_rolls).",
    "made to": f"A {BALL} [hits](event hit) and makes the {BLOCK} [tip over](event block_tips).",
    "negation": f"A {BALL} [hits](event hit) a {BLOCK}. The {BLOCK} [does not fall](negation block_falls).",
    "negation of the first": f"A {BALL} [does not roll](negation ball_never_rolls) but [hits](event hit) a {BLOCK}.",
    "negation of a touch": f"A {BALL} [rolls](event ball_rolls) past a [wooden](property b3) {BLOCK}, [never touches it](negation apart).",
    "several": f"A {BALL} and a {BLOCK} [roll](event ball_rolls).",
}


@pytest.mark.parametrize("name", list(HONEST))
def test_honest_words_are_not_refused(name: str) -> None:
    assert refused(HONEST[name]) == []
    assert [w for w in reading_of(world(HONEST[name])).warnings if "its words are about" in w] == []


@pytest.mark.parametrize(
    "marked",
    [
        f"A {BALL} [hits](event hit) a {BLOCK}. The {BLOCK} [does not fall](negation ball_falls).",
        f"A {BALL} [tips over](event block_tips) and a {BLOCK} [rolls](event ball_rolls).",
        f"A {BALL} [does not roll](negation block_never_rolls) but [hits](event hit) a {BLOCK}.",
        f"A {BALL} [rolls](event ball_rolls) and gets [knocked over](event block_tips) by a {BLOCK}.",
        f"A {BALL} beside the {BLOCK} [rolls](event block_rolls).",
        f"A {BALL} beside the [wooden](property b3) {BLOCK} [rolls](event block_rolls).",
        f"A {BALL} [rolls](event ball_rolls) past a {BLOCK}, [never touches it](negation others_apart).",
        f"A {BALL} [rolls](event ball_rolls) past a [wooden](property b3) {BLOCK}, [never touches it](negation others_apart).",
    ],
)
def test_what_is_told_of_another_body_is_refused(marked: str) -> None:
    assert refused(marked)


def test_matter_that_a_body_holds_is_not_looked_at() -> None:
    """A kettle steams: what rises is its steam."""
    spec = world(f"A {BALL} [tips over](event block_tips).")
    document = spec.model_dump(mode="json")
    document["entities"]["b3"]["physics"] = {"category": "gas", "resolution": 0.05}
    document["story"]["beats"]["block_tips"]["predicate"] = {"kind": "rises", "entity": "b3"}
    steams = WorldSpec.model_validate(document)
    assert [p for p in claim_problems(steams) if "its words are about" in p.text] == []


def quantity(marked: str) -> list[str]:
    return [p.text for p in claim_problems(world(marked)) if "right behind" in p.text or "level extent" in p.text]


def cm(entity: str, axis: int) -> str:
    return f"{100 * small_spec()['entities'][entity]['dimensions']['size'][axis]:g} cm"


def test_a_way_behind_a_verb_is_no_size_of_a_body() -> None:
    size, said = "/entities/ball/dimensions/size/0", cm("ball", 0)
    assert "says how far" in quantity(f"A {BALL} [rolls](event ball_rolls) [{said}](quantity {size}).")[0]
    assert quantity(f"A [{said}](quantity {size}) {BALL} [rolls](event ball_rolls).") == []


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_height_is_one_wherever_its_word_stands(axis: int) -> None:
    place = f"/entities/b3/dimensions/size/{axis}"
    found = quantity(f"A {BALL} [hits](event hit) a {BLOCK} [{cm('b3', axis)}](quantity {place}) tall.")
    assert bool(found) is (axis != 2)


def ways(marked: str) -> list[str]:
    return [p.text for p in claim_problems(world(marked)) if "up to the end of its sentence" in p.text]


@pytest.mark.parametrize(
    "marked",
    [
        f"A {BALL} [rolls](event ball_rolls) [along](route ball_rolls) a {OTHER}.",
        f"A {BALL} [hits](event hit) a {BLOCK}. It goes on [along](route ball_rolls) a {OTHER}.",
        f"[Along](route ball_rolls) a {OTHER} [rolls](event ball_rolls) a {BALL}.",
    ],
)
def test_a_way_is_gone_by_what_is_named_by_then(marked: str) -> None:
    assert ways(marked) == []


@pytest.mark.parametrize(
    "marked",
    [
        f"One can walk [along](route ball_rolls) a {OTHER}. A {BALL} [rolls](event ball_rolls).",
        f"A {BLOCK} goes [along](route ball_rolls) a {OTHER}.",
    ],
)
def test_a_way_that_something_else_goes_is_refused(marked: str) -> None:
    assert "'ball' goes by 'ball_rolls'" in ways(marked)[0]


def test_a_relative_pronoun_means_the_thing_right_before_it() -> None:
    """`A block, which does not roll` is no word about the ball; behind `of` either noun may be meant."""
    told = f"A {BALL} [hits](event hit) a {BLOCK}, which [does not roll](negation ball_never_rolls)."
    assert refused(told)
    assert not refused(told.replace("ball_never_rolls", "block_never_rolls"))
    assert refused(f"A {BALL} [hits](event hit) a {BLOCK} that suddenly [rolls](event ball_rolls).")
    assert not refused(f"A {BALL} [hits](event hit) the top of a {BLOCK}, which [rolls](event ball_rolls) on.")
