"""Fire through a specification: its heat is that of its fuel, and without a spark, a way or fuel nothing burns."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter
from worldagent.physics.combustion import FUELS
from worldagent.simulation.protocol import Intervention
from worldagent.simulation.variants import run_variant
from worldagent.testing.defects._gas_scenes import FRAMES, SOLVER, scene
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.testing.worlds.small_gas import FIRE_PROMPT, fire_spec
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.categories.gas.check import category_rows
from worldagent.verifiers.categories.gas.fires import Fires
from worldagent.verifiers.categories.gas.frames import box_of
from worldagent.verifiers.categories.gas.kindling import Kindling
from worldagent.verifiers.categories.gas.pushing import Pushing
from worldagent.verifiers.categories.gas.rows import hold_the_flame
from worldagent.verifiers.categories.gas.steaming import Steaming
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Predicate
from worldagent.worlds.spec import WorldSpec

SPAN = (0, FRAMES - 1)


def asked(candidate: Candidate, span: tuple[int, int] = SPAN, **fields: Any) -> Outcome:
    predicate: Any = TypeAdapter(Predicate).validate_python({"entity": "smoke", **fields})
    return evaluate(candidate, predicate, span)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """A fire of wood gas for a second, and half a second after its fuel has ended."""
    spec = WorldSpec.model_validate({"prompt": FIRE_PROMPT, **fire_spec(frames=37)})
    return simulate(tmp_path_factory.mktemp("fire"), spec)


def test_a_fire_gives_the_heat_of_its_fuel_and_every_row_of_it_passes(whole: Candidate) -> None:
    rows = {r.id.split(":")[2]: r for r in category_rows(whole, SOLVER)}
    assert {n for n, r in rows.items() if r.status != "pass" and r.mandatory} == {
        *Kindling.questions,  # no solid may burn
        *Steaming.questions,
        *Pushing.questions,
    }
    burnt = rows["burnt"].evidence
    assert burnt["released_J"] == pytest.approx(burnt["burnt_kg"] * FUELS["wood"].heat, rel=0.01)
    assert burnt["share_burnt"] > 0.8
    assert {rows[n].status for n in Fires.questions} == {"pass"}


def test_it_burns_and_goes_out_and_its_power_is_that_of_its_burner(whole: Candidate) -> None:
    span = (0, 36)
    assert asked(whole, span, kind="burns").status == "pass"
    out = asked(whole, span, kind="goes_out")
    assert (out.status, 24 < (out.first_true_frame or 0) <= 33) == ("pass", True)
    assert asked(whole, (0, 20), kind="goes_out").status == "fail"
    power = asked(whole, (12, 24), kind="heat_release", min=1.2e4, max=3.0e4, when="always")
    assert power.status == "pass", power.explanation
    assert asked(whole, (34, 36), kind="heat_release", max=200.0, when="always").status == "pass"


def test_a_beat_that_asks_for_flames_that_are_not_there_tells_when_and_where_they_were(whole: Candidate) -> None:
    late = asked(whole, (34, 36), kind="heat_release", min=1e3)
    flames = late.details["flames"]
    power = [asked(whole, (k, k), kind="heat_release", min=0.0).value or 0.0 for k in range(37)]
    assert (flames["brightest"], flames["most"]) == (int(np.argmax(power)), pytest.approx(max(power)))
    assert power[flames["last"]] > 0.01 * max(power) >= power[flames["last"] + 1]
    assert 24 < flames["last"] < 34
    source = whole.spec.entities["smoke"].pose.position
    assert np.linalg.norm(np.subtract(flames["at"], source)[:2]) < 0.05
    assert f"its flames burn from frame {flames['first']} to {flames['last']}, " in late.explanation
    assert flames["spark"] is None
    assert hold_the_flame("smoke", late.details) == []
    assert "flames" not in asked(scene("room"), kind="heat_release", min=1.0).details


def test_flames_that_end_with_their_spark_are_told_so_with_what_to_do(whole: Candidate) -> None:
    ends = asked(whole, (34, 36), kind="heat_release", min=1e3).details["flames"]["last"] / whole.spec.simulation.fps
    for early, named in ((0.1, "spark"), (0.5, None)):  # how long before the flames the spark ends
        drivers = dict(whole.spec.simulation.drivers)
        drivers["spark"] = drivers["spark"].model_copy(update={"end": ends - early})
        plan = whole.spec.simulation.model_copy(update={"drivers": drivers})
        candidate = dataclasses.replace(whole, spec=whole.spec.model_copy(update={"simulation": plan}))
        found = asked(candidate, (34, 36), kind="heat_release", min=1e3)
        assert found.details["flames"]["spark"] == named
        assert ("they ended with ignition spark" in found.explanation) == (named is not None)
        told = hold_the_flame("smoke", found.details)
        assert [c.patch for c in told] == ([({"op": "remove", "path": "/simulation/drivers/spark/end"},)] if named else [])


def test_a_gas_without_fuel_neither_burns_nor_goes_out() -> None:
    for kind in ("burns", "goes_out"):
        found = asked(scene("room"), kind=kind)
        assert (found.status, "has no fuel" in found.explanation) == ("fail", True)
    assert asked(scene("room"), kind="heat_release", min=1.0).status == "fail"
    fires = {r.id.split(":")[2]: r.status for r in category_rows(scene("room"), SOLVER)}
    assert {fires[n] for n in Fires.questions} == {"not_applicable"}


def test_a_flash_is_no_fire_and_a_flicker_goes_not_out(tmp_path: Path) -> None:
    """Flames at one frame alone; flames that pause."""

    def flash(k: int, data: dict[str, Any]) -> None:
        data["gas_released"] *= k == 5

    def pause(k: int, data: dict[str, Any]) -> None:
        data["gas_released"] *= k != 7

    assert asked(edited(scene("fire"), tmp_path / "a", SOLVER, flash), kind="burns").status == "fail"
    flickers = edited(scene("fire"), tmp_path / "b", SOLVER, pause)
    assert asked(flickers, kind="burns").status == "pass"
    assert asked(flickers, kind="goes_out").status == "fail"


@pytest.mark.parametrize("kind", ["fire", "burner"])
def test_without_its_spark_nothing_burns(kind: str) -> None:
    base = scene(kind)
    variant = run_variant(base, Intervention(without=frozenset({"spark"})), start=0, end=6)
    assert not variant.caches[SOLVER].read(6, ("gas_released",))["gas_released"].any()
    assert base.caches[SOLVER].read(6, ("gas_released",))["gas_released"].any()


def test_fire_does_not_cross_a_gap_without_fuel(tmp_path: Path) -> None:
    """A spark half a metre beside the fuel, which the air between them keeps from it, lights nothing."""
    document = fire_spec(frames=7)
    document["simulation"]["drivers"]["spark"] |= {"center": [0.35, 0.35, 0.05], "radius": 0.04}
    world = simulate(tmp_path, WorldSpec.model_validate({"prompt": FIRE_PROMPT, **document}))
    box = box_of(world, SOLVER)
    assert box.record("emitted_fuel")[-1] > 0.0
    assert not box.record("released_heat").any()


def test_a_run_that_goes_on_from_a_checkpoint_burns_alike() -> None:
    """To the byte, with the spark gone out between."""
    base = scene("puffed")
    variant = run_variant(base, Intervention(), start=0, end=6)
    for name in ("gas_released", "gas_fuel", "gas_temperature"):
        assert np.array_equal(variant.caches[SOLVER].read(6, (name,))[name], base.caches[SOLVER].read(6, (name,))[name])
