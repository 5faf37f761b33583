"""Every slow test belongs to a slice, slices take turns, and a failure is not recorded as a pass."""

from __future__ import annotations

import ast
import subprocess
from datetime import date
from pathlib import Path

import pytest
from worldagent.tests.collected import SLOW
from worldagent.tests.slow.record import BY_NAME, Run, assigned, due, read_passes, read_slices, recorded, table
from worldagent.tests.slow.run import ROOT, run_tests, slow_tests

TODAY = date(2026, 11, 23)
EXAMPLES = tuple((ROOT / "examples").glob("*.py"))


def _run(day: str = "2026-11-20", **changed: int) -> Run:
    counts = {"seconds": 60, "passed": 3, "failed": 0, "skipped": 0, "xfailed": 0, **changed}
    return Run(commit="abc", date=day, machine="2 cores, Linux", **counts)


def test_every_slow_test_has_its_slice_and_every_prefix_its_test(pytestconfig: pytest.Config) -> None:
    tests, left_out = pytestconfig.stash[SLOW] if SLOW in pytestconfig.stash else (slow_tests(), [])
    slices = {name: [p for p in listed if not p.startswith(tuple(left_out))] for name, listed in read_slices().items()}
    found, homeless, unused = assigned(tests, slices)
    assert len(tests) > 250
    assert (homeless, unused) == ([], [])
    assert all(found[name] for name, listed in slices.items() if listed)


def test_the_longest_prefix_decides() -> None:
    slices = {"all": ["tests/a"], "one": ["tests/a/test_x.py::test_one"]}
    found, homeless, unused = assigned(["tests/a/test_x.py::test_one[3]", "tests/a/test_x.py::test_two", "tests/b.py::t"], slices)
    assert found == {"all": ["tests/a/test_x.py::test_two"], "one": ["tests/a/test_x.py::test_one[3]"]}
    assert (homeless, unused) == (["tests/b.py::t"], [])


def test_what_never_passed_comes_before_what_passed_longest_ago() -> None:
    passes = {"a": {"passed": _run("2026-11-01")}, "b": {"passed": _run("2026-10-01")}}
    assert due(["a", "b"], passes, today=TODAY) == "b"
    assert due(["a", "b", "c"], passes, today=TODAY) == "c"


def test_a_slice_that_is_too_long_for_ci_has_no_turn() -> None:
    passes = {"a": {"passed": _run("2026-11-01")}}
    assert due(["long-a", "a"], passes, today=TODAY) == "a"
    assert any(n.startswith(BY_NAME) for n in read_slices())


def test_equally_old_slices_take_turns_by_the_day() -> None:
    passes = {n: {"passed": _run()} for n in "abc"}
    assert {due("abc", passes, today=date(2026, 11, day)) for day in (21, 22, 23)} == {"a", "b", "c"}


def test_a_failure_keeps_the_last_pass_and_its_age_and_a_pass_clears_it() -> None:
    failed = recorded({"a": {"passed": _run()}}, "a", _run("2026-11-22", failed=1))
    assert failed["a"]["passed"].date == "2026-11-20"
    assert "failed since (2026-11-22" in table(["a", "b"], failed, today=TODAY)
    assert "never passed" in table(["a", "b"], failed, today=TODAY)
    assert recorded(failed, "a", _run("2026-11-23")) == {"a": {"passed": _run("2026-11-23")}}


def test_a_run_without_a_passed_test_is_no_pass() -> None:
    assert not _run(passed=0).whole
    assert not _run(failed=1).whole
    assert _run().whole


def test_a_slice_that_fails_is_counted_as_failed() -> None:
    """The id names no test, so pytest itself refuses."""
    assert not run_tests(["tests/slow/test_slices.py::test_that_is_not_there"], jobs=1, limit=120).whole


def test_the_record_names_only_slices_that_there_are() -> None:
    assert set(read_passes()) <= set(read_slices())


def test_every_commit_of_the_record_is_in_the_history() -> None:
    """A commit that was rewritten tells nobody what passed."""
    if _git("rev-parse", "--is-shallow-repository") != "false":
        pytest.skip("no git repository here, or one without its whole history")
    commits = {run.commit for kinds in read_passes().values() for run in kinds.values()}
    assert len(commits) > 10
    history = _git("rev-list", "HEAD").splitlines()
    assert sorted(c for c in commits if not any(known.startswith(c) for known in history)) == []


def _git(*arguments: str) -> str:
    """Output of a git command in the repository's root; empty where it fails."""
    if not (ROOT / ".git").exists():
        return ""
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()


def test_every_showcase_is_taken_to_acceptance_by_a_test() -> None:
    """A test imports `run` or `main` of each module of `examples/` that has one, and calls it."""
    shows = {p.stem for p in EXAMPLES if p.stem != "client_run" and entry_of(p)}
    taken = {
        node.module.rpartition(".")[2]
        for path in (ROOT / "tests" / "examples").glob("test_*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.ImportFrom) and node.module and {a.name for a in node.names} & {"run", "main"}
    }
    assert len(shows) >= 8
    assert shows - taken == set()


def entry_of(path: Path) -> bool:
    """True if a module of `examples/` is a command: it has a function `run` or `main`."""
    functions = {node.name for node in ast.parse(path.read_text()).body if isinstance(node, ast.FunctionDef)}
    return bool(functions & {"run", "main"})
