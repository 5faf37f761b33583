"""Session of a scripted agent: a client with a server of its own, the way to acceptance, and the film."""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import shutil
import sys
import time
from collections.abc import Awaitable, Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from .domino_run import Agent

__all__ = ["WAIT_SECONDS", "accept", "main_of", "play", "play_spec"]

WAIT_SECONDS = 25.0
STEPS = (("place_object", "static_passed"), ("probe_sim", "passed"), ("bake_sim", "passed"))


A = TypeVar("A", bound=Agent)


def play(
    kind: type[A], world: str, prompt: str, options: argparse.Namespace, work: Callable[[A], Awaitable[dict[str, Any]]]
) -> dict[str, Any]:
    """One run in a fresh world folder of the workspace `options.out`; what happened.

    Args:
        kind: of the agent.
        world: its name.
        prompt: what is asked for.
        options: `out`, and `no_render` to leave out the film.
        work: all up to acceptance; its answer has `accepted`.
    """
    workspace = Path(options.out).resolve()
    shutil.rmtree(workspace / world, ignore_errors=True)
    workspace.mkdir(parents=True, exist_ok=True)
    return asyncio.run(_session(kind, world, prompt, options, workspace, work))


async def _session(
    kind: type[Any], world: str, prompt: str, options: argparse.Namespace, workspace: Path, work: Callable[[Any], Any]
) -> dict[str, Any]:
    from mcp import Client, StdioServerParameters

    started = time.monotonic()
    command = StdioServerParameters(
        command=sys.executable,
        args=["-P", "-m", "worldagent.server", "serve", "--workspace", str(workspace)],
        env=dict(os.environ),
    )
    async with Client(command) as client:
        agent = kind(client, world, started)
        agent.say(f"prompt: {prompt}")
        found: dict[str, Any] = await work(agent)
        if found["accepted"] and not options.no_render:
            agent.say("rendering the final sequence")
            size = {"samples": options.samples} if hasattr(options, "samples") else {}
            data, refused = await agent.call("render_shot", kind="final", wait_s=WAIT_SECONDS, **size)
            found["final"] = data
            agent.say(data["refused"] if refused else f"film: {data['frames']} frames of {data['width']} x {data['height']}")
        return found | {
            "calls": agent.calls,
            "seconds": round(time.monotonic() - started, 1),
            "world": str(workspace / agent.world),
        }


async def accept(agent: Agent, prompt: str, spec: dict[str, Any]) -> bool:
    """From a specification to the verdict without repairs; what fails is said."""
    data, refused = await agent.call("edit_spec", prompt=prompt, spec=spec)
    if refused or not data["audit"]["passed"]:
        agent.say(data.get("refused") or json.dumps(data["audit"]["open_rows"]))
        return False
    for tool, key in STEPS:
        data, refused = await agent.call(tool, detail="full", **({} if tool == "place_object" else {"wait_s": WAIT_SECONDS}))
        if refused or not data[key]:
            agent.say(data.get("refused") or f"{tool}: {json.dumps(data['open_rows'])[:4000]}")
            return False
        agent.say(f"{tool}: {data['counts']['pass']} rows pass")
    for _ in range(2):
        data, refused = await agent.call("run_checks", scope="acceptance", wait_s=WAIT_SECONDS)
        agent.say(data.get("refused") or f"acceptance: {data['says']}, {data['counts']['pass']} rows pass")
        if refused or data["verdict"] != "incomplete" or data["counts"]["fail"]:
            break
        # On a busy machine the time for pictures of the light may be over before all are there; these are kept.
        await agent.call("run_checks", scope="full", wait_s=WAIT_SECONDS)
    return not refused and bool(data["verdict"] == "accepted")


def play_spec(world: str, prompt: str, spec: dict[str, Any], options: argparse.Namespace) -> dict[str, Any]:
    """One run of a whole specification in a fresh world folder; what happened."""

    async def work(agent: Agent) -> dict[str, Any]:
        return {"accepted": await accept(agent, prompt, spec)}

    return play(Agent, world, prompt, options, work)


def main_of(
    world: str, prompt: str, frames: int, run: Callable[[argparse.Namespace], dict[str, Any]], argv: Sequence[str] | None
) -> int:
    """Command line of an example whose length is told in frames; exit code 0 when accepted, the last line is one JSON object."""
    parser = argparse.ArgumentParser(prog=world, description=prompt)
    parser.add_argument("--out", default="demo-out", help="workspace of the world")
    parser.add_argument("--frames", type=int, default=frames, help="at 24 per second")
    parser.add_argument("--samples", type=int, default=16, help="of each pixel of the film")
    parser.add_argument("--no-render", action="store_true")
    found = run(parser.parse_args(argv))
    print(json.dumps(found))
    return 0 if found["accepted"] else 1
