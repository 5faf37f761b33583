"""Rivals of a prompt are made from its claims: roles, numbers, negation and order, and nothing that the world's story entails."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.stories.small_run import MARKED, small_spec
from worldagent.tests.worlds.test_by_claim import at, world
from worldagent.workflow.review.questions import prompts_to_choose
from worldagent.workflow.review.rivals import rival_prompts
from worldagent.worlds.claim_marks import claim_operations
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.prompts.marks import parse_marks
from worldagent.worlds.spec import WorldSpec

HITS = {"kind": "hits", "entity": "ball", "other": "b1"}


def told(prompt: str, marked: str, **beats: dict[str, Any]) -> list[str]:
    """Rivals of a prompt that is told of the small world."""
    spec = small_spec(clauses={})
    for name, predicate in beats.items():
        spec["story"]["beats"][name]["predicate"] = predicate
    parsed = WorldSpec.model_validate({**spec, "prompt": prompt, "spec_version": "2"})
    assert parse_marks(marked, prompt)
    return rival_prompts(apply_patch(parsed, claim_operations(marked, parsed)))


def test_the_small_world_has_one_rival_of_each_sort() -> None:
    assert rival_prompts(world())[:3] == [
        "A steel block rolls into a row of three blocks. The last ball falls off the shelf.",
        "A steel ball rolls into a row of four blocks. The last block falls off the shelf.",
        "A steel ball never rolls into a row of three blocks. The last block falls off the shelf.",
    ]
    assert rival_prompts(world()) == rival_prompts(world())
    assert rival_prompts(WorldSpec.model_validate({**small_spec(claims={}), "prompt": "A ball rolls."})) == []


def test_doer_and_done_to_change_places_unless_both_do_it() -> None:
    prompt, marked = "The ball hits the block.", "The [ball](thing ball) [hits](event roll) the [block](thing b1)."
    assert told(prompt, marked, roll=HITS)[0] == "The block hits the ball."
    both = marked.replace("[hits](event roll)", "[hits](event roll fall)")
    mutual = told(prompt, both, roll=HITS, fall={"kind": "hits", "entity": "b1", "other": "ball"})
    assert mutual == ["The ball never hits the block."]


NUMBERS = {
    ("The three blocks fall.", "The [three](count b1 b2 b3) blocks fall."): "The four blocks fall.",
    ("The 12 blocks fall.", "The [12](count b1 b2 b3) blocks fall."): "The 13 blocks fall.",
    ("a fall of 0.5 m", "a fall of [0.5 m](quantity /simulation/fps)"): "A fall of 1 m",
    ("a fall of at least 0.5 m", "a fall of [at least 0.5 m](quantity /simulation/fps)"): None,
    ("one block falls", "[one](count b1) block falls"): None,
    ("Drei Steine fallen vom Regal.", "[Drei](count b1 b2 b3) Steine fallen vom Regal."): "Vier Steine fallen vom Regal.",
    ("三个球从架子上掉下来。", "[三](count b1 b2 b3)个球从架子上掉下来。"): "四个球从架子上掉下来。",
}


@pytest.mark.parametrize(("prompt", "marked"), NUMBERS)
def test_another_number_is_written_as_the_prompt_writes_its_own(prompt: str, marked: str) -> None:
    wanted = NUMBERS[prompt, marked]
    assert told(prompt, marked) == ([] if wanted is None else [wanted])


DENIED = {
    ("The ball does not fall off.", "The ball [does not fall off](negation hits)."): "The ball does fall off.",
    ("The ball never falls off.", "The ball [never falls](negation hits) off."): "The ball falls off.",
    ("The ball doesn't fall.", "The ball [doesn't fall](negation hits)."): "The ball does fall.",
    ("Der Ball fällt nicht vom Regal.", "Der Ball [fällt nicht](negation hits) vom Regal."): "Der Ball fällt vom Regal.",
    ("Le ballon ne tombe pas sur le sol.", "Le ballon [ne tombe pas](negation hits) sur le sol."): "Le ballon tombe sur le sol.",
    ("Le ballon roule vers le mur.", "Le ballon [roule](event roll) vers le mur."): "Le ballon ne roule jamais vers le mur.",
    ("Der Ball rollt vom Regal.", "Der Ball [rollt vom Regal](event roll)."): "Der Ball rollt nie vom Regal.",
    ("The ball falls after it rolls.", "The ball falls [after](order roll fall) it rolls."): "The ball falls before it rolls.",
}


@pytest.mark.parametrize(("prompt", "marked"), DENIED)
def test_what_is_told_is_denied_what_is_denied_is_told_and_order_is_turned(prompt: str, marked: str) -> None:
    marked = marked.replace("negation hits", "negation /graph/relations/hits")
    assert told(prompt, marked) == [DENIED[prompt, marked.replace("/graph/relations/hits", "hits")]]


def test_rivals_stand_among_the_prompts_to_choose() -> None:
    spec = world(at("/story/beats/roll/predicate", HITS), marked=MARKED)
    rivals = rival_prompts(spec)
    prompts, right = prompts_to_choose(spec.prompt, "d1", rivals)
    assert set(rivals[:4]) < set(prompts)
    assert prompts[right - 1] == spec.prompt
