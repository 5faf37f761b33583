"""The guide of a prompt: sections, kinds of event and an example that fit its words, within one reply."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from worldagent.bench.evaluation.prompts.reading import load_prompts
from worldagent.testing.prompts import strangers
from worldagent.workflow.answers import size_of
from worldagent.workflow.prompt_guide import CHARACTERS, SKILLS, prompt_guide
from worldagent.workflow.table_entries import sections_of
from worldagent.worlds.errors import InputError
from worldagent.worlds.prompts.marks import parse_marks

GUIDES = sorted(SKILLS.glob("*/guide.json"))


@pytest.mark.parametrize(
    ("prompt", "skills", "kinds", "example"),
    [
        ("A kettle steams on a stove under a lamp.", {"gas"}, {"rises"}, "gas/kettle.json"),
        ("A clay pot falls onto the tiles and shatters.", {"fracture"}, {"falls"}, "fracture/pot.json"),
        ("A wooden ball rolls along a table and pushes a glass tumbler over the edge. The tumbler falls and breaks on the stone floor.", {"fracture", "assets", "rigid-bodies"}, {"pushes", "breaks"}, "fracture/tumbler.json"),
        ("A log drifts down a river and jams at a footbridge.", {"coupled-systems", "liquids"}, {"drifts", "jams"}, "coupled-systems/stream.json"),
        ("A brass bowl slides on a tablecloth that lies on a table.", {"cloth"}, {"slides"}, "cloth/laid.json"),
        ("A duck floats beside the wall of a pool.", {"coupled-systems", "liquids"}, {"floats"}, "coupled-systems/crate.json"),
        ("A boulder rolls into a scree below a cliff.", {"particles", "rigid-bodies"}, {"rolls"}, "rigid-bodies/scree.json"),
        ("A brook runs through a valley into a lake.", {"outdoor-terrain"}, set(), "outdoor-terrain/example.json"),
        ("A red flag flutters in the wind.", {"cloth"}, {"flutters"}, "cloth/flag.json"),
        ("Sand runs out when the gate opens, and the heap topples a tile.", {"particles"}, {"opens", "topples"}, "particles/collapse.json"),
        ("A lava tongue reaches a pond and steam rises.", {"gas"}, {"rises"}, "gas/lava.json"),
        ("Rauch zieht aus dem Schornstein.", {"gas"}, set(), "gas/chimney.json"),
        ("A curtain hangs in a window of a room; a gust blows its hem against a porcelain vase on the stone sill, and the vase shatters.", {"cloth", "fracture"}, set(), "fracture/pot.json"),
        ("A red jelly falls on a plate and wobbles.", {"elastic-bodies"}, {"wobbles", "falls"}, "elastic-bodies/jelly.json"),
    ],
)  # fmt: skip
def test_words_call_for_skills_kinds_of_event_and_an_example(
    prompt: str, skills: set[str], kinds: set[str], example: str
) -> None:
    told = prompt_guide(prompt)
    assert skills <= set(told["skills"])
    assert kinds <= set(told["kinds"])
    assert told["example"]["file"] == example
    for name in skills:
        assert any(place.startswith(f"{name}/SKILL.md#") for place in told["sections"])


def test_any_prompt_is_answered_within_its_characters_and_what_is_left_out_has_its_place() -> None:
    prompts = [s.text for s in strangers()][:60]
    assert len(prompts) == 60
    for prompt in [*prompts, "x", " ".join(prompts)]:
        told = prompt_guide(prompt)
        assert size_of(told) <= CHARACTERS
        assert len(told["sections"]) >= 3
        for place in told["more"]:
            name, heading = place.split("/SKILL.md#")
            assert heading in sections_of((SKILLS / name / "SKILL.md").read_text())


def test_the_skill_that_most_words_call_for_has_most_room_and_no_strange_example_is_shown() -> None:
    told = prompt_guide("A beach ball floats across a pool, and the wind blows it against a wooden raft.")
    assert next(iter(told["sections"])) == "coupled-systems/SKILL.md#Floating"
    assert told["example"]["file"] == "coupled-systems/crate.json"
    assert prompt_guide("Honey drips from a spoon.")["example"]["file"] == "world-building/examples/two_blocks.json"
    assert "/entities/footbridge" in prompt_guide("A log drifts down a stream to a bridge.")["example"]


def test_furniture_that_tips_and_a_lamp_on_its_cord_are_no_slope_and_no_fire() -> None:
    """*Hang* is German for a slope, and what goes out of balance is no flame."""
    told = prompt_guide(
        "A bookcase in a study tips, its books slide under the piano, a lamp goes out of balance and stays hanging on its cord."
    )
    assert "interiors/SKILL.md#Furniture that tips, cords that catch" in told["sections"]
    assert "outdoor-terrain" not in told["skills"]
    assert told["events"]["goes out"] == ["tips", "topples"]
    assert "goes_out" not in told["kinds"]
    assert size_of(told) <= CHARACTERS
    assert "goes_out" in prompt_guide("A candle goes out on the balance.")["events"]["goes out"]


def test_the_marked_text_is_the_prompt() -> None:
    prompt = "A glass jug tips over and shatters, and its honey pours onto the oak floor."
    told = prompt_guide(prompt)
    marks = parse_marks(told["marked"], prompt)
    assert [m.quote for m in marks][:3] == ["glass", "jug", "tips over"]
    assert set(told["materials"]) == {"soda_lime_glass", "honey", "oak"}
    assert told["materials"]["oak"]["friction"] == [0.32, 0.48, 0.62]
    assert "pours" in told["events"]["pours"]


def test_a_substance_without_a_row_of_its_name_leads_to_its_rows() -> None:
    told = prompt_guide("A wooden crate falls off a lorry.")["materials"]
    assert told["wood"]["density"] == [120, 1200]
    assert "walnut" in told["wood"]["rows"]


def test_a_prompt_of_no_known_word_says_so_and_leads_on() -> None:
    told = prompt_guide("一个球滚下斜坡。")
    assert not told["skills"]
    assert "inspect_world(part='guide')" in told["warnings"][0]
    assert "the language is zh" in told["warnings"][1]


@pytest.mark.parametrize("prompt", ["", "  ", ". ,", "a" * 20_001])
def test_no_prompt_and_one_that_is_too_long_are_refused(prompt: str) -> None:
    with pytest.raises(InputError, match="give 1 word to 20000 characters"):
        prompt_guide(prompt)


@pytest.mark.parametrize("path", GUIDES, ids=lambda p: p.parent.name)
def test_what_a_guide_names_is_there(path: Path) -> None:
    guide: dict[str, Any] = json.loads(path.read_text())
    headings = sections_of((path.parent / "SKILL.md").read_text())
    assert set(guide["sections"]) <= set(headings)
    assert all((path.parent / file).is_file() for file in guide["examples"])


def test_every_skill_but_that_of_repair_has_its_guide() -> None:
    assert {p.parent.name for p in GUIDES} == {p.parent.name for p in SKILLS.glob("*/SKILL.md")} - {"repair"}


def test_what_a_prompt_speaks_of_again_and_again_comes_before_what_it_names_once() -> None:
    """The flooded corridor names many things once and the water six times; of liquids it told nothing before."""
    told = prompt_guide(load_prompts("agenticsimbench")["hotel_corridor"].text)
    assert "liquids" in list(told["skills"])[:4]
    assert any(place.startswith("liquids/") for place in told["sections"])


PANTRY = [
    "A pantry with a jar that is pushed off a shelf and breaks on the floor.",
    "In a pantry with a tiled floor, a tin rolls along a wall shelf and pushes a glass jar off its end; the jar breaks on the tiles, and the tin drops "
    "after it and rolls against the door.",
]


@pytest.mark.parametrize("prompt", PANTRY)
def test_a_jar_that_is_pushed_off_a_shelf_is_told_of_strength_and_of_its_pusher(prompt: str) -> None:
    told = prompt_guide(prompt)["sections"]
    assert "sqrt(push * fall)" in told["fracture/SKILL.md#Pushed off, broken on the floor"]
    assert "goes on over the edge" in told["rigid-bodies/SKILL.md#Pushes, and edges"]
    assert size_of(prompt_guide(prompt)) <= CHARACTERS
