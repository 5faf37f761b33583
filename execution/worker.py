"""The worker: a detached process that watches over one job.

    python -P -m worldagent.execution.worker --workspace W --job ID

It forks away from whoever started it (own session, no parent), takes charge of the job's row, and forks the task
that runs the entry, in a process group of its own. Since the worker runs no foreign code, it says every second
that it lives and obeys a cancel within 2 s, whatever native code does in the task. It alone writes the row.
"""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import sqlite3
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

from ..worlds.errors import EngineError, LimitError
from .context import Board
from .job import Job, JobState, Progress
from .launch import pump, settle
from .processes import signal_group
from .table import JobTable
from .task import run_task

__all__ = ["main"]

TICK_S = 0.1
"""How often the worker looks at the cancel flag [s]."""
STOPPING_TICK_S = 0.02
PROGRESS_S = 0.25
"""Least time between two writes of progress [s]."""
HEARTBEAT_S = 1.0
TERMINATE_S = 1.0
"""From the request to end until SIGTERM [s]."""
KILL_S = 1.8
"""From the request to end until SIGKILL [s]."""
UNREACHABLE_S = 30.0
"""The task is ended when jobs.db could not be written for so long [s]: the workspace is gone or the disk full."""


class Ending(NamedTuple):
    """How a job ended."""

    state: JobState
    result: dict[str, Any] | None = None
    error: dict[str, str] | None = None


class Watch:
    """Eyes on one running task."""

    def __init__(self, table: JobTable, job: Job, board: Board, pipe: int, task: int) -> None:
        self._table, self._job, self._board, self._pipe, self._task = table, job, board, pipe, task
        self._worker = os.getpid()
        self._output = b""
        self._started = self._written = self._reached = time.monotonic()
        self._progress: Progress | None = None
        self._stop_since: float | None = None
        self._stop_ending: Ending | None = None
        self._pushed: int | None = None
        self._told = False

    def tell(self, number: int, frame: object) -> None:
        """Signal handler: somebody wants this worker to end."""
        self._told = True

    def run(self) -> Ending | None:
        """Watch until the task and its whole group are gone. None if the job is not this worker's any more."""
        mine = True
        while mine and not self._task_ended():
            self._read(TICK_S if self._stop_since is None else STOPPING_TICK_S)
            mine = self._write()
            self._look_for_reasons()
            self._push()
        signal_group(self._task, signal.SIGKILL)  # before the leader is reaped: its id still names the group
        _, status = os.waitpid(self._task, 0)
        while self._read(0.0):
            pass
        self._progress = self._board.read_new() or self._progress
        if mine and self._progress is not None:
            self._reach(lambda: self._table.beat(self._job.id, self._worker, self._progress))
        return self._ending(status) if mine else None

    def _task_ended(self) -> bool:
        return os.waitid(os.P_PID, self._task, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None

    def _read(self, timeout_s: float) -> bool:
        """Take what the task wrote; True if there was something."""
        if self._pipe < 0:
            time.sleep(min(timeout_s, 0.005))  # it closed its end and is about to exit
            return False
        if not select.select([self._pipe], [], [], timeout_s)[0]:
            return False
        data = os.read(self._pipe, 1 << 16)
        self._output += data
        if not data:
            os.close(self._pipe)
            self._pipe = -1
        return bool(data)

    def _write(self) -> bool:
        """Heartbeat and progress; False if the job was taken away."""
        now = time.monotonic()
        if now - self._written < PROGRESS_S:
            return True
        self._progress = self._board.read_new() or self._progress
        if self._progress is None and now - self._written < HEARTBEAT_S:
            return True
        mine = self._reach(lambda: self._table.beat(self._job.id, self._worker, self._progress))
        if mine is None:
            return True
        self._written, self._progress = now, None
        return bool(mine)

    def _look_for_reasons(self) -> None:
        now = time.monotonic()
        if not self._board.cancel_asked():
            asked = self._reach(lambda: self._table.cancel_asked(self._job.id))
            if asked is not None:
                self._board.ask_cancel()
                self._stop(Ending("cancelled"), since=now - min(max(time.time() - asked, 0.0), TICK_S))
        cap = self._job.wall_s
        if cap is not None and now - self._started > cap:
            text = f"the job ran {now - self._started:.1f} s, its cap is wall_s = {cap:g} s; raise it or ask for less"
            self._stop(_failed(LimitError, text), since=now)
        if self._told:
            self._stop(_failed(EngineError, "the worker was told to end; submit the job again", state="lost"), since=now)
        if now - self._reached > UNREACHABLE_S:
            self._stop(_failed(EngineError, "jobs.db could not be reached", state="lost"), since=now - TERMINATE_S)

    def _stop(self, ending: Ending, *, since: float) -> None:
        if self._stop_ending is None:
            self._stop_ending, self._stop_since = ending, since
            self._board.ask_cancel()

    def _push(self) -> None:
        """End a task that does not end by itself."""
        if self._stop_since is None:
            return
        waited = time.monotonic() - self._stop_since
        number = signal.SIGKILL if waited > KILL_S else signal.SIGTERM if waited > TERMINATE_S else None
        if number is not None and number != self._pushed:
            signal_group(self._task, number)
            self._pushed = number

    def _reach(self, call: Any) -> Any:
        """Result of a call to the table; None if the database cannot be reached now."""
        try:
            value = call()
        except sqlite3.OperationalError as error:
            sys.stderr.write(f"worker: jobs.db: {error}\n")
            return None
        self._reached = time.monotonic()
        return value

    def _ending(self, status: int) -> Ending:
        outcome = json.loads(self._output) if self._output.endswith(b"\n") else None
        if self._stop_ending is not None and (outcome is None or outcome["state"] == "cancelled"):
            return self._stop_ending
        if outcome is not None:
            return Ending(outcome["state"], outcome.get("result"), outcome.get("error"))
        code = os.waitstatus_to_exitcode(status)
        how = f"killed by {signal.Signals(-code).name}" if code < 0 else f"ended with exit status {code} and no result"
        text = f"the task was {how} (SIGKILL often means out of memory)" if code == -signal.SIGKILL else f"the task was {how}"
        return _failed(EngineError, f"{text}; see {self._job.log}", state="lost")


def _failed(kind: type[Exception], message: str, *, state: JobState = "failed") -> Ending:
    return Ending(state, error={"type": kind.__name__, "message": message})


def _finish(table: JobTable, job: Job, ending: Ending) -> None:
    result = json.dumps(ending.result) if ending.result is not None else None
    deadline = time.monotonic() + UNREACHABLE_S
    while True:
        try:
            table.finish(job.id, os.getpid(), ending.state, result=result, error=ending.error)
        except sqlite3.OperationalError as error:
            sys.stderr.write(f"worker: jobs.db: {error}\n")
            if time.monotonic() > deadline:
                raise
            time.sleep(TICK_S)
        else:
            return


def _work(table: JobTable, job_id: str) -> None:
    worker = os.getpid()
    if not table.register(job_id, worker):
        return  # taken for lost because this start took too long, or started twice
    job = table.read(job_id)
    if job.cancel_requested is not None:
        _finish(table, job, Ending("cancelled"))
        return
    board = Board()
    reading, writing = os.pipe()
    task = os.fork()
    if task == 0:
        os.close(reading)
        run_task(job, table.workspace, board, writing, worker)
    os.close(writing)
    with contextlib.suppress(OSError):
        os.setpgid(task, task)  # the task does so too; whoever comes first
    watch = Watch(table, job, board, reading, task)
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, watch.tell)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    table.record_task(job_id, worker, task)
    ending = watch.run()
    if ending is not None:
        _finish(table, job, ending)


def main(arguments: list[str]) -> None:
    """Detach, do the job, start the next."""
    options = dict(zip(arguments[::2], arguments[1::2], strict=True))
    table = JobTable(Path(options["--workspace"]))
    if os.fork() != 0:
        os._exit(0)  # whoever started this has nothing to wait for, and no child that a kill of its tree would find
    os.setsid()
    _work(table, options["--job"])
    pump(table, slots=int(options["--slots"]) if "--slots" in options else None)
    settle()


if __name__ == "__main__":
    main(sys.argv[1:])
