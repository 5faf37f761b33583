"""Rows of a sketch that fail by the sketch's own step alone say so."""

from __future__ import annotations

import pytest
from worldagent.testing.worlds.small_worlds import ball, ground, world
from worldagent.workflow.sketches import owed_to_step
from worldagent.worlds.coarsening import sketched
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import RigidSettings


@pytest.mark.parametrize(
    ("measured", "steps", "owed"),
    [(0.0015, 4.0, True), (0.0041, 4.0, False), (0.0015, 1.0, False)],
)
def test_travel_per_step_is_told_at_the_step_of_production(measured: float, steps: float, owed: bool) -> None:
    """Travel goes with the step: 1.5 mm at four times the step are 0.375 mm, within 1 mm; 4.1 mm are not."""
    spec = world({"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(0, 0, 1))}, settings=RigidSettings(step=2.5e-4))
    coarse, _ = sketched(spec, 1.0, steps)
    row = Row(
        id="numerical:step_travel:rigid",
        question="numerical:step_travel",
        subject=("rigid",),
        check="numerical",
        group="physical",
        predicate="p",
        status="fail",
        measured=measured,
        bound=0.001,
        evidence={"explanation": "ball travels"},
    )
    told = owed_to_step(row, spec, coarse)
    assert ("owed_to_step" in told.evidence) == owed
    assert told.status == "fail", "a sketch changes no verdict"
    if owed:
        assert told.evidence["owed_to_step"] == pytest.approx(measured / steps)
        assert told.evidence["explanation"].startswith(
            "ball travels; by the step of this sketch alone, 0.001 s: at production's 0.00025 s"
        )
    assert owed_to_step(row.model_copy(update={"question": "numerical:speed"}), spec, coarse).evidence == {
        "explanation": "ball travels"
    }
