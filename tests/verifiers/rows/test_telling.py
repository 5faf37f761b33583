"""Progress that checks tell from within."""

from __future__ import annotations

from pathlib import Path

import pytest
from worldagent.testing.worlds import small_worlds as sw
from worldagent.testing.worlds.liquid_worlds import pool_in_tank
from worldagent.tests.verifiers.shots.test_shots import rolling, shot
from worldagent.verifiers.checks import run_checks
from worldagent.verifiers.rows import telling
from worldagent.worlds.candidate import Candidate


def reports(candidate: Candidate, check: str) -> list[str]:
    """Messages of a run of one check."""
    told: list[str] = []
    run_checks(candidate, only=[check], reruns=False, progress=lambda done, total, message, ends=None: told.append(message))
    return told


@pytest.fixture
def often(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(telling, "EVERY_S", 0.0)


@pytest.mark.usefixtures("often")
def test_a_check_of_a_liquid_tells_each_frame_of_how_many(tmp_path: Path) -> None:
    candidate = pool_in_tank().candidate(tmp_path)
    told = reports(candidate, "category")
    assert told[0] == "checking category"
    last = candidate.frame_count
    assert [t for t in told if f"water: frame {last} of {last}" in t]


@pytest.mark.usefixtures("often")
def test_the_check_of_support_tells_pairs_and_rows(tmp_path: Path) -> None:
    floor, block = sw.box(2.0, 2.0, 0.1, at=(0, 0, -0.05)), sw.box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1))
    candidate = sw.make_candidate(tmp_path, sw.world({"floor": floor, "block": block}))
    told = reports(candidate, "support")
    assert "checking support, distances of parts: pair 1 of 1" in told
    assert any(t.startswith("checking support, support:derived:block") for t in told)


def test_nothing_is_told_more_often_than_twice_a_second_nor_where_nobody_listens(tmp_path: Path) -> None:
    told: list[str] = []
    with telling.telling(lambda done, total, message, ends=None: told.append(message), "checking"):
        for frame in range(1000):
            telling.tell("frame", frame)
    telling.tell("frame", 1)
    assert len(told) <= 1


@pytest.mark.usefixtures("often")
def test_the_check_of_shots_tells_the_beat_and_the_frame_that_is_looked_at(tmp_path: Path) -> None:
    """In a flooded hall it stood at *checking shots* for eight minutes."""
    told = reports(rolling(tmp_path, {"s": shot(covers=["roll"])}), "shots")
    assert any(t.startswith("checking shots, when ") and t.endswith("beat 1 of 1") for t in told)
    assert any(t.startswith("checking shots, view of ") and " frame 1 of " in t for t in told)
