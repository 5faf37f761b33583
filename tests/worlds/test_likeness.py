"""Prompts that ask for the same are found however they are written; others are not."""

from __future__ import annotations

import pytest
from worldagent.worlds.likeness import likeness

PROMPT = "A ball rolls along a shelf and strikes a block. The block falls to the floor."
SLIDES = "A steel block slides on a stone floor and strikes one of oak."


@pytest.mark.parametrize(
    "other",
    [
        PROMPT + " ",
        PROMPT.upper(),
        PROMPT.replace(" ", "  \n"),
        PROMPT.replace(".", "!"),
        PROMPT.replace("shelf", "sh\u200belf"),
        PROMPT.replace("b", "\uff42"),
        PROMPT.replace("shelf", "sh\u00adelf\ufe0f"),
        PROMPT.replace("a shelf", "a\u00a0shelf") + "\u2060",
        PROMPT.replace("o", "\u043e", 3),
    ],
)
def test_letters_that_say_or_show_the_same_are_the_same(other: str) -> None:
    assert likeness(PROMPT, other) == 1.0


@pytest.mark.parametrize(
    "other",
    [
        PROMPT.replace("strikes", "hits"),
        PROMPT.replace("rolls", "is rolling"),
        PROMPT.replace("A ball", "The red ball"),
        PROMPT.replace("ball", "balll").replace("shelf", "shelv"),
        "Please: " + PROMPT,
    ],
)
def test_other_words_for_the_same_are_the_same(other: str) -> None:
    assert 0.8 <= likeness(PROMPT, other) < 1.0
    assert likeness(PROMPT, other) == likeness(other, PROMPT)


@pytest.mark.parametrize(
    "other",
    [
        f"It is a quiet old yard in summer, with flowers along its old walls and a smell of hay. {SLIDES}",
        f"{SLIDES} Nobody sees it, for all are in the house and the bells ring in the village behind the hill.",
        f"Behold! {SLIDES}",
        SLIDES.replace("A steel", "In a yard in summer, among flowers and the smell of fresh hay from the barn, a steel"),
        SLIDES.replace("slides", "slowly and gently slides"),
    ],
)
def test_a_prompt_that_holds_another_asks_for_it_too(other: str) -> None:
    assert likeness(SLIDES, other) > 0
    assert likeness(other, SLIDES) > 0


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("A steel block slides across a stone floor and hits a wooden block. A lump is there.",
         "A steel block slides across a stone floor and hits a wooden block. On it lies a cap."),
        (SLIDES, SLIDES.replace("block", "ball")),
        (SLIDES, SLIDES.replace("oak", "pine")),
        (SLIDES, SLIDES.replace("slides", "rolls")),
        (SLIDES, "Both steel blocks slide on a stone floor and strike one of oak."),
        ("Three dominoes stand in a row and fall one after the other.", "Nine dominoes stand in a row and fall one after the other."),
        ("The ball rolls to the gate and it stops there at once.", "The ball rolls to the gate and never stops there at once."),
        ("Ein Ball rollt über den Tisch und fällt auf den Boden.", "Ein Würfel rollt über den Tisch und fällt auf den Boden."),
        ("A ball falls.", "A child throws a red ball over a hedge, a dog barks, and at the end of the day the last of the leaves falls."),
    ],
)  # fmt: skip
def test_another_noun_verb_or_number_is_another_prompt(one: str, other: str) -> None:
    assert likeness(one, other) == likeness(other, one) == 0.0


@pytest.mark.parametrize("other", ["A vase tips and breaks on the floor.", "Sand runs through a funnel onto a tray.", ""])
def test_another_request_is_another(other: str) -> None:
    assert likeness(PROMPT, other) == 0.0


def test_scripts_without_blanks_are_compared_letter_by_letter() -> None:
    assert likeness("球滚下架子撞到木块。", "球滚下架子撞到铁块。") == pytest.approx(8 / 9)
    assert likeness("球滚下架子撞到木块。", "雨落在石凳上。") == 0.0


def test_long_prompts_are_compared_in_bounded_time() -> None:
    assert likeness("word " * 50_000, "word " * 60_000) == 1.0
