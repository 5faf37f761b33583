"""Touches between solids and grains: from the record of what the grains gave each solid, in a world that was simulated."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.testing.worlds.small_grains import SAND_PROMPT, sand_spec
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.categories.registry import pressed
from worldagent.verifiers.story.onsets import begins
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import EvidenceError
from worldagent.worlds.predicates import Contact, NoContact
from worldagent.worlds.spec import WorldSpec

FRAMES = 8
END = (1, FRAMES - 1)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """A ball falls into sand in a tray."""
    spec = sand_spec(radius=0.014, depth=0.12, frames=FRAMES, ball_at=0.21, young=2e5, preroll=0.0)
    return simulate(tmp_path_factory.mktemp("sand"), WorldSpec.model_validate({"prompt": SAND_PROMPT, **spec}))


def landing(run: Candidate) -> int:
    """Frame at which the ball first has less speed than free fall gives it."""
    fps, cache = run.spec.simulation.fps, run.caches["bodies"]
    speed = -np.asarray(cache.series("velocity"))[:, cache.index.bodies.index("ball/body"), 2]
    return int(np.argmax(speed < 9.81 * np.arange(FRAMES) / fps - 0.02))


@pytest.mark.parametrize("pair", [("ball", "sand"), ("sand", "ball")])
def test_a_ball_that_falls_into_sand_touches_it_from_its_landing_on(run: Candidate, pair: tuple[str, str]) -> None:
    a, b = pair
    first = landing(run)
    assert 2 < first < FRAMES - 1
    touched = evaluate(run, Contact(a=a, b=b), END)
    assert (touched.status, touched.first_true_frame) == ("pass", first)
    assert evaluate(run, Contact(a=a, b=b), (1, first - 1)).status == "fail"
    never = evaluate(run, NoContact(a=a, b=b), END)
    assert (never.status, never.first_failing_frame) == ("fail", first)
    assert evaluate(run, NoContact(a=a, b=b), (1, first - 1)).status == "pass"
    assert begins(run, a, b, END) == pytest.approx((first - 1) / run.spec.simulation.fps)


def test_the_impulse_that_is_asked_for_is_what_the_ball_lost(run: Candidate) -> None:
    cache = run.caches["bodies"]
    speed = np.asarray(cache.series("velocity"))[:, cache.index.bodies.index("ball/body"), 2]
    mass = sum(b.mass for b in run.entity("ball").bodies)
    fell = 9.81 * (FRAMES - 1) / run.spec.simulation.fps
    lost = mass * float(speed[-1] + fell)
    assert pressed(run, "ball", "sand").sum() == pytest.approx(lost, rel=0.05)
    assert evaluate(run, Contact(a="ball", b="sand", min_impulse=0.9 * lost), END).status == "pass"
    assert evaluate(run, Contact(a="ball", b="sand", min_impulse=1.2 * lost), END).status == "fail"


def test_a_ball_that_the_record_says_was_never_pressed_touches_no_sand(run: Candidate, tmp_path: Path) -> None:
    def untouched(k: int, data: dict[str, np.ndarray]) -> None:
        data["exchange/impulse"][:] = 0.0

    apart = edited(run, tmp_path, "grains", untouched)
    outcome = evaluate(apart, Contact(a="ball", b="sand"), END)
    assert (outcome.status, outcome.first_failing_entity) == ("fail", "ball")
    assert "never touch" in outcome.explanation
    assert evaluate(apart, NoContact(a="ball", b="sand"), END).status == "pass"


def test_a_solid_that_the_grains_do_not_meet_is_named(run: Candidate) -> None:
    with pytest.raises(EvidenceError, match="'nobody' is none of the solids that 'sand' meets"):
        pressed(run, "sand", "nobody")
