"""Old jobs leave the table, and their logs the disk. What a world needs stands in its own folder and ledger."""

from __future__ import annotations

import contextlib
import time

from .job import ENDED_STATES
from .schema import JobFile

__all__ = ["KEPT_DAYS", "KEPT_MAX", "prune"]

KEPT_MAX = 1000
"""Ended jobs that a workspace remembers."""
KEPT_MIN = 200
"""As many of the newest ended jobs stay whatever their age: a clock that jumps ahead must not empty the table."""
KEPT_DAYS = 30
SPARED_S = 3600.0
"""A job that ended so recently stays: a client may still ask for it [s]."""
EVERY = 50
"""Jobs between two looks."""

_OLD = f"""
    SELECT id, log FROM (
        SELECT id, log, number, finished, state, ROW_NUMBER() OVER (ORDER BY number DESC) AS rank,
            ROW_NUMBER() OVER (PARTITION BY world, kind, state ORDER BY number DESC) AS rank_of_kind
        FROM jobs WHERE state IN ({", ".join(f"'{state}'" for state in ENDED_STATES)}))
    WHERE (rank > :most OR (rank > :least AND finished < :oldest)) AND finished < :recent
    AND NOT (state = 'done' AND rank_of_kind = 1)"""  # noqa: S608 - constants


def prune(file: JobFile, *, now: float | None = None) -> int:
    """Forget old jobs, at every EVERY-th new one; how many went.

    Jobs that have not ended stay, and so does the newest done one of each kind and world.
    """
    now = time.time() if now is None else now
    values = {"most": KEPT_MAX, "least": KEPT_MIN, "oldest": now - KEPT_DAYS * 86400.0, "recent": now - SPARED_S}
    with file.open() as connection:
        (newest,) = connection.execute("SELECT COALESCE(MAX(number), 0) FROM jobs").fetchone()
    if newest % EVERY:
        return 0
    with file.transaction() as connection:
        old = connection.execute(_OLD, values).fetchall()
        connection.executemany("DELETE FROM jobs WHERE id = ?", [(row["id"],) for row in old])
    for row in old:
        with contextlib.suppress(OSError):
            (file.workspace / row["log"]).unlink(missing_ok=True)
    return len(old)
