"""Whose turn it is: caps of the queue, the order of claims, and what a queued job waits for.

Among the jobs that may start: the highest priority first, which grows while nothing of the job's world runs; of equal
ones the world with the fewest running jobs, then the world that was served longest ago, then the oldest job. So a
client that floods one world delays the next job of another world by at most the jobs that run already.
"""

from __future__ import annotations

import os
import sqlite3
import time
from typing import Any, NamedTuple

from ..worlds.errors import LimitError
from .job import INTERACTIVE, Job
from .processes import host_id
from .schema import FOLDER, JobFile, job_of
from .terms import Terms

__all__ = ["QUEUED_PER_WORKSPACE", "QUEUED_PER_WORLD", "Standing", "claim", "insert", "standing"]

QUEUED_PER_WORLD = 16
"""Jobs of one world that may wait. Own choice: an agent has one or two; more is a loop gone wrong."""
QUEUED_PER_WORKSPACE = 128
AGE_S = 30.0
"""A job of a world that waits unserved gains one level of priority in so long [s]: after ten minutes a bake passes even
fresh interactive work of other worlds."""

_ORDER = """
    next.priority + MAX(0, CAST((:now - MAX(next.created,
        (SELECT COALESCE(MAX(ended.finished), 0) FROM jobs AS ended WHERE ended.world IS next.world),
        IIF(EXISTS (SELECT 1 FROM jobs AS busy WHERE busy.state = 'running' AND busy.world IS next.world), :now, 0)
    )) / :age_s AS INTEGER)) DESC,
    (SELECT COUNT(*) FROM jobs AS same WHERE same.state = 'running' AND same.world IS next.world),
    (SELECT COALESCE(MAX(served.started), 0) FROM jobs AS served WHERE served.world IS next.world),
    next.number"""
_EARLIER = """
    SELECT * FROM jobs WHERE key = :key AND kind = :kind AND world IS :world
    AND state IN ('queued', 'running', 'done') ORDER BY number DESC LIMIT 1"""
_NEW = """
    INSERT INTO jobs (id, key, kind, world, entry, payload, state, exclusive, priority, warm, created, wall_s,
        memory_bytes, log)
    VALUES (:id, :key, :kind, :world, :entry, :payload, 'queued', :exclusive, :priority, :warm, :created, :wall_s,
        :memory_bytes, :log)"""
_CLAIM = f"""
    UPDATE jobs SET state = 'running', started = :now, heartbeat = :now, heartbeat_clock = :clock, host = :host
    WHERE number = (
        SELECT next.number FROM jobs AS next
        WHERE next.state = 'queued'
        AND (SELECT COUNT(*) FROM jobs WHERE state = 'running') < :slots + (next.priority >= :interactive)
        AND NOT (next.exclusive AND EXISTS (
            SELECT 1 FROM jobs AS other WHERE other.state = 'running' AND other.exclusive AND other.world = next.world))
        ORDER BY {_ORDER} LIMIT 1)
    RETURNING id"""  # noqa: S608 - constants of this module
_QUEUED = f"SELECT id FROM jobs AS next WHERE next.state = 'queued' ORDER BY {_ORDER}"  # noqa: S608
_RUNNING = "SELECT * FROM jobs WHERE state = 'running' ORDER BY number"


class Standing(NamedTuple):
    """Where a queued job stands."""

    ahead: int
    """Queued jobs whose turn comes before it, as things stand."""
    waits_for: str
    """Reason why it does not run, in words."""


def insert(file: JobFile, kind: str, world: str | None, entry: str, payload: str, *, terms: Terms) -> Job:
    """A new queued job, or the queued, running or done one that has this key already; `payload` is JSON.

    Raises:
        LimitError: Too many jobs of the world, or of the workspace, wait already.
    """
    job_id = f"job_{os.urandom(6).hex()}"  # what secrets.token_hex does, without its imports
    values: dict[str, Any] = {
        **vars(terms),
        "id": job_id,
        "kind": kind,
        "world": world,
        "entry": entry,
        "payload": payload,
        "created": time.time(),
        "log": f"{FOLDER}/logs/{job_id}.log",
    }
    with file.transaction() as connection:
        row = connection.execute(_EARLIER, values).fetchone() if terms.key is not None else None
        if row is None:
            _check_room(connection, world)
            connection.execute(_NEW, values)
            row = connection.execute("SELECT * FROM jobs WHERE id = :id", values).fetchone()
    return job_of(row)


def _check_room(connection: sqlite3.Connection, world: str | None) -> None:
    rows = connection.execute("SELECT id, world FROM jobs WHERE state = 'queued' ORDER BY number DESC").fetchall()
    same = [row for row in rows if row["world"] == world]
    for name, of, found, cap in (
        ("queued_jobs_per_world", "without a world" if world is None else f"of world {world!r}", same, QUEUED_PER_WORLD),
        ("queued_jobs", "of this workspace", rows, QUEUED_PER_WORKSPACE),
    ):
        if len(found) >= cap:
            newest = ", ".join(row["id"] for row in found[:3])
            raise LimitError(
                f"{name}: {len(found)} jobs {of} wait already, the cap is {cap}. Nothing was queued. Wait for one to end, "
                f"or cancel some with job(action='cancel', job_id=...); the newest are {newest}"
            )


def claim(file: JobFile, slots: int) -> tuple[str, ...]:
    """Take the jobs whose turn it is: queued -> running.

    At most `slots` run at a time, and one more if it is interactive: a look at a world need not wait for a film.
    """
    with file.open() as connection:
        if connection.execute("SELECT 1 FROM jobs WHERE state = 'queued' LIMIT 1").fetchone() is None:
            return ()
    values = {
        "host": host_id(),
        "slots": slots,
        "interactive": INTERACTIVE,
        "age_s": AGE_S,
    }
    claimed: list[str] = []
    with file.transaction() as connection:
        # Now, not when the lock was asked for: the job whose place one takes had not ended then.
        values |= {"now": time.time(), "clock": time.monotonic()}
        while rows := connection.execute(_CLAIM, values).fetchall():
            claimed.append(str(rows[0]["id"]))
    return tuple(claimed)


def standing(file: JobFile, job: Job) -> Standing | None:
    """Number of jobs ahead of a queued one and what it waits for; None if it is not queued."""
    with file.open() as connection:
        connection.execute("BEGIN")  # a job that starts between the two looks would wait for itself
        order = [row["id"] for row in connection.execute(_QUEUED, {"now": time.time(), "age_s": AGE_S})]
        running = [job_of(row) for row in connection.execute(_RUNNING)]
    if job.id not in order:
        return None
    busy = next((other for other in running if job.exclusive and other.exclusive and other.world == job.world), None)
    if busy is not None:
        waits_for = f"world busy with {busy.kind} {busy.id}"
    elif running:
        names = ", ".join(f"{other.kind} {other.id} of {other.world!r}" for other in running[:4])
        waits_for = f"{len(running)} running: {names}"
    else:
        waits_for = "its start"
    return Standing(order.index(job.id), waits_for)
