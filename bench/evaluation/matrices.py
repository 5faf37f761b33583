"""The matrix of every world of a sample as data, for two runs to be compared bit for bit."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ...worlds.errors import WorldAgentError
from ...worlds.folder import WorldFolder, world_ids
from ...worlds.ledger import Ledger

__all__ = ["matrices", "matrix_differences"]

_COMPARED = ("status", "measured", "bound", "unit", "mandatory", "first_failing_entity", "first_failing_frame")
"""Fields of a row that are its verdict. Evidence may tell of a random draw, as the intervals of a replay are."""


def matrices(workspace: Path) -> dict[str, Any]:
    """By world: revision, digest of its specification, verdict, digest of its frames, weakenings, and its rows."""
    return {name: _matrix(WorldFolder.of(workspace, name)) for name in world_ids(workspace)}


def _matrix(folder: WorldFolder) -> dict[str, Any]:
    try:
        ledger = Ledger(folder.ledger_path)
        revision, latest = ledger.revision(), ledger.acceptance()
        recorded = ledger.revision_spec(revision)
        rows = {r.id: {k: getattr(r, k) for k in _COMPARED} for r in ledger.rows()}
        return {
            "revision": revision,
            "spec": None if recorded is None else recorded[1],
            "verdict": None if latest is None else latest["verdict"],
            "frames": None if latest is None else latest["record"]["cache_digest"],
            "ablation": ledger.ablation(),
            "weakenings": ledger.weakenings(),
            "rows": dict(sorted(rows.items())),
        }
    except WorldAgentError as error:
        return {"damaged": str(error)}


def matrix_differences(before: dict[str, Any], after: dict[str, Any]) -> list[str]:
    """Lines that say where two runs' matrices differ; none where every verdict is the same, bit for bit."""
    found = [f"world {name!r} is in one of them only" for name in sorted(before.keys() ^ after.keys())]
    for name in sorted(before.keys() & after.keys()):
        one, other = before[name], after[name]
        keys = ("revision", "spec", "verdict", "frames", "ablation", "damaged")
        found += [f"{name}: {k} was {one.get(k)!r}, is {other.get(k)!r}" for k in keys if one.get(k) != other.get(k)]
        rows, others = one.get("rows", {}), other.get("rows", {})
        for row in sorted(rows.keys() | others.keys()):
            if rows.get(row) != others.get(row):
                found.append(f"{name}: row {row} was {rows.get(row)}, is {others.get(row)}")
    return found
