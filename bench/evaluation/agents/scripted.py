"""An agent that plays a world document or a list of calls: our own examples, and solutions written by hand."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from inspect_ai.model import ModelOutput
from inspect_ai.solver import Generate, Solver, TaskState, solver

from ....examples.client_run import accept
from ....examples.domino_run import Agent
from ....worlds.errors import InputError
from ..attempts import Attempt, conduct

__all__ = ["QuietAgent", "document_of", "scripted"]


class QuietAgent(Agent):
    """The agent of the examples, whose lines go into the sample instead of the terminal."""

    def __init__(self, client: Any, world: str, started: float) -> None:
        super().__init__(client, world, started)
        self.said: list[str] = []

    def say(self, text: str) -> None:
        """Keep one line."""
        self.said.append(text)


def document_of(sample: str, folder: Path | None) -> dict[str, Any]:
    """The document that a sample is played from: `SAMPLE.json` of the folder, else the example of the skills of that name.

    It holds a whole `spec` with or without its prompt, or `calls`, each with `tool` and `arguments`.

    Raises:
        InputError: there is none.
    """
    place = files("worldagent.skills") / "world-building" / "examples" if folder is None else folder
    found = place / f"{sample}.json"
    if not found.is_file():
        known = sorted(p.name.removesuffix(".json") for p in place.iterdir() if p.name.endswith(".json"))
        where = "the examples of the skill world-building" if folder is None else str(folder)
        raise InputError(f"no document for the sample {sample!r} in {where}; there are {', '.join(known) or 'none'}")
    document: dict[str, Any] = json.loads(found.read_text(encoding="utf-8"))
    return document


@solver
def scripted(folder: str = "", film: bool = False) -> Solver:
    """Plays documents; it needs no model.

    Args:
        folder: of `SAMPLE.json` files; default the examples of the skill `world-building`.
        film: render the final sequence of an accepted world.
    """
    place = Path(folder).absolute() if folder else None

    async def solve(state: TaskState, generate: Generate) -> TaskState:
        document = document_of(str(state.sample_id), place)

        async def work(attempt: Attempt) -> None:
            async with attempt.client() as client:
                agent = QuietAgent(client, attempt.example, time.monotonic())
                try:
                    await _play(agent, attempt, document)
                    if film:
                        await agent.call("render_shot", kind="final")
                finally:
                    state.output = ModelOutput.from_content("scripted", "\n".join(agent.said) or "played")

        return await conduct(state, work)

    return solve


async def _play(agent: Agent, attempt: Attempt, document: Mapping[str, Any]) -> None:
    if "calls" in document:
        for call in document["calls"]:
            data, refused = await agent.call(call["tool"], **call.get("arguments", {}))
            agent.say(f"{call['tool']}: {'refused: ' + data['refused'] if refused else data.get('summary', 'done')}")
        return
    spec = dict(document.get("spec", document))
    spec.pop("prompt", None)
    await accept(agent, attempt.prompt, spec)
