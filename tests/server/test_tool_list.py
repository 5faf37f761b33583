"""The real tools as a client sees them: what they are called, what they take, what importing them costs."""

from __future__ import annotations

import base64
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from mcp import Client
from worldagent.server.app import INSTRUCTIONS, create_server
from worldagent.server.prompts import make_world, repair_world, review_world
from worldagent.tools import TOOLS

SNAPSHOT = Path(__file__).with_name("tool_list.json")
HEAVY = ("numpy", "scipy", "mujoco", "mitsuba", "drjit", "warp", "cv2", "fcl", "trimesh", "coacd", "worldagent.worlds.spec")
VERBS = ("edit", "build", "place", "probe", "bake", "run", "render", "inspect", "export", "create")
_LIST = """
import asyncio, json, sys
from pathlib import Path
from mcp import Client
from worldagent.server.app import create_server

async def main():
    async with Client(create_server(Path(sys.argv[1]) / "absent")) as client:
        await client.list_tools(), await client.list_resources()
        await client.list_resource_templates(), await client.list_prompts()
        await client.read_resource("worldagent://worlds")

asyncio.run(main())
print(json.dumps(sorted(sys.modules)))
"""


def test_listing_loads_no_heavy_library_and_makes_no_workspace(tmp_path: Path) -> None:
    child = subprocess.run([sys.executable, "-c", _LIST, str(tmp_path)], capture_output=True, text=True, timeout=60, check=True)
    loaded = set(json.loads(child.stdout.splitlines()[-1]))
    assert not loaded & set(HEAVY)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.anyio
async def test_tools_are_as_the_snapshot_says(tmp_path: Path, era: str) -> None:
    """A renamed tool or argument breaks the prompts of users: change `tool_list.json` only on purpose."""
    async with Client(create_server(tmp_path), mode=era) as client:
        first, second = (await client.list_tools()).tools, (await client.list_tools()).tools
    assert first == second
    seen = [
        {
            "name": tool.name,
            "arguments": {name: name in tool.input_schema.get("required", ()) for name in tool.input_schema["properties"]},
            "read_only": tool.annotations.read_only_hint if tool.annotations else None,
            "open_world": tool.annotations.open_world_hint if tool.annotations else None,
            "structured": tool.output_schema is not None,
        }
        for tool in first
    ]
    assert seen == json.loads(SNAPSHOT.read_text())


@pytest.mark.anyio
async def test_who_sketches_hears_beforehand_that_looking_counts(tmp_path: Path) -> None:
    """Where frames are offered it is told what seeing them asks of the next edit, and not only afterwards."""
    async with Client(create_server(tmp_path)) as client:
        (probe,) = (t for t in (await client.list_tools()).tools if t.name == "probe_sim")
    assert probe.description
    _, _, after = " ".join(probe.description.split()).partition("sketch={")
    assert "looked at (render_shot, inspect_world) before any verdict count as evidence" in after
    assert "names its hypothesis" in after


@pytest.mark.anyio
async def test_every_tool_is_described_within_what_clients_show(tmp_path: Path) -> None:
    async with Client(create_server(tmp_path)) as client:
        tools = (await client.list_tools()).tools
    icons: set[str] = set()
    for tool in tools:
        assert tool.title
        assert tool.description
        assert len(tool.description.encode()) < 2048
        assert tool.meta is not None
        assert 10 < len(tool.meta["anthropic/searchHint"]) < 120
        assert tool.icons is not None
        assert tool.icons[0].src.startswith("data:image/svg+xml;base64,")
        drawing = ElementTree.fromstring(base64.b64decode(tool.icons[0].src.partition(",")[2]))
        assert [child.tag.rpartition("}")[2] for child in drawing] == ["path"], "a drawing, nothing that could run"
        icons.add(tool.icons[0].src)
        for name, schema in tool.input_schema["properties"].items():
            assert schema.get("description"), f"{tool.name}.{name}"
        for node in _nodes(tool.input_schema):
            assert node.get("type") != "array" or "items" in node, f"{tool.name}: some APIs refuse arrays without items"
    assert len(icons) == len(tools)


def test_instructions_and_prompts_name_only_tools_that_exist() -> None:
    known = {binding.name for binding in TOOLS}
    for text in (
        INSTRUCTIONS,
        make_world("x"),
        repair_world("w"),
        review_world("w"),
        *(binding.description for binding in TOOLS),
    ):
        named = set(re.findall(rf"\b(?:{'|'.join(VERBS)})_[a-z]+\b", text))
        assert named <= known | {"make_world", "repair_world", "review_world"}, named - known


def _nodes(schema: Any) -> list[dict[str, Any]]:
    if isinstance(schema, list):
        return [node for item in schema for node in _nodes(item)]
    if not isinstance(schema, dict):
        return []
    return [schema, *(node for value in schema.values() for node in _nodes(value))]
