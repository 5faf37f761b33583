"""Rows `impact_energy` and `rebounds`: contacts that give energy, impacts that give back another share; what only touches hard is not accused."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.defects import _impact_scenes as scenes
from worldagent.verifiers.categories.rigid import rebounds
from worldagent.verifiers.categories.rigid.bounces import restitution
from worldagent.verifiers.categories.rigid.bounds import BOUNCE, GAIN
from worldagent.verifiers.categories.rigid.check import category_rows
from worldagent.verifiers.ledgers.balance import Books
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.requirements import Row


def row_of(candidate: Candidate) -> Row:
    return next(r for r in category_rows(candidate, "rigid") if ":impact_energy:" in r.id)


@pytest.mark.parametrize("make", [scenes.cradle, scenes.bouncing, scenes.on_an_edge, scenes.landing])
@pytest.mark.parametrize("number", [0, 3])
def test_impacts_that_lose_energy_or_keep_it_pass(make, number: int, tmp_path: Path) -> None:
    row = row_of(make(number).candidate(tmp_path))
    assert (row.status, row.bound, row.mandatory) == ("pass", GAIN, True)
    # A stack that lands stays, and comes out of the skins that it entered at 2 m/s.
    assert row.measured < (0.5 if make is scenes.landing else 0.2) * GAIN


@pytest.mark.parametrize(("floor", "status"), [("rigid", "fail"), ("elastic", "not_applicable")])
def test_a_bounce_off_an_elastic_body_is_not_that_of_the_contact(floor: str, status: str, tmp_path: Path) -> None:
    """A cushion of rubber throws a ball back by its own elasticity; its material declares no restitution. A hard floor of such a one is accused."""
    candidate = scenes.bouncing(0).candidate(tmp_path)
    spec = candidate.spec
    wood = spec.materials["wood"].model_copy(update={"restitution": 0.0})
    soft = spec.entities["floor"].physics.model_copy(update={"category": floor})
    ground = spec.entities["floor"].model_copy(update={"physics": soft})
    changed = spec.model_copy(
        update={"materials": {**spec.materials, "wood": wood}, "entities": {**spec.entities, "floor": ground}}
    )
    edited = dataclasses.replace(candidate, spec=changed)
    found = restitution(Books(edited, edited.caches["rigid"]))
    assert found.status == status, found.text


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


def rebounds_of(candidate: Candidate) -> Row:
    return next(r for r in category_rows(candidate, "rigid") if ":rebounds:" in r.id)


@pytest.mark.parametrize("make", [scenes.cradle, scenes.rack, scenes.bouncing])
@pytest.mark.parametrize("number", [0, 1, 2, 5])
def test_every_impact_of_a_row_or_a_rack_is_judged(make, number: int, tmp_path: Path) -> None:
    row = rebounds_of(make(number).candidate(tmp_path))
    assert (row.status, row.bound, row.mandatory) == ("pass", BOUNCE, True)
    assert row.evidence["impacts"] >= (1 if make is scenes.bouncing else 4)
    assert row.measured < 0.3 * BOUNCE


def test_impacts_inside_a_row_that_give_back_less_are_found(tmp_path: Path) -> None:
    world = scenes.less_inside(tmp_path, 0.07, np.random.default_rng(0))
    row = rebounds_of(world.candidate)
    assert row.status == "fail"
    assert row.measured == pytest.approx(0.07, abs=0.01)
    assert row.evidence["worst"][0]["alone"]
    assert {c.group for c in row.corrections} >= {"material"}


def test_impacts_inside_a_row_that_give_back_a_little_less_pass(tmp_path: Path) -> None:
    assert rebounds_of(scenes.less_inside(tmp_path, 0.02, np.random.default_rng(0)).candidate).status == "pass"


@pytest.mark.parametrize("seed", range(3))
def test_an_impact_that_is_missing_from_the_log_is_found(seed: int, tmp_path: Path) -> None:
    assert rebounds_of(scenes.untold(tmp_path, 1.0, np.random.default_rng(seed)).candidate).status == "fail"


@pytest.mark.parametrize("number", range(scenes.VARIANTS))
def test_an_impact_of_two_between_the_same_balls_is_missed_too(number: int, tmp_path: Path) -> None:
    """Where two balls are let go, the first meets the second twice within a frame: the other impact explains the force, not all that was given."""
    film = scenes.cradle(number)
    assert rebounds_of(film.candidate(tmp_path / "whole")).status == "pass"
    scenes.leave_out_strongest(film)
    assert rebounds_of(film.candidate(tmp_path / "told")).status == "fail"


def test_friction_that_turns_round_within_the_frame_is_the_doubt_of_an_impact(tmp_path: Path) -> None:
    """The cue ball slides, hits, spins on its own and is hit again: friction first brakes it, then drives it, and the net of both says little."""
    row = rebounds_of(scenes.rack(6).candidate(tmp_path))
    assert (row.status, row.measured) == ("pass", 0.0)


@pytest.mark.parametrize("number", [0, 3, 5])
def test_a_ball_that_dominoes_wedge_onto_its_floor_has_no_impact_of_its_own_with_it(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A marble under the last domino of a line was accused of an untold impact with its desk (deviation 1) in five probes of an agent."""
    film = scenes.wedged(number)
    assert rebounds_of(film.candidate(tmp_path / "wedged")).status != "fail"
    monkeypatch.setattr(rebounds, "_squeezed", lambda books, k, found: np.zeros(len(found["contact/max_force"])))
    accused = rebounds_of(film.candidate(tmp_path / "accused"))
    assert accused.status == "fail", "the world would be accused without it"
    assert set(accused.evidence["worst"][0]["entities"]) == {"floor", "marble"}


def test_a_log_without_impacts_at_all_is_found(tmp_path: Path) -> None:
    film = scenes.bouncing(0)
    for frame in film.frames:
        for name in [n for n in frame if n.startswith("impact/")]:
            frame[name] = frame[name][:0]
    assert rebounds_of(film.candidate(tmp_path)).status == "fail"


def test_a_cache_without_the_channels_of_impacts_proves_nothing(tmp_path: Path) -> None:
    film = scenes.bouncing(0)
    for frame in film.frames:
        del frame["impact/normal"]
    assert rebounds_of(film.candidate(tmp_path)).status == "unverified"


def test_an_impact_along_another_line_than_the_centres_is_found(tmp_path: Path) -> None:
    film = scenes.cradle(0)
    for frame in film.frames:
        frame["impact/normal"] = np.roll(frame["impact/normal"], 1, axis=1)
    assert rebounds_of(film.candidate(tmp_path)).status == "fail"
