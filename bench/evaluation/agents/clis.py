"""Coding agents that are programs of their own, through `inspect_swe`: Claude Code and Codex.

They run with `sandbox="local"`, which isolates nothing: the same user, files and network. An agent with a shell can reach other
samples' folders; what it touches there is marked (`workspace.py`), and for honest scores it belongs into a container.
"""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from inspect_ai.agent import as_solver
from inspect_ai.solver import Generate, Solver, TaskState, solver

from ....worlds.errors import EngineError
from ..attempts import Attempt, conduct

__all__ = ["claude_code", "codex_cli"]

_SHELL = ["Bash", "Write", "Edit", "NotebookEdit"]
"""Tools of Claude Code with which it could write into a world folder past the server."""


@solver
def claude_code(shell: bool = False) -> Solver:
    """Claude Code on the model of the evaluation; needs `claude` on the path.

    Args:
        shell: leave it its shell and editor too.
    """

    def made(attempt: Attempt) -> Any:
        swe = _inspect_swe("claude_code", "anthropic")
        more = {} if shell else {"disallowed_tools": list(_SHELL)}
        # It writes settings into the home folder that it is given, so it gets one of its own.
        home = _home(attempt)
        return swe.claude_code(
            mcp_servers=[_server(attempt)], version="sandbox", env={"HOME": str(home), "IS_SANDBOX": "1"}, cwd=str(home), **more
        )

    return _of(made)


@solver
def codex_cli() -> Solver:
    """Codex on the model of the evaluation; needs `codex` on the path."""

    def made(attempt: Attempt) -> Any:
        swe = _inspect_swe("codex_cli", "openai")
        return swe.codex_cli(
            mcp_servers=[_server(attempt)],
            version="sandbox",
            approve_static_mcp_tools=True,
            web_search="disabled",
            cwd=str(_home(attempt)),
            # Without the first its first turn does not wait for the server's tools.
            config_overrides={
                "mcp_servers.worldagent.required": "true",
                "mcp_servers.worldagent.startup_timeout_sec": "120",
            },
        )

    return _of(made)


def _of(made: Any) -> Solver:
    async def solve(state: TaskState, generate: Generate) -> TaskState:
        async def work(attempt: Attempt) -> None:
            await as_solver(made(attempt))(state, generate)

        return await conduct(state, work)

    return solve


def _server(attempt: Attempt) -> Any:
    from inspect_ai.tool import MCPServerConfigStdio

    first, *rest = attempt.command
    return MCPServerConfigStdio(name="worldagent", command=first, args=rest, env=attempt.environment)


def _home(attempt: Attempt) -> Path:
    home = Path(attempt.record) / "home"
    home.mkdir(exist_ok=True)
    return home


def _inspect_swe(agent: str, package: str) -> Any:
    """The package that drives these programs.

    Raises:
        EngineError: it is not installed, or lacks the package of the model's protocol.
    """
    lacking = [name for name in ("inspect_swe", package) if find_spec(name) is None]
    if lacking:
        raise EngineError(
            f"the agent {agent} needs {' and '.join(lacking)}, which is not installed: pip install inspect_swe {package}; "
            "or choose react, scripted, replay, random_calls or external"
        )
    return import_module("inspect_swe")
