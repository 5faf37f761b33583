"""The server's own segmentation of prompts (R155)."""

from __future__ import annotations

import pytest
from worldagent.worlds.audits.clauses import clauses_of

CASES: dict[str, list[str]] = {
    "A ball rolls.": ["A ball rolls"],
    "A ball rolls. It stops! Does it?": ["A ball rolls", "It stops", "Does it"],
    "The ball rolls down the ramp, and it hits the wall; the wall falls.": [
        "The ball rolls down the ramp",
        "it hits the wall",
        "the wall falls",
    ],
    "A red, round ball rolls.": ["A red, round ball rolls"],
    "A ball rolls away\nthen a door closes": ["A ball rolls away", "then a door closes"],
    "  A ball   rolls.  ": ["A ball   rolls"],
    "A weight of 1.5 kg falls.": ["A weight of 1.5 kg falls"],
    "Ein Ball rollt über die Straße, dann fällt er.": ["Ein Ball rollt über die Straße", "dann fällt er"],
    "": [],
    "...": [],
}


@pytest.mark.parametrize("prompt", CASES)
def test_prompts_fall_into_clauses_in_reading_order(prompt: str) -> None:
    assert list(clauses_of(prompt).values()) == CASES[prompt]
    assert list(clauses_of(prompt)) == [f"c{i + 1}" for i in range(len(CASES[prompt]))]


def test_every_word_of_a_prompt_is_in_some_clause() -> None:
    prompt = "A steel ball is released, rolls down, and strikes a domino; the chain runs round a corner and then a bell rings."
    words = " ".join(clauses_of(prompt).values()).replace(",", "").split()
    lost = set(prompt.replace(",", "").replace(";", "").replace(".", "").split()) - set(words)
    assert lost <= {"and", "then", "while"}
