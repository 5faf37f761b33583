"""Prompts that ask for the same are found however they are written; others are not."""

from __future__ import annotations

import pytest
from worldagent.worlds.likeness import likeness

PROMPT = "A ball rolls along a shelf and strikes a block. The block falls to the floor."


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
    ],
)
def test_letters_that_say_the_same_are_the_same(other: str) -> None:
    assert likeness(PROMPT, other) == 1.0


@pytest.mark.parametrize("other", [PROMPT.replace("strikes", "hits"), "Please: " + PROMPT, PROMPT.replace("o", "\u043e", 3)])
def test_a_changed_word_or_a_look_alike_letter_is_told(other: str) -> None:
    assert 0.8 <= likeness(PROMPT, other) < 1.0


@pytest.mark.parametrize("other", ["A vase tips and breaks on the floor.", "Sand runs through a funnel onto a tray.", ""])
def test_another_request_is_another(other: str) -> None:
    assert likeness(PROMPT, other) == 0.0


def test_scripts_without_blanks_are_compared_letter_by_letter() -> None:
    assert likeness("球滚下架子撞到木块。", "球滚下架子撞到铁块。") == pytest.approx(8 / 9)
    assert likeness("球滚下架子撞到木块。", "雨落在石凳上。") == 0.0


def test_long_prompts_are_compared_in_bounded_time() -> None:
    assert likeness("word " * 50_000, "word " * 60_000) == 1.0
