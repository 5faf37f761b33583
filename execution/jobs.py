"""Durable jobs: submit, look, wait, cancel. They live in the workspace and outlive the process that asked for them."""

from __future__ import annotations

import re
import sqlite3
import time
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

from ..worlds.errors import EngineError, InputError
from ..worlds.limits import CAPS
from .entries import as_json, check_entry, check_module
from .job import Job, JobState
from .launch import pump, start, warm_up
from .processes import core_count
from .pruning import prune
from .queue import Standing, insert, standing
from .table import JobTable
from .terms import Terms, check_name

__all__ = ["JobStore"]

_KIND = re.compile(r"[a-z][a-z0-9_.-]{0,63}")
_POLL_S = (0.005, 0.05)
"""Shortest and longest pause between two looks at a job that is waited for [s]."""
_PUMP_S = 0.5

USUAL = Terms()
"""Terms of a job whose submitter names none."""


class JobStore:
    """The jobs of one workspace. Cheap to make, safe from several threads and processes at once.

    Every look at a job that has not ended also notices workers that died and starts jobs whose turn it is.
    """

    def __init__(self, workspace: Path, *, slots: int | None = None) -> None:
        """`slots` caps how many jobs of the workspace run at a time; default: the cores of this process, at
        most the cap `running_jobs`; an interactive job may run beside them."""
        if slots is not None and slots < 1:
            raise InputError(f"slots {slots} must be >= 1")
        self.slots = min(core_count(), CAPS["running_jobs"].value) if slots is None else slots
        self.workspace = workspace.resolve()
        """Absolute path of the workspace."""

    @cached_property
    def _table(self) -> JobTable:
        """Opened at the first need, so that what only reads worlds works where nothing can be written."""
        return JobTable(self.workspace)

    def submit(self, kind: str, world: str | None, payload: dict[str, Any], *, entry: str, terms: Terms = USUAL) -> Job:
        """Queue a job and start it if it is its turn.

        Args:
            kind: Sort of work, for lists and logs: lower case, digits, `_.-`.
            world: The world it belongs to, if any.
            payload: Plain JSON data for the entry.
            entry: `worldagent.module:function`, called as `function(payload, context)` in a process of its own.
            terms: On which it runs.

        Raises:
            InputError: An argument is out of range or the payload is no plain data.
            LimitError: Too many jobs of this world or workspace wait already; the payload is too large.
            RefusedError: The entry lies outside `worldagent.`.
        """
        if not _KIND.fullmatch(kind):
            raise InputError(f"kind {kind!r} must be a lower-case word of at most 64 letters, digits, '_', '.', '-'")
        check_name("world", world)
        if terms.exclusive and world is None:
            raise InputError("an exclusive job needs the world that it writes")
        text = as_json(payload, "the payload")
        self._recover_running()
        prune(self._table)
        job = insert(self._table, kind, world, check_entry(entry), text, terms=terms)
        return start(self._table, job, slots=self.slots)

    def get(self, job_id: str) -> Job:
        """The job as it stands.

        Raises:
            InputError: No such job.
        """
        job = self._table.read(job_id)
        if job.state == "queued":
            self.pump()
            return self._table.read(job_id)
        return self._settled(job)

    def list(
        self,
        world: str | None = None,
        state: JobState | Sequence[JobState] | None = None,
        *,
        limit: int = 50,
        offset: int = 0,
        pump: bool = True,
    ) -> tuple[Job, ...]:
        """Jobs in one of these states (default: any), the newest first; without `pump` none is started for the looking."""
        if pump:
            self.pump()
        return self._table.read_all(world=world, state=state, limit=limit, offset=offset)

    def latest(self, kind: str, world: str | None, key_start: str) -> Job | None:
        """The newest job of this kind and world whose key starts so, as it stands."""
        job = self._table.read_latest(kind, world, key_start)
        return None if job is None else self._settled(job)

    def count(self, world: str | None = None, state: JobState | Sequence[JobState] | None = None) -> int:
        """Number of jobs that `list` has to give in all."""
        return self._table.count(world=world, state=state)

    def standing(self, job: Job) -> Standing | None:
        """Number of jobs ahead of a queued one and what it waits for; None if it is not queued any more."""
        return standing(self._table, job)

    def warm_up(self, module: str) -> bool:
        """Have a process with the engines of the module `module` loaded wait for jobs of this workspace.

        Returns at once; True if one waits or loads now. It ends after some idle minutes. Without one (not Linux,
        switched off by WORLDAGENT_WARM=0, or it failed) jobs start cold.

        Raises:
            RefusedError: The module lies outside `worldagent.`.
        """
        check_module(module)
        try:
            return warm_up(self._table.workspace, module)
        except (OSError, sqlite3.Error, EngineError):  # nothing can be written here: whoever needs a job will be told
            return False

    def request_cancel(self, job_id: str) -> Job:
        """Ask a job to end; at once if it is queued, within 2 s if it runs. An ended job stays as it is.

        The entry may stop by itself (`JobContext.check`); after 1.0 s its process group gets SIGTERM, after 1.8 s
        SIGKILL. The call does not wait for that.
        """
        self._table.ask_cancel(job_id)
        return self.get(job_id)

    def wait(self, job_id: str, timeout_s: float) -> Job:
        """The job when it has ended, or as it stands after `timeout_s` [s]."""
        deadline = time.monotonic() + timeout_s
        pause, longest = _POLL_S
        next_pump = 0.0
        while True:
            job = self._settled(self._table.read(job_id))
            now = time.monotonic()
            if job.ended or now >= deadline:
                return job
            if now >= next_pump:
                self.pump()
                next_pump = now + _PUMP_S
            time.sleep(min(pause, deadline - now))
            pause = min(pause * 1.5, longest)

    def pump(self) -> int:
        """Notice dead workers and start jobs whose turn it is; how many were started."""
        self._recover_running()
        return pump(self._table, slots=self.slots)

    def log_path(self, job: Job) -> Path:
        """Where the output and the traces of a job lie."""
        return self._table.log_path(job)

    def _recover_running(self) -> None:
        for job in self._table.read_all(state="running", limit=1000):
            self._table.recover(job)

    def _settled(self, job: Job) -> Job:
        if not self._table.recover(job):
            return job if job.state != "running" else self._table.read(job.id)
        pump(self._table, slots=self.slots)
        return self._table.read(job.id)
