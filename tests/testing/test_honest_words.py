"""No honest prompt is refused for its words: each can be told so that every rule of words takes it (R2, R131)."""

from __future__ import annotations

import pytest
from worldagent.testing.prompts import Marked, Span, honest
from worldagent.testing.prompts.told import refusals


@pytest.mark.parametrize("prompt", honest(), ids=lambda p: p.id)
def test_an_honest_prompt_can_be_told_so_that_no_rule_of_words_refuses_it(prompt: Marked) -> None:
    assert refusals(prompt) == {}


@pytest.mark.parametrize(
    ("text", "thing", "event", "why"),
    [
        ("A ball almost hits a block.", "ball", "hits", "'almost' before 'hits' says that it does not happen"),
        ("A trio of balls rolls.", "balls", "rolls", "'trio of' says 3, and 'balls' names 1"),
    ],
)
def test_what_no_telling_cures_is_found(text: str, thing: str, event: str, why: str) -> None:
    left = refusals(Marked("x", "en", text, text, (Span(thing, 1, "thing"), Span(event, 1, "event"))))
    assert [why in reason for reason in left.values()] == [True]
