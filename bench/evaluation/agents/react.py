"""Inspect's own loop of a model that reasons and acts, with the tools of the sample's server."""

from __future__ import annotations

from inspect_ai.agent import as_solver, react
from inspect_ai.solver import Generate, Solver, TaskState, solver
from inspect_ai.tool import mcp_server_stdio

from ..attempts import Attempt, conduct

__all__ = ["react_agent"]


@solver
def react_agent() -> Solver:
    """A loop on the model of the evaluation: it calls tools until it calls none."""

    async def solve(state: TaskState, generate: Generate) -> TaskState:
        async def work(attempt: Attempt) -> None:
            first, *rest = attempt.command
            server = mcp_server_stdio(name="worldagent", command=first, args=rest, env=attempt.environment)
            await as_solver(react(prompt=None, tools=[server], submit=False))(state, generate)

        return await conduct(state, work)

    return solve
