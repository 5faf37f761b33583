"""`It` and `they` before an event mean what was named before; where the words leave a choice it is printed, and honest worlds are not refused (R131, R155)."""

from __future__ import annotations

import pytest
from worldagent.tests.worlds.test_subjects import BALL, BLOCK, OTHER, world
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.claims import prompt_record, reading_of

TOLD = ("its words are about", "the only thing named before it", "which nothing before it names")
BLOCKS = "[blocks](thing b2 b3)"


def refused(marked: str) -> list[str]:
    return [p.text for p in claim_problems(world(marked)) if any(t in p.text for t in TOLD)]


def warned(marked: str) -> list[str]:
    return [w for w in reading_of(world(marked)).warnings if any(t in w for t in TOLD)]


HONEST = {
    "same sentence": f"A {BALL} [rolls](event ball_rolls) off and it [hits](event hit) a {BLOCK}.",
    "next sentence": f"A {BALL} [rolls](event ball_rolls). It [hits](event hit) a {BLOCK}.",
    "marked": f"A {BALL} [rolls](event ball_rolls). [It](thing same_as=ball) [hits](event hit) a {BLOCK}.",
    "with helpers": f"A {BALL} [rolls](event ball_rolls). It then suddenly [hits](event hit) a {BLOCK}.",
    "of two, the first": f"A {BALL} [hits](event hit) a {BLOCK}. It [rolls](event ball_rolls) on.",
    "of two, the second": f"A {BALL} [hits](event hit) a {BLOCK}. It [tips over](event block_tips).",
    "of two, marked": f"A {BALL} [hits](event hit) a {BLOCK}. [It](thing same_as=block) [tips over](event block_tips).",
    "named earlier, when": f"A {BLOCK} is there. When the {BALL} comes near, it [tips over](event block_tips).",
    "named earlier, marked": f"A {BLOCK} is there. When the {BALL} comes near, [it](thing same_as=block) [tips over](event block_tips).",
    "they, over a single thing": f"There are {BLOCKS}. A {BALL} comes. They [tip over](event block_tips).",
    "they, of two things": f"A {BALL} and a {BLOCK} are there. They [roll](event ball_rolls).",
    "an unclaimed noun": f"A {BALL} lies beside a vase. It [tips over](event block_tips) as a {BLOCK} is hit.",
    "nothing before": f"It [tips over](event block_tips), a {BLOCK}.",
    "object": f"A {BALL} [rolls](event ball_rolls). It [knocks over](event block_tips) a {BLOCK}.",
    "weather": f"A {BALL} [rolls](event ball_rolls). It rains on a {BLOCK}.",
}


@pytest.mark.parametrize("name", list(HONEST))
def test_honest_pronouns_are_not_refused(name: str) -> None:
    assert refused(HONEST[name]) == []


@pytest.mark.parametrize(
    "marked",
    [
        f"A {BALL} [rolls](event ball_rolls) off and it [tips over](event block_tips). There is a {BLOCK}.",
        f"A {BALL} [rolls](event ball_rolls). It [tips over](event block_tips). A {BLOCK} is there.",
        f"A {BALL} [rolls](event ball_rolls). It then [tips over](event block_tips), and there is a {BLOCK}.",
        f"A {BALL} [rolls](event ball_rolls). [It](thing block) [tips over](event block_tips). There is a [block](thing b3).".replace("(thing block)", "(thing b3)"),
        f"Two {BLOCKS} are there. They [roll](event ball_rolls), and a {BALL} too.",
    ],
)  # fmt: skip
def test_a_pronoun_that_can_mean_one_thing_alone_is_told_of_that(marked: str) -> None:
    assert refused(marked)


def test_what_leaves_a_choice_is_printed_as_the_agents_reading() -> None:
    read = prompt_record(world(HONEST["of two, the second"]))["readings"]
    assert read["It tips over"] == ["/entities/b3"]
    marked = prompt_record(world(HONEST["of two, marked"]))["readings"]
    assert marked["It tips over"] == ["/entities/b3"]
    assert not any(k.startswith("It ") for k in prompt_record(world(HONEST["next sentence"]))["readings"])


def test_a_body_that_nothing_before_names_is_warned_of() -> None:
    marked = f"A {BALL} [hits](event hit) a {BLOCK}. [It](thing b2) [rolls](event ball_rolls) on. There is a {OTHER}."
    assert refused(marked) == []
    assert warned(marked)
