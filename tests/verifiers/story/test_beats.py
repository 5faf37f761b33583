"""Beats: declared outcomes, vacuous ones, staged ones, and what the server suggests."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, box, ground, make_candidate, pose, world
from worldagent.verifiers.story.beats import check
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Always, And, Contact, Displacement, Not, Reaches, RestsOn, Speed, StaysIn, Topples
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, BoxRegion, FieldDriver, ForceDriver, PathDriver, PathKey, Requirement, Story

N = 25
TIME = np.arange(N) / 24
REGIONS = {
    "goal": BoxRegion(min=(0.9, -0.5, 0), max=(1.5, 0.5, 0.5)),
    "here": BoxRegion(min=(-1, 1, 0), max=(1, 3, 1)),
    "aside": BoxRegion(min=(0.9, 0.3, 0), max=(1.5, 0.5, 0.5)),
    "plate": BoxRegion(min=(0.505, -0.1, 0.0), max=(0.515, 0.1, 0.2)),
}


def beat(predicate: Any, frames: tuple[int, int] = (0, N - 1), **more: Any) -> Beat:
    return Beat(
        text="it happens",
        owner=more.pop("owner", "rigid"),
        subject=more.pop("subject", "cube"),
        frames=frames,
        predicate=predicate,
        **more,
    )


def sliding(
    tmp_path: Path, beats: dict[str, Beat], *, requirements: dict[str, Requirement] | None = None, **more: Any
) -> Candidate:
    entities = {
        "floor": ground(),
        "cube": box(0.2, 0.2, 0.2, motion=more.pop("motion", "dynamic"), at=(0, 0, 0.1)),
        "rest": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 2, 0.1)),
    }
    story = Story(beats=beats, requirements=requirements or {})
    spec = world(entities, regions=REGIONS, frames=N, story=story, drivers=more.pop("drivers", None))
    positions = np.stack([TIME, 0 * TIME, 0 * TIME + 0.1], axis=1)
    return make_candidate(tmp_path, spec, tracks=more.pop("tracks", {"cube": (positions, IDENTITY)}), **more)


def rows_of(candidate: Candidate) -> dict[str, Row]:
    return {r.id: r for r in check(candidate)}


def test_a_beat_that_happens_passes_with_its_numbers(tmp_path: Path) -> None:
    row = rows_of(sliding(tmp_path, {"b": beat(Reaches(entity="cube", region="goal"), (10, 24))}))["beat:b"]
    assert row.status == "pass"
    assert row.evidence["first_true_frame"] == 22  # x = k / 24 >= 0.9
    assert (row.frames, row.group, row.artifact, row.unit) == ((10, 24), "temporal", "cache/rigid", "m")
    assert row.recipe


def test_a_miss_suggests_moving_the_start_by_the_measured_offset(tmp_path: Path) -> None:
    row = rows_of(sliding(tmp_path, {"b": beat(Reaches(entity="cube", region="aside"), (10, 24))}))["beat:b"]
    assert (row.status, row.measured) == ("fail", pytest.approx(0.3))
    assert (row.first_failing_entity, row.entities[0]) == ("cube", "cube")
    placement = next(c for c in row.corrections if c.group == "placement")
    assert placement.edit_class == "scene"
    assert placement.patch[0] == {"op": "add", "path": "/entities/cube/pose/position", "value": [0.0, 0.3, 0.1]}


def test_what_goes_through_a_region_between_two_frames_is_not_told_to_aim(tmp_path: Path) -> None:
    # x = k / 24: the plate lies between frames 12 and 13.
    row = rows_of(sliding(tmp_path, {"b": beat(Reaches(entity="cube", region="plate"), (10, 24))}))["beat:b"]
    assert (row.status, row.measured) == ("fail", pytest.approx(0.005))
    assert {c.group for c in row.corrections} == {"story"}
    assert "between frames 12 and 13, 0.0417 m apart" in row.corrections[0].cause
    assert "at least 0.05 m along its way" in row.corrections[0].action


def test_an_event_after_its_interval_is_found_and_replanned(tmp_path: Path) -> None:
    row = rows_of(sliding(tmp_path, {"b": beat(Reaches(entity="cube", region="goal"), (5, 15))}))["beat:b"]
    assert row.status == "fail"
    assert "at frame 22, 7 frames after" in row.corrections[0].cause
    assert row.corrections[0].patch[0]["value"] == [5, 22]
    assert row.evidence["shift_s"] == pytest.approx(1.2 * 7 / 24)
    narrow = rows_of(sliding(tmp_path / "narrow", {"b": beat(Reaches(entity="cube", region="goal"), (1, 3))}))["beat:b"]
    assert narrow.evidence["shift_s"] == pytest.approx((22 - 2) / 24)


def test_what_is_over_when_its_end_is_judged_is_not_replanned_to_begin_earlier(tmp_path: Path) -> None:
    """x = k / 24: within 0.25 m up to frame 6, and 0.83 m away at frame 20, where both intervals end."""
    near = And(of=[Displacement(entity="cube", max=0.25, when="end"), Displacement(entity="cube", min=0.1, when="end")])
    row = rows_of(sliding(tmp_path, {"b": beat(near, (10, 20))}))["beat:b"]
    assert (row.status, row.measured) == ("fail", pytest.approx(20 / 24))
    assert "late_frames" not in row.evidence
    assert not [c for c in row.corrections if "frames" in c.pointers[0]]
    # Where the end comes after it, it is true at the end of the interval that reaches there.
    far = And(of=[Displacement(entity="cube", min=0.9, when="end"), Displacement(entity="cube", min=0.1, when="end")])
    row = rows_of(sliding(tmp_path / "b", {"b": beat(far, (10, 20))}))["beat:b"]
    assert row.evidence["happens_at_frame"] == 22
    assert row.corrections[0].patch[0]["value"] == [10, 22]


def test_an_approach_that_the_end_cuts_off_asks_for_more_frames(tmp_path: Path) -> None:
    far = {"b": beat(Displacement(entity="cube", min=1.5))}
    row = rows_of(sliding(tmp_path, far))["beat:b"]
    assert row.corrections[0].group == "interval"
    assert row.corrections[0].patch[0] == {"op": "replace", "path": "/simulation/frames", "value": N + 24}
    assert f"the run ends at frame {N - 1}" in row.corrections[0].cause
    assert f"to frame {N + 23}" in row.corrections[0].action
    assert (row.evidence["about"], row.evidence["asks"]) == ("rigid", "displacement")


def test_what_never_started_to_fall_is_not_waited_for(tmp_path: Path) -> None:
    row = rows_of(sliding(tmp_path, {"b": beat(Topples(entity="rest"), subject="rest")}))["beat:b"]
    assert (row.status, row.measured) == ("fail", 0.0)
    assert "interval" not in {c.group for c in row.corrections}


def test_too_little_impulse_says_how_much_more(tmp_path: Path) -> None:
    from worldagent.testing.worlds.small_worlds import Touch

    beats = {"b": beat(Contact(a="cube", b="rest", min_impulse=2.0))}
    row = rows_of(sliding(tmp_path, beats, touches=[Touch(5, "cube", "rest", 0.5)]))["beat:b"]
    assert (row.status, row.measured, row.bound, row.unit) == ("fail", 0.5, 2.0, "N s")
    assert "4 times the impulse" in row.corrections[0].action


# ---------------------------------------------------------------- derived rows


def test_an_outcome_true_from_the_start_is_vacuous(tmp_path: Path) -> None:
    """R156."""
    rows = rows_of(sliding(tmp_path, {"b": beat(Displacement(entity="rest", max=0.1), subject="rest")}))
    assert rows["beat:b"].status == "pass"
    row = rows["beat:vacuous:b"]
    assert (row.status, row.first_failing_entity, row.first_failing_frame) == ("fail", "rest", 0)


def test_an_outcome_not_true_at_the_start_is_not_vacuous(tmp_path: Path) -> None:
    assert rows_of(sliding(tmp_path, {"b": beat(Displacement(entity="cube", min=0.5))}))["beat:vacuous:b"].status == "pass"


def test_a_state_that_was_left_and_came_back_is_not_vacuous(tmp_path: Path) -> None:
    hop = np.where(TIME < 0.5, np.sin(TIME * 2 * np.pi) * 0.5, 0)
    tracks = {"cube": (np.stack([0 * TIME, 0 * TIME, 0.1 + np.maximum(hop, 0)], axis=1), IDENTITY)}
    landing = {"b": beat(RestsOn(entity="cube", on="floor"), (10, 24))}
    velocity = np.zeros((N, 2, 3))
    velocity[1:12, 0, 2] = 1.0
    rows = rows_of(sliding(tmp_path, landing, tracks=tracks, channels={"velocity": velocity}))
    assert rows["beat:b"].status == "pass"
    assert rows["beat:vacuous:b"].status == "pass"
    still = {"b": beat(RestsOn(entity="rest", on="floor"), (10, 24), subject="rest", causes=["a"])}
    assert rows_of(sliding(tmp_path / "b", still))["beat:vacuous:b"].status == "fail"


def test_invariants_without_causes_may_hold_from_the_start(tmp_path: Path) -> None:
    for predicate in (
        Always(predicate=Displacement(entity="rest", max=0.1)),
        StaysIn(entity="rest", region="here"),
        Not(predicate=Topples(entity="rest")),
        Speed(entity="rest", max=1.0, when="always"),
    ):
        rows = rows_of(sliding(tmp_path / predicate.kind, {"b": beat(predicate, subject="rest")}))
        row = rows["beat:vacuous:b"]
        assert (rows["beat:b"].status, row.status, row.evidence.get("initial")) == ("pass", "pass", True)
        assert "an initial state" in row.evidence["explanation"]
    caused = {"b": beat(Not(predicate=Topples(entity="rest")), subject="rest", causes=["a"])}
    assert rows_of(sliding(tmp_path / "caused", caused))["beat:vacuous:b"].status == "fail"


def test_vacuity_is_found_before_any_simulation(tmp_path: Path) -> None:
    beats = {"b": beat(Displacement(entity="rest", max=0.1), subject="rest"), "c": beat(Displacement(entity="cube", min=0.5))}
    rows = rows_of(sliding(tmp_path, beats, tracks=None))
    assert (rows["beat:b"].status, rows["beat:c"].status) == ("unverified", "unverified")
    assert (rows["beat:vacuous:b"].status, rows["beat:vacuous:c"].status) == ("fail", "pass")


def test_an_outcome_moved_by_a_path_is_staged(tmp_path: Path) -> None:
    keys = {"a": PathKey(time=0, pose=pose((0, 0, 0.1))), "b": PathKey(time=1, pose=pose((1, 0, 0.1)))}
    drivers = {"rail": PathDriver(entity="cube", keys=keys)}
    moved = Displacement(entity="cube", min=0.5)
    beats = {
        "trigger": beat(moved, owner="rail"),
        "outcome": beat(moved, causes=["trigger"], owner="rail"),
        "claimed": beat(moved),
        "measured": beat(moved, subject="rest"),
    }
    rows = rows_of(sliding(tmp_path, beats, motion="kinematic", drivers=drivers))
    assert "beat:driven:trigger" not in rows  # an authored input, not an outcome
    assert {n: rows[f"beat:driven:{n}"].status for n in ("outcome", "claimed", "measured")} == dict.fromkeys(
        ("outcome", "claimed", "measured"), "fail"
    )
    assert "rail" in rows["beat:driven:outcome"].evidence["explanation"]


def test_an_outcome_moved_by_a_solver_is_not_staged(tmp_path: Path) -> None:
    assert rows_of(sliding(tmp_path, {"b": beat(Displacement(entity="cube", min=0.5))}))["beat:driven:b"].status == "pass"


# ---------------------------------------------------------------- requirements and evidence


def test_requirements_default_to_the_whole_sequence(tmp_path: Path) -> None:
    requirements = {
        "stays": Requirement(text="", predicate=StaysIn(entity="rest", region="goal"), mandatory=False),
        "slow": Requirement(text="", predicate=Speed(entity="cube", max=2, when="always")),
    }
    rows = rows_of(sliding(tmp_path, {}, requirements=requirements))
    assert (rows["requirement:stays"].status, rows["requirement:stays"].group, rows["requirement:stays"].mandatory) == (
        "fail",
        "spatial",
        False,
    )
    assert (rows["requirement:slow"].status, rows["requirement:slow"].group, rows["requirement:slow"].frames) == (
        "pass",
        "physical",
        (0, N - 1),
    )


def longer(candidate: Candidate, frames: int) -> Candidate:
    plan = candidate.spec.simulation.model_copy(update={"frames": frames})
    return dataclasses.replace(candidate, spec=candidate.spec.model_copy(update={"simulation": plan}), stage="probe")


def test_a_short_probe_leaves_later_beats_unverified(tmp_path: Path) -> None:
    beats = {
        "late": beat(Displacement(entity="cube", min=0.5), (20, 40)),
        "early": beat(Displacement(entity="cube", min=0.5), (0, 20)),
    }
    rows = rows_of(longer(sliding(tmp_path, beats), 48))
    assert (rows["beat:late"].status, rows["beat:early"].status) == ("unverified", "pass")
    assert "0..24" in rows["beat:late"].evidence["explanation"]


def test_a_broken_invariant_fails_on_a_short_probe_already(tmp_path: Path) -> None:
    requirements = {
        "slow": Requirement(text="", predicate=Speed(entity="cube", max=0.5, when="always")),
        "fast": Requirement(text="", predicate=Speed(entity="cube", max=2, when="always")),
    }
    rows = rows_of(longer(sliding(tmp_path, {}, requirements=requirements), 48))
    assert (rows["requirement:slow"].status, rows["requirement:fast"].status) == ("fail", "unverified")


def test_not_a_number_fails(tmp_path: Path) -> None:
    positions = np.stack([TIME, 0 * TIME, 0 * TIME + 0.1], axis=1)
    positions[7] = np.nan
    rows = rows_of(sliding(tmp_path, {"b": beat(Displacement(entity="cube", min=0.5))}, tracks={"cube": (positions, IDENTITY)}))
    assert (rows["beat:b"].status, rows["beat:b"].first_failing_frame, rows["beat:b"].measured) == ("fail", 7, None)
    assert rows["beat:b"].corrections[0].group == "step"


def test_a_driver_that_helps_an_outcome_unsaid_is_staging(tmp_path: Path) -> None:
    """R156: the story says that the rest does it; a force of its own time does."""
    beats = {
        "first": beat(Speed(entity="rest", min=0.5), subject="rest"),
        "slide": beat(Displacement(entity="cube", min=0.5), causes=["first"]),
    }

    def row(name: str, force: ForceDriver | FieldDriver, story: dict[str, Beat]) -> Row:
        return rows_of(sliding(tmp_path / name, story, drivers={"hand": force}))["beat:driven:slide"]

    early = ForceDriver(entity="cube", force=(5, 0, 0), start=0.1, end=0.3)
    assert (row("a", early, beats).status, row("a2", early, beats).first_failing_entity) == ("fail", "cube")
    owned = {**beats, "first": beats["first"].model_copy(update={"owner": "hand"})}
    assert row("b", early, owned).status == "pass"
    assert row("c", early.model_copy(update={"start": 0.9, "end": 1.0}), beats).status == "pass"
    wind, still_air = (
        FieldDriver.model_validate({"field": f}) for f in ({"kind": "wind", "velocity": [9, 0, 0]}, {"kind": "drag"})
    )
    assert row("d", wind, beats).status == "fail"
    assert row("e", still_air, beats).status == "pass", "a medium at rest brings nothing about"
