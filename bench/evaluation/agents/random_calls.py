"""An agent that calls tools at random, with arguments that look valid: nothing that it does may ever be accepted."""

from __future__ import annotations

import json
import random
from importlib.resources import files
from typing import Any

from inspect_ai.model import ModelOutput
from inspect_ai.solver import Generate, Solver, TaskState, solver

from ..attempts import Attempt, conduct
from .schemas import drawn

__all__ = ["random_calls"]

SENSIBLE = 0.7
"""Share of calls whose world and prompt are the sample's own, so that they reach something."""


@solver
def random_calls(seed: int = 0, calls: int = 30) -> Solver:
    """Random calls from the schemas of the tools; it needs no model.

    Most calls of `edit_spec` propose an example of the skills with one thing lifted, so that later calls have a world to work on.

    Args:
        seed: draws, with the sample's id and epoch.
        calls: how many.
    """

    async def solve(state: TaskState, generate: Generate) -> TaskState:
        rng = random.Random(f"{seed}/{state.sample_id}/{state.epoch}")

        async def work(attempt: Attempt) -> None:
            refused = 0
            async with attempt.client() as client:
                tools = (await client.list_tools()).tools
                for _ in range(calls):
                    tool = rng.choice(tools)
                    result = await client.call_tool(tool.name, _arguments(tool, attempt, rng))
                    refused += bool(result.is_error)
            state.output = ModelOutput.from_content("random", f"{calls} random calls, {refused} of them refused")

        return await conduct(state, work)

    return solve


def _arguments(tool: Any, attempt: Attempt, rng: random.Random) -> dict[str, Any]:
    found: dict[str, Any] = drawn(tool.input_schema, rng)
    known = tool.input_schema.get("properties", {})
    if "world" in known and rng.random() < SENSIBLE:
        found["world"] = attempt.example
    if "wait_s" in known:
        found["wait_s"] = rng.choice((0.0, 5.0))
    if tool.name == "edit_spec" and rng.random() < SENSIBLE:
        found = {"world": attempt.example, "prompt": attempt.prompt, "spec": _changed(rng)}
    return found


def _changed(rng: random.Random) -> dict[str, Any]:
    """The smallest example of the skills with one thing lifted off what carries it."""
    text = (files("worldagent.skills") / "world-building" / "examples" / "two_blocks.json").read_text(encoding="utf-8")
    spec: dict[str, Any] = json.loads(text)
    del spec["prompt"]
    entity = spec["entities"][rng.choice(sorted(spec["entities"]))]
    entity["pose"]["position"][2] = round(entity["pose"]["position"][2] + rng.uniform(0.05, 2.0), 3)
    return spec
