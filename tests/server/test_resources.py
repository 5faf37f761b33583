"""Resources, templates, prompts and completions through the in-memory client, in both protocol eras."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mcp import Client, MCPError
from mcp.types import PromptReference, Resource, ResourceTemplate, ResourceTemplateReference
from worldagent.execution import JobStore
from worldagent.server.app import create_server
from worldagent.server.skill_files import skill_files, skill_names
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.requirements import Correction, Row

pytestmark = pytest.mark.anyio

SPEC = {"spec_version": "1", "title": "Tiny", "prompt": "A box\nfalls.", "simulation": {"frames": 24}}


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    root = tmp_path / "workspace"
    for world in ("tiny", "other"):
        (root / world / "pictures").mkdir(parents=True)
        (root / world / "world.json").write_text(json.dumps(SPEC))
    (root / "tiny" / "pictures" / "sheet.jpg").write_bytes(b"\xff\xd8jpeg")
    (root / "tiny" / "pictures" / "plan.png").write_bytes(b"\x89PNG")
    (root / "tiny" / "acceptance").mkdir()
    (root / "tiny" / "acceptance" / "abc.html").write_text("<!DOCTYPE html>")
    (root / "tiny" / "acceptance" / "abc.zip").write_bytes(b"PK")
    (tmp_path / "secret.txt").write_text("secret")
    (root / "linked" / "pictures").mkdir(parents=True)
    (root / "linked" / "world.json").write_text(json.dumps(SPEC))
    (root / "linked" / "pictures" / "link.png").symlink_to(tmp_path / "secret.txt")
    ledger = Ledger(root / "tiny" / "ledger.sqlite")
    ledger.add_revision(json.dumps(SPEC), "0" * 64, expected=0, weakenings=["/limits"], reason="measured noise")
    correction = Correction(cause="too low", edit_class="scene", group="pose", action="raise box by 0.02 m")
    failing = Row(
        id="interpenetration:box:floor",
        check="interpenetration",
        group="spatial",
        predicate="clearance of box and floor",
        status="fail",
        measured=-0.02,
        bound=0.0,
        comparison=">=",
        unit="m",
        first_failing_entity="box",
        first_failing_frame=3,
        corrections=(correction,),
        evidence={"points": 2},
    )
    ledger.put_rows([failing], revision=1, stage="static")
    return root


async def read(client: Client, uri: str) -> Any:
    (content,) = (await client.read_resource(uri)).contents
    return content


async def test_every_resource_has_description_and_mime_type(workspace: Path, era: str) -> None:
    async with Client(create_server(workspace, tools=[]), mode=era) as client:
        resources = (await client.list_resources()).resources
        templates = (await client.list_resource_templates()).resource_templates
    assert {"worldagent://schema/world", "worldagent://capabilities", "worldagent://worlds"} <= {str(r.uri) for r in resources}
    uris = [t.uri_template for t in templates]
    assert uris == ["worldagent://schema/{part}"] + [
        f"worldagent://worlds/{{world}}/{part}"
        for part in ("spec", "matrix", "revisions", "report", "entities/{entity}", "pictures/{name}", "acceptance/{name}", "film")
    ] + ["worldagent://jobs/{job_id}", "worldagent://worlds/{world}/jobs", "skill://{name}/{+path}"] + [
        "worldagent://worlds/{world}/page{?view,status,group,q,row,offset,limit}"
    ]
    things: list[Resource | ResourceTemplate] = [*resources, *templates]
    for thing in things:
        assert thing.description
        assert thing.title
        assert thing.mime_type


async def test_general_resources(workspace: Path) -> None:
    async with Client(create_server(workspace, tools=[])) as client:
        schema = json.loads((await read(client, "worldagent://schema/world")).text)
        shape = json.loads((await read(client, "worldagent://schema/Shape")).text)
        assert "sphere" in shape["options"]
        with pytest.raises(MCPError, match="did you mean Sphere"):
            await client.read_resource("worldagent://schema/Spheres")
        assert "simulation" in schema["required"]
        assert json.loads((await read(client, "worldagent://worlds")).text) == {"worlds": ["linked", "other", "tiny"]}


async def test_capabilities_name_engines_versions_and_caps(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("worldagent.server.capabilities._renderer", lambda: {"engine": "mitsuba", "variant": "scalar_rgb"})
    async with Client(create_server(workspace, tools=[])) as client:
        found = json.loads((await read(client, "worldagent://capabilities")).text)
    assert found["categories"]["rigid"] == {
        "available": True,
        "engine": "mujoco",
        "covers": "rigid bodies, joints, ropes of links, drivers",
    }
    assert found["categories"]["liquid"]["engine"] == "dfsph, flip"
    assert found["categories"]["gas"]["engine"] == "gas"
    assert found["versions"]["mujoco"]
    assert found["caps"]["bodies"]["value"] == 2000


async def test_a_world_can_be_read(workspace: Path, era: str) -> None:
    async with Client(create_server(workspace, tools=[]), mode=era) as client:
        assert json.loads((await read(client, "worldagent://worlds/tiny/spec")).text) == SPEC
        matrix = json.loads((await read(client, "worldagent://worlds/tiny/matrix")).text)
        assert matrix["revision"] == 1
        assert [row["id"] for row in matrix["rows"]] == ["interpenetration:box:floor"]
        revisions = json.loads((await read(client, "worldagent://worlds/tiny/revisions")).text)
        assert revisions["revisions"][0]["reason"] == "measured noise"
        report = (await read(client, "worldagent://worlds/tiny/report")).text
    for part in (
        "# Tiny",
        "> A box\n> falls.",
        "1 fail",
        "-0.02 m",
        ">= 0 m",
        "box frame 3",
        "raise box by 0.02 m",
        "measured noise",
        "Never judged",
    ):
        assert part in report


async def test_reading_makes_no_ledger(workspace: Path) -> None:
    async with Client(create_server(workspace, tools=[])) as client:
        assert json.loads((await read(client, "worldagent://worlds/other/matrix")).text)["rows"] == []
        assert "nothing has been checked" in (await read(client, "worldagent://worlds/other/report")).text
    assert not (workspace / "other" / "ledger.sqlite").exists()


async def test_pictures_are_binary_with_their_own_mime_type(workspace: Path, era: str) -> None:
    async with Client(create_server(workspace, tools=[]), mode=era) as client:
        jpeg = await read(client, "worldagent://worlds/tiny/pictures/sheet.jpg")
        png = await read(client, "worldagent://worlds/tiny/pictures/plan.png")
    assert (jpeg.mime_type, png.mime_type) == ("image/jpeg", "image/png")
    assert jpeg.blob


async def test_report_and_bundle_are_served_with_their_own_mime_type(workspace: Path, era: str) -> None:
    async with Client(create_server(workspace, tools=[]), mode=era) as client:
        page = await read(client, "worldagent://worlds/tiny/acceptance/abc.html")
        bundle = await read(client, "worldagent://worlds/tiny/acceptance/abc.zip")
    assert (page.mime_type, bundle.mime_type) == ("text/html", "application/zip")
    assert base64.b64decode(bundle.blob) == b"PK"


@pytest.mark.parametrize(
    ("uri", "told"),
    [
        ("worldagent://worlds/tiny/acceptance/none.zip", "abc.zip"),
        ("worldagent://worlds/nowhere/spec", "tiny"),
        ("worldagent://worlds/tiny/pictures/absent.png", "sheet.jpg"),
        ("skill://absent/SKILL.md", "known skills"),
        ("worldagent://absent", "Unknown resource"),
    ],
)
async def test_what_is_missing_names_what_is_known(workspace: Path, era: str, uri: str, told: str) -> None:
    async with Client(create_server(workspace, tools=[]), mode=era) as client:
        with pytest.raises(MCPError) as caught:
            await client.read_resource(uri)
    assert caught.value.code == -32602
    assert told in str(caught.value)


@pytest.mark.parametrize(
    "uri",
    [
        "worldagent://worlds/..%2F..%2Fetc/spec",
        "worldagent://worlds/../spec",
        "worldagent://worlds/tiny/pictures/..%2Fworld.json",
        "worldagent://worlds/tiny/pictures/%2Fetc%2Fpasswd",
        "worldagent://worlds/linked/pictures/link.png",
        "worldagent://worlds/linked/spec",
        "worldagent://worlds/tiny/pictures/%00",
        "worldagent://worlds/tiny/acceptance/..%2Fledger.sqlite",
        "skill://../../pyproject.toml",
        "skill://..%2Fserver/app.py",
        "skill://world-building/../../pyproject.toml",
        "skill://world-building/..%2F..%2Fpyproject.toml",
    ],
)
async def test_no_path_leads_out(workspace: Path, uri: str) -> None:
    async with Client(create_server(workspace, tools=[])) as client:
        with pytest.raises(MCPError):
            await client.read_resource(uri)


async def test_skills_can_be_listed_and_read(workspace: Path) -> None:
    async with Client(create_server(workspace, tools=[])) as client:
        listed = {str(r.uri): r for r in (await client.list_resources()).resources}
        assert skill_names()
        for name in skill_names():
            assert (listed[f"skill://{name}/SKILL.md"].description or "") != f"Skill {name}"
            for file in skill_files(name):
                content = await read(client, f"skill://{name}/{file}")
                assert content.text
                assert content.mime_type == ("text/markdown" if file.endswith(".md") else "application/json")


async def test_prompts_name_tools_and_skills(workspace: Path, era: str) -> None:
    async with Client(create_server(workspace, tools=[]), mode=era) as client:
        prompts = {prompt.name: prompt for prompt in (await client.list_prompts()).prompts}
        assert list(prompts) == ["make_world", "repair_world", "review_world"]
        made = await client.get_prompt("make_world", {"prompt": "A {box} falls"})
        repaired = await client.get_prompt("repair_world", {"world": "tiny"})
        reviewed = await client.get_prompt("review_world", {"world": "tiny"})
    assert all(prompt.description and prompt.title for prompt in prompts.values())
    for result, parts in (
        (made, ("A {box} falls", "edit_spec", "bake_sim", "skill://world-building/SKILL.md")),
        (repaired, ("worldagent://worlds/tiny/report", "hypothesis")),
        (reviewed, ("worldagent://worlds/tiny/matrix", "without changing")),
    ):
        content: Any = result.messages[0].content
        for part in parts:
            assert part in content.text


async def test_worlds_skills_and_pictures_are_completed(workspace: Path, era: str) -> None:
    template: Callable[[str], ResourceTemplateReference] = lambda uri: ResourceTemplateReference(type="ref/resource", uri=uri)  # noqa: E731
    async with Client(create_server(workspace, tools=[]), mode=era) as client:
        spec = await client.complete(template("worldagent://worlds/{world}/spec"), {"name": "world", "value": "t"})
        prompt = await client.complete(PromptReference(type="ref/prompt", name="repair_world"), {"name": "world", "value": ""})
        skills = await client.complete(template("skill://{name}/{+path}"), {"name": "name", "value": ""})
        pictures = await client.complete(
            template("worldagent://worlds/{world}/pictures/{name}"),
            {"name": "name", "value": "s"},
            context_arguments={"world": "tiny"},
        )
        escaped = await client.complete(
            template("worldagent://worlds/{world}/pictures/{name}"),
            {"name": "name", "value": ""},
            context_arguments={"world": "../tiny"},
        )
    assert spec.completion.values == ["tiny"]
    assert prompt.completion.values == ["linked", "other", "tiny"]
    assert skills.completion.values == skill_names()
    assert pictures.completion.values == ["sheet.jpg"]
    assert escaped.completion.values == []


async def test_jobs_can_be_read_and_reading_makes_none(workspace: Path, era: str) -> None:
    async with Client(create_server(workspace, tools=[]), mode=era) as client:
        assert json.loads((await read(client, "worldagent://jobs")).text) == {"jobs": []}
        with pytest.raises(MCPError, match="has had none"):
            await read(client, "worldagent://jobs/job_000000000000")
        assert not (workspace / ".worldagent").exists()
        job = JobStore(workspace).submit(
            "bake", "tiny", {"seconds": 0, "label": "x"}, entry="worldagent.server.conformance.jobs:sleep"
        )
        JobStore(workspace).wait(job.id, 30)
        found = json.loads((await read(client, f"worldagent://jobs/{job.id}")).text)
        listed = json.loads((await read(client, "worldagent://jobs")).text)["jobs"]
        of_world = json.loads((await read(client, "worldagent://worlds/tiny/jobs")).text)["jobs"]
        of_other = json.loads((await read(client, "worldagent://worlds/other/jobs")).text)["jobs"]
        with pytest.raises(MCPError, match="no job"):
            await read(client, "worldagent://jobs/job_000000000000")
    assert (found["state"], found["result"]) == ("done", {"label": "x", "seconds": 0.0})
    assert [entry["job_id"] for entry in listed] == [entry["job_id"] for entry in of_world] == [job.id]
    assert of_other == []


async def test_an_entity_can_be_read(workspace: Path, era: str) -> None:
    (workspace / "other" / "world.json").write_text(json.dumps(SPEC | {"entities": {"ball_1": {"role": "ball"}, "floor": {}}}))
    async with Client(create_server(workspace, tools=[]), mode=era) as client:
        found = json.loads((await read(client, "worldagent://worlds/other/entities/ball_1")).text)
        with pytest.raises(MCPError, match="ball_1"):
            await read(client, "worldagent://worlds/other/entities/ball_2")
    assert found == {"world": "other", "entity": "ball_1", "contract": {"role": "ball"}}


async def test_entities_jobs_and_files_of_skills_are_completed(workspace: Path, era: str) -> None:
    (workspace / "other" / "world.json").write_text(json.dumps(SPEC | {"entities": {"ball_1": {}, "ball_2": {}, "floor": {}}}))
    store = JobStore(workspace)
    ids = [store.submit("bake", world, {"seconds": 0, "label": "x"}, entry="worldagent.server.conformance.jobs:sleep").id
           for world in ("tiny", "other")]  # fmt: skip
    async with Client(create_server(workspace, tools=[], store=store), mode=era) as client:

        async def values(uri: str, argument: str, value: str, **given: str) -> list[str]:
            reference = ResourceTemplateReference(type="ref/resource", uri=uri)
            found = await client.complete(reference, {"name": argument, "value": value}, context_arguments=given)
            return found.completion.values

        entity = "worldagent://worlds/{world}/entities/{entity}"
        assert await values(entity, "entity", "ball", world="other") == ["ball_1", "ball_2"]
        assert await values(entity, "entity", "_2", world="other") == ["ball_2"], "what contains it, where nothing begins so"
        assert await values(entity, "entity", "", world="../other") == []
        assert await values("worldagent://jobs/{job_id}", "job_id", "job_") == ids[::-1]
        assert await values("skill://{name}/{+path}", "path", "SK", name="repair") == ["SKILL.md"]
        assert await values("skill://{name}/{+path}", "path", "", name="../server") == []
        assert await values("worldagent://worlds/{world}/acceptance/{name}", "name", "", world="tiny") != []
        assert await values("worldagent://worlds/{world}/pictures/{name}", "other", "") == []


async def test_a_row_s_link_into_a_table_of_a_skill_leads_to_its_entry(tmp_path: Path) -> None:
    """Rows cite `skill://rigid-bodies/diagnosis.json#creeps`: both the resource and the guide give that entry alone."""
    async with Client(create_server(tmp_path)) as client:
        uri = "skill://rigid-bodies/diagnosis.json#beat-late"
        entry = json.loads((await client.read_resource(uri)).contents[0].text)
        assert entry["id"] == "beat-late"
        told = await client.call_tool("inspect_world", {"part": "guide", "pointer": uri})
        assert json.loads(told.structured_content["text"])["id"] == "beat-late"
        for call in (lambda: client.read_resource(uri.replace("late", "laet")),):
            with pytest.raises(MCPError, match="beat-late"):
                await call()
