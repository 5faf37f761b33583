"""Faults of the disk in words for the caller: full, read-only, out of reach, damaged."""

from __future__ import annotations

import errno
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from .errors import EngineError, EvidenceError, WorldAgentError

__all__ = ["exclusively", "storage_failure"]

_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_CLOSED = (errno.EROFS, errno.EACCES, errno.EPERM)
_BROKEN = (errno.EIO, errno.ESTALE, errno.ENODEV, errno.ENXIO)
_SCARCE = (errno.EMFILE, errno.ENFILE)
_IN_THE_WAY = (errno.EEXIST, errno.ENOTDIR, errno.EISDIR)
_SQL_FULL = (sqlite3.SQLITE_FULL,)
_SQL_CLOSED = (sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_PERM, sqlite3.SQLITE_AUTH)
_SQL_DAMAGED = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB)
_SQL_BUSY = (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED)


@contextmanager
def exclusively(lock: Path, patience_s: float) -> Iterator[None]:
    """Hold a lock file, against threads and processes; it stays where it is, and is free when its holder dies.

    It is an empty database: its locks are the system's on every platform, and none is ever taken for stale.

    Args:
        lock: the file; its folder is there.
        patience_s: how long to wait for another holder [s].

    Raises:
        EngineError: another process holds it too long, or it cannot be made.
    """
    with closing(sqlite3.connect(lock, timeout=patience_s, isolation_level=None)) as held:
        try:
            held.execute("BEGIN EXCLUSIVE")
        except sqlite3.Error as error:
            raise storage_failure(error, lock.name) or error from error
        yield


def storage_failure(error: BaseException, what: str = "") -> WorldAgentError | None:
    """The error that tells a fault of the disk and the next step; None for any other exception.

    Args:
        error: what was raised.
        what: the file or database, as the caller knows it; default: the name that the error carries.
    """
    if isinstance(error, sqlite3.Error):
        return _of_database(error, what or "a database of the workspace")
    if isinstance(error, OSError):
        return _of_file(error, what or _name(error))
    return None


def _of_file(error: OSError, what: str) -> WorldAgentError | None:
    if error.errno in _FULL:
        return _full(what, error)
    if error.errno in _CLOSED:
        return _closed(what, error)
    if error.errno in _IN_THE_WAY:
        return EngineError(f"{what} is in the way ({error.strerror}); move it out of the workspace, then repeat the call")
    if error.errno in _BROKEN:
        return EngineError(f"{what} cannot be reached: {error.strerror}. Look at the workspace's disk, then repeat the call")
    if error.errno in _SCARCE:
        return EngineError(f"{what} could not be opened: {error.strerror}. Wait until running calls end, then repeat the call")
    return None


def _of_database(error: sqlite3.Error, what: str) -> WorldAgentError | None:
    code = getattr(error, "sqlite_errorcode", None)
    primary = None if code is None else code & 0xFF
    if primary in _SQL_FULL:
        return _full(what, error)
    if primary in _SQL_CLOSED:
        return _closed(what, error)
    if primary in _SQL_BUSY:
        return EngineError(f"{what} is in use by another process ({error}); nothing was changed, repeat the call")
    if primary in _SQL_DAMAGED:
        return EvidenceError(f"{what} is damaged ({error})")
    if primary == sqlite3.SQLITE_IOERR:
        return EngineError(
            f"{what} cannot be read or written ({error}); nothing was changed. "
            "Free space on the workspace's disk or mend it, then repeat the call"
        )
    return None


def _full(what: str, error: Exception) -> EngineError:
    return EngineError(
        f"the disk is full: {what} could not be written ({error}). What was recorded before stands. Free space on the "
        "workspace's disk (old candidates and worlds are the largest), then repeat the call"
    )


def _closed(what: str, error: Exception) -> EngineError:
    return EngineError(
        f"the workspace cannot be written: {what} ({error}). Reading goes on. Make the workspace writable for the server, "
        "or start it with another --workspace, then repeat the call"
    )


def _name(error: OSError) -> str:
    name = error.filename
    return repr(str(name).rpartition("/")[2]) if name else "a file of the workspace"
