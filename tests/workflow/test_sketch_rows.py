"""Rows of a sketch that fail by the sketch's own step alone say so, and beats of which nothing can tell."""

from __future__ import annotations

import pytest
from worldagent.testing.worlds.small_worlds import ball, ground, world
from worldagent.workflow.sketches import not_in_matrix, owed_to_step, unjudged
from worldagent.worlds.coarsening import sketched
from worldagent.worlds.predicates import PairEvent
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, RigidSettings, Story


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


@pytest.mark.parametrize(
    ("check", "status", "last", "told"),
    [
        ("beat", "unverified", 12, True),
        ("beat", "unverified", 11, False),
        ("beat", "fail", 12, False),
        ("causal", "unverified", 12, False),
    ],
)
def test_a_beat_within_a_sketch_that_nothing_can_judge_is_told(check: str, status: str, last: int, told: bool) -> None:
    """One that ends later is judged by a longer run."""
    beat = Beat(
        text="b", owner="rigid", subject="ball", frames=(3, 12), predicate=PairEvent(kind="hits", entity="ball", other="floor")
    )
    spec = world({"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(0, 0, 1))}, story=Story(beats={"strike": beat}))
    row = Row(
        id=f"{check}:strike",
        question=check,
        subject=("strike",),
        check=check,
        group="physical",
        predicate="p",
        status=status,
        evidence={"explanation": "no cache has it"},
    )
    assert unjudged([row], spec, last) == ({f"{check}:strike": "no cache has it"} if told else {})


def test_no_row_of_a_sketch_is_said_to_be_looked_up_in_the_matrix() -> None:
    """`inspect_world(part='row')` answered that there is no row."""
    looks = [
        {"tool": "inspect_world", "arguments": {"part": "row", "row": "numerical:speed:cloth"}},
        {"tool": "inspect_world", "arguments": {"part": "records"}},
        {"tool": "probe_sim"},
    ]
    row = Row(
        id="numerical:speed:cloth", question="numerical:speed", subject=("cloth",), check="numerical", group="physical", predicate="p",
        status="fail", evidence={"explanation": "87 m/s", "diagnosis": {"symptom": "fast", "cheapest_probe": looks}},
    )  # fmt: skip
    assert not_in_matrix(row).evidence["diagnosis"] == {"symptom": "fast", "cheapest_probe": looks[1:]}
    plain = row.model_copy(update={"evidence": {"explanation": "87 m/s"}})
    assert not_in_matrix(plain) is plain
