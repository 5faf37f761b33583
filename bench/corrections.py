"""Benchmark `corrections`: corrections of failing rows, applied to the worlds they are made for (`testing/corrections.py`)."""

from __future__ import annotations

import re
import sys
import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
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

SUMMARY = re.compile(r"(interpenetration|support|contact):scene$")
"""Rows that count what others tell; they carry no correction."""
COUNTS = ("rows", "helped", "eased", "words", "patches", "helping", "recordings", "recordings_helped")
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
    judged = [t for t in every if not SUMMARY.match(t.row)]
    checks = {c: _of_check([t for t in judged if t.check == c]) for c in sorted({t.check for t in judged})}
    total = {k: sum(f[k] for f in checks.values()) for k in COUNTS}
    kinds = sorted({t.world.partition("/")[0] for t in judged})
    suites = {k: _of_check([t for t in judged if t.world.startswith(f"{k}/")]) for k in kinds}
    return {
        **total,
        "share": _share(total),
        "checks": checks,
        "suites": suites,
        "useless": [asdict(t) for t in judged if t.useless],
    }


def _of_check(tried_ones: Sequence[Tried]) -> dict[str, Any]:
    rows: dict[tuple[str, str], list[Tried]] = {}
    for t in tried_ones:
        rows.setdefault((t.world, t.row), []).append(t)
    forged = [of for of in rows.values() if any(t.recording for t in of)]
    rest = [of for of in rows.values() if not any(t.recording for t in of)]
    patches = [t for of in rest for t in of if t.outcome != "words"]
    found = {
        "rows": len(rest),
        "helped": sum(any(t.outcome == "helps" for t in of) for of in rest),
        "eased": sum({"eases"} == {t.outcome for t in of} & {"eases", "helps"} for of in rest),
        "words": sum(all(t.outcome == "words" for t in of) for of in rest),
        "patches": len(patches),
        "helping": sum(t.outcome == "helps" for t in patches),
        "recordings": len(forged),
        "recordings_helped": sum(any(t.outcome == "helps" for t in of) for of in forged),
    }
    return {**found, "share": _share(found)}


def _share(counts: Mapping[str, int]) -> float | None:
    return round(counts["helped"] / counts["rows"], 3) if counts["rows"] else None
