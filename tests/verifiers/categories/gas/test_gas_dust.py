"""Dust that impacts raise: how much, where, when, and by whom, held against the contacts of the rigid instance."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from worldagent.simulation.gas.puffs import Puff, spread
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.testing.worlds.small_gas import DUST_PROMPT, dust_spec
from worldagent.verifiers.categories.gas.check import category_rows, numerical_rows
from worldagent.verifiers.categories.gas.frames import box_of
from worldagent.verifiers.categories.registry import JUDGES
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.categories.gas.audit import gas_problems
from worldagent.worlds.categories.gas.facts import Grid
from worldagent.worlds.spec import WorldSpec

FALL = 0.15
FRAMES = 12
MASS = 7850.0 * 4.0 / 3.0 * np.pi * 0.1**3


def _spec(**changes: Any) -> WorldSpec:
    return WorldSpec.model_validate({"prompt": DUST_PROMPT, **dust_spec(frames=FRAMES, fall=FALL, **changes)})


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    return simulate(tmp_path_factory.mktemp("dust"), _spec())


def test_the_mass_of_the_dust_is_that_of_the_energy_of_the_fall(world: Candidate) -> None:
    energy = MASS * 9.81 * FALL
    assert float(box_of(world, "air").record("emitted_soot")[-1]) == pytest.approx(1e-5 * energy, rel=0.03)


def test_no_dust_comes_before_the_ball_lands(world: Candidate) -> None:
    mass, landing = box_of(world, "air").record("soot_mass"), 24.0 * np.sqrt(2.0 * FALL / 9.81)
    before = np.arange(FRAMES) < landing
    assert (mass[before] == 0.0).all()
    assert mass[int(np.ceil(landing)) + 1] > 0.0


def test_it_comes_where_the_ball_lands(world: Candidate) -> None:
    box = box_of(world, "air")
    frame = next(f for f, _ in box.steps() if f.soot.any())
    middle = np.average(frame.centers[frame.soot > 0], axis=0, weights=frame.soot[frame.soot > 0])
    assert np.linalg.norm(middle[:2]) < 0.05
    assert middle[2] < 0.12


def test_all_rows_hold(world: Candidate) -> None:
    rows = category_rows(world, "air") + numerical_rows(world, "air")
    assert [r.id for r in rows if r.status not in ("pass", "not_applicable")] == []


def test_the_ball_is_told_to_raise_it_and_does_not_feel_it(world: Candidate) -> None:
    judge = JUDGES["gas"]
    pushes = [p for frame in judge.pushes(world) for p in frame]
    assert {(p.a, p.b) for p in pushes} == {("ball", "dust")}
    assert judge.unfelt(world.spec) == {("dust", "ball")}


def test_the_register_says_that_the_figure_is_declared(world: Candidate) -> None:
    told = [line["what"] for line in JUDGES["gas"].lines(world)]
    assert "'kick' raises 1e-05 kg of dust per joule of an impact, whatever is hit" in told
    assert not any("shape of its source" in text for text in told)


@pytest.mark.parametrize(
    ("change", "pointer", "words"),
    [
        ({"temperature": 400.0}, "/entities/dust/physics/temperature", "comes with the air of the place"),
        ({"soot_density": 0.0}, "/entities/dust/physics/soot_density", "carries nothing"),
        ({"fuel": "wood"}, "/entities/dust/physics/fuel", "does not burn"),
    ],
)
def test_the_audit_refuses_dust_of_another_gas(change: dict[str, Any], pointer: str, words: str) -> None:
    spec = dust_spec()
    spec["entities"]["dust"]["physics"] |= change
    found = {p.pointer: p.text for p in gas_problems(WorldSpec.model_validate({"prompt": DUST_PROMPT, **spec}))}
    assert words in found[pointer]


def test_the_audit_names_a_body_that_cannot_raise_it() -> None:
    spec = dust_spec()
    spec["simulation"]["drivers"]["kick"]["bodies"] = ["floor"]
    found = {p.pointer: p.text for p in gas_problems(WorldSpec.model_validate({"prompt": DUST_PROMPT, **spec}))}
    assert "static rigid" in found["/simulation/drivers/kick/bodies/0"]


def test_more_dust_than_the_box_has_room_for_fills_all_of_it() -> None:
    room = np.random.default_rng(1).uniform(0.1, 1.0, (3, 3, 3)).astype(np.float32)
    at, share = spread(Grid((3, 3, 3), 0.1, np.zeros(3)), Puff(0.0, np.full(3, 0.01), 0.02, 1e3), room)
    assert float((share * room[at]).sum()) * 0.1**3 == pytest.approx(1.0)
    assert share.shape == room.shape
