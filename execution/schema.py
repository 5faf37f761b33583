"""The file `jobs.db`: its layout, older layouts brought up to date, connections to it.

SQLite with a rollback journal. Every call opens its own connection, so that a table may be used from any thread and
be carried across a fork.
"""

from __future__ import annotations

import contextlib
import json
import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..worlds.errors import InputError
from .damage import is_damage, set_aside
from .job import Job

__all__ = ["FOLDER", "JobFile", "job_of"]

FOLDER = ".worldagent"
"""Folder of a workspace that holds `jobs.db` and `logs/`."""
VERSION = 3

_BUSY_S = 20.0
_COLUMNS_OF_2 = (
    "warm INTEGER NOT NULL DEFAULT 0",
    "left_s REAL",
    "peak_bytes INTEGER",
    "cpu_s REAL",
)
_COLUMNS_OF_3 = ("pace TEXT",)
_SCHEMA = f"""
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
    log TEXT NOT NULL,
    {", ".join(_COLUMNS_OF_2 + _COLUMNS_OF_3)}
)
"""
_INDEXES = (
    "CREATE INDEX IF NOT EXISTS jobs_state ON jobs (state, priority, number)",
    "CREATE INDEX IF NOT EXISTS jobs_key ON jobs (key, kind, world) WHERE key IS NOT NULL",
    "CREATE INDEX IF NOT EXISTS jobs_served ON jobs (world, started)",
    "CREATE INDEX IF NOT EXISTS jobs_ended ON jobs (world, finished)",
)
_MIGRATIONS: dict[int, tuple[str, ...]] = {
    0: (_SCHEMA, *_INDEXES),
    1: (*(f"ALTER TABLE jobs ADD COLUMN {column}" for column in _COLUMNS_OF_2 + _COLUMNS_OF_3), *_INDEXES),
    2: tuple(f"ALTER TABLE jobs ADD COLUMN {column}" for column in _COLUMNS_OF_3),
}
"""Statements that bring a layout to the present one; rows stay."""


def job_of(row: sqlite3.Row) -> Job:
    """A row as data."""
    names = (name for name in row.keys() if name not in ("number", "pace"))  # noqa: SIM118 - a Row iterates values
    values: dict[str, Any] = {name: row[name] for name in names}
    for name in ("payload", "result", "error"):
        values[name] = json.loads(values[name]) if values[name] is not None else None
    for name in ("exclusive", "warm"):
        values[name] = bool(values[name])
    return Job(**values)


class JobFile:
    """`jobs.db` of a workspace, made or brought up to date when it is opened first."""

    def __init__(self, workspace: Path) -> None:
        self.workspace = workspace.resolve()
        self.path = self.workspace / FOLDER / "jobs.db"
        try:
            self._make()
        except sqlite3.DatabaseError as error:
            raise set_aside(self.path, error) if is_damage(error) else error from error

    def _make(self) -> None:
        for folder in (self.path.parent, self.path.parent / "logs"):
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with contextlib.closing(sqlite3.connect(self.path, timeout=_BUSY_S, isolation_level=None)) as connection:
            if _version(connection) != VERSION:
                connection.execute("BEGIN IMMEDIATE")
                version = _version(connection)  # another process may have been first
                if version != VERSION and version not in _MIGRATIONS:
                    raise InputError(f"{self.path} has layout {version}, this version reads {VERSION}; use another workspace")
                for statement in _MIGRATIONS.get(version, ()):
                    connection.execute(statement)
                connection.execute(f"PRAGMA user_version = {VERSION}")
                connection.execute("COMMIT")

    @contextlib.contextmanager
    def open(self) -> Iterator[sqlite3.Connection]:
        """A connection in autocommit mode."""
        # mode=rw: a workspace that was deleted under a running job is not made anew.
        uri = f"{self.path.as_uri()}?mode=rw"
        try:
            with contextlib.closing(sqlite3.connect(uri, uri=True, timeout=_BUSY_S, isolation_level=None)) as connection:
                connection.row_factory = sqlite3.Row
                # Still a rollback journal, but one that is not deleted each time: 0.9 instead of 5.6 ms a write on ext4.
                connection.execute("PRAGMA journal_mode = TRUNCATE")
                connection.execute("PRAGMA synchronous = NORMAL")
                yield connection
        except sqlite3.DatabaseError as error:
            if not is_damage(error):
                raise
            told = set_aside(self.path, error)
            self._make()
            raise told from error

    @contextlib.contextmanager
    def transaction(self) -> Iterator[sqlite3.Connection]:
        """A connection that holds the write lock from its beginning."""
        with self.open() as connection:
            connection.execute("BEGIN IMMEDIATE")
            try:
                yield connection
                connection.execute("COMMIT")
            except BaseException:
                if connection.in_transaction:
                    connection.execute("ROLLBACK")
                raise

    def change(self, statement: str, values: dict[str, Any]) -> bool:
        """True if an UPDATE met its row."""
        with self.open() as connection:
            return connection.execute(statement, values).rowcount == 1


def _version(connection: sqlite3.Connection) -> int:
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    return int(version)
