"""A damaged `jobs.db`: told apart from other faults, and moved aside so that work can go on.

The table holds no evidence: worlds, caches and verdicts live in the world folders. Losing it costs the list of jobs.
"""

from __future__ import annotations

import contextlib
import sqlite3
import time
from pathlib import Path

from ..worlds.errors import EngineError
from ..worlds.storage import exclusively

__all__ = ["is_damage", "set_aside"]

_DAMAGED = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB)
_PATIENCE_S = 20.0
"""Longest wait for another process that moves the same file aside [s]."""


def is_damage(error: sqlite3.Error) -> bool:
    """True if the content of the file is at fault, not the disk or another process."""
    code = getattr(error, "sqlite_errorcode", None)
    return (code is not None and code & 0xFF in _DAMAGED) or "no such table" in str(error)


def set_aside(path: Path, error: sqlite3.Error) -> EngineError:
    """Move a database that is still damaged out of the way, journal included; what to tell the caller."""
    kept = path.with_name(f"{path.stem}.damaged-{time.time_ns()}{path.suffix}")
    moved = "it was empty"
    # Of several that meet the damage one looks and moves: what the others would move is the new file.
    with exclusively(path.with_suffix(".lock"), _PATIENCE_S):
        if _damaged(path):
            moved = f"it was moved aside as {kept.name}"
            with contextlib.suppress(FileNotFoundError):
                journal = path.with_name(path.name + "-journal")
                path.rename(kept)
                journal.rename(kept.with_name(kept.name + "-journal"))
    return EngineError(
        f"{path.name} was damaged ({error}); {moved}, and an empty list of jobs begins. Worlds and their evidence are "
        "untouched. Jobs that ran are given up: repeat the call, an interrupted bake resumes"
    )


def _damaged(path: Path) -> bool:
    """True if the file cannot be read as a whole: another process may have replaced it meanwhile."""
    try:
        with contextlib.closing(sqlite3.connect(f"{path.as_uri()}?mode=rw", uri=True, timeout=3.0)) as connection:
            if path.stat().st_size and not connection.execute("SELECT 1 FROM sqlite_master WHERE name='jobs'").fetchone():
                return True
            return bool(connection.execute("PRAGMA quick_check(1)").fetchone()[0] != "ok")
    except (sqlite3.Error, OSError) as error:
        return isinstance(error, sqlite3.Error) and is_damage(error)
