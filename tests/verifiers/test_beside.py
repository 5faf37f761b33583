"""Checks that a second process judges: the same rows in the same order, and its death or sleep is an error."""

from __future__ import annotations

import os
import signal
from collections.abc import Mapping
from contextlib import nullcontext
from pathlib import Path

import pytest
from worldagent.construction import build_world
from worldagent.testing.worlds.small_worlds import ball, box, ground, world
from worldagent.verifiers import beside, checks
from worldagent.verifiers.checks import CHECKS, run_checks
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import EngineError, EvidenceError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.spec import BoxRegion, Connects, Entity

ASKED = ("scale", "interpenetration", "support", "navigability")


@pytest.fixture
def candidate(tmp_path: Path) -> Candidate:
    """A way past a pillar, a ball that hangs in the air, a box that is larger than it says, two boxes in each other."""
    entities: Mapping[str, Entity] = {
        "ground": ground(),
        "pillar": box(0.4, 0.4, 2.0, at=(0, 0, 1.0)),
        "hangs": ball(0.2, at=(2.0, 2.0, 1.0), motion="dynamic"),
        "large": box(0.4, 0.4, 0.4, at=(-2.0, 2.0, 0.2), size=(0.2, 0.4, 0.4)),
        "inside": box(0.3, 0.3, 0.3, at=(-2.1, 2.0, 0.3), motion="dynamic"),
    }
    regions = {
        "west": BoxRegion(kind="box", min=(-3, -0.5, 0), max=(-2, 0.5, 2)),
        "east": BoxRegion(kind="box", min=(2, -0.5, 0), max=(3, 0.5, 2)),
    }
    spec = world(entities, regions=regions, relations={"past": Connects(kind="connects", a="west", b="east", width=0.6)})
    folder = WorldFolder(tmp_path / "w")
    folder.root.mkdir()
    built, _ = build_world(folder, spec)
    return Candidate(folder.root, spec, built, "static")


def test_a_second_process_gives_the_rows_that_this_one_would(candidate: Candidate, monkeypatch: pytest.MonkeyPatch) -> None:
    alone = run_checks(candidate, only=ASKED)
    assert not beside.worth_while(candidate), "it is small"
    monkeypatch.setattr(beside, "LARGE", 1)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1}, raising=False)
    started = []
    ask = beside.Beside.ask
    monkeypatch.setattr(beside.Beside, "ask", lambda self, *given: started.append(given[1]) or ask(self, *given))
    again = Candidate(candidate.folder, candidate.spec, candidate.built, "static")
    assert [r.model_dump_json() for r in run_checks(again, only=ASKED)] == [r.model_dump_json() for r in alone]
    assert [[CHECKS[k].name for k in asked] for asked in started] == [["scale", "scale", "scale", "navigability"]]
    failing = {r.check for r in alone if r.status == "fail"}
    assert {"scale", "interpenetration", "support"} <= failing
    assert any(r.check == "navigability" and r.status == "pass" for r in alone)


def test_a_process_that_got_ready_ahead_gives_the_same_rows_and_ends_where_it_is_not_needed(
    candidate: Candidate, monkeypatch: pytest.MonkeyPatch
) -> None:
    alone = run_checks(candidate, only=ASKED)
    assert isinstance(checks.second_ahead(candidate.spec), nullcontext), "it is small"
    monkeypatch.setattr(beside, "MANY", 1)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1}, raising=False)
    with checks.second_ahead(candidate.spec) as second:
        assert second is not None
        assert [r.id for r in run_checks(candidate, only=ASKED, second=second)] == [r.id for r in alone]
        assert not second.checks, "few parts: this process judges all"
        assert second._process.poll() is None
        monkeypatch.setattr(beside, "LARGE", 1)
        again = Candidate(candidate.folder, candidate.spec, candidate.built, "static")
        rows = run_checks(again, only=ASKED, second=second)
        assert [r.model_dump_json() for r in rows] == [r.model_dump_json() for r in alone]
        assert [CHECKS[k].name for k in second.checks] == ["scale", "scale", "scale", "navigability"]
    assert second._process.poll() is not None


def test_a_process_alone_judges_where_there_is_one_core_or_no_folder(
    candidate: Candidate, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(beside, "LARGE", 1)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0}, raising=False)
    assert not beside.worth_while(candidate)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1}, raising=False)
    assert beside.worth_while(candidate)
    WorldFolder(candidate.folder).built("pillar", candidate.built["pillar"].recipe).unlink()
    assert not beside.worth_while(candidate)


def test_the_death_of_the_process_is_an_error(candidate: Candidate) -> None:
    with beside.Beside().ask(candidate, {1: CHECKS[1].function}) as second:
        os.kill(second._process.pid, signal.SIGKILL)
        with pytest.raises(EngineError, match="the process that judges 1 of the checks ended with code -9"):
            _ = second.rows


def test_a_process_that_hangs_is_ended_and_told(candidate: Candidate, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(beside, "LONGEST", 0.0)
    with beside.Beside().ask(candidate, {1: CHECKS[1].function}) as second:
        os.kill(second._process.pid, signal.SIGSTOP)
        with pytest.raises(EngineError, match="was ended after 0 s"):
            _ = second.rows
        assert second._process.poll() == -signal.SIGKILL


def test_what_a_check_raises_there_is_raised_here(candidate: Candidate) -> None:
    path = WorldFolder(candidate.folder).built("pillar", candidate.built["pillar"].recipe)
    path.write_bytes(b"no archive")
    with beside.Beside().ask(candidate, {1: CHECKS[1].function}) as second, pytest.raises(EvidenceError, match="pillar"):
        _ = second.rows


def test_it_ends_where_nobody_waits_for_it_any_more(candidate: Candidate) -> None:
    with beside.Beside().ask(candidate, {1: CHECKS[1].function}) as second:
        process = second._process
    assert process.poll() is not None
