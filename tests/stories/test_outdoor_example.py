"""The outdoor example of the skill, sent call by call as it stands there; and how much a client reads before it can begin."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from worldagent.server.app import INSTRUCTIONS
from worldagent.server.skill_files import SKILLS
from worldagent.tests.stories.inline_jobs import run_jobs_inline

EXAMPLE: list[dict[str, Any]] = json.loads((SKILLS / "outdoor-terrain" / "example.json").read_text())["calls"]
BEFORE_MOTION = [c["tool"] for c in EXAMPLE].index("probe_sim")
READ_FIRST = 40_000
"""Characters that a client may have to read before its first outdoor world."""


def _sent(agent: Any, calls: list[dict[str, Any]]) -> list[dict[str, Any]]:
    replies = []
    for one in calls:
        answer = agent.result(one["tool"], **one["arguments"])
        assert not answer.is_error, (one["tool"], answer.content[0].text)
        replies.append(json.loads(answer.content[0].text))
        while replies[-1].get("state") in ("queued", "running"):
            replies[-1] = agent.call("job", action="wait", job_id=replies[-1]["job_id"], wait_s=60)
        replies[-1] = replies[-1].get("result", replies[-1])
    return replies


def test_the_example_stands_before_motion_and_its_replies_lead_from_call_to_call(agent: Any, monkeypatch: Any) -> None:
    run_jobs_inline(monkeypatch)
    calls = EXAMPLE[:BEFORE_MOTION]
    replies = _sent(agent, calls)
    told = dict(zip([(c["tool"], c["arguments"].get("entity")) for c in calls], replies, strict=True))
    created, built = told["edit_spec", None], told["build_terrain", None]
    assert created["audit"]["passed"], created
    assert created["next"].startswith("build_terrain(world='valley', terrain='valley')")
    assert built["next"].startswith("place_object(world='valley', entity='hut', on='ground')")
    assert {"lakes", "rivers"} <= {k for k, n in built["features"].items() if n}
    assert told["place_object", "ball"]["static_passed"]
    assert told["place_object", "ball"]["next"] == "probe_sim(world='valley')"
    row = agent.call("inspect_world", world="valley", part="row", row="terrain:valley:plants")
    assert row["row"]["status"] == "pass", row
    plants = agent.call("inspect_world", world="valley", part="terrain")["plants"]
    assert set(plants) == {"pine"}
    assert plants["pine"] > 500


@pytest.mark.slow
def test_the_example_is_accepted(agent: Any) -> None:
    verdict = _sent(agent, EXAMPLE)[-1]
    assert verdict["verdict"] == "accepted", verdict


def test_what_is_read_before_the_first_outdoor_world_is_bounded(agent: Any) -> None:
    """Instructions, the skill, its example, the species, and the parts of the schema that such a world is made of."""
    read = len(INSTRUCTIONS)
    for file in ("SKILL.md", "example.json", "plants.md"):
        offset: int | None = 0
        while offset is not None:
            page = agent.call("inspect_world", part="guide", pointer=f"outdoor-terrain/{file}", offset=offset)
            read += len(json.dumps(page))
            offset = page.get("next_offset")
    for part in ("Terrain", "Layer", "Vegetation", "Entity", "Shot"):
        read += len(json.dumps(agent.call("inspect_world", part="schema", pointer=part)))
    assert 15_000 < read < READ_FIRST
    assert len(agent.read("worldagent://schema/world").text) > 3 * READ_FIRST, "what nobody is sent to any more"


@pytest.mark.parametrize(
    ("pointer", "words"),
    [
        ("world-building/SKILL.md#Claims", "Say what the words of the prompt mean"),
        ("world-building/SKILL.md#beats-and-causes", "A beat is one event"),
        ("outdoor-terrain/SKILL.md#What gives what", "crater lake"),
    ],
)
def test_a_section_of_a_guide_is_read_by_its_heading(agent: Any, pointer: str, words: str) -> None:
    section = agent.call("inspect_world", part="guide", pointer=pointer)
    assert words in section["text"]
    assert section["text"].count("\n## ") == 0
    assert section["total"] < 5000


def test_a_section_that_is_not_there_answers_with_those_that_are(agent: Any) -> None:
    answer = agent.result("inspect_world", part="guide", pointer="world-building/SKILL.md#Claws")
    assert answer.is_error
    assert "'Claims'" in answer.content[0].text


def test_the_files_that_the_skill_names_are_there() -> None:
    text = (SKILLS / "outdoor-terrain" / "SKILL.md").read_text()
    for name in ("example.json", "plants.md", "landforms.json", "diagnosis.json"):
        assert f"skill://outdoor-terrain/{name}" in text
        assert Path(SKILLS / "outdoor-terrain" / name).is_file()
