"""A forest costs nothing where it does not matter: checks that need no plants never read them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from worldagent.bench import forest
from worldagent.verifiers.checks import run_checks
from worldagent.worlds.landscape import SavedLandscape


@pytest.fixture
def read(monkeypatch: pytest.MonkeyPatch) -> set[str]:
    names: set[str] = set()
    real = SavedLandscape._array

    def watched(self: SavedLandscape, name: str) -> np.ndarray:
        names.add(name)
        return real(self, name)

    monkeypatch.setattr(SavedLandscape, "_array", watched)
    return names


def _candidate(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr(forest, "SIDE", 900)
    return forest._world(tmp_path, 2000)()


def test_spatial_checks_read_no_plant(tmp_path: Any, read: set[str], monkeypatch: pytest.MonkeyPatch) -> None:
    candidate = _candidate(tmp_path, monkeypatch)
    rows = run_checks(candidate, only=forest.SPATIAL)
    assert {r.status for r in rows} <= {"pass", "not_applicable"}
    assert "height" in read
    assert not [n for n in read if n.startswith("plant_")]


def test_a_way_through_the_forest_reads_them(tmp_path: Any, read: set[str], monkeypatch: pytest.MonkeyPatch) -> None:
    (row,) = run_checks(_candidate(tmp_path, monkeypatch), only=["navigability"])
    assert row.status == "pass"
    assert "plant_position" in read
