"""Benchmark result-size: what the server's texts and replies cost the model that reads them.

A real client over stdio plays the demo with its flaws, builds the worlds of the skill `world-building`, and reads
every part and picture of them. Tokens are characters / 4, as clients estimate them. What counts is what clients show:
structured content where there is some, else the text blocks; pictures are counted in bytes. Target: replies below
20,000 characters, typical ones below 8,000, pictures below 700 kB.
"""

from __future__ import annotations

import asyncio
import base64
import json
import os
import statistics
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

__all__ = ["Recorder", "Seen", "run", "shown"]

CHARACTERS_PER_TOKEN = 4
EXAMPLES = ("two_blocks", "route_past_still_life")
PARTS = ("overview", "spec", "matrix", "revisions", "iterations", "state", "events", "records", "acceptance", "worlds")
PICTURES = ("preview", "still", "contact_sheet", "ids", "ledger", "plan", "section")
PROMPTS = {"make_world": {"prompt": "A ball rolls."}, "repair_world": {"world": "w"}, "review_world": {"world": "w"}}
FINAL = {"kind": "final", "width": 96, "height": 64, "samples": 1}


class Seen(NamedTuple):
    """One reply as the model sees it."""

    call: str
    """Tool and the argument that says what was asked for."""
    characters: int
    pictures: tuple[int, ...]
    """Bytes of each picture."""
    error: bool
    links: tuple[str, ...]


def shown(result: Any) -> str:
    """Text of a tool's result that clients pass to the model: structured content where there is some, else text blocks."""
    if result.structured_content is not None and not result.is_error:
        return json.dumps(result.structured_content, separators=(",", ":"), ensure_ascii=False)
    return "\n".join(block.text for block in result.content if block.type == "text")


class Recorder:
    """A client's `call_tool` that keeps the size of every reply."""

    def __init__(self, client: Any) -> None:
        self.client = client
        self.seen: list[Seen] = []

    async def call_tool(self, name: str, arguments: dict[str, Any]) -> Any:
        """The call itself."""
        result = await self.client.call_tool(name, arguments)
        what = next((str(arguments[k]) for k in ("part", "kind", "scope", "action") if k in arguments), "")
        if name == "edit_spec":
            what = "prompt" if "prompt" in arguments else "patch"
        pictures = tuple(len(base64.b64decode(b.data)) for b in result.content if b.type == "image")
        links = tuple(str(b.uri) for b in result.content if b.type == "resource_link")
        self.seen.append(Seen(f"{name} {what}".strip(), len(shown(result)), pictures, bool(result.is_error), links))
        return result

    async def read_resource(self, uri: str) -> Any:
        """Reading goes past the record: it is the agent's choice."""
        return await self.client.read_resource(uri)


async def _example(client: Any, name: str) -> None:
    """An accepted world of the skill, from prompt to acceptance."""
    from ..examples.domino_run import Agent
    from ..server.skill_files import SKILLS

    spec = json.loads((SKILLS / "world-building" / "examples" / f"{name}.json").read_text())
    agent = Agent(client, name, time.monotonic())
    await agent.call("edit_spec", prompt=spec.pop("prompt"), spec=spec)
    for tool, more in (("place_object", {}), ("probe_sim", {"wait_s": 120}), ("bake_sim", {"wait_s": 120})):
        await agent.call(tool, **more)
    await agent.call("run_checks", scope="acceptance", wait_s=120)


async def _read_all(client: Any, world: str) -> None:
    """Every part, picture and scope of a world, and the list of jobs."""
    for part in PARTS:
        result = await client.call_tool("inspect_world", {"world": world, "part": part})
        if part == "matrix" and not result.is_error:
            row = result.structured_content["rows"][0]["id"]
            await client.call_tool("inspect_world", {"world": world, "part": "row", "row": row})
    for kind in PICTURES:
        await client.call_tool("render_shot", {"world": world, "kind": kind, "frame": 10})
    for scope in ("audit", "static", "probe", "full"):
        await client.call_tool("run_checks", {"world": world, "scope": scope, "wait_s": 120})
    await client.call_tool("job", {"action": "list", "world": world})


async def _texts(client: Any) -> dict[str, int]:
    """Characters of what a model reads before it calls anything."""
    tools = (await client.list_tools()).tools
    described = [
        {"name": t.name, "description": t.description, "input_schema": t.input_schema, "output_schema": t.output_schema}
        for t in tools
    ]
    found = {
        "tools/list": len(json.dumps(described, separators=(",", ":"))),
        "instructions": len(client.instructions or ""),
    }
    for name, arguments in PROMPTS.items():
        found[f"prompt {name}"] = sum(len(m.content.text) for m in (await client.get_prompt(name, arguments)).messages)
    for resource in (await client.list_resources()).resources:
        contents = (await client.read_resource(str(resource.uri))).contents
        found[str(resource.uri)] = sum(len(c.text) for c in contents if hasattr(c, "text"))
    return found


async def _measure(workspace: Path) -> tuple[dict[str, int], list[Seen]]:
    from mcp import Client, StdioServerParameters

    from ..examples.domino_run import Agent
    from ..examples.domino_world import domino_spec
    from ..examples.flaws import plant

    args = ["-P", "-m", "worldagent.server", "serve", "--workspace", str(workspace)]
    async with Client(StdioServerParameters(command=sys.executable, args=args, env=dict(os.environ))) as client:
        texts = await _texts(client)
        recorder = Recorder(client)
        agent = Agent(recorder, "domino_run", time.monotonic())
        spec = domino_spec()
        plant(spec, 1, 3)
        await agent.work(spec)
        await agent.call("render_shot", wait_s=120, **FINAL)
        for name in EXAMPLES:
            print(f"world {name}", file=sys.stderr)
            await _example(recorder, name)
        for world in ("domino_run", *EXAMPLES):
            print(f"reading {world}", file=sys.stderr)
            await _read_all(recorder, world)
        return texts, recorder.seen


def tokens(characters: float) -> int:
    """Tokens of that many characters, as clients estimate them."""
    return round(characters / CHARACTERS_PER_TOKEN)


def summary(texts: Mapping[str, int], seen: list[Seen]) -> dict[str, Any]:
    """Figures of the texts and replies that were read."""
    tools: dict[str, list[Seen]] = defaultdict(list)
    for item in seen:
        tools[item.call.split()[0]].append(item)
    good = {name: [i for i in items if not i.error] for name, items in tools.items()}
    pictures = [size for item in seen for size in item.pictures]
    return {
        "tools_list_tokens": tokens(texts["tools/list"]),
        "instructions_tokens": tokens(texts["instructions"]),
        "texts_tokens": {k: tokens(v) for k, v in texts.items() if k not in ("tools/list", "instructions")},
        "tools": {
            name: {
                "calls": len(items),
                "median_tokens": tokens(statistics.median(i.characters for i in items)),
                "max_tokens": tokens(max(i.characters for i in items)),
                "largest": max(items, key=lambda i: i.characters).call,
            }
            for name, items in good.items()
            if items
        },
        "largest_replies": {
            call: max(i.characters for i in seen if i.call == call)
            for call in sorted({i.call for i in seen}, key=lambda c: -max(i.characters for i in seen if i.call == c))[:12]
        },
        "median_characters": round(statistics.median(i.characters for i in seen)),
        "share_over_8000_characters": round(sum(i.characters > 8000 for i in seen) / len(seen), 3),
        "max_characters": max(i.characters for i in seen),
        "refusals": sum(i.error for i in seen),
        "pictures": len(pictures),
        "max_picture_bytes": max(pictures, default=0),
    }


def run() -> dict[str, Any]:
    """Measure all of it in a fresh workspace; a few minutes."""
    with tempfile.TemporaryDirectory(prefix="worldagent-") as workspace:
        texts, seen = asyncio.run(_measure(Path(workspace)))
    return summary(texts, seen)
