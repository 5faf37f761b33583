"""Rules for every reply: its head, its size, its pages, and links that can be read."""

from __future__ import annotations

import base64
import json
from typing import Any

import cv2
import numpy as np
import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec

KINDS = ("preview", "contact_sheet", "ids", "ledger", "plan", "section")
PARTS = ("overview", "schema", "guide", "spec", "matrix", "revisions", "iterations", "state", "events", "records", "acceptance", "worlds")  # fmt: skip
PAGED = {
    "matrix": ("rows", {}),
    "events": ("events", {}),
    "revisions": ("revisions", {}),
}


def _head(data: dict[str, Any]) -> None:
    assert list(data)[:3] == ["summary", "warnings", "next"]
    assert data["summary"]
    assert isinstance(data["warnings"], list)
    assert isinstance(data["next"], str)


def _links(result: Any) -> list[Any]:
    return [block for block in result.content if block.type == "resource_link"]


def _readable(agent: Any, link: Any) -> None:
    content = agent.read(link.uri)
    assert content.mime_type == link.mime_type
    raw = base64.b64decode(content.blob) if hasattr(content, "blob") else content.text.encode()
    assert raw
    assert link.size is None or link.size == len(raw)
    if link.mime_type.startswith("image/"):
        assert cv2.imdecode(np.frombuffer(raw, np.uint8), cv2.IMREAD_COLOR) is not None
    elif link.mime_type == "application/json":
        json.loads(raw)


def test_every_answer_of_the_loop_has_a_head_and_links_that_resolve(loop: Any, accepted: Any) -> None:
    seen = 0
    for answer in loop.answers.values():
        _head(answer.structured_content)
        assert len(answer.content[0].text) < 8000
        for link in _links(answer):
            _readable(accepted, link)
            seen += 1
    assert seen >= 6


@pytest.mark.parametrize("kind", KINDS)
def test_pictures_come_with_a_line_of_text_and_a_link(accepted: Any, kind: str) -> None:
    result = accepted.result("render_shot", world="w", kind=kind, frame=20)
    assert not result.is_error, result.content[0].text
    assert result.structured_content is None
    assert [b.type for b in result.content] == ["text", "image", "resource_link"]
    _head(json.loads(result.content[0].text))
    assert len(result.content[0].text) < 1000
    raw = base64.b64decode(result.content[1].data)
    assert len(raw) <= 700_000
    assert max(cv2.imdecode(np.frombuffer(raw, np.uint8), cv2.IMREAD_COLOR).shape) <= 1568
    (link,) = _links(result)
    assert link.mime_type == result.content[1].mime_type
    _readable(accepted, link)


@pytest.mark.parametrize("part", PARTS)
def test_every_part_has_a_head_and_fits(accepted: Any, part: str) -> None:
    for detail in ("concise", "full"):
        result = accepted.result("inspect_world", world="w", part=part, detail=detail)
        assert not result.is_error, result.content[0].text
        _head(result.structured_content)
        assert len(result.content[0].text) < (8000 if detail == "concise" else 20_000)
        for link in _links(result):
            _readable(accepted, link)


@pytest.mark.parametrize("part", PAGED)
def test_pages_join_to_the_whole(accepted: Any, part: str) -> None:
    key, more = PAGED[part]
    whole = accepted.pages(key, part=part, limit=200, **more)
    assert accepted.pages(key, part=part, limit=3, **more) == whole


def test_states_are_paged_and_cover_frames(accepted: Any) -> None:
    first = accepted.call("inspect_world", world="w", part="state", limit=2)
    assert (len(first["entities"]), first["next_offset"], first["total"]) == (2, 2, 6)
    second = accepted.call("inspect_world", world="w", part="state", limit=2, offset=2)
    assert not set(first["entities"]) & set(second["entities"])
    motion = accepted.call("inspect_world", world="w", part="state", entities=["ball"], frames=[0, 35])
    told = motion["entities"]["ball"]
    assert motion["frames"] == list(range(36))
    assert len(told["position"]) == len(told["speed"]) == 36
    one = accepted.call("inspect_world", world="w", part="state", entities=["ball"], frames=[20, 20])
    assert told["position"][20] == pytest.approx(one["entities"]["ball"]["position"], abs=1e-4)


def test_the_state_of_several_bodies_says_whose_it_is(agent: Any) -> None:
    spec = small_spec()
    rope = {"kind": "rope", "points": [[0, 0, 0], [0, 0, 0.7]], "radius": 0.01, "segments": 7}
    spec["entities"]["rope"] = {
        "role": "rope", "motion": "dynamic", "material": "steel", "dimensions": {"size": [0.02, 0.02, 0.72]},
        "pose": {"position": [1, 1, 1]}, "generator": rope,
    }  # fmt: skip
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=spec)
    asked = {"world": "w", "part": "state"}
    told = agent.call("inspect_world", **asked, entities=["rope", "rope/seg006", "ball"])["entities"]
    assert told["rope"]["body"].startswith(
        "'seg000', 1 of 7; a box holds all; entities=['rope/seg001'] tells of another: seg000, seg001"
    )
    assert told["rope/seg006"]["body"] == "'seg006', 7 of 7"
    assert "body" not in told["ball"]
    assert told["rope/seg006"]["box_min"][2] == pytest.approx(1.6, abs=0.02)
    assert told["rope"]["box_min"][2] == pytest.approx(1.0, abs=0.02)
    assert "'rope' has no body 'seg9'" in agent.refused("inspect_world", **asked, entities=["rope/seg9"])


def test_counts_are_of_the_whole_matrix(accepted: Any) -> None:
    whole = accepted.call("inspect_world", world="w", part="matrix")["counts"]
    only = accepted.call("inspect_world", world="w", part="matrix", status="not_applicable", limit=1)
    assert only["counts"] == whole
    assert only["total"] == whole["not_applicable"] < whole["pass"]


def test_a_matrix_with_many_open_rows_is_listed_in_lines(agent: Any) -> None:
    """A row that is asked for alone is told in full; of all rows, the first open ones are."""
    spec = small_spec()
    for name in ("b1", "b2", "b3", "ball"):
        spec["entities"][name]["pose"]["position"][2] -= 0.03
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=spec)
    agent.call("place_object", world="w")
    whole = agent.call("inspect_world", world="w", part="matrix", limit=200)["rows"]
    only = agent.call("inspect_world", world="w", part="matrix", limit=200, status="open")["rows"]
    waiting = [r for r in whole if r["status"] in ("fail", "unverified")]
    assert [r["id"] for r in waiting][: len(only)] == [r["id"] for r in only]
    assert {"corrections" in r for r in waiting} == {True, False}
    assert all("corrections" in r or "why" in r for r in only)
    assert len(whole) > 2 * len(only)


def test_a_probe_of_other_settings_is_named_where_it_cannot_be_shown(accepted: Any) -> None:
    accepted.edit(("/entities/ball/physics/linear_velocity/0", 0.9))
    text = accepted.refused("render_shot", world="w", frame=3, stage="probe")
    assert "call probe_sim first" in text
    assert "of revision 1 is of other settings" in text
    uri = text.split("contact sheet is ")[1].split(",")[0]
    assert accepted.read(uri).mime_type == "image/jpeg"


def test_a_row_in_full_says_more_than_a_concise_one(accepted: Any) -> None:
    accepted.edit(("/entities/ball/pose/position/2", 0.9))
    short = accepted.call("place_object", world="w")
    whole = accepted.call("place_object", world="w", detail="full")
    assert [r["id"] for r in short["open_rows"]] == [r["id"] for r in whole["open_rows"]]
    row = short["open_rows"][0]
    assert row["status"] == "fail"
    assert row["why"]
    assert "artifact" not in row
    assert whole["open_rows"][0]["evidence"]["explanation"] == row["why"]
    assert len(json.dumps(short["open_rows"])) < 0.7 * len(json.dumps(whole["open_rows"]))


def test_guides_can_be_read_to_their_end(accepted: Any) -> None:
    files = accepted.call("inspect_world", part="guide")["files"]
    assert "world-building/SKILL.md" in files
    text, offset = "", 0
    while True:
        page = accepted.call("inspect_world", part="guide", pointer="world-building/SKILL.md", offset=offset)
        text += page["text"]
        assert page["offset"] == offset
        if "next_offset" not in page:
            break
        offset = page["next_offset"]
    assert text == accepted.read("skill://world-building/SKILL.md").text


def test_the_example_of_the_schema_can_be_created(agent: Any) -> None:
    found = agent.call("inspect_world", part="schema", pointer="example")
    assert agent.call("edit_spec", world="copy", prompt=found["prompt"], spec=found["spec"], claims=found["claims"])["audit"][
        "passed"
    ]


@pytest.mark.slow
def test_a_film_comes_as_a_link_with_its_size_and_length(accepted: Any) -> None:
    result = accepted.result("render_shot", world="w", kind="final", width=64, height=64, samples=1)
    assert not result.is_error, result.content[0].text
    data = json.loads(result.content[0].text)
    _head(data)
    assert data["duration_s"] == 1.5
    sheet, film = _links(result)
    _readable(accepted, sheet)
    _readable(accepted, film)
    assert (film.mime_type, film.size) == ("video/webm", data["bytes"])
    assert "1.5 s" in film.description
