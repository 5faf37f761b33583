"""The slices of the slow tests and their record: which tests belong to which, and when each last passed.

`slices.json` maps a slice to prefixes of test ids; a slow test belongs to the slice with the longest prefix that fits. `passes.json`
maps a slice to its last pass and, while it fails, to the failure since.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import date
from pathlib import Path

__all__ = ["PASSES", "SLICES", "Run", "assigned", "due", "read_passes", "read_slices", "recorded", "table"]

HERE = Path(__file__).parent
SLICES = HERE / "slices.json"
PASSES = HERE / "passes.json"


@dataclass(frozen=True)
class Run:
    """One run of a slice."""

    commit: str
    date: str
    """ISO date."""
    seconds: int
    passed: int
    failed: int
    skipped: int
    xfailed: int
    machine: str
    """Cores and operating system."""

    @property
    def whole(self) -> bool:
        """Something passed and nothing failed."""
        return self.passed > 0 and self.failed == 0


Passes = Mapping[str, Mapping[str, Run]]
"""Slice -> {"passed": its last pass, "failed": the failure after it}; either may be missing."""


def read_slices(path: Path = SLICES) -> dict[str, list[str]]:
    """Slice name -> prefixes of test ids."""
    found: dict[str, list[str]] = json.loads(path.read_text())
    return found


def read_passes(path: Path = PASSES) -> dict[str, dict[str, Run]]:
    """Last pass and failure of every slice; empty where there is no file."""
    if not path.exists():
        return {}
    return {name: {kind: Run(**run) for kind, run in kinds.items()} for name, kinds in json.loads(path.read_text()).items()}


def assigned(tests: Iterable[str], slices: Mapping[str, Sequence[str]]) -> tuple[dict[str, list[str]], list[str], list[str]]:
    """Tests by slice.

    Returns: tests of each slice; tests that no slice takes; prefixes that take no test.
    """
    prefixes = {prefix: name for name, listed in slices.items() for prefix in listed}
    found: dict[str, list[str]] = {name: [] for name in slices}
    homeless, used = [], set()
    for test in tests:
        fitting = [p for p in prefixes if test.startswith(p)]
        if not fitting:
            homeless.append(test)
            continue
        longest = max(fitting, key=len)
        used.add(longest)
        found[prefixes[longest]].append(test)
    return found, homeless, sorted(set(prefixes) - used)


BY_NAME = "long-"
"""Slices that begin so take more than CI has: they run by name alone, and their age is printed with the others."""


def due(slices: Iterable[str], passes: Passes, *, today: date) -> str:
    """The slice whose last pass is oldest, never passed ones first; of those equally old the day of the year picks; none of `BY_NAME`.

    A fresh clone of one commit so runs another slice every day, until newer passes are committed.
    """
    turns = [name for name in slices if not name.startswith(BY_NAME)]
    when = {name: passes.get(name, {})["passed"].date if "passed" in passes.get(name, {}) else "" for name in turns}
    oldest = sorted(name for name in when if when[name] == min(when.values()))
    return oldest[today.timetuple().tm_yday % len(oldest)]


def recorded(passes: Passes, name: str, run: Run) -> dict[str, dict[str, Run]]:
    """The record with one run more: a pass clears the failure, a failure keeps the last pass beside it."""
    kinds = dict(passes.get(name, {}))
    kinds = {"passed": run} if run.whole else {**kinds, "failed": run}
    return {**{n: dict(k) for n, k in passes.items()}, name: kinds}


def written(passes: Passes) -> str:
    """The record as text, one line a run."""
    lines = [
        f'  "{name}": {{\n'
        + ",\n".join(f'    "{kind}": {json.dumps(asdict(run))}' for kind, run in sorted(kinds.items()))
        + "\n  }"
        for name, kinds in sorted(passes.items())
    ]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def table(slices: Iterable[str], passes: Passes, *, today: date) -> str:
    """One line a slice: age of its last pass, commit, time and counts; failures since."""
    lines = []
    for name in sorted(slices):
        kinds = passes.get(name, {})
        if "passed" in kinds:
            run = kinds["passed"]
            age = (today - date.fromisoformat(run.date)).days
            text = f"passed {age} days ago ({run.date}, {run.commit}): {run.passed} tests in {run.seconds} s"
            text += f", {run.skipped} skipped" if run.skipped else ""
            text += f", {run.xfailed} declared misses" if run.xfailed else ""
        else:
            text = "never passed"
        if "failed" in kinds:
            bad = kinds["failed"]
            text += f"; failed since ({bad.date}, {bad.commit}): {bad.failed} of {bad.failed + bad.passed}"
        lines.append(f"{name:24} {text}")
    return "\n".join(lines)
