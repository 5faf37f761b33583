"""`beat:driven`: what starts a beat, in words that are true of its status (R97, R156)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, box, ground, make_candidate, pose, world
from worldagent.verifiers.story.beats import check
from worldagent.worlds.audits.story import story_problems
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import And, Contact, Count, Displacement, Speed
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, BoxRegion, FieldDriver, ForceDriver, PathDriver, PathKey, ReleaseDriver

FRAMES = 25
TIME = np.arange(FRAMES) / 24
FAR = Displacement(entity="cube", min=0.3)
"""Comes true at frame 8 of a motion that starts at frame 0, at 20 of one that starts at frame 12."""
PUSH = ForceDriver(entity="cube", force=(5, 0, 0), start=0.1, end=0.3)
ROLL = ForceDriver(entity="ball", force=(1, 0, 0), start=0.1, end=0.3)
REGIONS = {"cart": BoxRegion(min=(-1, -1, 0), max=(1, 1, 1), relative_to="cart")}


def beat(predicate: Any = FAR, subject: str = "cube", **more: Any) -> Beat:
    owner = more.pop("owner", "rigid")
    return Beat(text="it happens", owner=owner, subject=subject, frames=(1, FRAMES - 1), predicate=predicate, **more)


def moving(
    tmp_path: Path,
    beats: dict[str, Beat],
    *,
    start: float = 0.5,
    speed: float = 0.0,
    rest: tuple[float, float] = (9, 9),
    **more: Any,
) -> Candidate:
    """A cube that slides at 1 m/s from `start` [s] on, and not during `rest` [s]; its declared speed [m/s]; a ball that stays."""
    entities = {
        "floor": ground(),
        "cube": box(0.2, 0.2, 0.2, motion=more.pop("motion", "dynamic"), at=(0, 0, 0.1), velocity=(speed, 0, 0)),
        "ball": ball(0.1, motion="dynamic", at=(0, 2, 0.1)),
        "cart": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 4, 0.1)),
    }
    spec = world(entities, frames=FRAMES, beats=beats, regions=REGIONS, **more)
    x = np.clip(TIME - start, 0, None) - np.clip(TIME - rest[0], 0, rest[1] - rest[0])
    track = (np.stack([x, 0 * x, 0 * x + 0.1], axis=1), IDENTITY)
    moved = np.concatenate([np.diff(x), np.diff(x)[-1:]]) * 24
    velocity = np.zeros((FRAMES, 3, 3))
    velocity[:, 0, 0] = moved
    return make_candidate(tmp_path, spec, tracks={"cube": track}, channels={"velocity": velocity})


def driven(candidate: Candidate, name: str = "b") -> Row:
    return next(r for r in check(candidate) if r.id == f"beat:driven:{name}")


CASES: dict[str, tuple[dict[str, Beat], dict[str, Any], str, str, str]] = {
    # beats, world, status, what was found, words
    "of causes": ({"a": beat(Speed(entity="cube", min=0.5)), "b": beat(causes=["a"])}, {"speed": 1.0}, "pass", "causes", "moved by a solver, from a"),
    "of a lasting state": ({"b": beat(Speed(entity="cube", max=2, when="always"))}, {}, "pass", "state", "lasting state of cube"),
    "of its own driver": ({"b": beat(owner="push")}, {"drivers": {"push": PUSH}}, "pass", "driver", "driver push acts from 0.1 s on and owns b"),
    "of another beat's driver": ({"b": beat(), "other": beat(owner="push")}, {"drivers": {"push": PUSH}}, "pass", "driver", "which beat other owns"),
    "of a start velocity": ({"b": beat()}, {"speed": 1.0}, "pass", "velocity", "cube starts with the velocity"),
    "of weight": ({"b": beat()}, {"start": 0.0}, "pass", "weight", "in motion from frame 0 up to frame 8"),
    "of a body that it speaks of": ({"b": beat(Contact(a="ball", b="cube"), "ball")}, {"speed": 1.0}, "pass", "velocity", "cube starts"),
    "on a path": ({"b": beat()}, {"motion": "kinematic"}, "fail", "path", "an authored motion, so beat b is staged"),
    "of an unsaid driver": ({"b": beat()}, {"drivers": {"push": PUSH}}, "fail", "unsaid", "no beat is owned by push"),
    "unsaid beside a start velocity": ({"b": beat()}, {"drivers": {"push": PUSH}, "speed": 1.0}, "fail", "unsaid", "no beat is owned by push"),
    "unsaid beside causes": (
        {"a": beat(Speed(entity="cube", min=0.5)), "b": beat(causes=["a"])}, {"drivers": {"push": PUSH}, "speed": 1.0}, "fail", "unsaid",
        "no beat that leads to it is owned by push",
    ),
    "of a late driver": (
        {"b": beat(owner="push")}, {"drivers": {"push": PUSH.model_copy(update={"start": 0.9, "end": 1.0})}}, "fail", "late",
        "before its driver acts",
    ),
    "of a driver that adds next to nothing": (
        {"b": beat(owner="push")}, {"drivers": {"push": PUSH.model_copy(update={"force": (1e-6, 0.0, 0.0)})}, "speed": 1.0}, "fail", "idle",
        "an initial state, not the force",
    ),
    "of its own driver beside a start velocity": ({"b": beat(owner="push")}, {"drivers": {"push": PUSH}, "speed": 0.1}, "pass", "driver", "owns b"),
    "of nothing": ({"b": beat()}, {}, "fail", "none", "beat 'b' has no cause and nothing that the story owns starts it"),
    "after a rest": ({"b": beat()}, {"start": 0.0, "rest": (0.1, 0.6)}, "fail", "none", "none moves from frame 0 on"),
    "of still air": ({"b": beat()}, {"drivers": {"air": FieldDriver.model_validate({"field": {"kind": "drag"}})}}, "fail", "none", "nothing that the story owns"),
    "of a path in a part of it": (
        {"b": beat(And(of=[FAR, Speed(entity="ball", max=9)]), "ball")}, {"motion": "kinematic"}, "fail", "path", "so its part in beat b is staged",
    ),
    "of a count of which one is on a path": (
        {"b": beat(Count(entities=["cube", "ball"], predicate=Displacement(entity="each", min=0.3), min=2), "ball")},
        {"motion": "kinematic"}, "fail", "path", "cube follows an authored motion",
    ),
    "of its own driver, and of an unsaid one of another body": (
        {"b": beat(And(of=[FAR, Displacement(entity="ball", min=0.3)]), "ball", owner="roll")}, {"drivers": {"roll": ROLL, "push": PUSH}}, "fail",
        "unsaid", "driver push acts on cube from 0.1 s on, before b comes true, and no beat is owned by push",
    ),
    "of its own driver, and of another beat's": (
        {"b": beat(And(of=[FAR, Displacement(entity="ball", min=0.3)]), "ball", owner="roll"), "other": beat(owner="push")},
        {"drivers": {"roll": ROLL, "push": PUSH}}, "pass", "driver", "driver roll acts from 0.1 s on and owns b",
    ),
    "of a driver of what it speaks of": (
        {"b": beat(Contact(a="ball", b="cube"), "ball")}, {"drivers": {"push": PUSH}}, "fail", "none", "no beat is owned by push",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_the_row_says_what_was_found(tmp_path: Path, name: str) -> None:
    beats, more, status, kind, words = CASES[name]
    row = driven(moving(tmp_path, beats, **more))
    said = str(row.evidence["explanation"])
    assert (row.status, row.evidence["trigger"]) == (status, kind), said
    assert words in said
    assert bool(row.corrections) == (status == "fail")
    if status == "pass":
        assert not any(word in said + row.predicate for word in ("leaves out", "no beat", "staged", "nothing", "not by"))


def test_every_fault_names_what_to_do(tmp_path: Path) -> None:
    row = driven(moving(tmp_path / "a", {"b": beat()}))
    assert [c.pointers[0] for c in row.corrections][:2] == ["/story/beats/b/causes", "/story/beats/b/owner"]
    row = driven(moving(tmp_path / "b", {"b": beat()}, drivers={"push": PUSH}))
    assert row.corrections[0].action == "let push own beat b (/story/beats/b/owner), or take push away"


def test_a_short_run_leaves_open_what_moves_by_itself(tmp_path: Path) -> None:
    late = beat().model_copy(update={"frames": (1, 40)})
    assert driven(moving(tmp_path / "a", {"b": late})).status == "unverified"
    assert driven(moving(tmp_path / "b", {"b": late}, speed=1.0)).status == "pass"


@pytest.mark.parametrize(("start", "status"), [(0.1, "fail"), (1.5, "pass")])
def test_a_run_that_goes_on_is_not_accused_of_what_acts_after_its_last_frame(tmp_path: Path, start: float, status: str) -> None:
    """A beat that may still come true before an unsaid driver acts (a draught after the candle is lit) is judged by what has acted so far."""
    slides = beat(Speed(entity="cube", min=0.5))
    later = beat(causes=["a"]).model_copy(update={"frames": (1, 40)})
    push = ForceDriver(entity="cube", force=(5, 0, 0), start=start, end=start + 0.1)
    row = driven(moving(tmp_path, {"a": slides, "b": later}, start=0.95, speed=1.0, drivers={"push": push}))
    assert row.status == status, row.evidence["explanation"]


def test_a_trigger_on_a_path_is_an_input_and_has_no_row(tmp_path: Path) -> None:
    keys = {"a": PathKey(time=0, pose=pose((0, 0, 0.1))), "b": PathKey(time=1, pose=pose((1, 0, 0.1)))}
    beats = {"b": beat(owner="rail"), "follows": beat(Speed(entity="ball", min=1), "ball", causes=["b"])}
    rows = check(moving(tmp_path, beats, motion="kinematic", drivers={"rail": PathDriver(entity="cube", keys=keys)}))
    assert "beat:driven:b" not in {r.id for r in rows}


def test_the_audit_tells_of_an_unsaid_driver_of_a_beat_without_causes(tmp_path: Path) -> None:
    """As soon as it is sure to act: from the specification alone."""
    let_go = {"let_go": ReleaseDriver(entity="cube", time=0.0)}
    (problem,) = story_problems(moving(tmp_path / "a", {"b": beat()}, drivers=let_go).spec)
    assert problem.pointer == "/story/beats/b/owner"
    assert "release let_go lets cube go at 0 s" in problem.text
    assert "let let_go own beat b" in problem.text
    for beats in ({"b": beat(owner="let_go")}, {"a": beat(owner="let_go"), "b": beat()}):
        assert not story_problems(moving(tmp_path / str(len(beats)), beats, drivers=let_go).spec)
