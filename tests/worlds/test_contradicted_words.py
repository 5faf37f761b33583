"""Words of a property that the specification contradicts; whatever is judged by nothing is printed as the agent's reading (R2, R131)."""

from __future__ import annotations

import json

import pytest
from worldagent.testing.defects.accepted import SKILLS
from worldagent.tests.worlds.test_amounts import said, told, warned
from worldagent.worlds.claims import prompt_record, reading_of
from worldagent.worlds.contradicted_words import contradicted_words
from worldagent.worlds.judged_spans import judged_spans
from worldagent.worlds.patch import parse_spec


def of(word: str) -> str:
    return f"The [{word}](property b1) [block](thing b1) stands on the shelf."


def test_what_burns_in_a_world_without_fire_is_refused() -> None:
    assert "nothing of it burns" in said(of("burning"))
    assert "nothing of it burns" in said("Der [brennende](property b1) [Klotz](thing b1) steht auf dem Regal.")
    assert "burns" not in said(of("wooden"))


def test_fire_of_gas_is_no_contradiction() -> None:
    bowl = json.loads((SKILLS / "gas" / "bowl.json").read_text(encoding="utf-8"))
    spec = parse_spec(bowl)
    assert [m for m in contradicted_words(spec, reading_of(spec).spans, "en") if m.sure] == []
    claims = {"b": {"quote": "burning", "nth": 1, "type": "property", "by": ["/entities/fire"]}}
    burning = parse_spec({**bowl, "claims": claims, "prompt": "A burning bowl stands there.", "spec_version": "2"})
    assert list(contradicted_words(burning, reading_of(burning).spans, "en")) == []


@pytest.mark.parametrize(
    ("word", "why"),
    [("broken", "one whole piece"), ("invisible", "every picture shows it"), ("weightless", "gravity pulls it")],
)
def test_other_words_that_are_not_so_warn(word: str, why: str) -> None:
    assert why in warned(of(word))
    assert why not in warned(of("wooden"))
    assert "is said of" not in said(of(word))


def test_words_that_nothing_judges_stand_in_print_as_the_agent_s_reading() -> None:
    record = prompt_record(told(of("haunted")))
    assert "haunted" in record["readings"]
    assert [s.state for s in judged_spans(record, ()) if s.text == "haunted"] == ["reading"]
    assert "wooden" not in prompt_record(told(of("wooden")))["readings"]
