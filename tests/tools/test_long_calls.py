"""Placing and pictures that take long: progress while they go on, and a job that can be waited for and cancelled."""

from __future__ import annotations

from typing import Any, cast

import pytest
from worldagent.tests.stories.small_run import GAP, PROMPT, TOP, small_spec
from worldagent.tools.edit_spec import edit_spec
from worldagent.tools.job import job
from worldagent.tools.place_object import place_object
from worldagent.tools.render_shot import render_shot
from worldagent.workflow import placing, taken_pictures
from worldagent.workflow.arrangements import Array, Thing
from worldagent.workflow.context import ToolContext
from worldagent.workflow.places_asked import Asked


def test_placing_at_once_tells_what_it_does(context: ToolContext, told: list[tuple[float, float, str]]) -> None:
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    reply = place_object(context, world="w")
    assert reply.data["static_passed"]
    messages = [message for _, _, message in told]
    assert messages[0] == "building shapes"
    assert any("support" in m for m in messages)
    assert len(set(messages)) >= 5


def test_placing_in_a_large_world_is_a_job_with_the_reply_of_the_call(
    context: ToolContext, told: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    at_once = place_object(context, world="w")
    monkeypatch.setattr(placing, "THINGS_AT_ONCE", 0)
    begun = place_object(context, world="w", wait_s=0.0)
    assert begun.data["kind"] == "placing"
    assert begun.data["state"] in ("queued", "running")
    ended = job(context, action="wait", job_id=begun.data["job_id"], wait_s=120.0)
    assert ended.data["state"] == "done", ended.data
    assert ended.data["result"]["static_passed"]
    assert ended.data["result"]["counts"] == at_once.data["counts"]
    assert "entities built anew; the static checks pass" in ended.data["summary"]
    assert told, "a call that waits tells its progress"


def test_a_job_moves_what_the_call_would_move_and_tells_its_refusals(
    context: ToolContext, monkeypatch: pytest.MonkeyPatch
) -> None:
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    monkeypatch.setattr(placing, "THINGS_AT_ONCE", 0)
    moved = place_object(context, world="w", entity="b1", on="shelf", at=(0.02, 0.01), wait_s=240.0)
    assert (moved.data["moved"], moved.data["revision"]) == (True, 2), moved.data
    assert moved.data["pose"]["position"][2] == pytest.approx(TOP + GAP + 0.025, abs=1e-4)
    begun = place_object(context, world="w", entity="b1", on="nothing", wait_s=0.0)
    ended = job(context, action="wait", job_id=begun.data["job_id"], wait_s=120.0)
    assert ended.data["state"] == "failed"
    assert "nothing" in ended.data["error"]["message"]


def test_a_placing_job_is_cancelled_and_named_again(context: ToolContext, monkeypatch: pytest.MonkeyPatch) -> None:
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    monkeypatch.setattr(placing, "THINGS_AT_ONCE", 0)
    begun = place_object(context, world="w", entity="b1", on="shelf", at=(0.02, 0.01), hypothesis="h", wait_s=0.0)
    context.jobs.request_cancel(begun.data["job_id"])
    ended = job(context, action="wait", job_id=begun.data["job_id"], wait_s=60.0)
    assert ended.data["state"] == "cancelled"
    assert ended.data["next"].startswith("place_object(world='w', hypothesis='h', entity='b1', on='shelf'")


def test_many_things_are_a_job_whose_call_is_told_again(context: ToolContext, monkeypatch: pytest.MonkeyPatch) -> None:
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    monkeypatch.setattr(placing, "THINGS_AT_ONCE", 0)
    things = [Thing(entity="b1", on="shelf", at=(0.02, 0.01)), Thing(entity="b2", on="nothing")]
    done = place_object(context, world="w", things=things, hypothesis="h", wait_s=240.0)
    assert done.data["placed"][0]["id"] == "b1"
    assert "unknown entity 'nothing'" in done.data["not_placed"][0]["why"]
    begun = place_object(context, world="w", things=things, hypothesis="h", wait_s=0.0)
    context.jobs.request_cancel(begun.data["job_id"])
    ended = job(context, action="wait", job_id=begun.data["job_id"], wait_s=60.0)
    assert ended.data["next"].startswith("place_object(world='w', hypothesis='h', things=[{'entity': 'b1', 'on': 'shelf'")


def test_what_is_asked_for_survives_the_way_to_the_job() -> None:
    asked = Asked("chair", at=(1.0, 2.0), group=("lid", "leg"), array=Array(kind="grid", counts=(2, 3)), strict=False)
    assert placing.asked_of(placing.asked_plain(asked)) == asked


def test_a_fine_still_is_a_job_and_the_same_call_shows_it(context: ToolContext, monkeypatch: pytest.MonkeyPatch) -> None:
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    place_object(context, world="w")
    asked: dict[str, Any] = {"world": "w", "kind": "still", "width": 64, "height": 64, "samples": 1}
    monkeypatch.setattr(taken_pictures, "PATHS_AT_ONCE", 0)
    begun = render_shot(context, **asked, wait_s=0.0)
    assert not begun.pictures
    assert begun.data["kind"] == "picture"
    ended = job(context, action="wait", job_id=begun.data["job_id"], wait_s=120.0)
    assert ended.data["state"] == "done", ended.data
    assert ended.data["result"]["file"].startswith("pictures/still_")
    shown = render_shot(context, **asked, wait_s=0.0)
    assert shown.pictures
    assert shown.data["file"] == ended.data["result"]["file"]
    assert shown.data["camera"] == ended.data["result"]["camera"]


def test_a_picture_tells_no_time_left_before_anything_is_drawn(context: ToolContext, monkeypatch: pytest.MonkeyPatch) -> None:
    """Stills that took 70 s were told as 14 minutes, from the twentieth that a first step had counted for."""
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    asked = taken_pictures.PictureAsk("preview", 0, None, None, None, "static", (64, 64), None)
    told: list[tuple[float, float, str]] = []

    class Job:
        def progress(self, done: float, total: float, message: str) -> None:
            told.append((done, total, message))

    payload = {"folder": str(context.workspace / "w"), "asked": asked.plain()}
    assert taken_pictures.picture(payload, cast("Any", Job()))["file"].startswith("pictures/preview_")
    assert told[-1][2].startswith("drawing 64 x 64 pixels")
    assert all(done == 0.0 for done, _, _ in told)
