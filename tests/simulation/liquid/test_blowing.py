"""Force fields on running liquids: bodies of water that are drawn and blown, by both engines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.worlds.liquid_worlds import DENSITY, liquid_world, water
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.verifiers.categories import check as category
from worldagent.worlds.spec import FieldDriver, WorldSpec
from worldagent.worlds.spec.fields import AttractionField, WindField

SPACING, SIDE = 0.04, 0.24
AWAY = AttractionField(center=(1e4, 0, 0), acceleration=5.0, distance=1.0, exponent=0.0)


def cube(engine: str, driver: FieldDriver, *, frames: int = 5, gravity: float = 0.0) -> WorldSpec:
    spec = liquid_world(
        {"pool": water((SIDE,) * 3, (0, 0, 0), SPACING)}, spacing=SPACING, low=(-1,) * 3, high=(1,) * 3,
        sides=("open",) * 6, frames=frames, engine=engine, drivers={"field": driver},
    )  # fmt: skip
    return spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"gravity": (0, 0, -gravity)})})


@pytest.mark.parametrize("engine", ["dfsph", "flip"])
def test_an_attraction_accelerates_all_of_a_liquid_alike(tmp_path: Path, engine: str) -> None:
    candidate = simulate(tmp_path, cube(engine, FieldDriver(field=AWAY, end=3 / 24)))
    frame = candidate.caches["water"].read(4)
    speed = frame["particle/velocity"]
    assert np.allclose(speed.mean(axis=0), (5 * 3 / 24, 0, 0), atol=2e-3)
    assert np.ptp(speed[:, 0]) < 0.05
    mass = DENSITY * SIDE**3
    assert float(frame["record/field_impulse_x"]) == pytest.approx(mass * 5 * 3 / 24, rel=1e-3)
    assert float(frame["record/field_work"]) == pytest.approx(0.5 * mass * (5 * 3 / 24) ** 2, rel=5e-3)
    rows = {r.id: r for r in category.check(candidate)}
    for name in ("fields", "flight", "energy"):
        assert rows[f"category:liquid:{name}:water"].status in ("pass", "not_applicable"), rows[f"category:liquid:{name}:water"]
    assert rows["category:liquid:fields:water"].status == "pass"


@pytest.mark.parametrize("engine", ["dfsph", "flip"])
def test_what_a_wind_gives_is_what_the_liquid_gets(tmp_path: Path, engine: str) -> None:
    candidate = simulate(tmp_path, cube(engine, FieldDriver(field=WindField(velocity=(0, 20, 0)))))
    frame = candidate.caches["water"].read(4)
    mass = DENSITY * SIDE**3
    gained = mass * frame["particle/velocity"].mean(axis=0)
    given = np.array([float(frame[f"record/field_impulse_{a}"]) for a in "xyz"])
    assert np.allclose(gained, given, atol=0.05 * given[1])
    # A cube of six spacings has less of a surface than a plate, and more than none.
    plate = 0.5 * 1.204 * 20**2 * SIDE**2 * 4 / 24
    assert 0.4 * plate < given[1] < plate
    row = next(r for r in category.check(candidate) if r.id == "category:liquid:fields:water")
    assert row.status == "pass", row.evidence


def test_a_liquid_that_goes_on_from_a_checkpoint_is_blown_alike(tmp_path: Path) -> None:
    from worldagent.simulation.liquid.solver import SolverLiquid
    from worldagent.testing.worlds.small_worlds import build_all

    spec = cube("flip", FieldDriver(field=WindField(velocity=(0, 20, 0), gust=0.5), start=1 / 48))
    built = build_all(spec)
    solver = SolverLiquid(spec, built, "water")
    solver.prepare()
    solver.advance(1)
    state = solver.checkpoint()
    solver.advance(2)
    other = SolverLiquid(spec, built, "water")
    other.prepare(resumed=True)
    other.restore(state, 1)
    other.advance(2)
    one, two = solver.frame_data(), other.frame_data()
    assert all(np.array_equal(one[k], two[k]) for k in one)
    assert float(one["record/field_impulse_y"]) > 0
