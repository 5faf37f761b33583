"""Verdicts about a world folder anywhere, without the server: `worldagent verify` and `worldagent recompute`."""

from __future__ import annotations

import secrets
import shutil
import sqlite3
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ..worlds.ablation import ablation_words, require_whole
from ..worlds.errors import EvidenceError, InputError, RefusedError, WorldAgentError
from ..worlds.folder import WorldFolder
from ..worlds.ledger import Ledger
from ..worlds.patch import parse_spec
from ..worlds.requirements import Row
from ..worlds.verdicts import prompt_told, unusual_told, verdict_words
from .rows import counts
from .session import Session
from .verify_bundle import untrue_geometry

__all__ = ["recompute_folder", "verify_folder"]


def _report(record: dict[str, Any]) -> dict[str, Any]:
    rows = [Row.model_validate(r) for r in record["rows"]]
    return {
        "verdict": record["verdict"],
        "freeze": record["freeze"],
        "spec_digest": record["spec_digest"],
        "cache_digest": record["cache_digest"],
        "rows": counts(rows),
        "failing": [
            {
                "id": r.id,
                "status": r.status,
                "measured": r.measured,
                "bound": r.bound,
                "entity": r.first_failing_entity,
                "frame": r.first_failing_frame,
            }
            for r in rows
            if r.mandatory and r.status in ("fail", "unverified")
        ],
        "says": verdict_words(record),
        **unusual_told(record),
        **prompt_told(record),
        "approximations": record["approximations"],
        "versions": record["versions"],
        "replayed": record["replayed"],
    }


def verify_folder(
    folder: Path, *, replay: bool, seed: int | None = None, intervals: int | None = None, report: Path | None = None
) -> dict[str, Any]:
    """Judge a world folder, or an acceptance bundle, in a fresh process with this program's own verifiers.

    Nothing in it is written. A bundle is always replayed: without that it proves nothing.

    Args:
        folder: a world folder, copied from anywhere, or the zip file of a bundle.
        replay: also simulate randomly chosen intervals again and compare bytes.
        seed: chooses the intervals; default a new one, which the answer names.
        intervals: how many; default 3, more than there are means all.
        report: where to write the matrix report of this judgement, as HTML.

    Raises:
        InputError: there is no such folder or bundle.
        RefusedError: no candidate holds the folder's specification, its bake is incomplete, or an evaluation without some checks made it.
        EvidenceError: something recorded is missing or damaged.
    """
    from ..verifiers.acceptance import REPLAY_INTERVALS, judge_fresh
    from .matrix_report import write_report
    from .verify_bundle import verify_bundle

    require_whole("verify")
    drawn = secrets.randbelow(2**31) if seed is None else seed
    many = REPLAY_INTERVALS if intervals is None else intervals
    if folder.is_file():
        return verify_bundle(folder, seed=drawn, intervals=many, report=report)
    if not (folder / "world.json").is_file():
        raise InputError(f"{str(folder)!r} is neither a world folder (it has no world.json) nor a bundle")
    world = WorldFolder.at(folder)
    _require_every_check(world)
    record = judge_fresh(world.root, replay=replay, seed=drawn, intervals=many)
    wrong = _untrue(world, record)
    found = {**_report(record), "seed": drawn, "problems": wrong, "differences": _recorded_otherwise(world, record)}
    found["reviews"] = _reviews(world, record)
    if wrong:
        found |= {"verdict": "incomplete", "says": "incomplete"}
    if report is not None:
        write_report(report, world, {**record, "verdict": found["verdict"]}, problems=wrong)
    return found


def _require_every_check(world: WorldFolder) -> None:
    """Refuse what a server made that left checks out: its candidates say so, and its ledger."""
    made = next(
        (name for path in sorted((world.root / "candidates").glob("*/candidate.json")) if (name := _told(world, path))), ""
    )
    if not made:
        with suppress(sqlite3.Error, ValueError, WorldAgentError), _copied_ledger(world) as ledger:
            made = "" if ledger is None else ledger.ablation()
    if made:
        raise RefusedError(f"{world.id!r} is {ablation_words(made)}; make the world anew with a server that judges everything")


def _told(world: WorldFolder, path: Path) -> str:
    """Name of the ablation in the record of a candidate; a damaged record is no candidate."""
    try:
        record = world.read_json(path)
    except EvidenceError:
        return ""
    return str(record.get("ablation", "")) if isinstance(record, dict) else ""


@contextmanager
def _copied_ledger(world: WorldFolder) -> Iterator[Ledger | None]:
    """A copy of the world's ledger, since opening one may write to it; None where there is none."""
    if not world.ledger_path.is_file():
        yield None
        return
    with tempfile.TemporaryDirectory(prefix="worldagent-") as temporary:
        yield Ledger(Path(shutil.copy(world.ledger_path, temporary)))


def _untrue(world: WorldFolder, record: dict[str, Any]) -> list[str]:
    """Built geometry that this installation does not get from the specification: its digest alone proves nothing."""
    known = world.read_json(world.candidate(record["freeze"]) / "candidate.json")
    wrong = untrue_geometry(world, parse_spec(known["spec"]), known)
    return [f"the built geometry of {name!r} is not what the specification gives" for name in wrong]


def _reviews(world: WorldFolder, record: dict[str, Any]) -> list[dict[str, Any]]:
    """Reviews that the folder's own ledger holds, with what their digests say here; they decide nothing."""
    from .review.verdict import shown_reviews

    try:
        with _copied_ledger(world) as ledger:
            return [] if ledger is None else shown_reviews(world, ledger, record["freeze"])
    except (sqlite3.Error, ValueError, TypeError, WorldAgentError) as error:
        return [{"ledger": f"cannot be read: {error}"}]


def _recorded_otherwise(world: WorldFolder, record: dict[str, Any]) -> list[dict[str, Any]]:
    """Rows that the folder's own ledger tells otherwise; the ledger is no evidence, so that these decide nothing."""
    from ..verifiers.checks import rerun_ids
    from ..verifiers.delivery.bundle import compare_rows
    from .review.verdict import not_of_reviews

    try:
        with _copied_ledger(world) as ledger:
            known = None if ledger is None else ledger.acceptance(record["subject"])
    except (sqlite3.Error, ValueError) as error:
        return [{"ledger": f"cannot be read: {error}"}]
    if known is None:
        return []
    theirs = not_of_reviews(known["record"]["rows"])
    if not record["replayed"]:
        again = {"delivery:replay", *rerun_ids(parse_spec(world.read_json(world.spec_path)))}
        theirs = [r for r in theirs if r["id"] not in again]
    return compare_rows(theirs, record["rows"], exact=True)


def recompute_folder(folder: Path) -> dict[str, Any]:
    """Build, probe, bake and judge a world folder from its specification alone (R158).

    What is cached already is reused only where its digests match; delete `candidates/` and `built/` to start from nothing.
    """
    from ..execution import run_inline
    from ..verifiers.acceptance import judge_fresh
    from .plates import plates_anywhere

    root = folder.resolve()
    session = Session.at(WorldFolder.at(root))
    session.require_audit("recompute")
    payload = {"folder": str(root)}
    session.check_static()
    probed = run_inline("worldagent.workflow.jobs:probe", payload)
    if not probed["passed"]:
        return {
            "verdict": "incomplete",
            "says": "incomplete",
            "rows": probed["counts"],
            "failing": probed["open_rows"],
            "stage": "probe",
        }
    run_inline("worldagent.workflow.jobs:bake", payload)
    plates_anywhere(root)
    record = judge_fresh(root, seed=secrets.randbelow(2**31))
    return _report(record)
