"""Row `impact_energy`: contacts that give energy are found in steps and in frames, and what only touches hard is not accused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.defects import _impact_scenes as scenes
from worldagent.verifiers.categories.rigid.bounds import GAIN
from worldagent.verifiers.categories.rigid.check import category_rows
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.requirements import Row


def row_of(candidate: Candidate) -> Row:
    return next(r for r in category_rows(candidate, "rigid") if ":impact_energy:" in r.id)


@pytest.mark.parametrize("make", [scenes.cradle, scenes.bouncing, scenes.on_an_edge, scenes.landing])
@pytest.mark.parametrize("number", [0, 3])
def test_impacts_that_lose_energy_or_keep_it_pass(make, number: int, tmp_path: Path) -> None:
    row = row_of(make(number).candidate(tmp_path))
    assert (row.status, row.bound, row.mandatory) == ("pass", GAIN, True)
    assert row.measured < 0.2 * GAIN


def test_a_cradle_that_gains_energy_is_found_where_it_does(tmp_path: Path) -> None:
    """Two of five balls are let go; the law that pushes open contacts gave three times the energy in a few steps of frame 2."""
    world = scenes.old_law(tmp_path, 1.0, np.random.default_rng(1))
    row = row_of(world.candidate)
    assert row.status == "fail"
    assert row.first_failing_frame == 2
    assert str(row.first_failing_entity).startswith("ball")
    assert row.measured > 0.1
    assert all({a[:4], b[:4]} == {"ball"} for a, b in row.evidence["touching"])
    assert {c.group for c in row.corrections} >= {"placement", "step"}


def test_a_forged_record_does_not_hide_it(tmp_path: Path) -> None:
    world = scenes.forged_cradle(tmp_path, 1.0, np.random.default_rng(0))
    assert row_of(world.candidate).status == "fail"


def test_a_gain_that_the_next_step_takes_again_is_found_in_the_record_alone(tmp_path: Path) -> None:
    found = row_of(scenes.forged_gain(tmp_path / "over", 1.05 * GAIN, np.random.default_rng(2)).candidate)
    assert found.status == "fail"
    assert found.evidence["recorded_gain_J"] > 0
    assert row_of(scenes.forged_gain(tmp_path / "under", 0.5 * GAIN, np.random.default_rng(2)).candidate).status == "pass"


def test_a_run_without_the_record_proves_nothing(tmp_path: Path) -> None:
    film = scenes.cradle(0)
    for frame in film.frames:
        del frame["record/contact_gain"]
    assert row_of(film.candidate(tmp_path)).status == "unverified"


def test_a_record_that_is_no_number_is_no_proof(tmp_path: Path) -> None:
    film = scenes.cradle(0)
    film.set_record("contact_gain", np.nan)
    assert row_of(film.candidate(tmp_path)).status == "fail"


def test_what_a_path_pushes_gains_energy_by_right(tmp_path: Path) -> None:
    from worldagent.testing.defects import _scenes

    assert row_of(_scenes.pushed(0).candidate(tmp_path)).status == "pass"
