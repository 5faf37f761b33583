"""Reads a candidate's bake from a ledger: digest of every frame, and the replays that did not give them."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .cache import Cache
from .errors import EvidenceError
from .ledger_file import check_seal

__all__ = ["BakeRecord", "bake_record", "frame_digests", "refuted_texts"]


@dataclass(frozen=True)
class BakeRecord:
    """The record of the newest complete bake of a freeze."""

    digest: str
    """Digest of the caches' content, as `cache_digest` gives it."""
    frames: Mapping[str, Sequence[str]] = field(default_factory=dict)
    """Digest of every frame by solver instance; empty where an older version, or a bundle, told the whole only."""
    sealed: bool = True
    """True if the record has the seals it was written with. One without them proves nothing about the cache."""
    refuted: tuple[Mapping[str, Any], ...] = ()
    """Replays since that bake which did not give the cached bytes: `digest` of the caches then, `frames`, `first_different_frame`."""


def frame_digests(caches: Mapping[str, Cache]) -> dict[str, list[str]]:
    """Digest of every frame as it was written, by solver instance; what a bake leaves in the ledger."""
    return {name: list(cache.digests()[: cache.index.frames]) for name, cache in sorted(caches.items())}


def refuted_texts(db: sqlite3.Connection, freeze: str) -> tuple[str, ...]:
    """All failed replays of a freeze since its newest bake, oldest first, as the seal covers them."""
    found = db.execute("SELECT digest, detail FROM refuted WHERE freeze=? AND settled=0 ORDER BY n", (freeze,)).fetchall()
    return tuple(text for r in found for text in (r["digest"], r["detail"]))


def bake_record(path: Path, freeze: str) -> BakeRecord | None:
    """Read the record of a freeze's bake from a ledger file without writing to it; None where there is none.

    Raises:
        EvidenceError: the file cannot be read, or holds something else than was written.
    """
    if not path.is_file():
        return None
    try:
        db = sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True, isolation_level=None)
        try:
            db.row_factory = sqlite3.Row
            db.execute("PRAGMA trusted_schema=OFF")  # the file may come with a world from a stranger
            db.execute("BEGIN")
            return _record(db, freeze)
        finally:
            db.close()
    except (sqlite3.Error, ValueError, KeyError, TypeError, AttributeError) as error:
        raise EvidenceError(f"{path.name} does not tell what was baked ({error}); call bake_sim again") from error


def _record(db: sqlite3.Connection, freeze: str) -> BakeRecord | None:
    tables = {r["name"] for r in db.execute("SELECT name FROM sqlite_master WHERE type='table'")}
    if not {"meta", "bakes"} <= tables:
        return None
    row = db.execute("SELECT digest, detail FROM bakes WHERE freeze=?", (freeze,)).fetchone()
    if row is None:
        return None
    check_seal(db, f"bake:{freeze}", row["digest"], row["detail"])
    places = [f"bake:{freeze}"]
    texts: tuple[str, ...] = ()
    if "refuted" in tables:
        texts = refuted_texts(db, freeze)
        check_seal(db, f"refuted:{freeze}", *texts)
    frames = json.loads(row["detail"]).get("frame_digests", {})
    if frames:  # an older version left neither
        places.append(f"refuted:{freeze}")
    sealed = all(db.execute("SELECT 1 FROM meta WHERE key=?", (f"seal:{p}",)).fetchone() for p in places)
    found = ({"digest": digest, **json.loads(text)} for digest, text in zip(texts[::2], texts[1::2], strict=True))
    return BakeRecord(row["digest"], {str(k): tuple(map(str, v)) for k, v in frames.items()}, sealed, tuple(found))
