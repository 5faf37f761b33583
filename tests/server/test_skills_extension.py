"""The skills extension: what is listed is what can be read, byte for byte."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import pytest
from mcp import Client, MCPError
from mcp.types import Request
from pydantic import TypeAdapter
from worldagent.server.app import create_server
from worldagent.server.extensions.tasks import TASKS
from worldagent.server.skill_files import SKILLS, skill_frontmatter, skill_names

pytestmark = pytest.mark.anyio


class AboutSkills(Request[dict[str, Any], str]):
    """A request of the extension."""

    method: str
    params: dict[str, Any]


async def ask(client: Client, method: str, **params: Any) -> dict[str, Any]:
    return await client.session.send_request(AboutSkills(method=method, params=params), TypeAdapter(dict[str, Any]))


async def test_listed_digests_are_those_of_what_is_served(tmp_path: Path, era: str) -> None:
    async with Client(create_server(tmp_path, tools=[]), mode=era) as client:
        if era == "auto":  # the handshake era has no field for extensions
            assert set(client.server_capabilities.extensions or {}) >= {"io.modelcontextprotocol/skills", TASKS}
        listed = await ask(client, "skills/list")
        assert [entry["frontmatter"]["name"] for entry in listed["skills"]] == skill_names()
        for entry in listed["skills"]:
            assert entry["uri"] in [file["uri"] for file in entry["resources"]]
            for file in entry["resources"]:
                (content,) = (await client.read_resource(file["uri"])).contents
                data = getattr(content, "text", "").encode()
                assert len(data) == file["size"]
                assert f"sha256:{hashlib.sha256(data).hexdigest()}" == file["digest"]


async def test_one_skill_is_as_it_is_listed(tmp_path: Path) -> None:
    async with Client(create_server(tmp_path, tools=[])) as client:
        listed = {entry["uri"]: entry for entry in (await ask(client, "skills/list"))["skills"]}
        found = await ask(client, "skills/get", uri="skill://repair/SKILL.md")
        assert found["skill"] == listed["skill://repair/SKILL.md"]
        with pytest.raises(MCPError, match="known skills") as caught:
            await ask(client, "skills/get", uri="skill://absent/SKILL.md")
    assert caught.value.code == -32602


@pytest.mark.parametrize("name", skill_names())
def test_the_head_of_a_skill_has_only_what_is_read_of_it(name: str) -> None:
    """The frontmatter is read without a YAML library, so it must be one plain `key: value` a line."""
    head = (SKILLS / name / "SKILL.md").read_text().split("---\n")[1]
    found = skill_frontmatter(name)
    assert found["name"] == name
    assert "".join(f"{key}: {value}\n" for key, value in found.items()) == head
    assert not any(": " in value or " #" in value or value[0] in "\"'[{&*!|>%@`" for value in found.values())
