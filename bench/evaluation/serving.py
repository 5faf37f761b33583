"""The server of a sample: its command, its environment, and what is asked of it before a run."""

from __future__ import annotations

import asyncio
import os
import re
import shutil
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

from ...worlds.ablation import ABLATIONS, ENV_ABLATION
from ...worlds.canonical import digest_of
from ...worlds.errors import EngineError, InputError

__all__ = ["NEEDED_TOOLS", "Preflight", "ServerLost", "preflight", "server_command", "server_environment"]

ENV_SERVER = "WORLDAGENT_EVAL_SERVER"
"""Environment variable: another server's command, words separated by the separator of paths; `{workspace}` stands for its folder."""
NEEDED_TOOLS = ("edit_spec", "place_object", "probe_sim", "bake_sim", "run_checks", "render_shot", "inspect_world", "job")
"""Without these no sample can be finished."""
ASK_S = 120.0
"""Longest time of the questions before a run [s]."""
_PASSED_ON = re.compile(
    r"WORLDAGENT_(?!TOKEN$|WORKSPACE$|ABLATION$|EVAL_)\w*|PYTHON(PATH|SAFEPATH|HASHSEED)|(CUDA|NVIDIA|LD|DYLD|WARP|NUMBA|OMP|DRJIT)_\w+|"
    r"XDG_\w+|TMPDIR|(?i:https?|no|all)_proxy|LANG|LC_\w+"
)
"""Variables that a server gets beside HOME, PATH and the like; an MCP client passes on nothing else."""


class ServerLost(Exception):  # noqa: N818 - what happened to the server; the sample is the error
    """The server of a sample died, hung or flooded: the sample is an error, and no failure of its agent."""


@dataclass(frozen=True)
class Preflight:
    """Answers of the server about itself before a run; it stands in the log of every sample."""

    name: str
    version: str
    protocol: str
    tools: tuple[str, ...]
    tools_digest: str
    """Hash of the list of tools with schemas and descriptions: equal lists are the same to every agent."""
    instructions: str

    def told(self) -> dict[str, Any]:
        """The same for a log, without the instructions, which stand in the prompt."""
        return {k: v for k, v in asdict(self).items() if k != "instructions"}


def server_command(workspace: Path) -> list[str]:
    """Command line of a stdio server on a workspace: this installation's, or the one that the environment names."""
    if other := os.environ.get(ENV_SERVER):
        return [word.format(workspace=workspace) for word in other.split(os.pathsep)]
    return [sys.executable, "-P", "-m", "worldagent.server", "serve", "--workspace", str(workspace)]


def server_environment(ablation: str = "") -> dict[str, str]:
    """Environment of a sample's server, beside what every MCP client passes on.

    Raises:
        InputError: there is no such ablation.
    """
    if ablation and ablation not in ABLATIONS:
        raise InputError(f"ablation {ablation!r} must be one of {', '.join(ABLATIONS)}, or empty")
    kept = {k: v for k, v in os.environ.items() if _PASSED_ON.fullmatch(k)}
    return {**kept, **({ENV_ABLATION: ablation} if ablation else {})}


async def preflight(command: Sequence[str], environment: Mapping[str, str]) -> Preflight:
    """Start the server once in an empty folder and ask what it is; the answer is kept for the process.

    Raises:
        EngineError: its executable is missing, it does not answer, or it lacks tools that every sample needs.
    """
    # Samples that start together ask once.
    asked = _asked.setdefault(asyncio.get_running_loop(), {})
    key = (*command, *(f"{k}={v}" for k, v in sorted(environment.items())))
    if key not in asked:
        asked[key] = asyncio.ensure_future(_ask(command, dict(environment)))
    return await asyncio.shield(asked[key])


_asked: WeakKeyDictionary[asyncio.AbstractEventLoop, dict[tuple[str, ...], asyncio.Future[Preflight]]] = WeakKeyDictionary()


async def _ask(command: Sequence[str], environment: Mapping[str, str]) -> Preflight:
    import anyio
    from mcp import Client, StdioServerParameters

    if shutil.which(command[0]) is None:
        raise EngineError(f"the server's executable {command[0]!r} is missing; install it, or correct ${ENV_SERVER}")
    parameters = StdioServerParameters(command=command[0], args=list(command[1:]), env=dict(environment))
    try:
        with anyio.fail_after(ASK_S):
            async with Client(parameters, mode="legacy") as client:
                listed = (await client.list_tools()).tools
                info, protocol, text = client.server_info, client.protocol_version, client.instructions
    except TimeoutError:
        raise EngineError(f"the server {' '.join(command)!r} did not say what it can within {ASK_S:g} s") from None
    except Exception as error:
        raise EngineError(f"the server {' '.join(command)!r} does not start: {type(error).__name__}: {error}") from error
    names = tuple(tool.name for tool in listed)
    lacking = [name for name in NEEDED_TOOLS if name not in names]
    if lacking:
        raise EngineError(f"the server lacks the tools {', '.join(lacking)}; it has {', '.join(names)}")
    digest = digest_of(*(tool.model_dump(mode="json", exclude_none=True) for tool in listed))
    return Preflight(
        name="" if info is None else info.name,
        version="" if info is None else info.version,
        protocol=str(protocol),
        tools=names,
        tools_digest=digest,
        instructions=text or "",
    )
