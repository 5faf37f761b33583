"""The first accepted world on a new machine, through a real client: `python -m worldagent.examples.first_world`.

It takes the smallest example of the skill `world-building` from its prompt to acceptance and a picture, and prints what
each step took. `--client codex` has Codex's own MCP client make the calls (`codex app-server`, no account needed) with
the servers that stand in its list, so that what `worldagent setup codex` wrote is what runs.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any, Protocol

from ..worlds.errors import EngineError

__all__ = ["CodexClient", "SdkClient", "first_world", "main", "two_blocks"]

WAIT_SECONDS = 25.0
"""How long a call waits for its job; the shortest limit of a client is 60 s [s]."""
SERVER = "worldagent"


class ToolClient(Protocol):
    """Something that calls tools of one server."""

    async def call(self, tool: str, arguments: dict[str, Any]) -> tuple[dict[str, Any], int]:
        """Data of the reply and how many pictures came along.

        Raises:
            EngineError: The call was refused.
        """
        ...


class SdkClient:
    """The MCP SDK's client, over stdio to a program."""

    def __init__(self, client: Any) -> None:
        self._client = client

    async def call(self, tool: str, arguments: dict[str, Any]) -> tuple[dict[str, Any], int]:
        """See `ToolClient`."""
        result = await self._client.call_tool(tool, arguments)
        return _data(tool, [block.model_dump() for block in result.content], result.structured_content, result.is_error)


class CodexClient:
    """Codex's client, reached through `codex app-server`."""

    def __init__(self, program: str) -> None:
        self._process = subprocess.Popen(
            [program, "app-server"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        self._count = 0
        self._ask("initialize", {"clientInfo": {"name": "worldagent", "version": "1"}, "capabilities": {"experimentalApi": True}})
        self._send({"method": "initialized"})
        self._thread = self._ask("thread/start", {"cwd": str(Path.cwd())})["thread"]["id"]

    async def call(self, tool: str, arguments: dict[str, Any]) -> tuple[dict[str, Any], int]:
        """See `ToolClient`."""
        where = {"threadId": self._thread, "server": SERVER}
        found = self._ask("mcpServer/tool/call", {**where, "tool": tool, "arguments": arguments})
        return _data(tool, found["content"], found.get("structuredContent"), bool(found.get("isError")))

    def close(self) -> None:
        """End Codex, and with it the server; jobs live on."""
        self._process.terminate()
        self._process.communicate(timeout=10.0)

    def _send(self, message: dict[str, Any]) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(message) + "\n")
        self._process.stdin.flush()

    def _ask(self, method: str, parameters: dict[str, Any]) -> dict[str, Any]:
        self._count += 1
        self._send({"id": self._count, "method": method, "params": parameters})
        assert self._process.stdout is not None
        for line in self._process.stdout:
            answer = json.loads(line)
            if answer.get("id") == self._count and "method" not in answer:
                if "error" in answer:
                    raise EngineError(f"codex {method}: {answer['error'].get('message')}")
                result: dict[str, Any] = answer["result"]
                return result
        raise EngineError(f"codex ended during {method}")


def _data(
    tool: str, content: Sequence[dict[str, Any]], structured: dict[str, Any] | None, is_error: bool
) -> tuple[dict[str, Any], int]:
    text = next((block["text"] for block in content if block["type"] == "text"), "")
    if is_error:
        raise EngineError(f"{tool}: {text}")
    pictures = sum(block["type"] == "image" for block in content)
    return structured if structured is not None else json.loads(text), pictures


def two_blocks() -> dict[str, Any]:
    """Prompt and specification of the smallest example that ships with the skill."""
    text = (files("worldagent.skills") / "world-building" / "examples" / "two_blocks.json").read_text(encoding="utf-8")
    found: dict[str, Any] = json.loads(text)
    return found


async def first_world(client: ToolClient, world: str) -> dict[str, Any]:
    """Seconds per step, number of calls, and whether the world was accepted and shown."""
    spec = two_blocks()
    prompt = spec.pop("prompt")
    steps: list[dict[str, Any]] = []
    calls = 0

    async def step(name: str, tool: str, **arguments: Any) -> tuple[dict[str, Any], int]:
        nonlocal calls
        begin = time.monotonic()
        data, pictures = await client.call(tool, {"world": world, **arguments})
        calls += 1
        while data.get("state") in ("queued", "running"):
            answer, _ = await client.call("job", {"action": "wait", "job_id": data["job_id"], "wait_s": WAIT_SECONDS})
            calls += 1
            if answer["state"] in ("failed", "cancelled", "lost"):
                raise EngineError(f"{name}: {answer}")
            data = answer["result"] if answer["state"] == "done" else answer
        steps.append({"step": name, "tool": tool, "seconds": round(time.monotonic() - begin, 1)})
        print(f"{steps[-1]['seconds']:6.1f} s  {name}", flush=True)
        return data, pictures

    await step("specify", "edit_spec", prompt=prompt, spec=spec)
    await step("build, place, static checks", "place_object")
    await step("probe", "probe_sim", wait_s=WAIT_SECONDS)
    await step("bake", "bake_sim", wait_s=WAIT_SECONDS)
    verdict, _ = await step("acceptance", "run_checks", scope="acceptance", wait_s=WAIT_SECONDS)
    _, pictures = await step("a picture", "render_shot", kind="contact_sheet", wait_s=WAIT_SECONDS)
    return {"accepted": verdict.get("verdict") == "accepted", "pictures": pictures, "calls": calls, "steps": steps}


async def _with_sdk(program: Sequence[str], workspace: Path, world: str) -> dict[str, Any]:
    from mcp import Client, StdioServerParameters

    arguments = [*program[1:], "serve", "--workspace", str(workspace)]
    async with Client(StdioServerParameters(command=program[0], args=arguments, env=dict(os.environ))) as client:
        return await first_world(SdkClient(client), world)


def main(argv: Sequence[str] | None = None) -> int:
    """Exit code 0 when the world was accepted and a picture came along; the last line is one JSON object."""
    parser = argparse.ArgumentParser(prog="first_world", description="The first accepted world through a real client.")
    parser.add_argument("--client", choices=("sdk", "codex"), default="sdk")
    parser.add_argument("--program", default="", help="sdk: the server's executable; codex: the codex executable")
    parser.add_argument("--workspace", type=Path, default=Path.home() / "worldagent", help="sdk: root of all worlds")
    parser.add_argument("--world", default="first_world", help="id of the new world")
    options = parser.parse_args(argv)
    begin = time.monotonic()
    if options.client == "codex":
        codex = CodexClient(options.program or "codex")
        try:
            found = asyncio.run(first_world(codex, options.world))
        finally:
            codex.close()
    else:
        program = [options.program] if options.program else [sys.executable, "-P", "-m", "worldagent.server"]
        found = asyncio.run(_with_sdk(program, options.workspace.expanduser().absolute(), options.world))
    found["wall_s"] = round(time.monotonic() - begin, 1)
    print(json.dumps(found))
    return 0 if found["accepted"] and found["pictures"] else 1


if __name__ == "__main__":
    sys.exit(main())
