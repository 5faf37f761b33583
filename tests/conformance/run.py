"""Prove the protocol with other people's tools: `python tests/conformance/run.py [--ci] [--record]`.

Runs the official suite (both requirement sets, tasks included) against the server with the suite's fixtures, what needs
no fixtures against the real server, the Inspector in both eras over stdio and HTTP, and `tdqs lint`. Prints a table and
ends with 1 if anything failed. Where npm is missing it says what was skipped; with `--ci` that is a failure too.

`expected.json` holds how many checks each scenario passes, so that a scenario which finds no fixture and passes for want
of anything to check is noticed. `--record` writes it anew.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # PYTHONSAFEPATH leaves the script's own folder out

from node_tools import Missing, conformance, inspector, install

EXPECTED = Path(__file__).with_name("expected.json")
REVISIONS = ("2026-07-28", "2025-11-25")
NOT_CHECKED = {
    "tasks-status-notifications": "the suite checks nothing yet: it waits for a rewrite of this scenario",
    "server-sse-polling": "not scored and pending in the suite: streams that resume, which 2026-07-28 removed",
}
"""Scenarios without a verdict, and why."""
_SUMMARY = re.compile(r"^[✓✗] (?P<name>\S+): (?P<passed>\d+) passed, (?P<failed>\d+) failed", re.MULTILINE)
_LONGEST_S = 300


@dataclass(frozen=True)
class Outcome:
    """One line of the table."""

    what: str
    ok: bool
    detail: str
    seconds: float = 0.0


def main() -> int:
    """Run everything; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ci", action="store_true", default=bool(os.environ.get("CI")), help="what is skipped fails")
    parser.add_argument("--record", action="store_true", help="write expected.json from this run")
    options = parser.parse_args()
    outcomes: list[Outcome] = []
    with tempfile.TemporaryDirectory(prefix="worldagent-conformance-") as folder:
        try:
            install()
        except Missing as error:
            outcomes.append(Outcome("conformance suite and Inspector", not options.ci, f"skipped: {error}"))
        else:
            outcomes += _with_fixtures(Path(folder), record=options.record)
            outcomes += _real(Path(folder))
        outcomes.append(_lint(Path(folder)))
    _print(outcomes)
    return 0 if all(outcome.ok for outcome in outcomes) else 1


def _with_fixtures(folder: Path, *, record: bool) -> list[Outcome]:
    expected = json.loads(EXPECTED.read_text())["fixtures"] if EXPECTED.is_file() else {}
    found: dict[str, dict[str, int]] = {}
    outcomes: list[Outcome] = []
    with _served(folder / "fixtures", "--conformance") as url:
        for revision in REVISIONS:
            began = time.monotonic()
            code, output = _run(conformance("server", "--url", url, "--requirements", revision))
            seen = _scenarios(output)
            found[revision] = {name: passed for name, (passed, failed) in seen.items() if not failed and name not in NOT_CHECKED}
            wanted = found[revision] if record else expected.get(revision, {})
            outcomes += _compared(f"suite {revision}", seen, wanted, time.monotonic() - began)
            outcomes.append(Outcome(f"suite {revision} exit code", code == 0, str(code)))
    if record:
        kept = json.loads(EXPECTED.read_text()) if EXPECTED.is_file() else {"real": {}}
        EXPECTED.write_text(json.dumps({**kept, "fixtures": found}, indent=1) + "\n")
    return outcomes


def _real(folder: Path) -> list[Outcome]:
    expected = json.loads(EXPECTED.read_text())["real"]
    workspace = folder / "real"
    outcomes: list[Outcome] = []
    with _served(workspace) as url:
        for revision in REVISIONS:
            began = time.monotonic()
            _, output = _run(conformance("server", "--url", url, "--requirements", revision))
            seen = {name: counts for name, counts in _scenarios(output).items() if name in expected[revision]}
            outcomes += _compared(f"real server {revision}", seen, expected[revision], time.monotonic() - began)
        stdio = ["--", *_serve(workspace)]
        http = [url, "--transport", "http"]
        for era in ("legacy", "modern"):
            listing = ["--protocol-era", era, "--method", "tools/list", "--strict", "--format", "json"]
            outcomes.append(_inspected(f"Inspector tools/list --strict, stdio, {era}", [*listing, *stdio], '"edit_spec"'))
            outcomes.append(_inspected(f"Inspector tools/list --strict, http, {era}", [*http, *listing], '"edit_spec"'))
        modern = ["--protocol-era", "modern", "--method"]
        verify = [*modern, "skills/list", "--verify", "--require-digests"]
        outcomes.append(
            _inspected("Inspector skills/list --verify --require-digests, stdio", [*verify, *stdio], "no conformance errors")
        )
        outcomes.append(
            _inspected("Inspector skills/list --verify --require-digests, http", [*http, *verify], "no conformance errors")
        )
        outcomes.append(
            _inspected("Inspector tools/list --app-info", [*http, *modern, "tools/list", "--app-info"], '"hasApp":true')
        )
    return outcomes


def _compared(what: str, seen: dict[str, tuple[int, int]], wanted: dict[str, int], seconds: float) -> Iterator[Outcome]:
    """One outcome for what is as expected, one for each scenario that is not."""
    good = 0
    for name in sorted({*seen, *wanted}):
        passed, failed = seen.get(name, (0, 0))
        if name in NOT_CHECKED:
            yield Outcome(f"{what}: {name}", True, f"no verdict: {NOT_CHECKED[name]}")
        elif failed or passed < wanted.get(name, 1):
            yield Outcome(f"{what}: {name}", False, f"{passed} checks passed, {wanted.get(name, 1)} expected, {failed} failed")
        else:
            good += 1
    checks = sum(passed for passed, _ in seen.values())
    yield Outcome(what, good > 0, f"{good} scenarios as expected, {checks} checks passed", seconds)


def _inspected(what: str, arguments: Sequence[str], needs: str) -> Outcome:
    """Runs the Inspector; besides exit code 0, its output must hold `needs`."""
    began = time.monotonic()
    code, output = _run(inspector(*arguments))
    last = output.strip().splitlines()[-1] if output.strip() else ""
    detail = last[:160] if code else "exit 0" if needs in output else f"exit 0, but nothing says {needs}"
    return Outcome(what, code == 0 and needs in output, detail, time.monotonic() - began)


def _lint(folder: Path) -> Outcome:
    began = time.monotonic()
    command = shlex.join(_serve(folder / "lint"))
    code, output = _run([sys.executable, "-P", "-m", "tdqs", "lint", "--command", command, "--fail-on", "warning"])
    last = output.strip().splitlines()[-1] if output.strip() else ""
    return Outcome("tdqs lint", code == 0, last[:160], time.monotonic() - began)


def _serve(workspace: Path, *options: str) -> list[str]:
    return [sys.executable, "-P", "-m", "worldagent.server", "serve", "--workspace", str(workspace), *options]


@contextmanager
def _served(workspace: Path, *options: str) -> Iterator[str]:
    """URL of a server on a free port."""
    command = _serve(workspace, "--transport", "http", "--port", "0", *options)
    log = workspace.with_suffix(".log")
    with log.open("w+") as stream, subprocess.Popen(command, stderr=stream) as child:
        try:
            deadline = time.monotonic() + 60
            while not (found := re.search(r"http://\S+", log.read_text())):
                if child.poll() is not None or time.monotonic() > deadline:
                    raise RuntimeError(f"the server did not start: {log.read_text()}")
                time.sleep(0.1)
            yield found.group()
        finally:
            child.terminate()


def _run(command: Sequence[str]) -> tuple[int, str]:
    done = subprocess.run(command, capture_output=True, text=True, timeout=_LONGEST_S, check=False)
    return done.returncode, done.stdout + done.stderr


def _scenarios(output: str) -> dict[str, tuple[int, int]]:
    """Checks passed and failed by scenario."""
    return {found["name"]: (int(found["passed"]), int(found["failed"])) for found in _SUMMARY.finditer(output)}


def _print(outcomes: Sequence[Outcome]) -> None:
    width = max(len(outcome.what) for outcome in outcomes)
    for outcome in outcomes:
        seconds = f"{outcome.seconds:6.1f} s" if outcome.seconds else "        "
        print(f"{'ok  ' if outcome.ok else 'FAIL'}  {outcome.what:<{width}}  {seconds}  {outcome.detail}")
    print(f"{sum(not outcome.ok for outcome in outcomes)} failed")


if __name__ == "__main__":
    sys.exit(main())
