"""Measures which statements of one floor its own fast tests reach, and prints the last figures of the other floors.

python -m worldagent.tests.slow.coverage [FLOOR] [--record] [--gate] [--folder] [--jobs N]; without a floor: the one whose turn it is by the date.

One floor at a time: the tracer made the tests about a third slower (one comparison on two busy cores, Python 3.11). Bodies of kernels are compiled,
so the tracer never sees them run; modules of kernels are left out.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, date, datetime
from pathlib import Path
from typing import Any

from .run import ROOT, commit

FIGURES = Path(__file__).parent / "coverage.json"
"""Floor -> its last recorded `Figures`."""
FLOORS = {
    "physics": "tests/physics/laws",
    "worlds": "tests/worlds",
    "execution": "tests/execution",
    "geometry": "tests/geometry",
    "construction": "tests/construction",
    "simulation": "tests/simulation",
    "verifiers": "tests/verifiers",
    "rendering": "tests/rendering",
    "workflow": "tests/workflow",
    "tools": "tests/tools",
    "server": "tests/server",
}
"""Floor -> folder of its tests."""
LEAST = 10
"""Modules that are listed by name."""


@dataclass(frozen=True)
class Figures:
    """Coverage of one floor."""

    commit: str
    date: str
    """ISO date."""
    statements: int
    missed: int
    failed: bool
    """True if a test failed under the tracer."""
    least: dict[str, float]
    """Least covered modules -> part of their statements that ran [%]."""

    @property
    def percent(self) -> float:
        """Part of the statements that ran [%]."""
        return 100.0 * (1.0 - self.missed / max(self.statements, 1))


def turn(today: date) -> str:
    """The floor that is measured on this day."""
    return list(FLOORS)[today.toordinal() % len(FLOORS)]


def figures_of(report: Mapping[str, Any], *, commit: str, today: date, failed: bool) -> Figures:
    """Figures from a JSON report of coverage.py."""
    parts = {name: file["summary"] for name, file in report["files"].items() if file["summary"]["num_statements"]}
    least = sorted(parts, key=lambda name: (parts[name]["percent_covered"], name))[:LEAST]
    return Figures(
        commit=commit,
        date=today.isoformat(),
        statements=report["totals"]["num_statements"],
        missed=report["totals"]["missing_lines"],
        failed=failed,
        least={name: round(parts[name]["percent_covered"], 1) for name in least},
    )


def measured(floor: str, *, jobs: int) -> Figures:
    """Run the fast tests of a floor under the tracer."""
    with tempfile.TemporaryDirectory() as folder:
        surroundings = {**os.environ, "COVERAGE_FILE": f"{folder}/data"}

        def cover(*words: str) -> int:
            return subprocess.run([sys.executable, "-m", "coverage", *words], cwd=ROOT, env=surroundings, check=False).returncode

        tests = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "not slow", FLOORS[floor]]
        code = cover("run", f"--source={floor}", *tests, *(["-n", str(jobs), "--dist", "loadfile"] if jobs > 1 else []))
        cover("combine", "-q")
        if cover("json", "-q", "-o", f"{folder}/report.json"):
            raise SystemExit(f"nothing of {floor} was measured")
        report = json.loads(Path(folder, "report.json").read_text())
    return figures_of(report, commit=commit(), today=datetime.now(UTC).date(), failed=code != 0)


def read_figures(path: Path = FIGURES) -> dict[str, Figures]:
    """Last recorded figures of every floor; empty where there is no file."""
    return {floor: Figures(**found) for floor, found in json.loads(path.read_text()).items()} if path.exists() else {}


def table(known: Mapping[str, Figures]) -> str:
    """One line per floor."""
    lines = []
    for floor in FLOORS:
        if floor in known:
            found = known[floor]
            noted = ", a test failed under the tracer" if found.failed else ""
            lines.append(
                f"{floor:13s}{found.percent:5.1f} % of {found.statements} statements ({found.date}, {found.commit}{noted})"
            )
        else:
            lines.append(f"{floor:13s}never recorded")
    return "\n".join(lines)


def main() -> int:
    """The command; 0 whatever is covered: no figure is demanded. With `--gate` 1 where a test failed under the tracer."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("floor", nargs="?", choices=FLOORS, default=turn(datetime.now(UTC).date()))
    parser.add_argument("--record", action="store_true", help="write the figures to tests/slow/coverage.json")
    parser.add_argument("--gate", action="store_true", help="fail where a test failed")
    parser.add_argument("--folder", action="store_true", help="only print the floor and the folder of its tests")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    if options.folder:
        print(options.floor, FLOORS[options.floor])
        return 0
    found = measured(options.floor, jobs=options.jobs)
    known = {**read_figures(), options.floor: found}
    print(f"\nstatements of each floor that its own fast tests run; now measured: {options.floor}\n{table(known)}")
    print(f"least covered of {options.floor}:", *(f"  {part:5.1f} %  {name}" for name, part in found.least.items()), sep="\n")
    if options.record:
        FIGURES.write_text(json.dumps({f: asdict(known[f]) for f in FLOORS if f in known}, indent=2) + "\n")
    return int(options.gate and found.failed)


if __name__ == "__main__":
    sys.exit(main())
