"""Evaluators of predicates: verdicts and measured numbers against analytic motion."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter
from worldagent.testing.worlds.small_worlds import IDENTITY, Touch, ball, box, ground, make_candidate, world
from worldagent.tests.verifiers.agreement import agrees, evaluate
from worldagent.verifiers.predicates.evaluators import EVALUATORS
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import (
    After,
    Always,
    And,
    Before,
    Contact,
    Count,
    Crosses,
    Displacement,
    Eventually,
    JointAngle,
    NoContact,
    Not,
    Or,
    Predicate,
    Reaches,
    RestsOn,
    Separation,
    Speed,
    StaysIn,
    Supported,
    Tilts,
    Topples,
    Until,
    Within,
)
from worldagent.worlds.predicates.registry import PREDICATES
from worldagent.worlds.spec import Beat, BoxRegion, CylinderRegion, HingeJoint, SphereRegion

FPS = 24
N = 25
TIME = np.arange(N) / FPS


def slide(speed: float = 1.0, z: float = 0.1) -> tuple[Any, Any]:
    """Along +x at constant speed from the origin."""
    return np.stack([speed * TIME, 0 * TIME, 0 * TIME + z], axis=1), np.repeat([IDENTITY], N, 0)


def turn(angles: Any, at: Any = (0, 0, 0.1)) -> tuple[Any, Any]:
    """Turned about +y by `angles` [rad]."""
    angles = np.asarray(angles)
    quaternions = np.stack([np.cos(angles / 2), 0 * angles, np.sin(angles / 2), 0 * angles], axis=1)
    return np.repeat([at], len(angles), 0).astype(float), quaternions


REGIONS = {
    "near": BoxRegion(min=(0.4, -0.1, 0.0), max=(0.6, 0.1, 0.2)),
    "far": BoxRegion(min=(1.5, 0.1, 0.0), max=(2.0, 0.5, 0.2)),
    "start": SphereRegion(center=(0, 0, 0.1), radius=0.25),
    "tube": CylinderRegion(center=(0.5, 0, 0.1), radius=0.1, height=0.4),
    "beside": BoxRegion(min=(-0.05, 0.2, -0.05), max=(0.05, 0.4, 0.05), relative_to="car"),
    "wide": BoxRegion(min=(-0.3, -0.1, 0.0), max=(0.3, 0.1, 0.2)),
}


def moving_cube(tmp_path: Path, track: Any = None, **more: Any) -> Candidate:
    entities = {
        "floor": ground(),
        "cube": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1)),
        "car": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, -0.3, 0.1)),
    }
    beats = more.pop("beats", {})
    joints = {"hinge": HingeJoint(child="car", anchor=(0, 0, 0), axis=(0, 1, 0))}
    spec = world(entities, regions=REGIONS, beats=beats, joints=joints, frames=N, fps=FPS)
    car = (slide()[0] + [0, -0.3, 0], slide()[1])
    return make_candidate(tmp_path, spec, tracks={"cube": track or slide(), "car": car}, **more)


def test_every_kind_has_one_evaluator_and_every_evaluator_a_kind() -> None:
    assert set(EVALUATORS) == set(PREDICATES)


def test_every_model_of_the_grammar_is_registered() -> None:
    schema = TypeAdapter(Predicate).json_schema()
    assert set(schema["discriminator"]["mapping"]) == set(EVALUATORS)


# ---------------------------------------------------------------- regions


def test_reaches_is_first_true_when_the_centre_enters(tmp_path: Path) -> None:
    outcome = evaluate(moving_cube(tmp_path), Reaches(entity="cube", region="near"), (0, N - 1))
    assert outcome.status == "pass"
    assert outcome.first_true_frame == math.ceil(0.4 * FPS)  # x = k / 24 reaches 0.4 at k = 9.6
    assert outcome.truth is not None
    assert outcome.truth.sum() == 5  # frames 10..14: 0.4 <= k/24 <= 0.6
    assert outcome.margin == pytest.approx(0.1)  # middle of the box at frame 12, 0.1 m from its walls


def test_a_missed_region_reports_distance_frame_and_offset(tmp_path: Path) -> None:
    outcome = evaluate(moving_cube(tmp_path), Reaches(entity="cube", region="far"), (0, N - 1))
    assert outcome.status == "fail"
    assert outcome.value == pytest.approx(math.hypot(0.5, 0.1))  # from (1, 0) to the corner (1.5, 0.1)
    assert outcome.details["frame"] == N - 1
    assert outcome.details["offset"] == pytest.approx([-0.5, -0.1, 0])
    assert "offset (-0.500, -0.100, +0.000)" in outcome.explanation
    assert outcome.first_failing_entity == "cube"


def test_reaching_with_the_whole_surface_is_harder_than_with_the_centre(tmp_path: Path) -> None:
    candidate = moving_cube(tmp_path)
    inside = evaluate(candidate, StaysIn(entity="cube", region="wide", measure="surface"), (0, 4))
    assert inside.status == "pass"  # the cube spans x in [k/24 - 0.1, k/24 + 0.1]; at frame 4 up to 0.267
    assert evaluate(candidate, StaysIn(entity="cube", region="wide", measure="surface"), (0, 5)).first_failing_frame == 5
    assert evaluate(candidate, StaysIn(entity="cube", region="wide"), (0, 7)).status == "pass"
    assert evaluate(candidate, StaysIn(entity="cube", region="wide"), (0, 8)).first_failing_frame == 8


def test_stays_in_fails_at_the_first_frame_outside(tmp_path: Path) -> None:
    outcome = evaluate(moving_cube(tmp_path), StaysIn(entity="cube", region="start"), (0, N - 1))
    assert (outcome.status, outcome.first_failing_frame) == ("fail", 7)  # 6/24 = 0.25 is on the sphere, 7/24 outside
    assert outcome.value == pytest.approx(1.0 - 0.25)


def test_a_region_moves_with_the_entity_it_is_relative_to(tmp_path: Path) -> None:
    outcome = evaluate(moving_cube(tmp_path), StaysIn(entity="cube", region="beside"), (0, N - 1))
    assert outcome.status == "pass"
    assert outcome.margin == pytest.approx(0.05)


def test_cylinder_regions_measure_across_and_along(tmp_path: Path) -> None:
    outcome = evaluate(moving_cube(tmp_path), Reaches(entity="cube", region="tube"), (0, N - 1))
    assert outcome.margin == pytest.approx(0.1)
    missed = evaluate(moving_cube(tmp_path / "b"), Reaches(entity="car", region="tube"), (0, N - 1))
    assert missed.value == pytest.approx(0.3 - 0.1)


# ---------------------------------------------------------------- motion


def test_crossing_needs_to_come_from_behind(tmp_path: Path) -> None:
    candidate = moving_cube(tmp_path)
    forth = evaluate(candidate, Crosses(entity="cube", point=(0.5, 0, 0), normal=(2, 0, 0)), (0, N - 1))
    assert (forth.status, forth.first_true_frame) == ("pass", 12)
    back = evaluate(candidate, Crosses(entity="cube", point=(0.5, 0, 0), normal=(-1, 0, 0)), (0, N - 1))
    assert back.status == "fail"
    never = evaluate(candidate, Crosses(entity="cube", point=(-0.5, 0, 0), normal=(1, 0, 0)), (0, N - 1))
    assert never.status == "fail"
    assert "never behind" in never.explanation
    assert never.value == pytest.approx(0.5)
    agrees(back)
    agrees(never)
    agrees(forth)
    short = evaluate(candidate, Crosses(entity="cube", point=(1.25, 0, 0), normal=(1, 0, 0)), (0, N - 1))
    assert short.details["distance"] == pytest.approx(0.25)
    assert short.value == pytest.approx(-0.25)
    agrees(short)
    late = evaluate(candidate, Crosses(entity="cube", point=(0.5, 0, 0), normal=(1, 0, 0)), (12, N - 1))
    assert late.first_true_frame == 12  # the frame before the interval was behind
    assert evaluate(candidate, Crosses(entity="cube", point=(0.5, 0, 0), normal=(1, 0, 0)), (13, N - 1)).status == "fail"


def test_toppling_is_measured_against_frame_0(tmp_path: Path) -> None:
    candidate = moving_cube(tmp_path, turn(np.linspace(0, 1.21, N)))
    outcome = evaluate(candidate, Topples(entity="cube"), (0, N - 1))
    assert (outcome.status, outcome.first_true_frame) == ("pass", 12)
    assert outcome.value == pytest.approx(1.21)
    late = evaluate(candidate, Topples(entity="cube"), (15, N - 1))
    assert late.status == "fail"
    assert "already toppled" in late.explanation


def test_a_wobble_does_not_topple_and_reports_its_largest_angle(tmp_path: Path) -> None:
    wobble = 0.5 * np.sin(np.linspace(0, np.pi, N))
    outcome = evaluate(moving_cube(tmp_path, turn(wobble)), Topples(entity="cube"), (0, N - 1))
    assert outcome.status == "fail"
    assert outcome.details["largest_angle"] == pytest.approx(0.5)
    assert outcome.details["largest_frame"] == 12


def test_turning_about_the_axis_itself_is_no_tilt(tmp_path: Path) -> None:
    angles = np.linspace(0, 1.2, N)
    spin = np.stack([np.cos(angles / 2), 0 * angles, 0 * angles, np.sin(angles / 2)], axis=1)
    candidate = moving_cube(tmp_path, (np.repeat([(0, 0, 0.1)], N, 0), spin))
    assert evaluate(candidate, Tilts(entity="cube", max=1e-9, when="always"), (0, N - 1)).status == "pass"
    assert evaluate(candidate, Tilts(entity="cube", axis=(1, 0, 0), min=1.2 - 1e-9), (0, N - 1)).status == "pass"


def test_speed_and_displacement_match_uniform_motion(tmp_path: Path) -> None:
    candidate = moving_cube(tmp_path, slide(2.0))
    speed = evaluate(candidate, Speed(entity="cube", min=1.9, max=2.1, when="always"), (0, N - 1))
    assert speed.status == "pass"
    assert speed.value == pytest.approx(2.0)
    assert evaluate(candidate, Displacement(entity="cube", min=2.0 - 1e-9), (0, N - 1)).value == pytest.approx(2.0)
    along = evaluate(candidate, Displacement(entity="cube", axis=(-1, 0, 0), max=-1.0, when="end"), (0, N - 1))
    assert (along.status, along.value) == ("pass", pytest.approx(-2.0))
    fast = evaluate(candidate, Speed(entity="cube", max=1.0, when="always"), (3, N - 1))
    assert (fast.status, fast.first_failing_frame, fast.bound, fast.comparison) == ("fail", 3, 1.0, "<=")
    assert fast.margin == pytest.approx(-1.0)


def test_joint_coordinates_come_from_the_engine(tmp_path: Path) -> None:
    candidate = moving_cube(tmp_path, joints={"hinge": np.linspace(0, 0.5, N)})
    outcome = evaluate(candidate, JointAngle(joint="hinge", min=0.25), (0, N - 1))
    assert (outcome.status, outcome.first_true_frame, outcome.unit) == ("pass", 12, "rad")
    assert evaluate(candidate, JointAngle(joint="hinge", min=0.6), (0, N - 1)).value == pytest.approx(0.5)


# ---------------------------------------------------------------- touching


def test_contact_adds_up_the_impulse_of_its_frames(tmp_path: Path) -> None:
    touches = [Touch(k, "cube", "car", 0.5) for k in (5, 6, 7)]
    candidate = moving_cube(tmp_path, touches=touches)
    outcome = evaluate(candidate, Contact(a="car", b="cube", min_impulse=1.0), (0, N - 1))
    assert (outcome.status, outcome.value, outcome.first_true_frame) == ("pass", 1.5, 6)
    weak = evaluate(candidate, Contact(a="cube", b="car", min_impulse=2.0), (0, N - 1))
    assert (weak.status, weak.margin) == ("fail", -0.5)
    assert evaluate(candidate, Contact(a="cube", b="car"), (8, N - 1)).status == "fail"


def test_entities_that_never_touch_report_their_nearest_gap(tmp_path: Path) -> None:
    outcome = evaluate(moving_cube(tmp_path), Contact(a="cube", b="car"), (0, N - 1))
    assert outcome.details["nearest_gap"] == pytest.approx(0.3 - 0.1 - 0.05)
    assert (outcome.value, outcome.unit) == (pytest.approx(0.15), "m")
    agrees(outcome)
    assert evaluate(moving_cube(tmp_path / "b"), NoContact(a="cube", b="car"), (0, N - 1)).status == "pass"


def test_no_contact_fails_at_the_first_touch_even_without_impulse(tmp_path: Path) -> None:
    candidate = moving_cube(tmp_path, touches=[Touch(9, "cube", "car", 0.0)])
    outcome = evaluate(candidate, NoContact(a="cube", b="car"), (0, N - 1))
    assert (outcome.status, outcome.first_failing_frame) == ("fail", 9)
    assert (outcome.value, outcome.unit) == (1.0, "frame")
    agrees(outcome)


def test_sleeping_bodies_touch_by_their_surfaces(tmp_path: Path) -> None:
    still = (np.array([0, 0, 0.1]), np.array(IDENTITY))
    asleep = moving_cube(tmp_path, still, asleep={"cube": 1})
    assert evaluate(asleep, NoContact(a="cube", b="floor"), (0, N - 1)).status == "fail"
    lifted = moving_cube(tmp_path / "b", (np.array([0, 0, 0.2]), np.array(IDENTITY)), asleep={"cube": 1})
    assert evaluate(lifted, NoContact(a="cube", b="floor"), (0, N - 1)).status == "pass"


def test_resting_needs_a_carrier_and_rest(tmp_path: Path) -> None:
    drop = np.stack([0 * TIME, 0 * TIME, np.maximum(0.1, 0.6 - TIME)], axis=1)
    candidate = moving_cube(tmp_path, (drop, np.repeat([IDENTITY], N, 0)))
    outcome = evaluate(candidate, RestsOn(entity="cube", on="floor"), (0, N - 1))
    assert outcome.status == "pass"
    assert outcome.value == pytest.approx(0.0, abs=1e-9)
    assert evaluate(candidate, RestsOn(entity="cube", on="floor", when="always"), (0, N - 1)).first_failing_frame == 0
    falling = evaluate(candidate, RestsOn(entity="cube", on="floor"), (0, 6))
    assert falling.status == "fail"
    assert "away from floor" in falling.explanation
    sliding = evaluate(moving_cube(tmp_path / "b"), RestsOn(entity="cube", on="floor"), (0, N - 1))
    assert (sliding.status, sliding.value) == ("fail", pytest.approx(1.0))


def test_what_leans_against_a_wall_does_not_rest_on_it(tmp_path: Path) -> None:
    entities = {
        "floor": ground(),
        "wall": box(0.1, 1, 1, at=(0.15, 0, 0.5)),
        "cube": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1)),
    }
    candidate = make_candidate(tmp_path, world(entities), tracks={"cube": (np.array([0, 0, 0.1]), np.array(IDENTITY))})
    assert evaluate(candidate, RestsOn(entity="cube", on="floor"), (0, 23)).status == "pass"
    leaning = evaluate(candidate, RestsOn(entity="cube", on="wall"), (0, 23))
    assert leaning.status == "fail"
    assert "from the side" in leaning.explanation
    agrees(leaning)
    away = make_candidate(tmp_path / "away", world(entities), tracks={"cube": (np.array([0, 0, 0.3]), np.array(IDENTITY))})
    hangs = evaluate(away, RestsOn(entity="cube", on="floor"), (0, 23))
    assert (hangs.value, hangs.unit) == (pytest.approx(0.2), "m")
    agrees(hangs)


def test_support_follows_the_chain_down_to_the_ground(tmp_path: Path) -> None:
    cube = {"motion": "dynamic"}
    entities = {
        "floor": ground(),
        "low": box(0.2, 0.2, 0.2, at=(0, 0, 0.1), **cube),
        "high": box(0.2, 0.2, 0.2, at=(0, 0, 0.3), **cube),
        "loose": box(0.2, 0.2, 0.2, at=(1, 0, 1.0), **cube),
        "on_loose": box(0.2, 0.2, 0.2, at=(1, 0, 1.2), **cube),
    }
    candidate = make_candidate(tmp_path, world(entities, frames=3), tracks={})
    assert evaluate(candidate, Supported(entity="high"), (0, 2)).status == "pass"
    outcome = evaluate(candidate, Supported(entity="on_loose"), (0, 2))
    assert (outcome.status, outcome.first_failing_frame, outcome.value) == ("fail", 0, 0.0)


def test_separation_is_the_clearance_of_the_visible_surfaces(tmp_path: Path) -> None:
    approach = (np.stack([0 * TIME, -0.2 * TIME, 0 * TIME + 0.1], axis=1), np.repeat([IDENTITY], N, 0))
    entities = {"cube": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1)), "post": box(0.1, 0.1, 1, at=(0, -0.3, 0.5))}
    candidate = make_candidate(tmp_path, world(entities, frames=N), tracks={"cube": approach})
    outcome = evaluate(candidate, Separation(a="cube", b="post", min=0.1), (0, N - 1))
    assert outcome.status == "fail"
    assert outcome.value == pytest.approx(0.15 - 0.2)  # overlaps by 5 cm at 1 s
    assert outcome.first_failing_frame == 7  # 0.15 - 0.2 k / 24 < 0.1 from k > 6
    assert evaluate(candidate, Separation(a="cube", b="post", max=0.2), (0, N - 1)).status == "pass"


# ---------------------------------------------------------------- combinators


def falling_row(tmp_path: Path, ends: list[float]) -> Candidate:
    entities = {f"d{i}": box(0.05, 0.1, 0.2, motion="dynamic", at=(i, 0, 0.1)) for i in range(len(ends))}
    tracks = {f"d{i}": turn(np.linspace(0, a, N), (i, 0, 0.1)) for i, a in enumerate(ends)}
    return make_candidate(tmp_path, world(entities, frames=N), tracks=tracks)


def test_count_names_those_that_miss(tmp_path: Path) -> None:
    candidate = falling_row(tmp_path, [1.21, 0.3, 1.21, 1.21])
    names = [f"d{i}" for i in range(4)]
    each = Topples(entity="each")
    outcome = evaluate(candidate, Count(entities=names, predicate=each, min=4), (0, N - 1))
    assert (outcome.status, outcome.value, outcome.failing) == ("fail", 3.0, ("d1",))
    assert outcome.first_failing_entity == "d1"
    assert evaluate(candidate, Count(entities=names, predicate=each, min=3), (0, N - 1)).first_true_frame == 12
    over = evaluate(candidate, Count(entities=names, predicate=each, max=2), (0, N - 1))
    assert (over.status, over.comparison, over.bound) == ("fail", "<=", 2.0)
    assert over.failing == ("d0", "d2", "d3")


def test_each_is_replaced_at_any_depth(tmp_path: Path) -> None:
    candidate = falling_row(tmp_path, [1.2, 0.3])
    deep = And(of=[Not(predicate=Topples(entity="each")), Tilts(entity="each", min=0.2)])
    assert evaluate(candidate, Count(entities=["d0", "d1"], predicate=deep, min=1, max=1), (0, N - 1)).status == "pass"


def test_of_several_that_must_hold_the_one_that_fails_worst_is_named(tmp_path: Path) -> None:
    """Its kind decides which advice a row gets."""
    candidate = falling_row(tmp_path, [1.2, 0.3])
    both = And(of=[Tilts(entity="d1", max=3.0), Topples(entity="d1")])
    failed = evaluate(candidate, both, (0, N - 1))
    assert (failed.status, failed.details["asks"]) == ("fail", "topples")
    held = evaluate(candidate, And(of=[Topples(entity="d0"), Tilts(entity="d0", max=3.0)]), (0, N - 1))
    assert held.status == "pass"
    assert "asks" not in held.details


def test_always_and_eventually_use_the_inner_truth_over_their_own_frames(tmp_path: Path) -> None:
    candidate = moving_cube(tmp_path)
    inside = Reaches(entity="cube", region="near")
    assert evaluate(candidate, Always(predicate=inside, frames=(10, 14)), (0, 5)).status == "pass"
    broken = evaluate(candidate, Always(predicate=inside, frames=(10, 16)), (0, 5))
    assert (broken.status, broken.first_failing_frame, broken.value) == ("fail", 15, pytest.approx(5 / 7))
    assert evaluate(candidate, Eventually(predicate=inside, frames=(0, 9)), (0, 20)).status == "fail"
    assert evaluate(candidate, Eventually(predicate=inside, frames=(0, 10)), (0, 20)).first_true_frame == 10


def test_until_needs_hold_up_to_the_goal_and_the_goal(tmp_path: Path) -> None:
    candidate = moving_cube(tmp_path)
    goal = Reaches(entity="cube", region="near")
    assert evaluate(candidate, Until(hold=Displacement(entity="cube", max=0.39), goal=goal), (0, N - 1)).status == "pass"
    broken = evaluate(candidate, Until(hold=Displacement(entity="cube", max=0.3), goal=goal), (0, N - 1))
    assert (broken.status, broken.first_failing_frame, broken.value) == ("fail", 8, 2.0)
    never = Until(hold=Displacement(entity="cube", max=5), goal=Reaches(entity="cube", region="far"))
    assert evaluate(candidate, never, (0, N - 1)).status == "fail"


def order_world(tmp_path: Path) -> Candidate:
    at = (0, N - 1)
    beats = {
        "early": Beat(text="", owner="rigid", subject="cube", frames=at, predicate=Displacement(entity="cube", min=0.25)),
        "late": Beat(text="", owner="rigid", subject="cube", frames=at, predicate=Displacement(entity="cube", min=0.5)),
        "never": Beat(text="", owner="rigid", subject="cube", frames=at, predicate=Displacement(entity="cube", min=5)),
        "ring": Beat(
            text="",
            owner="rigid",
            subject="cube",
            frames=at,
            predicate=After(beat="ring2", predicate=Speed(entity="cube", min=0)),
        ),
        "ring2": Beat(
            text="", owner="rigid", subject="cube", frames=at, predicate=After(beat="ring", predicate=Speed(entity="cube", min=0))
        ),
    }
    return moving_cube(tmp_path, beats=beats)


def test_order_uses_first_true_frames_of_other_beats(tmp_path: Path) -> None:
    candidate = order_world(tmp_path)
    third = Displacement(entity="cube", min=0.375)  # first true at frame 9; early at 6, late at 12
    assert evaluate(candidate, After(beat="early", predicate=third), (0, N - 1)).value == 3
    assert evaluate(candidate, Before(beat="late", predicate=third), (0, N - 1)).status == "pass"
    wrong = evaluate(candidate, After(beat="late", predicate=third), (0, N - 1))
    assert (wrong.status, wrong.value, wrong.bound) == ("fail", -3.0, 1.0)
    assert evaluate(candidate, Within(beat="early", frames=3, predicate=third), (0, N - 1)).status == "pass"
    assert evaluate(candidate, Within(beat="early", frames=2, predicate=third), (0, N - 1)).status == "fail"
    assert evaluate(candidate, After(beat="never", predicate=third), (0, N - 1)).status == "fail"


def test_beats_that_refer_to_each_other_in_a_circle_are_unverified(tmp_path: Path) -> None:
    candidate = order_world(tmp_path)
    outcome = evaluate(candidate, After(beat="ring", predicate=Speed(entity="cube", min=0)), (0, N - 1))
    assert outcome.status == "unverified"
    assert "circle" in outcome.explanation


def test_logic_joins_verdicts(tmp_path: Path) -> None:
    candidate = moving_cube(tmp_path)
    yes, no = Displacement(entity="cube", min=0.5), Displacement(entity="cube", min=2.0)
    unknown = Displacement(entity="ghost", min=1.0)
    at = (0, N - 1)
    assert evaluate(candidate, And(of=[yes, yes]), at).first_true_frame == 12
    assert evaluate(candidate, And(of=[yes, no]), at).value == pytest.approx(1.0)
    assert evaluate(candidate, And(of=[yes, unknown]), at).status == "unverified"
    assert evaluate(candidate, And(of=[no, unknown]), at).status == "fail"
    assert evaluate(candidate, Or(of=[no, yes]), at).status == "pass"
    assert evaluate(candidate, Or(of=[no, unknown]), at).status == "unverified"
    assert evaluate(candidate, Or(of=[no, no]), at).status == "fail"
    assert evaluate(candidate, Not(predicate=no), at).status == "pass"
    assert evaluate(candidate, Not(predicate=yes), at).first_failing_frame == 12
    assert evaluate(candidate, Not(predicate=unknown), at).status == "unverified"


# ---------------------------------------------------------------- evidence


def test_frames_beyond_a_probe_are_unverified(tmp_path: Path) -> None:
    candidate = moving_cube(tmp_path)
    outcome = evaluate(candidate, Displacement(entity="cube", min=0.1), (0, N))
    assert outcome.status == "unverified"
    assert f"0..{N - 1}" in outcome.explanation


def test_no_frames_but_the_first_before_a_simulation(tmp_path: Path) -> None:
    spec = world({"cube": box(0.2, 0.2, 0.2, motion="dynamic", at=(0.5, 0, 0.1))}, regions=REGIONS)
    candidate = make_candidate(tmp_path, spec)
    spec_region = Reaches(entity="cube", region="near")
    assert evaluate(candidate, spec_region, (0, 0)).status == "pass"
    assert evaluate(candidate, spec_region, (0, 5)).status == "unverified"
    assert evaluate(candidate, Contact(a="cube", b="cube"), (0, 0)).status == "unverified"


@pytest.mark.parametrize(
    ("channel", "predicate"),
    [
        ("position", Displacement(entity="cube", min=0.1)),
        ("velocity", Speed(entity="cube", min=0.1)),
        ("contact/impulse", Contact(a="cube", b="car")),
        ("joint", JointAngle(joint="hinge", min=0.1)),
        ("asleep", NoContact(a="cube", b="car")),
    ],
)
def test_a_missing_channel_is_unverified(tmp_path: Path, channel: str, predicate: Any) -> None:
    outcome = evaluate(moving_cube(tmp_path, without=[channel]), predicate, (0, N - 1))
    assert outcome.status == "unverified"


@pytest.mark.parametrize(
    "predicate",
    [
        Reaches(entity="cube", region="near"),
        StaysIn(entity="cube", region="start"),
        Displacement(entity="cube", min=0.1),
        Displacement(entity="cube", max=9),
        Not(predicate=Displacement(entity="cube", min=0.1)),
        Tilts(entity="cube", max=1),
        Crosses(entity="cube", point=(0.1, 0, 0), normal=(1, 0, 0)),
        Separation(a="cube", b="car", min=0),
        Supported(entity="cube"),
        RestsOn(entity="cube", on="floor"),
    ],
)
def test_not_a_number_fails_at_its_first_frame(tmp_path: Path, predicate: Any) -> None:
    positions, quaternions = slide()
    positions[3:], quaternions[3:] = np.nan, np.nan
    candidate = moving_cube(tmp_path, (np.where(np.isnan(positions), np.nan, positions), quaternions))
    outcome = evaluate(candidate, predicate, (0, N - 1))
    assert outcome.status == "fail"
    assert outcome.first_failing_frame is not None
    assert outcome.first_failing_frame <= 3
    assert outcome.first_failing_entity in {"cube", "car"}


def test_a_moving_entity_without_a_cache_is_unverified(tmp_path: Path) -> None:
    candidate = moving_cube(tmp_path)
    entities = {**candidate.spec.entities, "stray": box(0.1, 0.1, 0.1, motion="dynamic")}
    spec = candidate.spec.model_copy(update={"entities": entities})
    stray = dataclasses.replace(candidate, spec=spec, built={**candidate.built, "stray": candidate.built["car"]})
    assert evaluate(stray, Displacement(entity="stray", max=1, when="always"), (0, N - 1)).status == "unverified"


def test_a_ball_s_fastest_point_is_its_rim(tmp_path: Path) -> None:
    """Law: a rolling ball's top moves at twice the speed of its centre."""
    angles = 1.0 * TIME / 0.1
    spin = np.stack([np.cos(angles / 2), 0 * angles, np.sin(angles / 2), 0 * angles], axis=1)
    spec = world({"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(0, 0, 0.1))}, frames=N)
    channels = {"angular_velocity": np.repeat([[[0, 10.0, 0]]], N, 0)}
    candidate = make_candidate(tmp_path, spec, tracks={"ball": (slide()[0], spin)}, channels=channels)
    outcome = evaluate(candidate, RestsOn(entity="ball", on="floor"), (0, N - 1))
    assert outcome.value == pytest.approx(2.0, rel=0.01)
