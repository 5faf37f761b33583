"""Benchmark `corrections`: corrections of failing rows, applied to the worlds they are made for (`testing/corrections.py`)."""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from ..testing.corrections import Broken, Tried, flaw, seeded, try_corrections, wrong_edit
from ..testing.defects.suites import CHECKS, suite_of
from .skill_repair import cases
from .wrong_edits import EDITS

__all__ = ["figures", "run", "worlds"]

World = tuple[str, str]
"""Kind and name of a world."""


def worlds(only: Sequence[str] = ()) -> list[World]:
    """All broken worlds, or those of the named suites, of `flaws` and of `edits`."""
    found = [(c, m.name) for c in CHECKS for m in suite_of(c).of(broken=True)]
    found += [("flaws", name) for name in cases()["flaws"]] + [("edits", str(k)) for k in range(len(EDITS))]
    return [w for w in found if not only or w[0] in only]


def _made(world: World, folder: Path) -> Broken:
    kind, name = world
    if kind == "flaws":
        return flaw(name, folder)
    if kind == "edits":
        return wrong_edit(EDITS[int(name)], folder)
    return seeded(kind, next(m for m in suite_of(kind).mechanisms if m.name == name), folder)


def tried(world: World) -> list[Tried]:
    """Every correction of a world, tried."""
    with tempfile.TemporaryDirectory(prefix="worldagent-corrections-") as folder:
        return list(try_corrections(_made(world, Path(folder))))


def run(*, checks: Sequence[str] | None = None, jobs: int = 1) -> dict[str, Any]:
    """Share of failing rows with a correction that helps, per check; every correction that does not, with the reason.

    Args:
        checks: names of suites, `flaws`, `edits`; default all.
        jobs: worlds at a time.
    """
    every: list[Tried] = []
    chosen = worlds(checks or ())
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for world, found in zip(chosen, pool.map(tried, chosen), strict=True):
            every += found
            told = Counter(t.outcome for t in found)
            print(f"{world[0]}/{world[1]}: {dict(told)}", file=sys.stderr, flush=True)
    return figures(every)


def figures(every: Sequence[Tried]) -> dict[str, Any]:
    """Counts per check, and the corrections with a patch that do not help."""
    checks = {c: _of_check([t for t in every if t.check == c]) for c in sorted({t.check for t in every})}
    total = {k: sum(f[k] for f in checks.values()) for k in ("rows", "helped", "eased", "words", "patches", "helping")}
    useless = [asdict(t) for t in every if t.outcome not in ("helps", "words")]
    return {**total, "share": round(total["helped"] / max(1, total["rows"]), 3), "checks": checks, "useless": useless}


def _of_check(tried_ones: Sequence[Tried]) -> dict[str, Any]:
    rows: dict[tuple[str, str], list[str]] = {}
    for t in tried_ones:
        rows.setdefault((t.world, t.row), []).append(t.outcome)
    helped = [o for o in rows.values() if "helps" in o]
    with_patch = [t for t in tried_ones if t.outcome != "words"]
    return {
        "rows": len(rows),
        "helped": len(helped),
        "eased": sum("eases" in o and "helps" not in o for o in rows.values()),
        "words": sum(set(o) == {"words"} for o in rows.values()),
        "patches": len(with_patch),
        "helping": sum(t.outcome == "helps" for t in with_patch),
        "share": round(len(helped) / len(rows), 3),
    }
