"""A small world through all tools, in worker processes: `python watched_run.py WORKSPACE part|whole`; its texts are all Python code."""

from __future__ import annotations

import asyncio
import json
import os
import sys
from pathlib import Path
from typing import Any

from mcp import Client
from worldagent.server.app import create_server
from worldagent.server.quiet import silence_telemetry
from worldagent.tests.stories.small_run import PROMPT, small_spec

CODE = f"__import__('os').system('touch /tmp/{os.environ['WATCH_MARKER']}') # {os.environ['WATCH_MARKER']} ${{7*7}} {{{{7*7}}}}"


async def main(workspace: Path, *, whole: bool) -> None:
    spec = small_spec()
    spec["title"] = CODE[:200]
    for beat in spec["story"]["beats"].values():
        beat["text"] += " " + CODE
    for name in ("floor", "shelf"):
        spec["entities"][name]["role"] = CODE
    spec["claims"]["code"] = {"quote": "${7*7} {{7*7}}", "type": "look", "waived": CODE}
    spec["shots"]["only"]["intent"] = CODE
    async with Client(create_server(workspace)) as client:

        async def call(tool: str, **arguments: Any) -> dict[str, Any]:
            answer = await client.call_tool(tool, {"world": "w", **arguments})
            assert not answer.is_error, f"{tool}: {answer.content[0].text}"  # type: ignore[union-attr]
            data: dict[str, Any] = json.loads(answer.content[0].text)  # type: ignore[union-attr]
            return data

        await call("edit_spec", prompt=f"{PROMPT} {CODE}", spec=spec)
        await call("edit_spec", patch=[{"op": "add", "path": "/look/exposure", "value": 0.1}], hypothesis=CODE)
        await call("place_object")
        await call("render_shot", kind="preview")
        await call("probe_sim", wait_s=200)
        if whole:
            await call("bake_sim", wait_s=200)
            await call("run_checks", scope="acceptance", wait_s=240)
            await call("render_shot", kind="final", wait_s=240)
        for part in ("overview", "matrix", "revisions", "state"):
            await call("inspect_world", part=part)
        for uri in ("worldagent://worlds/w/report", "worldagent://worlds/w/spec", "worldagent://capabilities"):
            await client.read_resource(uri)


if __name__ == "__main__":
    silence_telemetry()
    asyncio.run(main(Path(sys.argv[1]), whole=sys.argv[2] == "whole"))
