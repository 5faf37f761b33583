"""A job: the row of `jobs.db` as plain data, and how its end is handed to a caller."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, TypeAlias, get_args

from ..worlds import errors
from ..worlds.errors import EngineError, WorldAgentError

__all__ = [
    "BULK",
    "ENDED_STATES",
    "INTERACTIVE",
    "JOB_STATES",
    "NORMAL",
    "Cancelled",
    "Job",
    "JobState",
    "Progress",
    "Usage",
    "as_exception",
    "result_of",
]

JobState: TypeAlias = Literal["queued", "running", "done", "failed", "cancelled", "lost"]

JOB_STATES: tuple[JobState, ...] = get_args(JobState)
ENDED_STATES: tuple[JobState, ...] = ("done", "failed", "cancelled", "lost")

BULK, NORMAL, INTERACTIVE = 0, 10, 20
"""Priorities: hours of work; work that a client waits for; looks that take seconds. The last may run beside full slots."""


class Cancelled(WorldAgentError):  # noqa: N818 - the outcome was asked for; it is no error
    """The work stopped because its caller asked for it."""


class Progress(NamedTuple):
    """Progress of the work: `done` of `total` in the entry's own unit; total is None where nobody knows."""

    done: float
    total: float | None
    message: str
    ends: float | None = None
    """Progress at which the present pace ends, in the same unit: what comes then goes on at another."""


class Usage(NamedTuple):
    """Memory and time that a task used; None where it was not measured."""

    peak_bytes: int | None
    """Largest resident memory of its processes together [bytes]."""
    cpu_s: float | None
    """CPU time of its processes [s]."""


@dataclass(frozen=True)
class Job:
    """One job as it stood when it was read. Times are UNIX seconds."""

    id: str
    """`job_` and 12 hex digits."""
    key: str | None
    """Idempotency key, within kind and world."""
    kind: str
    world: str | None
    entry: str
    """The function that does the work, `package.module:function`."""
    payload: dict[str, Any]
    state: JobState
    exclusive: bool
    """True if it writes its world: of these, one per world runs at a time."""
    priority: int
    """Higher starts first; see `BULK`, `NORMAL`, `INTERACTIVE`."""
    progress_done: float
    """Never falls."""
    progress_total: float | None
    message: str
    result: dict[str, Any] | None
    error: dict[str, str] | None
    """`type` and `message`, for failed and lost jobs."""
    created: float
    started: float | None
    finished: float | None
    host: str | None
    """Boot and process namespace in which `pid` and `task_pid` have a meaning."""
    pid: int | None
    """The worker process, which watches over the task."""
    pid_started: str | None
    """Start time of the process `pid` as the kernel tells it: a reused pid has another one."""
    task_pid: int | None
    """The process that runs the entry; also its process group."""
    task_started: str | None
    heartbeat: float | None
    """When the worker last said that it lives."""
    heartbeat_clock: float | None
    """The same on the monotonic clock of `host`: neither sleep nor a corrected clock makes a job look dead."""
    cancel_requested: float | None
    wall_s: float | None
    """Cap of the running time [s]."""
    memory_bytes: int | None
    """Cap of the resident memory of all processes of the task together [bytes]."""
    log: str
    """Output and traces of the task, path relative to the workspace."""
    warm: bool = False
    """True if it may start in a process that has the engines of its entry's module loaded."""
    left_s: float | None = None
    """Time until its end, estimated at `heartbeat` from the measured rate of progress [s]; None where nobody knows."""
    peak_bytes: int | None = None
    """Largest resident memory of its processes together so far [bytes]."""
    cpu_s: float | None = None
    """CPU time of its processes [s], once it ended."""

    @property
    def ended(self) -> bool:
        """True if the state is final."""
        return self.state in ENDED_STATES


def result_of(job: Job) -> dict[str, Any]:
    """Result of a job that is done; the error of one that is not, as `run_inline` would raise it.

    Raises:
        Cancelled: The job was cancelled.
        WorldAgentError: What the entry raised; EngineError for any other exception and for a lost or unended job.
    """
    if job.state == "done":
        return job.result or {}
    if job.state == "cancelled":
        raise Cancelled(f"job {job.id} was cancelled")
    if job.error is None:
        raise EngineError(f"job {job.id} is {job.state}, not done; wait for it first")
    raise as_exception(job.error)


def as_exception(error: dict[str, str]) -> WorldAgentError:
    """The error that `error_of` described: one of worldagent as itself, any other as EngineError."""
    name, message = error["type"], error["message"]
    if name in errors.__all__:
        kind: type[WorldAgentError] = getattr(errors, name)
        return kind(message)
    return EngineError(f"{name}: {message}")
