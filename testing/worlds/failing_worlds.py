"""Small worlds that fail on purpose: what their rows hold, and whether the suggested patches mend them.

The flaws are those of `skills/repair/evals/cases.json`.
"""

from __future__ import annotations

import random
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...bench.skill_repair import cases, flawed
from ...bench.trial import Judged, Trial
from ...worlds.groups import GROUPS
from ...worlds.requirements import Correction, Row

__all__ = ["try_patches"]


def _trial(data: dict[str, Any], name: str, seed: int, folder: str) -> Trial:
    spec = flawed(data, name, random.Random(f"{name} {seed}"))
    return Trial(Path(folder) / "w", data["worlds"][data["flaws"][name]["world"]]["prompt"], spec)


def _suggestions(judged: Judged) -> list[tuple[Row, Correction]]:
    """The best patch of each failing row that mends the world, the same patch once."""
    found: dict[str, tuple[Row, Correction]] = {}
    for row in judged.rows:
        best = next((c for c in row.corrections if c.patch and GROUPS[c.group].edit_class in ("scene", "solver")), None)
        if row.status == "fail" and best is not None:
            found.setdefault(str(best.patch), (row, best))
    return list(found.values())


def try_patches(names: Sequence[str] = (), *, seed: int = 1) -> list[dict[str, Any]]:
    """Apply the best suggested patch of every failing row, each to the flawed world itself.

    Returns:
        Per patch: flaw, row, group, whether the edit was taken (`applied`), whether the audit passes after it, and what
        became of the row: `passes`, `better` (nearer to its bound), `same`, `worse`, or `not judged` where another check stops
        before it.
    """
    data, found = cases(), []
    for name in names or data["flaws"]:
        with tempfile.TemporaryDirectory() as folder:
            suggestions = _suggestions(_trial(data, name, seed, folder).judge())
        for row, correction in suggestions:
            with tempfile.TemporaryDirectory() as folder:
                trial = _trial(data, name, seed, folder)
                trial.judge()
                refused = trial.edit([dict(o) for o in correction.patch], f"{correction.cause}: {correction.action}")
                audit = not refused and trial.session.audit().passed
                found.append(
                    {
                        "flaw": name,
                        "row": row.id,
                        "group": correction.group,
                        "applied": not refused,
                        "refused": refused,
                        "audit": audit,
                        "outcome": _outcome(row, trial.judge()) if audit else "not judged",
                    }
                )
    return found


def _outcome(before: Row, judged: Judged) -> str:
    after = next((r for r in judged.rows if r.id == before.id), None)
    if after is None:
        early = judged.stage == "static" and before.frames is not None and before.frames[1] > 0
        return "not judged" if early else "passes"
    if None in (before.measured, before.bound, after.measured, after.bound):
        return "same"
    was, now = (abs(float(r.measured or 0.0) - float(r.bound or 0.0)) for r in (before, after))
    return "better" if now < was else "worse" if now > was else "same"
