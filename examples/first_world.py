"""The first accepted world on a new machine, through a real client: `python -m worldagent.examples.first_world`.

It takes the smallest example of the skill `world-building` from its prompt to acceptance and a picture, and prints what
each step took. `--client codex` and `--client claude` have those programs make the calls, without an account, with the
servers that stand in their lists, so that what `worldagent setup` wrote is what runs.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

from ..worlds.errors import EngineError
from .real_clients import ClaudeClient, CodexClient, SdkClient, ToolClient

__all__ = ["first_world", "main", "two_blocks"]

WAIT_SECONDS = 25.0
"""Time that a call waits for its job; the shortest limit of a client is 60 s [s]."""
PROGRAMS: dict[str, Callable[[str], ToolClient]] = {"codex": CodexClient, "claude": ClaudeClient}
"""Clients that are programs of their own."""


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
    parser.add_argument("--client", choices=("sdk", *PROGRAMS), default="sdk")
    parser.add_argument("--program", default="", help="sdk: the server's executable; others: theirs")
    parser.add_argument("--workspace", type=Path, default=Path.home() / "worldagent", help="sdk: root of all worlds")
    parser.add_argument("--world", default="first_world", help="id of the new world")
    options = parser.parse_args(argv)
    begin = time.monotonic()
    if options.client in PROGRAMS:
        client = PROGRAMS[options.client](options.program or options.client)
        try:
            found = asyncio.run(first_world(client, options.world))
        finally:
            client.close()
    else:
        program = [options.program] if options.program else [sys.executable, "-P", "-m", "worldagent.server"]
        found = asyncio.run(_with_sdk(program, options.workspace.expanduser().absolute(), options.world))
    found["wall_s"] = round(time.monotonic() - begin, 1)
    print(json.dumps(found))
    return 0 if found["accepted"] and found["pictures"] else 1


if __name__ == "__main__":
    sys.exit(main())
