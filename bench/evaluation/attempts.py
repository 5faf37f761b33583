"""One attempt at a sample: its folder and server, its agent under watch, and how it is left.

Inspect keeps time, tokens and messages. Here are the budgets that it does not know (calls, device seconds) and the loss of the
server; all of them end the agent at once, whatever kind it is, and each leaves its reason.
"""

from __future__ import annotations

import os
import time
from collections.abc import Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import anyio
import anyio.to_thread

from ...execution import Job, JobStore
from ...worlds.errors import WorldAgentError
from .cleanup import cancel_jobs
from .matrices import matrices
from .records import Ending, Record
from .relay import relay_command
from .serving import ServerLost, server_command, server_environment
from .workspace import SampleFolder, take_folder

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from inspect_ai.solver import TaskState
    from mcp import Client

__all__ = ["Attempt", "Budget", "attempt_of", "begin", "conduct", "device_seconds", "settle"]

MOST_JOBS = 1000
"""Jobs that one question returns."""
WATCH_S = 0.5
"""Between two looks at the budgets [s]."""
KEY = "attempt"
"""Where an attempt stands in the metadata of a sample's state."""


@dataclass(frozen=True)
class Budget:
    """Use that one sample may make of calls and time, beside what Inspect limits itself."""

    calls: int = 300
    """Tool calls."""
    device_s: float = 7200.0
    """Seconds of jobs in worker processes (probes, bakes, judgements, pictures), all together [s]."""
    call_timeout_s: float = 600.0
    """Longest wait for one answer [s]; a tool answers within its own `wait_s`, and long work goes on as a job."""
    start_s: float = 120.0
    """Longest start of the server [s]."""


@dataclass(frozen=True)
class Attempt:
    """Folder, server and budget of one attempt, as plain data: it stands in the log."""

    workspace: str
    record: str
    began: float
    example: str
    prompt: str
    """Prompt of the scene alone."""
    command: tuple[str, ...]
    """Command line of the server behind its relay."""
    environment: dict[str, str]
    """Variables of the server, beside what MCP clients pass on."""
    device_s: float
    ablation: str = ""

    @property
    def folder(self) -> SampleFolder:
        """Workspace and record."""
        return SampleFolder(Path(self.workspace), Record(Path(self.record)), self.began)

    def ending(self) -> Ending | None:
        """The ending from outside, if there is one: as the relay says, or the device seconds."""
        known = self.folder.record.ending()
        used = device_seconds(Path(self.workspace)) if known is None else 0.0
        if used > self.device_s:
            reason = f"jobs took {used:.0f} s, of which {self.device_s:g} s are allowed"
            self.folder.record.end(Ending("limit", "device_s", reason, used, self.device_s))
        return self.folder.record.ending()

    @asynccontextmanager
    async def client(self) -> AsyncIterator[Client]:
        """An MCP client of the server, for agents that are no model."""
        from mcp import Client, StdioServerParameters

        parameters = StdioServerParameters(command=self.command[0], args=list(self.command[1:]), env=self.environment)
        async with Client(parameters, mode="legacy") as client:
            yield client


def begin(state: TaskState, run: Path, budget: Budget, *, example: int, prompt: str, ablation: str = "") -> Attempt:
    """Take a folder for a sample and name its server; nothing is started yet."""
    folder = take_folder(run, example, epoch=state.epoch)
    relay = relay_command(
        folder.record.folder,
        server_command(folder.workspace),
        calls=budget.calls,
        call_timeout_s=budget.call_timeout_s,
        start_s=budget.start_s,
    )
    made = Attempt(
        workspace=str(folder.workspace),
        record=str(folder.record.folder),
        began=folder.began,
        example=folder.name,
        prompt=prompt,
        command=tuple(relay),
        environment=server_environment(ablation),
        device_s=budget.device_s,
        ablation=ablation,
    )
    folder.record.write(
        "start.json", {"sample": str(state.sample_id), "epoch": state.epoch, "uuid": state.uuid, "pid": os.getpid()}
    )
    state.metadata[KEY] = asdict(made)
    return made


def attempt_of(state: TaskState) -> Attempt:
    """The attempt of a sample that `begin` was called for."""
    known = dict(state.metadata[KEY])
    return Attempt(**{**known, "command": tuple(known["command"])})


def device_seconds(workspace: Path) -> float:
    """Seconds that the jobs of a workspace took so far in worker processes [s]."""
    if not (workspace / ".worldagent" / "jobs.db").is_file():
        return 0.0
    store, jobs = JobStore(workspace), list[Job]()
    while page := store.list(limit=MOST_JOBS, offset=len(jobs), pump=False):
        jobs += page
        if len(page) < MOST_JOBS:
            break
    return sum((job.finished or time.time()) - job.started for job in jobs if job.started is not None)


async def conduct(state: TaskState, work: Callable[[Attempt], Awaitable[Any]]) -> TaskState:
    """Run an agent under watch: until it is done, or something ends it.

    Raises:
        LimitExceededError: a budget is used up; the sample is scored.
        ServerLost: the server died, hung or flooded; the sample is an error, which Inspect may retry.
    """
    from inspect_ai.util import LimitExceededError

    attempt, failed = attempt_of(state), list[Exception]()

    async def watch(scope: anyio.CancelScope) -> None:
        while True:
            with suppress(WorldAgentError):  # the jobs' file is busy or new: the next look tells
                if attempt.ending() is not None:
                    scope.cancel()
                    return
            await anyio.sleep(WATCH_S)

    async with anyio.create_task_group() as group:
        group.start_soon(watch, group.cancel_scope)
        try:
            await work(attempt)
        except Exception as error:  # raised below, once it is known what the server says
            failed.append(error)
        group.cancel_scope.cancel()
    ended = attempt.ending()
    if ended is not None:
        state.metadata["ended"] = asdict(ended)
        if ended.kind == "limit":
            raise LimitExceededError("custom", value=ended.value, limit=ended.limit, message=f"{ended.type}: {ended.reason}")
        raise ServerLost(f"{ended.type}: {ended.reason}") from next(iter(failed), None)
    if failed:
        raise failed[0]
    return state


async def settle(state: TaskState) -> None:
    """Leave a sample: end its jobs, keep its matrices, and write down what is in its folder. Again it does nothing."""
    if KEY not in state.metadata:  # its folder was never taken
        return
    attempt = attempt_of(state)
    with anyio.CancelScope(shield=True):
        await anyio.to_thread.run_sync(_settle, attempt)


def _settle(attempt: Attempt) -> None:
    folder = attempt.folder
    if folder.record.read("manifest.json") is not None:
        return
    folder.record.write("jobs.json", {"cancelled": cancel_jobs(folder.workspace), "device_s": device_seconds(folder.workspace)})
    folder.record.write("matrix.json", matrices(folder.workspace))
    folder.close()
