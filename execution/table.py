"""The table of jobs in `<workspace>/.worldagent/jobs.db`: rows and their changes of state.

Every change of state is one UPDATE that names the state it starts from, so that of two processes that want to change
a job one succeeds and the other learns that it did not.

    queued -> running -> done | failed | cancelled | lost
    queued -> cancelled
"""

from __future__ import annotations

import json
import re
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..worlds.errors import EngineError, InputError
from .job import JOB_STATES, Job, JobState, Progress, Usage
from .processes import end_group, end_stragglers, host_id, is_alive, start_time
from .schema import FOLDER, JobFile, job_of

__all__ = ["FOLDER", "JobTable"]

STALE_S = 10.0
"""A worker that has not said for so long that it lives is lost [s]. It says so every second."""
ANSWER_S = 2.0
"""A silent one is given so long to speak while it is looked at [s]: whatever held it up may have held up the onlooker too."""
START_S = 30.0
"""A worker that has not reported so long after its start is lost [s]; a start takes 0.1 s on an idle machine."""
KNOWN_IDS = 5
"""Ids that the error about an unknown one names."""
KNOWN_PACES = 50
"""Latest jobs that are looked through for one to compare with."""
EXTENT = ("scope", "only", "coarser")
"""Fields of a payload that decide how much of its work a job does."""

AHEAD_S = 3600.0
"""Further than this [s] no clock of another host runs ahead."""

_ID = re.compile(r"job_[0-9a-f]{12}")
_CHOSEN = """
    (:world IS NULL OR world = :world) AND (:states IS NULL OR state IN (SELECT value FROM json_each(:states)))"""


def _states(state: JobState | Sequence[JobState] | None) -> str | None:
    if state is None:
        return None
    states = [state] if isinstance(state, str) else list(state)
    for name in states:
        if name not in JOB_STATES:
            raise InputError(f"state {name!r} is none of {', '.join(JOB_STATES)}")
    return json.dumps(states)


class JobTable(JobFile):
    """Rows of jobs and the changes they allow. `JobStore` is the face of it for callers."""

    # Reading

    def read(self, job_id: str) -> Job:
        """The row as it stands.

        Raises:
            InputError: No such job.
        """
        if _ID.fullmatch(job_id):
            with self.open() as connection:
                row = connection.execute("SELECT * FROM jobs WHERE id = ?", (job_id,)).fetchone()
            if row is not None:
                return job_of(row)
        newest = ", ".join(f"{job.id} ({job.kind}, {job.state})" for job in self.read_all(limit=KNOWN_IDS))
        known = f"the newest are {newest}" if newest else "it has none yet"
        raise InputError(f"no job {job_id[:60]!r} in this workspace; {known}; job(action='list') shows all")

    def read_all(
        self,
        *,
        world: str | None = None,
        state: JobState | Sequence[JobState] | None = None,
        limit: int = 50,
        offset: int = 0,
    ) -> tuple[Job, ...]:
        """Rows of these states, the newest first."""
        if not 1 <= limit <= 1000 or offset < 0:
            raise InputError(f"limit {limit} must lie in [1, 1000] and offset {offset} be >= 0")
        statement = f"SELECT * FROM jobs WHERE {_CHOSEN} ORDER BY number DESC LIMIT :limit OFFSET :offset"  # noqa: S608
        with self.open() as connection:
            values = {"world": world, "states": _states(state), "limit": limit, "offset": offset}
            return tuple(job_of(row) for row in connection.execute(statement, values))

    def read_latest(self, kind: str, world: str | None, key_start: str) -> Job | None:
        """The newest row of this kind and world whose key starts so."""
        statement = """
            SELECT * FROM jobs WHERE kind = :kind AND world IS :world AND substr(key, 1, length(:start)) = :start
            ORDER BY number DESC LIMIT 1"""
        with self.open() as connection:
            row = connection.execute(statement, {"kind": kind, "world": world, "start": key_start}).fetchone()
        return None if row is None else job_of(row)

    def count(self, *, world: str | None = None, state: JobState | Sequence[JobState] | None = None) -> int:
        """Number of rows that `read_all` has to give."""
        with self.open() as connection:
            statement = f"SELECT COUNT(*) FROM jobs WHERE {_CHOSEN}"  # noqa: S608
            (number,) = connection.execute(statement, {"world": world, "states": _states(state)}).fetchone()
        return int(number)

    def log_path(self, job: Job) -> Path:
        """Where the output of a job lies."""
        return self.workspace / job.log

    # Asking

    def ask_cancel(self, job_id: str) -> None:
        """Cancel a queued job, flag a running one, leave an ended one."""
        values = {"id": job_id, "now": time.time()}
        waiting = """
            UPDATE jobs SET state = 'cancelled', cancel_requested = :now, finished = :now WHERE id = :id AND state = 'queued'"""
        running = """
            UPDATE jobs SET cancel_requested = :now WHERE id = :id AND state = 'running' AND cancel_requested IS NULL"""
        if not self.change(waiting, values):
            self.change(running, values)

    # The worker's side; every call answers whether the job is still this worker's

    def register(self, job_id: str, pid: int) -> bool:
        """A worker takes charge of a job that was claimed for it."""
        statement = """
            UPDATE jobs SET pid = :pid, pid_started = :started, host = :host, heartbeat = :now, heartbeat_clock = :clock
            WHERE id = :id AND state = 'running' AND pid IS NULL"""
        return self.change(statement, {"id": job_id, **_identity(pid), "host": host_id()})

    def record_task(self, job_id: str, pid: int, task_pid: int) -> bool:
        """The worker names the process that runs the entry."""
        statement = (
            "UPDATE jobs SET task_pid = :task, task_started = :started WHERE id = :id AND state = 'running' AND pid = :pid"
        )
        return self.change(statement, {"id": job_id, "pid": pid, "task": task_pid, "started": start_time(task_pid)})

    def beat(
        self, job_id: str, pid: int, progress: Progress | None, *, left_s: float | None = None, usage: Usage | None = None
    ) -> bool:
        """The worker lives; `progress` if there is news, the time left as estimated now [s], and what the task used."""
        statement = """
            UPDATE jobs SET heartbeat = :now, heartbeat_clock = :clock, left_s = :left_s,
            peak_bytes = COALESCE(:peak_bytes, peak_bytes), cpu_s = COALESCE(:cpu_s, cpu_s)
            {news} WHERE id = :id AND state = 'running' AND pid = :pid"""
        news = ", progress_done = MAX(progress_done, :done), progress_total = :total, message = :message"
        values: dict[str, Any] = {"id": job_id, "pid": pid, "now": time.time(), "clock": time.monotonic(), "left_s": left_s}
        values |= (usage or Usage(None, None))._asdict()
        if progress is None:
            return self.change(statement.format(news=""), values)
        return self.change(statement.format(news=news), {**values, **progress._asdict()})

    def cancel_asked(self, job_id: str) -> float | None:
        """When cancel was requested."""
        with self.open() as connection:
            row = connection.execute("SELECT cancel_requested FROM jobs WHERE id = ?", (job_id,)).fetchone()
        return None if row is None else row["cancel_requested"]

    def finish(
        self,
        job_id: str,
        pid: int | None,
        state: JobState,
        *,
        result: str | None = None,
        error: dict[str, str] | None = None,
        usage: Usage | None = None,
        pace: list[float] | None = None,
    ) -> bool:
        """running -> `state`. A cancel that was requested before this moment wins over any other end."""
        statement = """
            UPDATE jobs SET finished = :now, left_s = NULL, result = IIF(cancel_requested IS NULL, :result, NULL),
            error = IIF(cancel_requested IS NULL, :error, NULL), state = IIF(cancel_requested IS NULL, :state, 'cancelled'),
            peak_bytes = COALESCE(:peak_bytes, peak_bytes), cpu_s = COALESCE(:cpu_s, cpu_s), pace = :pace
            WHERE id = :id AND state = 'running' AND pid IS :pid"""
        text = json.dumps(error) if error is not None else None
        values = {"id": job_id, "pid": pid, "state": state, "result": result, "error": text, "now": time.time()}
        values["pace"] = json.dumps(pace) if pace is not None else None
        return self.change(statement, values | (usage or Usage(None, None))._asdict())

    def latest_pace(self, job: Job) -> list[float] | None:
        """Pace in time of the last done job of this kind, world and extent; see `Estimate`. Another world's tells nothing."""
        statement = """
            SELECT pace, payload FROM jobs WHERE kind = :kind AND world IS :world AND state = 'done' AND pace IS NOT NULL
            ORDER BY number DESC LIMIT :most"""
        with self.open() as connection:
            rows = connection.execute(statement, {"kind": job.kind, "world": job.world, "most": KNOWN_PACES}).fetchall()
        wanted = [job.payload.get(name) for name in EXTENT]
        for row in rows:
            payload = json.loads(row["payload"])
            if [payload.get(name) for name in EXTENT] == wanted:
                pace: list[float] = json.loads(row["pace"])
                return pace
        return None

    # Recovery

    def recover(self, job: Job) -> bool:
        """End a running job whose worker is gone, as `lost` (or `cancelled`); True if that was so.

        On this host a worker is gone when its pid is, or has another start time. A worker that lives but is silent
        for STALE_S is killed first. Of another host (or an earlier boot) only the silence can be seen. Who was silent and
        speaks under these eyes is not lost.
        """
        reason = _loss(job)
        if reason is None or self._speaks(job):
            return False
        if job.host == host_id() and job.pid is not None:  # without a worker there is no task; one may come this very moment
            for pid, started in ((job.pid, job.pid_started), (job.task_pid, job.task_started)):
                if pid is not None:
                    end_group(pid, started)
            end_stragglers(job.id, session=job.pid, group=job.task_pid)
        error = {"type": EngineError.__name__, "message": f"{reason}; its output is in {job.log}"}
        return self.finish(job.id, job.pid, "lost", error=error)

    def _speaks(self, job: Job) -> bool:
        """True if the worker of a silent job says that it lives within ANSWER_S, or the job is not as it was read."""
        deadline = time.monotonic() + ANSWER_S
        while job.pid is not None and (job.host != host_id() or is_alive(job.pid, job.pid_started)):
            with self.open() as connection:
                row = connection.execute("SELECT state, heartbeat FROM jobs WHERE id = ?", (job.id,)).fetchone()
            if row is None or (row["state"], row["heartbeat"]) != (job.state, job.heartbeat):
                return True
            if time.monotonic() > deadline:
                return False
            time.sleep(0.02)
        return False


def _identity(pid: int) -> dict[str, Any]:
    return {"pid": pid, "started": start_time(pid), "now": time.time(), "clock": time.monotonic()}


def _loss(job: Job) -> str | None:
    """Why a running job must be taken for lost, or None."""
    if job.state != "running" or job.heartbeat is None or job.heartbeat_clock is None:
        return None
    if job.host != host_id():
        silent = time.time() - job.heartbeat
        if silent < -AHEAD_S:
            return f"the worker on another host or boot spoke last {-silent:.0f} s in the future: a clock was set back since"
        return f"the worker on another host or boot is silent for {silent:.0f} s" if silent > START_S else None
    silent = time.monotonic() - job.heartbeat_clock
    if job.pid is None:
        return f"the worker did not report within {START_S:.0f} s of its start" if silent > START_S else None
    if not is_alive(job.pid, job.pid_started):
        return f"the worker process {job.pid} is gone"
    return f"the worker process {job.pid} is silent for {silent:.0f} s" if silent > STALE_S else None
