"""The matrix report of a world as a file: `worldagent report`, and beside every acceptance bundle."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from ..worlds.accounts import Account
from ..worlds.candidate import Candidate, open_candidate
from ..worlds.errors import EvidenceError, InputError
from ..worlds.folder import WorldFolder, write_atomically
from ..worlds.ledger import Ledger
from ..worlds.patch import parse_spec
from ..worlds.requirements import Row
from ..worlds.spec import WorldSpec
from ..worlds.verdicts import verdict_words

__all__ = ["report_world", "write_report"]


def write_report(
    out: Path,
    folder: WorldFolder,
    record: Mapping[str, Any],
    *,
    spec: WorldSpec | None = None,
    problems: Sequence[str] = (),
    sheet: Callable[[], bytes] | None = None,
) -> None:
    """Write the page about a judged candidate.

    Args:
        out: the HTML file.
        folder: the world.
        record: of the judgement.
        spec: what was judged; default `world.json` as it is now.
        problems: further reasons against the verdict.
        sheet: gives the contact sheet where it was drawn before.
    """
    from ..rendering import ReportPictures, matrix_page, report_pictures

    spec = spec or parse_spec(folder.read_json(folder.spec_path))
    candidate = _candidate(folder, str(record["freeze"]), str(record.get("stage", "full")))
    try:
        pictures = (
            ReportPictures()
            if candidate is None
            else report_pictures(candidate, record["rows"], sheet=sheet, account=_account(candidate), record=record)
        )
    except EvidenceError:  # what is damaged cannot be drawn; its rows say so
        pictures = ReportPictures()
    write_atomically(out, matrix_page(record, spec, pictures=pictures, problems=problems).encode())


def _candidate(folder: WorldFolder, freeze: str, stage: str) -> Candidate | None:
    """The candidate to draw; None where nothing was simulated."""
    if not freeze or stage not in ("probe", "full"):
        return None
    try:
        return open_candidate(folder, freeze, "full" if stage == "full" else "probe")
    except EvidenceError:
        return None


def report_world(root: Path, out: Path) -> dict[str, Any]:
    """Judge a world folder now and write its page; where there is no complete bake, the page shows what the matrix knows.

    Raises:
        InputError: there is no such world.
        EvidenceError: it has no ledger.
    """
    from .bundles import judged
    from .rows import counts

    folder = WorldFolder.at(root)
    if not folder.spec_path.is_file():
        raise InputError(f"{str(root)!r} is no world folder: it has no world.json")
    if not folder.ledger_path.is_file():
        raise EvidenceError(f"{folder.id!r} has no ledger.sqlite; use worldagent verify FOLDER --report OUT.html")
    record = judged(folder, Ledger(folder.ledger_path))
    write_report(out, folder, record)
    return {
        "verdict": record["verdict"],
        "says": verdict_words(record),
        "report": str(out),
        "rows": counts(Row.model_validate(r) for r in record["rows"]),
        **({"reason": record["reason"]} if "reason" in record else {}),
    }


def _account(candidate: Candidate) -> Account | None:
    """The verifiers' ledgers; None where a channel for them is missing."""
    from ..verifiers.ledgers.accounts import account_of

    try:
        return account_of(candidate)
    except EvidenceError:
        return None
