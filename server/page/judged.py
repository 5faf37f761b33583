"""Rows and verdicts of a ledger as plain data for the page."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from ...workflow.rows import brief, counts
from ...workflow.standing import Standing
from ...worlds.folder import WorldFolder
from ...worlds.ledger import Ledger
from ...worlds.requirements import Row
from ...worlds.verdicts import reader_words, unusual_told, verdict_words

__all__ = ["OPEN_ROWS", "latest_acceptance", "latest_verdict", "row_counts", "row_line", "row_status", "row_text"]

OPEN_ROWS = 12
"""Rows that stand open, or are not proven, in an overview."""


def row_status(row: Row) -> str:
    """The status of a row, with `stale` for what was judged before an edit and not since."""
    return "stale" if row.status == "unverified" and row.evidence.get("stale") else row.status


def row_counts(rows: Iterable[Row]) -> dict[str, int]:
    """Rows per status; stale ones apart from those that were never judged."""
    rows = list(rows)
    found = counts(rows)
    stale = sum(row_status(r) == "stale" for r in rows)
    return found | {"stale": stale, "unverified": found["unverified"] - stale}


def row_text(row: Row) -> str:
    """Text of a row that a search looks through."""
    parts = (row.id, row.check, row.predicate, row.first_failing_entity or "", " ".join(row.entities))
    return " ".join(parts).lower()


def row_line(row: Row) -> dict[str, Any]:
    """A row for a table."""
    data = brief(row, corrections=1)
    kept = (
        "id", "check", "group", "predicate", "mandatory", "measured", "bound", "comparison", "unit", "frames",
        "first_failing_entity", "first_failing_frame", "corrections",
    )  # fmt: skip
    found = {k: data[k] for k in kept if k in data}
    if row_status(row) == "stale":
        found |= {"was": row.evidence.get("was"), "why": row.evidence.get("stale")}
    return found | {"status": row_status(row)}


def latest_verdict(ledger: Ledger, where: Standing) -> dict[str, Any] | None:
    """The latest verdict of the ledger and whether it is about what is there now."""
    latest = ledger.acceptance()
    if latest is None:
        return None
    step = where.step("accepted")
    told = {"verdict": latest["verdict"], "says": verdict_words(latest["record"]), "revision": latest["revision"]}
    told |= unusual_told(latest["record"])
    return {**told, "stale": step.state == "stale", "note": step.note}


def _prompt(record: Mapping[str, Any]) -> dict[str, Any] | None:
    """Shares of the prompt and who read it; None for clauses."""
    prompt = record.get("prompt")
    if not isinstance(prompt, Mapping):
        return None
    return {**{k: prompt.get(k, 0) for k in ("claimed", "filler", "waived")}, "read_by": reader_words(prompt)}


def latest_acceptance(folder: WorldFolder, ledger: Ledger, where: Standing) -> dict[str, Any] | None:
    """The latest verdict with all that it leaves unproven."""
    latest = ledger.acceptance()
    if latest is None:
        return None
    record = latest["record"]
    rows = [Row.model_validate(r) for r in record.get("rows", [])]
    clauses = record.get("clauses") or {}
    names = {"report": f"{latest['freeze'][:16]}.html", "bundle": f"{latest['freeze'][:16]}.zip"}
    if latest["verdict"] != "accepted":
        del names["bundle"]
    return {
        **(latest_verdict(ledger, where) or {}),
        "at": latest["at"],
        "freeze": latest["freeze"][:16],
        "reason": record.get("reason", ""),
        "matrix": counts(rows),
        "not_proven": [row_line(r) for r in rows if r.status in ("fail", "unverified")][:OPEN_ROWS],
        "not_proven_count": sum(r.status in ("fail", "unverified") for r in rows),
        "clauses": [
            {"id": k, "text": c.get("text", ""), "unmet": c.get("unmet"), "static_because": c.get("static_because")}
            for k, c in clauses.items()
        ],
        "prompt": _prompt(record),
        "approximations": record.get("approximations", []),
        "weakenings": record.get("weakenings", []),
        "easier_beside": record.get("easier_beside", []),
        "replayed": record.get("replayed", False),
        "versions": record.get("versions", {}),
        "files": {kind: name for kind, name in names.items() if (folder.acceptance / name).is_file()},
    }
