"""From a prompt to an accepted world and its final video, through a client."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import Any

import anyio
import pytest
from mcp import Client, StdioServerParameters
from worldagent.tests.stories.small_run import small_spec

GROUPS = {"spatial", "physical", "temporal", "observational", "delivery"}
CHECKS = {
    "scale",
    "interpenetration",
    "support",
    "navigability",
    "causal",
    "category",
    "numerical",
    "contact",
    "shots",
    "delivery",
}
PHASES = ("preroll", "activation", "first_contact", "peak_response", "early_settling")


def test_a_prompt_becomes_an_accepted_world_with_rows_links_and_job_ids(loop: Any, accepted: Any) -> None:
    data = {name: json.loads(answer.content[0].text) for name, answer in loop.answers.items()}
    assert all(answer.structured_content == data[name] for name, answer in loop.answers.items())
    created, placed, probed, baked, verdict = (data[k] for k in ("create", "place", "probe", "bake", "accept"))
    assert "claims_to_make" not in created
    assert created["audit"]["passed"]
    assert created["bake_order"] == ["rigid"]
    assert loop.answers["create"].content[1].uri == "worldagent://worlds/w/spec"
    assert "place_object" in created["next"]

    assert set(placed["built"]) == set(small_spec()["entities"])
    assert placed["static_passed"]
    assert accepted.call("place_object", world="w")["built"] == []

    assert probed["passed"]
    assert probed["job_id"].startswith("job_")
    assert all(probed["phases"][p] is not None for p in PHASES)
    assert loop.answers["probe"].content[1].mime_type == "image/jpeg"
    assert (loop.workspace / "w" / "pictures" / probed["picture"]).is_file()

    assert (baked["complete"], baked["frames"], baked["passed"]) == (True, 36, True)
    assert verdict["verdict"] == "accepted"
    assert verdict["counts"]["mandatory_open"] == 0
    assert all(interval["identical"] for interval in verdict["replayed"])
    assert len(verdict["replayed"]) >= 3
    assert any("skin" in line["what"] for line in verdict["approximations"])

    rows = accepted.pages("rows", part="matrix", detail="full")
    assert {r["group"] for r in rows} == GROUPS
    assert {r["check"] for r in rows} >= CHECKS
    assert all(r["artifact"] for r in rows)
    linked = {c.uri.rpartition(".")[2]: c.uri for c in loop.answers["accept"].content if c.type == "resource_link"}
    assert linked == {
        "html": f"worldagent://worlds/w/{verdict['report']}",
        "zip": f"worldagent://worlds/w/{verdict['bundle']}",
    }
    told = accepted.call("inspect_world", world="w", part="acceptance")
    assert (told["report"], told["bundle"]) == (verdict["report"], verdict["bundle"])
    kept = told["acceptance"]
    assert kept["verdict"] == "accepted"
    assert kept["approximations"] == verdict["approximations"]
    assert {j["kind"]: j["state"] for j in data["jobs"]["jobs"]} == {"probe": "done", "bake": "done", "accept": "done"}


def test_an_accepted_world_renders_its_final_sequence(loop: Any, accepted: Any) -> None:
    data = accepted.call("render_shot", world="w", kind="final", width=64, height=64, samples=1)
    assert data["says"] == json.loads(loop.answers["accept"].content[0].text)["says"] == "accepted, prompt read by nobody"
    assert (data["frames"], data["width"], data["height"]) == (36, 64, 64)
    video = accepted.workspace / "w" / data["video"]
    assert video.stat().st_size > 1000


def test_pictures_come_inline_and_as_links(accepted: Any) -> None:
    for kind in ("preview", "contact_sheet", "plan"):
        answer = accepted.result("render_shot", world="w", kind=kind, frame=0, width=96, height=64)
        assert not answer.is_error, answer.content[0].text
        assert [c.type for c in answer.content] == ["text", "image", "resource_link"]
        assert answer.structured_content is None


def test_measurements_name_their_source(accepted: Any) -> None:
    state = accepted.call("inspect_world", world="w", part="state", entities=["b3"], frames=[35, 35])
    assert state["stage"] == "full"
    assert state["entities"]["b3"]["position"][2] < 0.2
    events = accepted.call("inspect_world", world="w", part="events", entities=["ball"])
    assert any({e["a"], e["b"]} == {"ball", "b1"} for e in events["events"])
    records = accepted.call("inspect_world", world="w", part="records", limit=10)["records"]
    assert records["mass"]["unit"] == "kg"


@pytest.mark.anyio
async def test_a_client_over_stdio_places_and_checks(copy: Path) -> None:
    command = StdioServerParameters(
        command=sys.executable,
        args=["-P", "-m", "worldagent.server", "serve", "--workspace", str(copy.parent)],
        env=dict(os.environ),
    )
    with anyio.fail_after(100):
        async with Client(command) as client:

            async def call(tool: str, **arguments: Any) -> dict[str, Any]:
                answer = await client.call_tool(tool, arguments)
                assert not answer.is_error, answer.content[0].text
                return json.loads(answer.content[0].text)

            assert (await call("place_object", world="w"))["built"] == []
            started = await call("run_checks", world="w", scope="full", only=["beat"], wait_s=0)
            assert started["state"] in ("queued", "running")
            ended = await call("job", action="wait", job_id=started["job_id"], wait_s=90)
            assert ended["state"] == "done"
            assert ended["result"]["counts"]["mandatory_open"] == 0
