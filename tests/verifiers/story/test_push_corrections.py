"""Corrections of a push that is too brief: what they say of how two bodies part, and that the world mended so pushes."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.defects._films import film_of
from worldagent.testing.worlds.small_worlds import box, entity, ground, pose, world
from worldagent.verifiers.diagnosis.cite import diagnose
from worldagent.verifiers.predicates.evaluators import evaluate
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.verifiers.story.beat_corrections import corrections_of
from worldagent.verifiers.story.beats import check
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.predicates import PairEvent
from worldagent.worlds.requirements import Correction, Row
from worldagent.worlds.spec import Beat, ContactPair, Cylinder, Material, Part, RigidPhysics, RigidSettings, WorldSpec

RADIUS, FRAMES = 0.055, 24
ASKED = PairEvent(kind="pushes", entity="tin", other="jar")


def rolling_tin(
    *,
    speed: float,
    mass: float,
    friction: float = 0.4,
    bounce: float = 0.0,
    end: float = 5.0,
    bounce_of_pair: float | None = None,
) -> WorldSpec:
    """A tin of a mass [kg] rolls at a speed [m/s] on a shelf towards a jar of 0.35 kg, whose middle is `end` [m] before the shelf's end."""
    wood = {"wood": Material(density=600.0, friction=friction, restitution=bounce, substance="wood")}
    shape = Part(shape=Cylinder(radius=RADIUS, height=0.12), pose=pose((0, 0, 0), euler=(1.5708, 0, 0)))
    rolling = RigidPhysics(linear_velocity=(speed, 0, 0), angular_velocity=(0, speed / RADIUS, 0), mass=mass)
    entities = {
        "floor": ground(20.0),
        "shelf": box(5.0 + end, 1.0, 0.05, at=((end - 5.0) / 2, 0, 0.975)),
        "tin": entity(shape, motion="dynamic", at=(-0.2, 0, 1.0 + RADIUS + 0.0011), physics=rolling),
        "jar": entity(Cylinder(radius=0.0375, height=0.13), motion="dynamic", at=(0, 0, 1.0661), physics=RigidPhysics(mass=0.35)),
    }
    push = Beat(text="the tin pushes the jar", owner="rigid", subject="jar", frames=(0, FRAMES - 1), predicate=ASKED)
    spec = world(entities, frames=FRAMES, settings=RigidSettings(step=1e-3), materials=wood, beats={"push": push})
    if bounce_of_pair is None:
        return spec
    pair = ContactPair(a="tin", b="jar", restitution=bounce_of_pair, reason="felt is wound around the tin")
    return spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"contacts": {"felt": pair}})})


def run(spec: WorldSpec, folder: Path) -> tuple[Candidate, Outcome]:
    candidate = film_of(spec).candidate(folder)
    return candidate, evaluate(candidate, ASKED, (0, candidate.last_frame))


def advice(candidate: Candidate, outcome: Outcome) -> dict[str, Correction]:
    found = corrections_of(candidate, ASKED, outcome, "/story/beats/push", (0, candidate.last_frame))
    return {c.group: c for c in found}


def push_row(candidate: Candidate) -> Row:
    return diagnose(next(r for r in check(candidate) if r.id == "beat:push"), candidate.spec)


def test_a_push_that_spends_itself_is_told_and_the_speed_that_is_offered_makes_it_last(tmp_path: Path) -> None:
    candidate, outcome = run(rolling_tin(speed=0.3, mass=0.3), tmp_path / "a")
    assert outcome.status == "fail"
    assert "pushes it for 0.0833 s" in outcome.explanation
    assert "does not work" not in outcome.explanation
    found = advice(candidate, outcome)
    assert "spends itself" in found["initial_state"].cause
    assert "contact" not in found, "the jar does not leap ahead"
    _, mended = run(apply_patch(candidate.spec, found["initial_state"].patch), tmp_path / "b")
    assert mended.status == "pass"
    assert run(rolling_tin(speed=0.3, mass=3.0), tmp_path / "c")[1].status == "pass", "the mass that is advised"
    assert "heavier than jar" in found["mass"].action


def test_a_jar_that_leaps_ahead_asks_for_less_bounce_and_not_for_speed(tmp_path: Path) -> None:
    candidate, outcome = run(rolling_tin(speed=1.25, mass=0.4, friction=0.15, bounce=0.8), tmp_path / "a")
    found = advice(candidate, outcome)
    assert outcome.details["pushed_speed"] > 2 * outcome.details["pusher_speed"]
    assert "restitution of 0.8" in found["contact"].cause
    assert "reason" in found["contact"].action
    assert found["contact"].patch == (), "the audit asks for a reason that no patch can know"
    assert "initial_state" not in found
    mended = run(rolling_tin(speed=1.25, mass=0.4, friction=0.15, bounce=0.8, bounce_of_pair=0.0), tmp_path / "b")[1]
    assert mended.status == "pass"


def test_a_jar_pushed_over_an_edge_at_once_is_to_start_farther_from_it(tmp_path: Path) -> None:
    candidate, outcome = run(rolling_tin(speed=1.2, mass=0.8, end=0.002), tmp_path / "a")
    assert outcome.status == "fail"
    found = advice(candidate, outcome)
    told = re.search(r"start jar and tin ([\d.]+) m farther from the edge", found["placement"].action)
    assert told is not None
    assert "contact" not in found
    assert run(rolling_tin(speed=1.2, mass=0.8, end=0.002 + float(told[1])), tmp_path / "b")[1].status == "pass"


def test_bodies_that_never_meet_are_brought_together(tmp_path: Path) -> None:
    candidate, outcome = run(rolling_tin(speed=-0.5, mass=0.8), tmp_path)
    found = advice(candidate, outcome)
    assert "do not touch in these frames" in found["placement"].cause
    assert set(found) == {"placement", "initial_state"}


def test_the_row_tells_the_frames_of_the_touch_and_no_word_of_friction_or_dominoes(tmp_path: Path) -> None:
    candidate, outcome = run(rolling_tin(speed=0.3, mass=0.3), tmp_path)
    row = push_row(candidate)
    told = " ".join(f"{c.cause} {c.action}" for c in row.corrections)
    assert "domino" not in told
    assert "lower friction" not in told
    looks: list[dict[str, Any]] = row.evidence["diagnosis"]["cheapest_probe"]
    first, last = looks[0]["arguments"]["frames"]
    assert first <= outcome.details["onset"] < outcome.details["until"] <= last


@pytest.mark.parametrize(("speed", "mass"), [(1.25, 0.8), (0.5, 0.8)])
def test_a_push_that_lasts_is_true_and_tells_its_way(speed: float, mass: float, tmp_path: Path) -> None:
    outcome = run(rolling_tin(speed=speed, mass=mass), tmp_path)[1]
    assert outcome.status == "pass"
    assert outcome.explanation.startswith("tin pushes jar over")
