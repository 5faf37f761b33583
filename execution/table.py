"""The table of jobs in `<workspace>/.worldagent/jobs.db`: rows and their changes of state.

SQLite with a rollback journal. Every call opens its own connection, so that a table may be used from any thread
and be carried across a fork. Every change of state is one UPDATE that names the state it starts from, so that of
two processes that want to change a job one succeeds and the other learns that it did not.

    queued -> running -> done | failed | cancelled | lost
    queued -> cancelled
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import sqlite3
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..worlds.errors import EngineError, InputError
from .job import JOB_STATES, Job, JobState, Progress
from .processes import end_group, host_id, is_alive, start_time

__all__ = ["FOLDER", "JobTable"]

FOLDER = ".worldagent"
"""Folder of a workspace that holds `jobs.db` and `logs/`."""

STALE_S = 10.0
"""A worker that has not said for so long that it lives is lost [s]. It says so every second."""
START_S = 30.0
"""A worker that has not reported so long after its start is lost [s]; a start takes 0.1 s on an idle machine."""

_BUSY_S = 3.0
_VERSION = 1
_ID = re.compile(r"job_[0-9a-f]{12}")
_SCHEMA = """
CREATE TABLE IF NOT EXISTS jobs (
    number INTEGER PRIMARY KEY,
    id TEXT NOT NULL UNIQUE,
    key TEXT,
    kind TEXT NOT NULL,
    world TEXT,
    entry TEXT NOT NULL,
    payload TEXT NOT NULL,
    state TEXT NOT NULL CHECK (state IN ('queued', 'running', 'done', 'failed', 'cancelled', 'lost')),
    exclusive INTEGER NOT NULL,
    priority INTEGER NOT NULL,
    progress_done REAL NOT NULL DEFAULT 0,
    progress_total REAL,
    message TEXT NOT NULL DEFAULT '',
    result TEXT,
    error TEXT,
    created REAL NOT NULL,
    started REAL,
    finished REAL,
    host TEXT,
    pid INTEGER,
    pid_started TEXT,
    task_pid INTEGER,
    task_started TEXT,
    heartbeat REAL,
    heartbeat_clock REAL,
    cancel_requested REAL,
    wall_s REAL,
    memory_bytes INTEGER,
    log TEXT NOT NULL
)
"""
_INDEXES = (
    "CREATE INDEX IF NOT EXISTS jobs_state ON jobs (state, priority, number)",
    "CREATE INDEX IF NOT EXISTS jobs_key ON jobs (key, kind, world) WHERE key IS NOT NULL",
)


def _job(row: sqlite3.Row) -> Job:
    values: dict[str, Any] = {name: row[name] for name in row.keys() if name != "number"}  # noqa: SIM118 - a Row iterates values
    for name in ("payload", "result", "error"):
        values[name] = json.loads(values[name]) if values[name] is not None else None
    values["exclusive"] = bool(values["exclusive"])
    return Job(**values)


class JobTable:
    """Rows of jobs and the changes they allow. `JobStore` is the face of it for callers."""

    def __init__(self, workspace: Path) -> None:
        self.workspace = workspace.resolve()
        self.path = self.workspace / FOLDER / "jobs.db"
        (self.path.parent / "logs").mkdir(mode=0o700, parents=True, exist_ok=True)
        with contextlib.closing(sqlite3.connect(self.path, timeout=_BUSY_S, isolation_level=None)) as connection:
            (version,) = connection.execute("PRAGMA user_version").fetchone()
            if version == 0:
                connection.execute("BEGIN IMMEDIATE")
                connection.execute(_SCHEMA)
                for index in _INDEXES:
                    connection.execute(index)
                connection.execute(f"PRAGMA user_version = {_VERSION}")
                connection.execute("COMMIT")
            elif version != _VERSION:
                raise InputError(f"{self.path} has layout {version}, this version reads {_VERSION}; use another workspace")

    @contextlib.contextmanager
    def _open(self) -> Iterator[sqlite3.Connection]:
        # mode=rw: a workspace that was deleted under a running job is not made anew.
        uri = f"{self.path.as_uri()}?mode=rw"
        with contextlib.closing(sqlite3.connect(uri, uri=True, timeout=_BUSY_S, isolation_level=None)) as connection:
            connection.row_factory = sqlite3.Row
            # Still a rollback journal, but one that is not deleted each time: 0.9 instead of 5.6 ms a write on ext4.
            connection.execute("PRAGMA journal_mode = TRUNCATE")
            connection.execute("PRAGMA synchronous = NORMAL")
            yield connection

    @contextlib.contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        with self._open() as connection:
            connection.execute("BEGIN IMMEDIATE")
            try:
                yield connection
            except BaseException:
                connection.execute("ROLLBACK")
                raise
            connection.execute("COMMIT")

    def _change(self, statement: str, values: dict[str, Any]) -> bool:
        with self._open() as connection:
            return connection.execute(statement, values).rowcount == 1

    # Reading

    def read(self, job_id: str) -> Job:
        """The row as it stands.

        Raises:
            InputError: No such job.
        """
        if _ID.fullmatch(job_id):
            with self._open() as connection:
                row = connection.execute("SELECT * FROM jobs WHERE id = ?", (job_id,)).fetchone()
            if row is not None:
                return _job(row)
        raise InputError(f"no job {job_id!r} in this workspace; ids are 'job_' and 12 hex digits, list the jobs to see them")

    def read_all(
        self, *, world: str | None = None, state: JobState | None = None, limit: int = 50, offset: int = 0
    ) -> tuple[Job, ...]:
        """Rows, the newest first."""
        if state is not None and state not in JOB_STATES:
            raise InputError(f"state {state!r} is none of {', '.join(JOB_STATES)}")
        if not 1 <= limit <= 1000 or offset < 0:
            raise InputError(f"limit {limit} must lie in [1, 1000] and offset {offset} be >= 0")
        statement = """
            SELECT * FROM jobs WHERE (:world IS NULL OR world = :world) AND (:state IS NULL OR state = :state)
            ORDER BY number DESC LIMIT :limit OFFSET :offset"""
        with self._open() as connection:
            values = {"world": world, "state": state, "limit": limit, "offset": offset}
            return tuple(_job(row) for row in connection.execute(statement, values))

    def log_path(self, job: Job) -> Path:
        """Where the output of a job lies."""
        return self.workspace / job.log

    # Queue

    def insert(
        self,
        *,
        key: str | None,
        kind: str,
        world: str | None,
        entry: str,
        payload: str,
        exclusive: bool,
        priority: int,
        wall_s: float | None,
        memory_bytes: int | None,
    ) -> str:
        """Id of a new queued job, or of the queued, running or done one that has this key already."""
        job_id = f"job_{os.urandom(6).hex()}"  # what secrets.token_hex does, without its imports
        earlier = """
            SELECT id FROM jobs WHERE key = :key AND kind = :kind AND world IS :world
            AND state IN ('queued', 'running', 'done') ORDER BY number DESC LIMIT 1"""
        new = """
            INSERT INTO jobs (id, key, kind, world, entry, payload, state, exclusive, priority, created, wall_s,
                memory_bytes, log)
            VALUES (:id, :key, :kind, :world, :entry, :payload, 'queued', :exclusive, :priority, :created, :wall_s,
                :memory_bytes, :log)"""
        values = {
            "id": job_id,
            "key": key,
            "kind": kind,
            "world": world,
            "entry": entry,
            "payload": payload,
            "exclusive": exclusive,
            "priority": priority,
            "created": time.time(),
            "wall_s": wall_s,
            "memory_bytes": memory_bytes,
            "log": f"{FOLDER}/logs/{job_id}.log",
        }
        with self._transaction() as connection:
            row = connection.execute(earlier, values).fetchone() if key is not None else None
            if row is not None:
                return str(row["id"])
            connection.execute(new, values)
        return job_id

    def claim(self, slots: int) -> tuple[str, ...]:
        """Take the jobs whose turn it is: queued -> running, at most `slots` of the workspace at a time."""
        statement = """
            UPDATE jobs SET state = 'running', started = :now, heartbeat = :now, heartbeat_clock = :clock, host = :host
            WHERE number = (
                SELECT number FROM jobs AS next
                WHERE state = 'queued' AND (SELECT COUNT(*) FROM jobs WHERE state = 'running') < :slots
                AND NOT (exclusive AND EXISTS (
                    SELECT 1 FROM jobs AS other WHERE other.state = 'running' AND other.exclusive AND other.world = next.world))
                ORDER BY priority DESC, number LIMIT 1)
            RETURNING id"""
        with self._open() as connection:
            if connection.execute("SELECT 1 FROM jobs WHERE state = 'queued' LIMIT 1").fetchone() is None:
                return ()
        claimed: list[str] = []
        with self._transaction() as connection:
            values = {"now": time.time(), "clock": time.monotonic(), "host": host_id(), "slots": slots}
            while rows := connection.execute(statement, values).fetchall():
                claimed.append(str(rows[0]["id"]))
        return tuple(claimed)

    def ask_cancel(self, job_id: str) -> None:
        """Cancel a queued job, flag a running one, leave an ended one."""
        values = {"id": job_id, "now": time.time()}
        waiting = """
            UPDATE jobs SET state = 'cancelled', cancel_requested = :now, finished = :now WHERE id = :id AND state = 'queued'"""
        running = """
            UPDATE jobs SET cancel_requested = :now WHERE id = :id AND state = 'running' AND cancel_requested IS NULL"""
        if not self._change(waiting, values):
            self._change(running, values)

    # The worker's side; every call answers whether the job is still this worker's

    def register(self, job_id: str, pid: int) -> bool:
        """A worker takes charge of a job that was claimed for it."""
        statement = """
            UPDATE jobs SET pid = :pid, pid_started = :started, host = :host, heartbeat = :now, heartbeat_clock = :clock
            WHERE id = :id AND state = 'running' AND pid IS NULL"""
        return self._change(statement, {"id": job_id, **_identity(pid), "host": host_id()})

    def record_task(self, job_id: str, pid: int, task_pid: int) -> bool:
        """The worker names the process that runs the entry."""
        statement = (
            "UPDATE jobs SET task_pid = :task, task_started = :started WHERE id = :id AND state = 'running' AND pid = :pid"
        )
        return self._change(statement, {"id": job_id, "pid": pid, "task": task_pid, "started": start_time(task_pid)})

    def beat(self, job_id: str, pid: int, progress: Progress | None) -> bool:
        """The worker lives; `progress` if there is news."""
        statement = """
            UPDATE jobs SET heartbeat = :now, heartbeat_clock = :clock WHERE id = :id AND state = 'running' AND pid = :pid"""
        with_progress = """
            UPDATE jobs SET heartbeat = :now, heartbeat_clock = :clock, progress_done = MAX(progress_done, :done),
            progress_total = :total, message = :message WHERE id = :id AND state = 'running' AND pid = :pid"""
        values: dict[str, Any] = {"id": job_id, "pid": pid, "now": time.time(), "clock": time.monotonic()}
        if progress is None:
            return self._change(statement, values)
        return self._change(with_progress, {**values, **progress._asdict()})

    def cancel_asked(self, job_id: str) -> float | None:
        """When cancel was requested."""
        with self._open() as connection:
            row = connection.execute("SELECT cancel_requested FROM jobs WHERE id = ?", (job_id,)).fetchone()
        return None if row is None else row["cancel_requested"]

    def finish(
        self, job_id: str, pid: int | None, state: JobState, *, result: str | None = None, error: dict[str, str] | None = None
    ) -> bool:
        """running -> `state`. A cancel that was requested before this moment wins over any other end."""
        statement = """
            UPDATE jobs SET finished = :now, result = IIF(cancel_requested IS NULL, :result, NULL),
            error = IIF(cancel_requested IS NULL, :error, NULL), state = IIF(cancel_requested IS NULL, :state, 'cancelled')
            WHERE id = :id AND state = 'running' AND pid IS :pid"""
        text = json.dumps(error) if error is not None else None
        return self._change(
            statement, {"id": job_id, "pid": pid, "state": state, "result": result, "error": text, "now": time.time()}
        )

    # Recovery

    def recover(self, job: Job) -> bool:
        """End a running job whose worker is gone, as `lost` (or `cancelled`); True if that was so.

        On this host a worker is gone when its pid is, or has another start time. A worker that lives but is silent
        for STALE_S is killed first. Of another host (or an earlier boot) only the silence can be seen.
        """
        reason = _loss(job)
        if reason is None:
            return False
        if job.host == host_id():
            for pid, started in ((job.pid, job.pid_started), (job.task_pid, job.task_started)):
                if pid is not None:
                    end_group(pid, started)
        error = {"type": EngineError.__name__, "message": f"{reason}; see {job.log}, then submit the job again"}
        return self.finish(job.id, job.pid, "lost", error=error)


def _identity(pid: int) -> dict[str, Any]:
    return {"pid": pid, "started": start_time(pid), "now": time.time(), "clock": time.monotonic()}


def _loss(job: Job) -> str | None:
    """Why a running job must be taken for lost, or None."""
    if job.state != "running" or job.heartbeat is None or job.heartbeat_clock is None:
        return None
    if job.host != host_id():
        silent = time.time() - job.heartbeat
        return f"the worker on another host or boot is silent for {silent:.0f} s" if silent > START_S else None
    silent = time.monotonic() - job.heartbeat_clock
    if job.pid is None:
        return f"the worker did not report within {START_S:.0f} s of its start" if silent > START_S else None
    if not is_alive(job.pid, job.pid_started):
        return f"the worker process {job.pid} is gone"
    return f"the worker process {job.pid} is silent for {silent:.0f} s" if silent > STALE_S else None
