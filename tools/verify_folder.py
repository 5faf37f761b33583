"""Verdicts about a world folder anywhere, without the server: `worldagent verify` and `worldagent recompute`."""

from __future__ import annotations

import secrets
from pathlib import Path
from typing import Any

from ..worlds.folder import WorldFolder
from ..worlds.requirements import Row
from .session import Session, counts

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
        "unmet_clauses": {k: c["unmet"] for k, c in record["clauses"].items() if c["unmet"]},
        "approximations": record["approximations"],
        "versions": record["versions"],
        "replayed": record["replayed"],
    }


def verify_folder(folder: Path, *, replay: bool) -> dict[str, Any]:
    """Judge a world folder in a fresh process with this program's own verifiers; nothing in it is written.

    Args:
        folder: a world folder, copied from anywhere.
        replay: also simulate randomly chosen intervals again and compare bytes.

    Raises:
        RefusedError: no candidate holds the folder's specification, or its bake is incomplete.
        EvidenceError: something recorded is missing or damaged.
    """
    from ..verifiers.acceptance import judge_fresh

    return _report(judge_fresh(folder.resolve(), replay=replay, seed=secrets.randbelow(2**31)))


def recompute_folder(folder: Path) -> dict[str, Any]:
    """Build, probe, bake and judge a world folder from its specification alone (R158).

    What is cached already is reused only where its digests match; delete `candidates/` and `built/` to start from nothing.
    """
    from ..execution import run_inline
    from ..verifiers.acceptance import judge_fresh

    root = folder.resolve()
    session = Session.at(WorldFolder(root))
    session.require_audit("recompute")
    payload = {"folder": str(root)}
    session.check_static()
    probed = run_inline("worldagent.tools.jobs:probe", payload)
    if not probed["passed"]:
        return {"verdict": "incomplete", "rows": probed["counts"], "failing": probed["open_rows"], "stage": "probe"}
    run_inline("worldagent.tools.jobs:bake", payload)
    record = judge_fresh(root, seed=secrets.randbelow(2**31))
    return _report(record)
