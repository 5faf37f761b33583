"""Runs one slice of the slow tests and records the run in `passes.json`.

python -m worldagent.tests.slow.run [NAME] [--ages] [--gate] [--jobs N]; without a name: the slice whose pass is oldest.
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys
import tempfile
import time
from datetime import UTC, datetime
from pathlib import Path
from xml.etree import ElementTree

from .record import BY_NAME, PASSES, Run, assigned, due, read_passes, read_slices, recorded, table, written

ROOT = Path(__file__).resolve().parents[2]
LIMIT_SECONDS = 1500
"""A slice is cut to 15 minutes on two quiet cores; a busy machine gets 25."""
LONG_SECONDS = 4 * 3600
"""Slices that run by name alone take 30 to 90 minutes on quiet cores."""


def slow_tests() -> list[str]:
    """Ids of all tests that are marked slow, in the order in which pytest collects them."""
    command = [sys.executable, "-m", "pytest", "-q", "--collect-only", "-m", "slow", "-p", "no:cacheprovider", "tests"]
    told = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if told.returncode not in (0, 5):
        raise SystemExit(f"the tests cannot be collected:\n{told.stdout[-2000:]}{told.stderr[-2000:]}")
    return [line for line in told.stdout.splitlines() if line.startswith("tests/") and "::" in line]


def commit() -> str:
    """The commit that is checked out, marked where tracked files differ from it (the record itself aside)."""

    def git(*words: str) -> str:
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()

    changed = git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!tests/slow/passes.json")
    return (git("rev-parse", "--short=12", "HEAD") or "unknown") + ("-changed" if changed else "")


def run_tests(tests: list[str], *, jobs: int, limit: float = LIMIT_SECONDS) -> Run:
    """Run these tests, in `jobs` processes; what takes longer than the limit [s] counts as one failure."""
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        listed, report = Path(folder, "tests.txt"), Path(folder, "report.xml")
        listed.write_text("\n".join(tests) + "\n")
        command = [sys.executable, "-m", "pytest", "-q", "-m", "slow", f"--junitxml={report}", f"@{listed}"]
        alone = len({test.partition("::")[0] for test in tests}) == 1
        command += ["-n", str(jobs), "--dist", "load" if alone else "loadfile"] if jobs > 1 else []
        late = False
        try:
            code = subprocess.run(command, cwd=ROOT, timeout=limit, check=False).returncode
        except subprocess.TimeoutExpired:
            late, code = True, 1
            print(f"stopped after {limit:g} s", file=sys.stderr)
        cases = list(ElementTree.parse(report).getroot().iter("testcase")) if report.exists() else []
    bad = sum(c.find("failure") is not None or c.find("error") is not None for c in cases)
    left_out = [c.find("skipped") for c in cases]
    missed = sum(s is not None and s.get("type") == "pytest.xfail" for s in left_out)
    skipped = sum(s is not None for s in left_out) - missed
    return Run(
        commit=commit(),
        date=datetime.now(UTC).date().isoformat(),
        seconds=round(time.monotonic() - start),
        passed=len(cases) - bad - skipped - missed,
        failed=bad + late if bad or late else int(code != 0),
        skipped=skipped,
        xfailed=missed,
        machine=f"{len(os.sched_getaffinity(0))} cores, {platform.system()}",
    )


def main() -> int:
    """The command; 0 where the slice passed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("name", nargs="?")
    parser.add_argument("--ages", action="store_true", help="only print when each slice last passed")
    parser.add_argument("--gate", action="store_true", help="record nothing; leave out slices that never passed or fail now")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    slices, passes = read_slices(), read_passes()
    today = datetime.now(UTC).date()
    print(table(slices, passes, today=today), flush=True)
    if options.ages:
        return 0
    sound = [n for n in slices if "passed" in passes.get(n, {}) and "failed" not in passes[n]]
    if options.gate and not sound:
        parser.error("no slice has a recorded pass; run `make slow` and commit tests/slow/passes.json")
    name = options.name or due(sound if options.gate else slices, passes, today=today)
    if name not in slices:
        parser.error(f"no slice {name!r}; there are {', '.join(sorted(slices))}")
    tests, homeless, _ = assigned(slow_tests(), slices)
    if homeless:
        parser.error(f"no slice of tests/slow/slices.json takes {homeless[:5]}")
    print(f"slice {name}: {len(tests[name])} tests", flush=True)
    limit = LONG_SECONDS if name.startswith(BY_NAME) else LIMIT_SECONDS
    run = run_tests(tests[name], jobs=options.jobs, limit=limit)
    print(f"slice {name}: {'passed' if run.whole else 'FAILED'} in {run.seconds} s", flush=True)
    if not options.gate:
        PASSES.write_text(written(recorded(passes, name, run)))
    return 0 if run.whole else 1


if __name__ == "__main__":
    sys.exit(main())
