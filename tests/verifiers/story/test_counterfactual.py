"""Counterfactual causality: the cause is taken away in a run that goes on from a checkpoint, and the effect must not come."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from jsonpatch import apply_patch
from worldagent.simulation.variants import run_variant
from worldagent.testing.worlds.simulated_worlds import SLICK, beat, simulate
from worldagent.testing.worlds.small_worlds import ball, box, ground, make_candidate, world
from worldagent.tests.verifiers.pushed_blocks import N, only, pushed
from worldagent.verifiers.checks import rerun_ids, run_checks
from worldagent.verifiers.diagnosis.cite import diagnose
from worldagent.verifiers.story import reruns
from worldagent.verifiers.story.counterfactual import check, row_ids
from worldagent.workflow.rows import brief, concise
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import And, Contact, Displacement, JointAngle, PairEvent, Reaches, RestsOn, Speed, Tilts
from worldagent.worlds.spec import (
    BoxRegion,
    CausalMargin,
    DetachDriver,
    ForceDriver,
    HingeJoint,
    MotorDriver,
    PathDriver,
    ReleaseDriver,
    WeldJoint,
    WorldSpec,
)


def test_an_effect_vanishes_with_its_cause(tmp_path: Path) -> None:
    row = only(simulate(tmp_path, pushed()))
    assert (row.id, row.check, row.group, row.status) == ("causal:without:hit:slide", "causal", "temporal", "pass")
    assert (row.bound, row.comparison, row.unit) == (0.05, "<=", "m")
    assert row.measured == pytest.approx(0.0, abs=1e-4)
    assert row.evidence["intervention"].startswith("a held from frame")
    assert row.evidence["frames_rerun"] == 24
    assert row.evidence["steps_rerun"] > 0


def test_coincident_independent_events_fail(tmp_path: Path) -> None:
    """R97: two balls dropped together land together; neither needs the other."""
    entities = {"floor": ground()} | {n: ball(0.05, motion="dynamic", at=(x, 0, 0.5)) for n, x in (("a", 0.0), ("b", 0.5))}
    beats = {
        "one": beat("a", Contact(a="a", b="floor"), frames=(1, 20)),
        "two": beat("b", Contact(a="b", b="floor"), frames=(1, 20), causes=["one"]),
    }
    row = only(simulate(tmp_path, world(entities, beats=beats, frames=N)))
    assert (row.status, row.first_failing_entity) == ("fail", "b")
    assert row.evidence["frame_without_cause"] == row.evidence["frame_with_cause"]
    assert {c.edit_class for c in row.corrections} == {"scene", "story"}  # no driver is there to take away


def test_rest_is_an_effect_of_sliding_once_it_is_asked_where(tmp_path: Path) -> None:
    """A block that is held is at rest too: the correction asks how far it had come, and then sliding is what brought it there."""
    entities = {"floor": ground(), "a": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.051), velocity=(0.5, 0, 0))}
    beats = {
        "slide": beat("a", Displacement(entity="a", min=0.05), frames=(1, 10)),
        "stop": beat("a", Speed(entity="a", max=0.01, when="end"), frames=(8, 24), causes=["slide"]),
    }
    spec = world(entities, beats=beats, frames=N, materials=SLICK)
    row = only(simulate(tmp_path / "a", spec))
    assert row.status == "fail", row.evidence
    assert row.corrections[0].cause == "stop is true of a wherever nothing moves it"
    mended = apply_patch(spec.model_dump(mode="json"), list(row.corrections[0].patch))
    assert only(simulate(tmp_path / "b", WorldSpec.model_validate(mended))).status == "pass"


def test_a_hidden_driver_that_does_it_anyway_fails(tmp_path: Path) -> None:
    drivers = {"wind": ForceDriver(entity="b", force=(3, 0, 0), start=0.3, end=1.0)}
    row = only(simulate(tmp_path, pushed(drivers=drivers)))
    assert row.status == "fail"
    assert "still comes" in row.evidence["explanation"]


def test_what_falls_through_its_support_does_not_rest_on_it(tmp_path: Path) -> None:
    """Without their contact the ball lies inside the thin plate, on the floor below: geometry alone would call it carried."""
    entities = {
        "floor": ground(),
        "plate": box(0.3, 0.3, 0.002, at=(0, 0, 0.001)),
        "ball": ball(0.05, motion="dynamic", at=(0, 0, 0.2)),
    }
    beats = {
        "land": beat("ball", Contact(a="ball", b="plate"), frames=(1, 24)),
        "rest": beat("ball", RestsOn(entity="ball", on="plate"), frames=(1, 36), causes=["land"]),
    }
    candidate = simulate(tmp_path, world(entities, beats=beats, frames=37, materials=SLICK))
    assert only(candidate).status == "pass"


def test_a_margin_asks_for_a_later_effect(tmp_path: Path) -> None:
    """The hit only hastens what the wind does as well."""
    drivers = {"wind": ForceDriver(entity="b", force=(3, 0, 0), start=0.3, end=1.0)}
    late = {}
    for asked in (1, 40):
        spec = pushed(drivers=drivers)
        slide = spec.story.beats["slide"].model_copy(update={"margins": {"hit": CausalMargin(frames=asked)}})
        story = spec.story.model_copy(update={"beats": {**spec.story.beats, "slide": slide}})
        row = only(simulate(tmp_path / str(asked), spec.model_copy(update={"story": story})))
        assert (row.unit, row.comparison, row.bound) == ("frame", ">=", asked)
        late[asked] = (row.status, row.measured)
    assert late[1][0] == "pass"
    assert late[40][0] == "fail"
    assert late[1][1] == late[40][1] > 0


def test_a_margin_asks_for_another_value_at_the_same_frame(tmp_path: Path) -> None:
    drivers = {"wind": ForceDriver(entity="b", force=(3, 0, 0), start=0.0, end=1.0)}
    for asked, status in ((0.03, "pass"), (1.0, "fail")):
        beats = {
            "hit": beat("b", Contact(a="a", b="b"), frames=(1, 20)),
            "far": beat(
                "b", Displacement(entity="b", min=0.2), frames=(1, 24), causes=["hit"], margins={"hit": CausalMargin(value=asked)}
            ),
        }
        row = only(simulate(tmp_path / str(asked), pushed(drivers=drivers, beats=beats)))
        assert (row.status, row.unit, row.bound) == (status, "m", asked)


@pytest.mark.parametrize(("least", "bound"), [(0.2, None), (0.05, 0.003464)])
def test_a_tiny_margin_does_not_make_noise_a_change(tmp_path: Path, least: float, bound: float | None) -> None:
    """The wind alone moves the block; a hit that adds nothing is no cause, however small a change was asked.

    Of a short way the least is 2 % of the block's diagonal, of a long one a share of the way.
    """
    entities = {
        "floor": ground(),
        "a": ball(0.01, motion="dynamic", at=(0, 0, 0.011), velocity=(1.0, 0, 0)),
        "b": box(0.1, 0.1, 0.1, motion="dynamic", at=(0.15, 0, 0.051)),
    }
    beats = {
        "hit": beat("b", Contact(a="a", b="b"), frames=(1, 20)),
        "far": beat(
            "b", Displacement(entity="b", min=least), frames=(1, 24), causes=["hit"], margins={"hit": CausalMargin(value=1e-6)}
        ),
    }
    drivers = {"wind": ForceDriver(entity="b", force=(3, 0, 0), start=0.0, end=1.0)}
    row = only(simulate(tmp_path, world(entities, beats=beats, drivers=drivers, frames=N, materials=SLICK)))
    assert row.measured is not None
    assert row.bound is not None
    assert (row.status, row.unit) == ("fail", "m")
    assert 1e-6 < row.measured < row.bound
    assert bound is None or row.bound == pytest.approx(bound)


@pytest.mark.parametrize(
    ("margin", "error"), [({}, "one of the two"), ({"frames": 2, "value": 1.0}, "one of the two"), ({"frames": 0}, "greater")]
)
def test_a_margin_is_frames_or_a_value(margin: dict[str, Any], error: str) -> None:
    with pytest.raises(ValueError, match=error):
        CausalMargin(**margin)


# ---------------------------------------------------------------- which intervention


def test_a_rebound_is_taken_away_by_letting_the_two_pass(tmp_path: Path) -> None:
    """A ball that comes back from a wall: held, it would prove nothing about the wall."""
    entities = {
        "floor": ground(),
        "wall": box(0.1, 1.0, 0.5, at=(0.5, 0, 0.25)),
        "ball": ball(0.05, motion="dynamic", at=(0, 0, 0.3), velocity=(3, 0, 0)),
    }
    regions = {"back": BoxRegion(min=(-2, -1, 0), max=(0.2, 1, 2)), "beyond": BoxRegion(min=(0.3, -1, 0), max=(3, 1, 2))}
    beats = {
        "bounce": beat("ball", Contact(a="ball", b="wall"), frames=(2, 12)),
        "returns": beat("ball", Reaches(entity="ball", region="back"), frames=(6, 24), causes=["bounce"]),
    }
    spec = world(
        entities,
        beats=beats,
        regions=regions,
        frames=N,
        materials={"wood": SLICK["wood"].model_copy(update={"restitution": 0.8})},
    )
    row = only(simulate(tmp_path / "a", spec))
    assert row.status == "pass"
    assert "pass through each other" in row.evidence["intervention"]


def test_what_a_ball_brushes_on_its_way_is_no_cause_of_where_it_goes(tmp_path: Path) -> None:
    """A hit on a feather-light block on the way does not bring the ball to its goal."""
    entities = {
        "floor": ground(),
        "ball": ball(0.1, motion="dynamic", at=(0, 0, 0.101), velocity=(2, 0, 0)),
        "tuft": box(0.02, 0.02, 0.02, motion="dynamic", at=(0.4, 0, 0.011)),
    }
    regions = {"goal": BoxRegion(min=(0.8, -1, 0), max=(3, 1, 2))}
    beats = {
        "brush": beat("ball", Contact(a="ball", b="tuft"), frames=(1, 12)),
        "arrive": beat("ball", Reaches(entity="ball", region="goal"), frames=(6, 24), causes=["brush"]),
    }
    row = only(simulate(tmp_path, world(entities, beats=beats, regions=regions, frames=N)))
    assert row.status == "fail"
    assert "pass through each other" in row.evidence["intervention"]


def test_a_row_of_blocks_is_stopped_by_holding_what_strikes_the_first(tmp_path: Path) -> None:
    entities = {"c": box(0.1, 0.1, 0.1, motion="dynamic", at=(0.45, 0, 0.051))}
    beats = {
        "hit": beat("b", Contact(a="a", b="b"), frames=(1, 20)),
        "last": beat("c", Displacement(entity="c", min=0.02), frames=(1, 24), causes=["hit"]),
    }
    row = only(simulate(tmp_path, pushed(entities=entities, beats=beats)))
    assert row.status == "pass"
    assert row.evidence["intervention"].startswith("a held")


@pytest.mark.parametrize(("bystander", "status"), [(False, "pass"), (True, "fail")])
def test_of_a_hit_of_the_body_that_moves_on_the_doer_is_taken_away(bystander: bool, status: str, tmp_path: Path) -> None:
    """Held itself, the struck body would do nothing, whoever else comes; without the hit the bystander sends it on as well."""
    from_aside = {"c": box(0.2, 0.2, 0.2, motion="dynamic", at=(0.25, -0.6, 0.101), velocity=(0, 3.0, 0))} if bystander else {}
    beats = {
        "hit": beat("b", PairEvent(kind="hits", entity="a", other="b"), frames=(1, 20)),
        "slide": beat("b", Displacement(entity="b", min=0.02), frames=(1, 24), causes=["hit"]),
    }
    candidate = simulate(tmp_path, pushed(entities=from_aside, beats=beats))
    row = next(r for r in check(candidate) if r.id == "causal:without:hit:slide")
    assert row.evidence["intervention"].startswith("a held from frame"), row.evidence
    assert row.status == status, row.evidence


def test_a_cause_that_no_intervention_prevents_is_unverified(tmp_path: Path) -> None:
    """Holding a block cannot keep it from being near the floor."""
    beats = {
        "low": beat("b", Displacement(entity="b", max=0.5), frames=(0, 24)),
        "slide": beat("b", Displacement(entity="b", min=0.05), frames=(1, 24), causes=["low"]),
    }
    row = only(simulate(tmp_path, pushed(beats=beats)))
    assert row.status == "unverified"
    assert "prevents low" in row.evidence["explanation"]
    asks, other = row.corrections
    assert (asks.patch[0]["path"], other.patch[0]["path"]) == ("/story/beats/low/predicate", "/story/beats/slide/causes/0")
    mended = WorldSpec.model_validate(apply_patch(pushed(beats=beats).model_dump(mode="json"), list(asks.patch)))
    (tmp_path / "mended").mkdir()
    again = only(simulate(tmp_path / "mended", mended))
    assert again.status == "pass", again.evidence
    bare = WorldSpec.model_validate(apply_patch(pushed(beats=beats).model_dump(mode="json"), list(other.patch)))
    assert bare.story.beats["slide"].causes == []


def test_a_cause_of_what_cannot_move_is_to_be_replaced_by_a_beat_of_what_does(tmp_path: Path) -> None:
    beats = {
        "lies": beat("floor", Speed(entity="floor", max=1.0), frames=(0, 24)),
        "slide": beat("b", Displacement(entity="b", min=0.05), frames=(1, 24), causes=["lies"]),
    }
    row = only(simulate(tmp_path, pushed(beats=beats)))
    assert row.status == "unverified"
    assert "no body of it moves" in row.evidence["explanation"]
    (found,) = row.corrections
    assert "name a beat of what moves or strikes b" in found.action
    assert found.patch[0] == {"op": "remove", "path": "/story/beats/slide/causes/0"}


def test_where_holding_the_subject_is_not_enough_all_bodies_of_the_cause_are_held(tmp_path: Path) -> None:
    beats = {
        "both": beat("b", And(of=[Contact(a="a", b="b"), Speed(entity="a", min=0.1)]), frames=(1, 20)),
        "slide": beat("b", Displacement(entity="b", min=0.05), frames=(1, 24), causes=["both"]),
    }
    row = only(simulate(tmp_path, pushed(beats=beats)))
    assert row.status == "pass"
    assert row.evidence["not_enough"] == ["b held from frame 3 on"]
    assert "held" in row.evidence["intervention"]


ROD = {"arm": box(0.4, 0.04, 0.04, motion="dynamic", at=(0.2, 0, 0.5))}
HINGE = {"pin": HingeJoint(child="arm", anchor=(0, 0, 0.5), axis=(0, 1, 0))}
DRIVERS: dict[str, tuple[dict[str, Any], dict[str, Any], Any, dict[str, Any]]] = {
    "release": (
        {"a": ball(0.05, motion="dynamic", at=(0, 0, 0.5))},
        {},
        ReleaseDriver(entity="a", time=0.2),
        {"cause": Speed(entity="a", min=0.3), "effect": Contact(a="a", b="floor")},
    ),
    "force": (
        {"a": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.051))},
        {},
        ForceDriver(entity="a", force=(6, 0, 0), start=0.1, end=0.4),
        {"cause": Speed(entity="a", min=0.3), "effect": Displacement(entity="a", min=0.1)},
    ),
    "path": (
        {
            "a": box(0.1, 0.1, 0.1, motion="kinematic", at=(0, 0, 0.06)),
            "b": box(0.1, 0.1, 0.1, motion="dynamic", at=(0.13, 0, 0.051)),
        },
        {},
        PathDriver(
            entity="a",
            keys={
                "k0": {"time": 0.2, "pose": {"position": (0, 0, 0.06)}},
                "k1": {"time": 0.8, "pose": {"position": (0.2, 0, 0.06)}},
            },  # type: ignore[arg-type]
        ),
        {"cause": Displacement(entity="a", min=0.01), "effect": Displacement(entity="b", min=0.1)},
    ),
    "motor": (
        {"arm": box(0.4, 0.04, 0.04, motion="dynamic", at=(0.2, 0, 0.5))},
        {"pin": HingeJoint(child="arm", anchor=(0.2, 0, 0.5), axis=(0, 1, 0))},
        MotorDriver(joint="pin", velocity=2.0, max_effort=1.0, start=0.1, end=1.0),
        {"cause": JointAngle(joint="pin", min=0.1), "effect": Tilts(entity="arm", min=0.5)},
    ),
    "detach": (
        {"a": ball(0.05, motion="dynamic", at=(0, 0, 0.5))},
        {"glue": WeldJoint(child="a", anchor=(0, 0, 0.5))},
        DetachDriver(joint="glue", time=0.2),
        {"cause": Speed(entity="a", min=0.3), "effect": Contact(a="a", b="floor")},
    ),
}


@pytest.mark.parametrize("kind", sorted(DRIVERS))
def test_a_driver_is_taken_away(kind: str, tmp_path: Path) -> None:
    entities, joints, driver, predicates = DRIVERS[kind]
    subject = "arm" if "arm" in entities else "a"
    beats = {
        "cause": beat(subject, predicates["cause"], frames=(2, 22), owner="d"),
        "effect": beat("b" if "b" in entities else subject, predicates["effect"], frames=(2, 24), causes=["cause"]),
    }
    spec = world({"floor": ground(), **entities}, joints=joints, drivers={"d": driver}, beats=beats, frames=N, materials=SLICK)
    row = only(simulate(tmp_path, spec))
    assert (row.status, row.evidence["intervention"]) == ("pass", "driver d is taken away"), row.evidence


# ---------------------------------------------------------------- which runs it takes


def test_one_run_serves_all_effects_of_a_cause(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    beats = {
        "hit": beat("b", Contact(a="a", b="b"), frames=(1, 20)),
        "slide": beat("b", Displacement(entity="b", min=0.05), frames=(1, 22), causes=["hit"]),
        "fast": beat("b", Speed(entity="b", min=0.2), frames=(1, 24), causes=["hit"]),
    }
    candidate = simulate(tmp_path, pushed(beats=beats))
    calls = []

    def counted(*args: Any, **more: Any) -> Candidate:
        calls.append(more)
        return run_variant(*args, **more)

    monkeypatch.setattr(reruns, "run_variant", counted)
    assert [r.status for r in check(candidate)] == ["pass", "pass"]
    assert [c["end"] for c in calls] == [24]


def test_judging_writes_nothing(tmp_path: Path) -> None:
    candidate = simulate(tmp_path, pushed())
    before = {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*")}
    check(candidate)
    assert {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*")} == before


def test_equal_worlds_give_equal_rows(tmp_path: Path) -> None:
    rows = [only(simulate(tmp_path / n, pushed())) for n in "ab"]
    assert rows[0] == rows[1]


def test_progress_tells_rows_and_frames(tmp_path: Path) -> None:
    told: list[tuple[float, float, str]] = []
    check(simulate(tmp_path, pushed()), lambda *report: told.append(report))
    done = [d / n for d, n, _ in told]
    assert done == sorted(done)
    assert (done[0], done[-1]) == (0.0, 1.0)
    assert len(told) == 25
    assert told[-1][2] == "checking causal: slide without hit, rigid: frame 24 of 24"


# ---------------------------------------------------------------- missing evidence


def test_caches_without_checkpoints_are_unverified(tmp_path: Path) -> None:
    candidate = make_candidate(tmp_path, pushed(), tracks={})
    assert only(candidate).status == "unverified"
    simulated = simulate(tmp_path / "s", pushed())
    for path in (tmp_path / "s").rglob("*.bin"):
        path.unlink()
    row = only(simulated)
    assert row.status == "unverified"
    assert "no checkpoint" in row.evidence["explanation"]


def test_a_damaged_checkpoint_is_missing_evidence(tmp_path: Path) -> None:
    candidate = simulate(tmp_path, pushed())
    for path in tmp_path.rglob("*.bin"):
        path.write_bytes(b"nothing")
    assert only(candidate).status == "unverified"


@pytest.mark.parametrize(("impulse", "least", "absent"), [(0.0, 5.0, "fly"), (1e6, 0.0, "hit")])
def test_a_row_whose_beat_never_came_names_the_row_that_it_follows_from(
    tmp_path: Path, impulse: float, least: float, absent: str
) -> None:
    beats = {
        "hit": beat("b", Contact(a="a", b="b", min_impulse=impulse), frames=(1, 20)),
        "fly": beat("b", Displacement(entity="b", min=least), frames=(1, 24), causes=["hit"]),
    }
    candidate = simulate(tmp_path, pushed(beats=beats))
    row = diagnose(only(candidate), candidate.spec)
    assert (row.status, row.evidence["follows"]) == ("unverified", f"beat:{absent}")
    assert f"this row follows from beat:{absent}" in row.evidence["explanation"]
    assert row.corrections == ()  # more frames would not help
    assert f"row='beat:{absent}'" in concise(brief(row))["look"]


# ---------------------------------------------------------------- where it is judged


def test_rows_are_judged_at_the_probe_and_kept_by_the_bake(tmp_path: Path) -> None:
    candidate = simulate(tmp_path, pushed())
    wanted = {"causal:hit:slide", "causal:without:hit:slide"}
    assert {r.id for r in run_checks(candidate, only=["causal"])} == wanted
    full = Candidate(tmp_path, candidate.spec, candidate.built, "full", candidate.caches, "run", candidate.digest)
    assert {r.id for r in run_checks(full, only=["causal"])} == {"causal:hit:slide"}
    assert {r.id for r in run_checks(full, only=["causal"], reruns=True)} == wanted
    assert row_ids(candidate.spec) == rerun_ids(candidate.spec) == {"causal:without:hit:slide"}


def test_nothing_is_simulated_again_while_the_motion_itself_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    beats = {
        "hit": beat("b", Contact(a="a", b="b"), frames=(1, 20)),
        "slide": beat("b", Displacement(entity="b", min=0.05), frames=(1, 24), causes=["hit"]),
        "far": beat("b", Displacement(entity="b", min=50.0), frames=(1, 24)),
    }
    candidate = simulate(tmp_path, pushed(beats=beats))
    monkeypatch.setattr(reruns, "run_variant", lambda *a, **k: pytest.fail("a variant was simulated"))
    rows = {r.id: r for r in run_checks(candidate, only=["beat", "causal"], reruns=True)}
    assert (rows["beat:far"].status, rows["causal:hit:slide"].status) == ("fail", "pass")
    late = rows["causal:without:hit:slide"]
    assert (late.status, late.evidence["follows"]) == ("unverified", "beat:far")
    assert "not simulated while beat:far fails" in late.evidence["explanation"]
