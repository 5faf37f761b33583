"""The sets of prompts: schema, and that they cover what they promise. Texts are own choice: the paper prints none (S16)."""

from __future__ import annotations

import json
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError
from worldagent.bench.evaluation.prompts.reading import BESIDES, COUPLINGS, SETS, PromptSet, load_prompts, load_set
from worldagent.worlds.errors import InputError

LONG = load_prompts("agenticsimbench")
SMALL = load_prompts("small")
MATTER = ("cloth", "elastic", "fracture", "gas", "liquid", "particles", "rigid")
"""Categories of matter when the sets were fixed; a later category changes no score."""
PAIRS = [f"{a}+{b}" for a, b in combinations(MATTER, 2)]
NAMED = {
    "volcano": ("crater", "lava"),
    "hotel_corridor": ("corridor", "hotel", "water"),
    "ball_and_river": ("soft rubber", "river", "splash"),
    "city_wall": ("wall", "cannon"),
    "aquarium": ("aquarium", "glass"),
    "stream_of_leaves": ("stream", "leaves"),
}
"""Scenes that the paper names, and words that their prompts cannot do without."""


def document(name: str = "small") -> dict[str, Any]:
    return load_set(name).model_dump(mode="json")


def test_the_benchmark_has_thirteen_prompts_with_five_beats_each() -> None:
    assert len(LONG) == 13
    assert all(len(prompt.beats) == 5 for prompt in LONG.values())


@pytest.mark.parametrize("scene", NAMED)
def test_a_scene_that_the_paper_names_is_among_them(scene: str) -> None:
    assert NAMED[scene]
    assert [word for word in NAMED[scene] if word not in LONG[scene].text] == []


def test_both_settings_every_category_and_every_coupling_stand_somewhere() -> None:
    said = {capability for prompt in LONG.values() for capability in prompt.capabilities}
    assert said == {*MATTER, *PAIRS, *BESIDES}
    assert set(PAIRS) <= set(COUPLINGS)
    assert all(sum(p.setting == setting for p in LONG.values()) >= 6 for setting in ("outdoor", "interior"))


def test_a_coupling_stands_beside_both_of_its_categories() -> None:
    named = [(p, c) for p in (*LONG.values(), *SMALL.values()) for c in p.capabilities if c in COUPLINGS]
    assert len(named) > 50
    assert [(p.id, c) for p, c in named if not set(c.split("+")) <= set(p.capabilities)] == []


@pytest.mark.parametrize("prompt", LONG.values(), ids=LONG)
def test_a_long_prompt_names_a_scene_many_things_and_a_sequence(prompt: Any) -> None:
    assert len(prompt.text.split()) >= 150
    assert "The camera" in prompt.text
    assert sum(question.kind == "entity" for question in prompt.composition) >= 6
    assert sum(question.kind == "region" for question in prompt.composition) >= 3
    assert len(prompt.requirements) >= 10


@pytest.mark.parametrize("name", SETS)
def test_questions_and_beats_tell_no_method_and_no_tool(name: str) -> None:
    """A judge that reads them must not learn who made the film (R151)."""
    text = json.dumps(document(name)["prompts"]).lower()
    assert not [word for word in ("worldagent", "blender", "mujoco", "mcp", "simulat", "render") if word in text]


def test_there_are_twenty_small_prompts_one_per_capability() -> None:
    firsts = [prompt.capabilities[0] for prompt in SMALL.values()]
    assert len(firsts) == len(set(firsts)) == 20
    assert {*MATTER, *BESIDES} < set(firsts)
    assert all(prompt.duration_s <= 3 and len(prompt.text.split()) <= 30 for prompt in SMALL.values())


@pytest.mark.parametrize("name", SETS)
def test_a_set_says_whose_it_is_and_its_digest_depends_on_every_word(name: str) -> None:
    whole = load_set(name)
    assert whole.origin.startswith("Written for this project")
    other = document(name)
    other["prompts"][-1]["requirements"][-1]["text"] += " Really."
    assert PromptSet.model_validate(other).digest != whole.digest == load_set(name).digest


def test_a_set_of_ones_own_is_read_from_its_file(tmp_path: Path) -> None:
    path = tmp_path / "mine.json"
    path.write_text(json.dumps({**document(), "name": "mine"}))
    assert list(load_prompts(str(path))) == list(SMALL)
    with pytest.raises(InputError, match="agenticsimbench, small"):
        load_set("absent")


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (lambda d: d["prompts"][0]["capabilities"].append("magic"), "magic"),
        (lambda d: d["prompts"].append(d["prompts"][0]), "stand twice"),
        (lambda d: d["prompts"][0]["beats"].append(d["prompts"][0]["beats"][0]), "stand twice among its beats"),
        (lambda d: d.update(beats_at_least=5), "at least 5"),
        (lambda d: d["prompts"][0]["composition"][0].update(question="A crate is there."), "question"),
        (lambda d: d["prompts"][0].update(answer="a world"), "answer"),
        (lambda d: d["prompts"][0].update(beats=[]), "beats"),
    ],
)
def test_what_is_wrong_with_a_set_is_named(change: Any, word: str) -> None:
    broken = document()
    change(broken)
    with pytest.raises(ValidationError, match=word):
        PromptSet.model_validate(broken)
