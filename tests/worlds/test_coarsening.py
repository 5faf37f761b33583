"""Settings that a probe may leave coarser: which, how far, and that a record cannot ask for others."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import ValidationError
from worldagent.testing.worlds.small_grains import SAND_PROMPT, sand_spec
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.worlds.categories.rigid.models import RigidSettings
from worldagent.worlds.coarsening import (
    COARSEST,
    LONGEST_STEP,
    coarsened,
    overrides_for,
    read_overrides,
    sketched,
    write_overrides,
)
from worldagent.worlds.errors import EvidenceError, InputError
from worldagent.worlds.spec import WorldSpec

POINTER = "/entities/water/physics/resolution"


def world(engine: str = "dfsph") -> WorldSpec:
    return WorldSpec.model_validate({**tank_spec(spacing=0.03, engine=engine), "prompt": PROMPT})


@pytest.mark.parametrize("engine", ["dfsph", "flip"])
def test_liquids_get_coarser_and_nothing_else_changes(engine: str) -> None:
    spec = world(engine)
    overrides = overrides_for(spec, 1.5)
    assert overrides == {POINTER: pytest.approx(0.045)}
    other = coarsened(spec, overrides)
    assert other.entities["water"].physics.resolution == pytest.approx(0.045)  # type: ignore[union-attr]
    assert other.model_copy(update={"entities": {**other.entities, "water": spec.entities["water"]}}) == spec
    assert overrides_for(spec, 1.0) == {}
    assert coarsened(spec, {}) is spec


def test_grains_get_larger_and_nothing_else_changes() -> None:
    spec = WorldSpec.model_validate({**sand_spec(), "prompt": SAND_PROMPT})
    overrides = overrides_for(spec, 2.0)
    assert overrides == {"/entities/sand/physics/radius": pytest.approx(0.016)}
    other = coarsened(spec, overrides)
    assert other.entities["sand"].physics.radius == pytest.approx(0.016)  # type: ignore[union-attr]
    assert other.model_copy(update={"entities": {**other.entities, "sand": spec.entities["sand"]}}) == spec


@pytest.mark.parametrize("factor", [0.5, 2.5, float("nan")])
def test_factors_out_of_range_are_refused(factor: float) -> None:
    with pytest.raises(InputError, match=f"allowed: 1 .* to {COARSEST:g}"):
        overrides_for(world(), factor)


def test_a_world_of_rigid_bodies_has_nothing_to_leave_coarser() -> None:
    spec = world()
    plan = spec.simulation.model_copy(update={"solvers": {k: s for k, s in spec.simulation.solvers.items() if k == "rigid"}})
    with pytest.raises(InputError, match="rigid contact depends on its step"):
        overrides_for(spec.model_copy(update={"simulation": plan}), 1.5)


@pytest.mark.parametrize(
    ("pointer", "value"),
    [("/simulation/fps", 12.0), (POINTER, 0.02), (POINTER, 0.07), ("/entities/ghost/physics/resolution", 0.04)],
)
def test_a_forged_record_overrides_nothing_else(pointer: str, value: float, tmp_path: Path) -> None:
    write_overrides(tmp_path, {pointer: value})
    with pytest.raises(EvidenceError, match=pointer):
        coarsened(world(), read_overrides(tmp_path))


def test_a_damaged_record_is_named(tmp_path: Path) -> None:
    assert read_overrides(tmp_path) == {}
    (tmp_path / "overrides.json").write_text("[1]")
    with pytest.raises(EvidenceError, match=r"overrides\.json"):
        read_overrides(tmp_path)


def test_a_sketch_also_lengthens_the_step_of_bodies_to_what_a_specification_allows() -> None:
    spec = world()
    step = spec.simulation.rigid["rigid"].settings.step
    other, told = sketched(spec, 3.0, 2.0)
    assert told == {POINTER: pytest.approx(0.09), "/simulation/solvers/rigid/settings/step": pytest.approx(2 * step)}
    assert other.simulation.rigid["rigid"].settings.step == pytest.approx(2 * step)
    assert other.entities["water"].physics.resolution == pytest.approx(0.09)  # type: ignore[union-attr]
    assert sketched(spec, 1.0, 1.0) == (spec, {})
    longest = spec.model_copy(deep=True)
    longest.simulation.rigid["rigid"].settings.__dict__["step"] = 0.004
    assert sketched(longest, 1.0, 4.0)[1] == {"/simulation/solvers/rigid/settings/step": LONGEST_STEP}
    with pytest.raises(ValidationError, match=r"less than or equal to 0\.005"):
        RigidSettings(step=1.001 * LONGEST_STEP)
    assert RigidSettings(step=LONGEST_STEP)


@pytest.mark.parametrize(("coarser", "steps"), [(0.9, 1.0), (4.1, 1.0), (1.0, 0.5), (1.0, 5.0)])
def test_factors_of_a_sketch_out_of_range_are_refused(coarser: float, steps: float) -> None:
    with pytest.raises(InputError, match=r"allowed: 1 .* to 4"):
        sketched(world(), coarser, steps)
