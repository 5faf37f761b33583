"""The file of a ledger: tables, transactions, and seals that tell a flipped bit from what was written."""

from __future__ import annotations

import hashlib
import sqlite3
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from .ablation import ablation
from .errors import EvidenceError
from .storage import storage_failure

__all__ = ["LedgerFile", "change_count", "check_seal", "matrix_texts", "put_seal"]

_TABLES = {
    "meta": "key TEXT PRIMARY KEY, value TEXT NOT NULL",
    "revisions": """
        n INTEGER PRIMARY KEY, created REAL NOT NULL, digest TEXT NOT NULL, spec TEXT NOT NULL, patch TEXT NOT NULL,
        hypothesis TEXT NOT NULL, groups TEXT NOT NULL, weakenings TEXT NOT NULL, reason TEXT NOT NULL""",
    "early": "n INTEGER PRIMARY KEY, lines TEXT NOT NULL",
    "matrix": """
        id TEXT PRIMARY KEY, revision INTEGER NOT NULL, stage TEXT NOT NULL, status TEXT NOT NULL, row TEXT NOT NULL,
        updated REAL NOT NULL""",
    "history": """
        seq INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT NOT NULL, revision INTEGER NOT NULL, stage TEXT NOT NULL,
        status TEXT NOT NULL, measured REAL, bound REAL, entity TEXT, frame INTEGER, at REAL NOT NULL""",
    "iterations": """
        n INTEGER PRIMARY KEY AUTOINCREMENT, revision INTEGER NOT NULL, hypothesis TEXT NOT NULL, grp TEXT NOT NULL,
        failing_before TEXT NOT NULL, probe TEXT, failing_after TEXT, at REAL NOT NULL, changes TEXT, before TEXT, after TEXT""",
    "freezes": """
        freeze TEXT PRIMARY KEY, revision INTEGER NOT NULL, passed INTEGER NOT NULL, detail TEXT NOT NULL, at REAL NOT NULL""",
    "bakes": "freeze TEXT PRIMARY KEY, revision INTEGER NOT NULL, digest TEXT NOT NULL, detail TEXT NOT NULL, at REAL NOT NULL",
    "refuted": """
        n INTEGER PRIMARY KEY AUTOINCREMENT, freeze TEXT NOT NULL, digest TEXT NOT NULL, detail TEXT NOT NULL, at REAL NOT NULL,
        settled INTEGER NOT NULL""",
    "looks": """
        freeze TEXT NOT NULL, stage TEXT NOT NULL, revision INTEGER NOT NULL, last INTEGER NOT NULL, at REAL NOT NULL,
        settled INTEGER NOT NULL, PRIMARY KEY (freeze, stage)""",
    "acceptances": """
        n INTEGER PRIMARY KEY AUTOINCREMENT, freeze TEXT NOT NULL, revision INTEGER NOT NULL, subject TEXT NOT NULL,
        verdict TEXT NOT NULL, record TEXT NOT NULL, at REAL NOT NULL""",
    "reviews": "n INTEGER PRIMARY KEY AUTOINCREMENT, digest TEXT NOT NULL, record TEXT NOT NULL",
}
_BUSY_S = 60.0
"""Longest wait for others [s]: an edit holds the file while its rules are judged, and the end of a bake must not be lost for that."""


class LedgerFile:
    """A SQLite file with a rollback journal. Every call opens its own connection, so that any thread may call."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._held = threading.local()
        with self._open() as db:
            known = {r["name"] for r in db.execute("SELECT name FROM sqlite_master WHERE type='table'")}
            if not known >= _TABLES.keys():
                db.executescript("".join(f"CREATE TABLE IF NOT EXISTS {name} ({columns});" for name, columns in _TABLES.items()))
            if not known:
                db.execute("INSERT OR IGNORE INTO meta VALUES ('seals', 'all')")

    @contextmanager
    def together(self, undo: Callable[[], None] = lambda: None) -> Iterator[None]:
        """A transaction of this thread: nobody else writes meanwhile, and all of it counts or nothing.

        `undo` takes back what was written elsewhere, where the step fails. A step within a step is a part of it.

        Raises:
            EngineError: another process holds the file too long, or it cannot be written.
        """
        if hasattr(self._held, "db"):
            try:
                yield
            except BaseException:
                undo()
                raise
            return
        with self._told():
            db = self._begun("BEGIN IMMEDIATE")
            if name := ablation():
                db.execute("INSERT OR REPLACE INTO meta VALUES ('ablation', ?)", (name,))
        self._held.db = db
        try:
            yield
            with self._told():
                db.execute("COMMIT")
        except BaseException:
            undo()
            raise
        finally:
            del self._held.db
            db.close()  # what was not committed is undone

    def ablation(self) -> str:
        """Name of the ablation of the server that made this world; empty for every other world."""
        with self._open() as db:
            row = db.execute("SELECT value FROM meta WHERE key='ablation'").fetchone()
        return "" if row is None else str(row["value"])

    @contextmanager
    def looking(self) -> Iterator[None]:
        """A reading transaction of this thread: one state of the file. Keep it short, since writers wait meanwhile."""
        with self._told():
            db = self._begun("BEGIN")
        self._held.db = db
        try:
            yield
        finally:
            del self._held.db
            db.close()

    @contextmanager
    def _open(self) -> Iterator[sqlite3.Connection]:
        """A transaction for reading: one state of the file, whoever writes meanwhile.

        What cannot be read or understood is told as damage.
        """
        held: sqlite3.Connection | None = getattr(self._held, "db", None)
        with self._told():
            db = held or self._begun("BEGIN")  # a record and its seal are two statements
            try:
                yield db
            finally:
                if db is not held:
                    db.close()

    @contextmanager
    def _write(self) -> Iterator[sqlite3.Connection]:
        """A transaction: all of it or nothing."""
        if not hasattr(self._held, "db"):
            with self.together(), self._write() as db:
                yield db
            return
        with self._told():
            yield self._held.db

    def _begun(self, how: str) -> sqlite3.Connection:
        db = sqlite3.connect(self.path, timeout=_BUSY_S, isolation_level=None)
        try:
            db.row_factory = sqlite3.Row
            db.execute("PRAGMA trusted_schema=OFF")  # the file may come with a world from a stranger
            db.execute(how)
        except BaseException:
            db.close()
            raise
        return db

    @contextmanager
    def _told(self) -> Iterator[None]:
        """Errors of the database file become errors of ours."""
        try:
            yield
        except (sqlite3.DatabaseError, ValueError, KeyError) as error:
            raise self._failure(error) from error

    def _failure(self, error: Exception) -> Exception:
        if isinstance(error, sqlite3.ProgrammingError | sqlite3.InterfaceError):
            return error
        world = self.path.parent.name
        told = storage_failure(error, f"{self.path.name} of world {world!r}")
        if told is not None and not isinstance(told, EvidenceError):
            return told
        return EvidenceError(
            f"{self.path.name} of world {world!r} is damaged ({error}); nothing in it counts and nothing was written. "
            f"The specification and the caches beside it are untouched: put back a copy of {self.path.name}, or create "
            f"another world with edit_spec from what the resource worldagent://worlds/{world}/spec holds"
        )


def change_count(path: Path) -> int:
    """Changes with every transaction that writes to the file, however coarse the clock of its file system; 0 where it is none.

    References:
        SQLite, Database File Format, 1.3.7 File change counter. https://www.sqlite.org/fileformat2.html
    """
    try:
        with path.open("rb") as stream:
            return int.from_bytes(stream.read(28)[24:], "big")
    except OSError:
        return 0


def _sealed(texts: tuple[str, ...]) -> str:
    state = hashlib.sha256()
    for text in texts:
        state.update(text.encode())
        state.update(b"\x00")
    return state.hexdigest()


def put_seal(db: sqlite3.Connection, place: str, *texts: str) -> None:
    """Record a digest of what a place of the ledger holds, within the transaction that writes it."""
    db.execute("INSERT OR REPLACE INTO meta VALUES (?,?)", (f"seal:{place}", _sealed(texts)))


def check_seal(db: sqlite3.Connection, place: str, *texts: str) -> None:
    """Compare a place with its digest; one that holds something has none only in ledgers of older servers.

    A seal finds accidents. It keeps nobody from writing both: what counts against that is the acceptance process.

    Raises:
        ValueError: they differ, so that the file was damaged.
    """
    if not all(isinstance(text, str) for text in texts):  # a flipped bit of its type makes a text a number or bytes
        raise ValueError(f"the record {place!r} holds what is no text")
    found = db.execute("SELECT value FROM meta WHERE key=?", (f"seal:{place}",)).fetchone()
    if found is None and texts and db.execute("SELECT 1 FROM meta WHERE key='seals'").fetchone() is not None:
        raise ValueError(f"the seal of the record {place!r} was taken away")
    if found is not None and found["value"] != _sealed(texts):
        raise ValueError(f"the record {place!r} is not what was written")


def matrix_texts(db: sqlite3.Connection) -> tuple[str, ...]:
    """All that the matrix holds, in the order of its ids."""
    found = db.execute("SELECT id, stage, row FROM matrix ORDER BY id").fetchall()
    return tuple(text for r in found for text in (r["id"], r["stage"], r["row"]))
