"""Eyes on one running task: heartbeat, progress and its pace, cancel, caps of time and memory, size of the log."""

from __future__ import annotations

import json
import os
import select
import signal
import sqlite3
import sys
import time
from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

from ..worlds.errors import EngineError, LimitError
from .caps import ENV_MEMORY, ENV_WALL
from .context import Board
from .estimate import Estimate
from .job import Job, JobState, Progress, Usage
from .logs import trim_log
from .processes import descendants, signal_group
from .table import JobTable
from .usage import Meter

__all__ = ["TICK_S", "UNREACHABLE_S", "Ending", "Watch", "failed"]

TICK_S = 0.1
"""Time between two looks of the worker at the cancel flag [s]."""
STOPPING_TICK_S = 0.02
PROGRESS_S = 0.25
"""Least time between two writes of progress [s]."""
HEARTBEAT_S = 1.0
TERMINATE_S = 1.0
"""From the request to end until SIGTERM [s]."""
KILL_S = 1.8
"""From the request to end until SIGKILL [s]."""
LONG_S = 90.0
"""Longer times are told in minutes [s]."""
UNREACHABLE_S = 30.0
"""The task is ended when jobs.db could not be written for so long [s]: the workspace is gone or the disk full."""
STRAGGLERS_S = 1.0
"""Longest time to collect killed descendants of the task [s]."""

_T = TypeVar("_T")


class Ending(NamedTuple):
    """End of a job: its state and why."""

    state: JobState
    result: dict[str, Any] | None = None
    error: dict[str, str] | None = None
    usage: Usage = Usage(None, None)
    pace: list[float] | None = None


def failed(kind: type[Exception], message: str, *, state: JobState = "failed") -> Ending:
    """The ending of a job that did not come to its result."""
    return Ending(state, error={"type": kind.__name__, "message": message})


class Watch:
    """Watches over one task, in the worker; its only writer of the row."""

    def __init__(self, table: JobTable, job: Job, board: Board, pipe: int, task: int) -> None:
        self._table, self._job, self._board, self._pipe, self._task = table, job, board, pipe, task
        self._worker = os.getpid()
        self._output = b""
        self._started = self._reached = time.monotonic()
        self._written = self._started - HEARTBEAT_S
        self._progress: Progress | None = None
        self._latest: Progress | None = None
        self._estimate = Estimate(self._reach(lambda: table.latest_pace(job)))
        self._meter = Meter(self._worker, task)
        self._stop_since: float | None = None
        self._stop_ending: Ending | None = None
        self._pushed: int | None = None
        self._told = False
        self._waited: tuple[Any, ...] | None = None

    def tell(self, number: int, frame: object) -> None:
        """Signal handler: somebody wants this worker to end."""
        self._told = True

    def run(self) -> Ending | None:
        """Watch until the task and all that it started are gone. None if the job is not this worker's any more."""
        mine = True
        while mine and not self._task_ended():
            self._read(TICK_S if self._stop_since is None else STOPPING_TICK_S)
            mine = self._write()
            self._look_for_reasons()
            self._push()
        signal_group(self._task, signal.SIGKILL)  # before the leader is reaped: its id still names the group
        status, used = self._waited or os.wait4(self._task, 0)[1:]
        self._end_stragglers()
        while self._read(0.0):
            pass
        trim_log(self._table.log_path(self._job))
        peak = max(self._meter.peak, used.ru_maxrss * (1 if sys.platform == "darwin" else 1024))
        usage = Usage(peak, round(used.ru_utime + used.ru_stime, 3))
        self._take_progress()
        if mine and self._progress is not None:
            self._reach(lambda: self._table.beat(self._job.id, self._worker, self._progress))
        pace = self._estimate.pace(time.monotonic())
        return self._ending(status, peak)._replace(usage=usage, pace=pace) if mine else None

    def _task_ended(self) -> bool:
        if not hasattr(os, "waitid"):  # macOS before Python 3.13
            pid, *waited = os.wait4(self._task, os.WNOHANG)
            self._waited = tuple(waited) if pid else None
            return pid != 0
        while (ended := os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)) is not None:
            if ended.si_pid == self._task:
                return True
            os.waitpid(ended.si_pid, 0)  # an orphan of the task that this worker adopted
        return False

    def _end_stragglers(self) -> None:
        """Kill and collect what left the task's group, or lost its parent."""
        deadline = time.monotonic() + STRAGGLERS_S
        while (left := descendants(self._worker)) and time.monotonic() < deadline:
            _kill(left)
            for pid in left:
                try:
                    os.waitpid(pid, os.WNOHANG)
                except ChildProcessError:  # a grandchild; it is adopted when its parent is gone
                    continue
            time.sleep(0.002)

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

    def _take_progress(self) -> None:
        news = self._board.read_new()
        if news is not None:
            self._progress = self._latest = news
            self._estimate.add(time.monotonic(), news.done, news.total, news.ends)

    def _write(self) -> bool:
        """Heartbeat and progress; False if the job was taken away."""
        now = time.monotonic()
        self._take_progress()
        if now - self._written < PROGRESS_S:
            return True
        if self._progress is None and now - self._written < HEARTBEAT_S:
            return True
        trim_log(self._table.log_path(self._job))
        left, usage = self._estimate.left(now), Usage(self._meter.peak or None, None)
        told = self._progress if left is not None else self._of_stretch(now)
        mine = self._reach(lambda: self._table.beat(self._job.id, self._worker, told, left_s=left, usage=usage))
        if mine is None:
            return True
        self._written, self._progress = now, None
        return mine

    def _of_stretch(self, now: float) -> Progress | None:
        """The latest news; where only the time left of its stretch is known, with that in its words.

        News of before are told again with it: where nothing comes for minutes, what is left does not stand still.
        """
        news = self._latest
        if news is None or news.ends is None or (left := self._estimate.left_of_stretch(now)) is None:
            return self._progress
        about = f"{max(1.0, left):.0f} s" if left < LONG_S else f"{left / 60:.0f} min"
        return news._replace(message=f"{news.message} (this part: about {about} more)")

    def _look_for_reasons(self) -> None:
        now = time.monotonic()
        if not self._board.cancel_asked():
            asked = self._reach(lambda: self._table.cancel_asked(self._job.id))
            if asked is not None:
                self._board.ask_cancel()
                self._stop(Ending("cancelled"), since=now - min(max(time.time() - asked, 0.0), TICK_S))
        cap = self._job.wall_s
        if cap is not None and now - self._started > cap:
            text = (
                f"the job ran {now - self._started:.1f} s, its cap is wall_s = {cap:g} s. Knob: {ENV_WALL}_{self._job.kind.upper()} "
                "in the server's environment, or ask for less"
            )
            self._stop(failed(LimitError, text), since=now)
        self._look_at_memory(now)
        if self._told:
            text = "the worker was told to end (SIGTERM): a shutdown, or somebody ended it"
            self._stop(failed(EngineError, text, state="lost"), since=now)
        if now - self._reached > UNREACHABLE_S:
            self._stop(failed(EngineError, "jobs.db could not be reached", state="lost"), since=now - TERMINATE_S)

    def _look_at_memory(self, now: float) -> None:
        held, cap = self._meter.look(), self._job.memory_bytes
        if cap is not None and held is not None and held > cap:
            text = (
                f"the job held {held / 1e9:.2f} GB of memory, its cap is memory_bytes = {cap / 1e9:.2f} GB; it was ended "
                f"before the machine ran out. Knob: {ENV_MEMORY} in the server's environment, or ask for less"
            )
            self._stop(failed(LimitError, text), since=now - KILL_S)  # a moment later there may be nothing left to save

    def _stop(self, ending: Ending, *, since: float) -> None:
        if self._stop_ending is None:
            self._stop_ending, self._stop_since = ending, since
            self._board.ask_cancel()

    def _push(self) -> None:
        """End a task that does not end by itself."""
        if self._stop_since is None:
            return
        waited = time.monotonic() - self._stop_since
        number = signal.SIGKILL if waited >= KILL_S else signal.SIGTERM if waited > TERMINATE_S else None
        if number is not None and number != self._pushed:
            signal_group(self._task, number)
            if number == signal.SIGKILL:
                _kill(descendants(self._worker))
            self._pushed = number

    def _reach(self, call: Callable[[], _T]) -> _T | None:
        """Result of a call to the table; None if the database cannot be reached now."""
        try:
            value = call()
        except sqlite3.OperationalError as error:
            sys.stderr.write(f"worker: jobs.db: {error}\n")
            return None
        self._reached = time.monotonic()
        return value

    def _ending(self, status: int, peak: int) -> Ending:
        outcome = json.loads(self._output) if self._output.endswith(b"\n") else None
        if self._stop_ending is not None and (outcome is None or outcome["state"] == "cancelled"):
            return self._stop_ending
        if outcome is not None:
            return Ending(outcome["state"], outcome.get("result"), outcome.get("error"))
        code = os.waitstatus_to_exitcode(status)
        how = f"killed by {signal.Signals(-code).name}" if code < 0 else f"ended with exit status {code} and no result"
        text = f"the task was {how}"
        if code == -signal.SIGKILL:
            text += f" (often the machine was out of memory; the task held up to {peak / 1e9:.2f} GB)"
        return failed(EngineError, f"{text}; its output is in {self._job.log}", state="lost")


def _kill(pids: list[int]) -> None:
    for pid in pids:
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            continue
