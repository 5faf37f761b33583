"""An agent that is somewhere else: a session of a person or of another program, which connects to the sample's server by itself."""

from __future__ import annotations

import shlex
from pathlib import Path

import anyio
from inspect_ai.model import ModelOutput
from inspect_ai.solver import Generate, Solver, TaskState, solver

from ..attempts import Attempt, conduct

__all__ = ["external"]

LOOK_S = 0.5
"""Between two looks for the file `done` [s]."""


@solver
def external() -> Solver:
    """Waits for a session that is driven from elsewhere; it needs no model.

    `records/example_k/connect.json` holds the server's command line and environment, `prompt.txt` the whole prompt. The sample ends
    when the file `done` appears there (its text is kept as the answer), or when a budget is used up. The server may be started
    more than once, one after the other: calls are counted over all of them.
    """

    async def solve(state: TaskState, generate: Generate) -> TaskState:
        async def work(attempt: Attempt) -> None:
            record = attempt.folder.record
            done = record.folder / "done"
            first, *rest = attempt.command
            (record.folder / "prompt.txt").write_text(state.messages[0].text, encoding="utf-8")
            record.write(
                "connect.json",
                {
                    "command": first,
                    "args": rest,
                    "env": attempt.environment,
                    "shell": shlex.join(attempt.command),
                    "prompt": str(record.folder / "prompt.txt"),
                    "done": str(done),
                    "mcpServers": {"worldagent": {"command": first, "args": rest, "env": attempt.environment}},
                },
            )
            while not done.exists():
                await anyio.sleep(LOOK_S)
            state.output = ModelOutput.from_content("external", _said(done))

        return await conduct(state, work)

    return solve


def _said(done: Path) -> str:
    return done.read_text(encoding="utf-8", errors="replace").strip()[:20_000] or "done"
