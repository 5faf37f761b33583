"""Pushes of a liquid and its coming to rest, on motions in closed form whose impulses are known."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.bodies_in_liquid import EDGE, crate_in_tank
from worldagent.testing.worlds.liquid_worlds import Flow, G
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.predicates import BodyEvent, PairEvent
from worldagent.worlds.spec import Requirement

FRAMES = 37
FPS = 24
AFLOAT = 0.2
"""Height of the middle of a crate of half the water's density: that of the surface [m]."""
DEPTH = 0.2
PUSHES = PairEvent(kind="pushes", entity="pool", other="crate")
STOPS = BodyEvent(kind="stops", entity="pool")


def judged(flow: Flow, folder: Path, event: Any = PUSHES) -> Outcome:
    return evaluate(flow.candidate(folder), event, (0, flow.frames - 1))


def driven(speed: float, *, by_liquid: float = 1.0, frames: int = FRAMES) -> Flow:
    """A floating crate that is brought from rest to a level speed over all frames, by the liquid for a share of the impulse."""
    times = np.arange(frames) / FPS
    flow = crate_in_tank(np.full(frames, AFLOAT))
    mass, gain = 500.0 * EDGE**3, speed / times[-1]
    track = np.stack([0.5 * gain * times**2, 0 * times, np.full(frames, AFLOAT)], axis=1)
    row = flow.colliders.index("crate/body")
    push = flow.share[row].copy()
    push[1:, 0] += by_liquid * mass * gain / FPS
    velocity = np.stack([gain * times, 0 * times, 0 * times], axis=1)[:, None]
    rotation = np.array(flow.tracks["crate"][1])
    return flow.edited(
        share={row: push},
        tracks={"crate": (track, rotation)},
        rigid={"exchange/impulse": push[:, None], "velocity": velocity},
    )


def test_water_that_drives_a_crate_along_pushes_it(tmp_path: Path) -> None:
    found = judged(driven(0.3), tmp_path)
    assert (found.status, found.unit) == ("pass", "m"), found.explanation
    assert found.value == pytest.approx(0.5 * 0.3 * (FRAMES - 1) / FPS, rel=0.1), "the whole way"


def test_water_that_only_bears_a_crate_pushes_nothing(tmp_path: Path) -> None:
    """It gives it its whole weight upward all the time."""
    assert judged(crate_in_tank(np.full(FRAMES, AFLOAT)), tmp_path).status == "fail"
    rising = AFLOAT + 0.05 * np.sin(np.pi * np.arange(FRAMES) / (FRAMES - 1))
    assert judged(crate_in_tank(rising), tmp_path / "bobs").status == "fail"


def test_water_that_helps_a_little_does_not_push_what_something_else_drives(tmp_path: Path) -> None:
    found = judged(driven(0.3, by_liquid=0.2), tmp_path)
    assert (found.status, found.bound, found.value) == ("fail", 0.5, pytest.approx(0.2, abs=0.05)), found.explanation
    assert judged(driven(0.3, by_liquid=0.8), tmp_path / "most").status == "pass"


def test_water_that_brakes_a_crate_does_not_push_it(tmp_path: Path) -> None:
    assert judged(driven(0.3, by_liquid=-1.0), tmp_path).status == "fail"


def moving(speeds: np.ndarray) -> Flow:
    """The water of the tank at a mean speed in each frame, half of it one way and half the other."""
    flow = crate_in_tank(np.full(len(speeds), AFLOAT))
    return flow.edited(
        velocity=[np.where(p[:, :1] > 0, v, -v) * np.array([1.0, 0, 0]) for v, p in zip(speeds, flow.position, strict=True)]
    )


def test_water_that_ran_and_is_slow_for_a_second_comes_to_rest(tmp_path: Path) -> None:
    """A twentieth of sqrt(g depth) is the bound; before it ran at a half of that root."""
    pace = float(np.sqrt(G * DEPTH))
    k = np.arange(FRAMES + 24)
    found = judged(moving(np.where(k < 30, 0.5 * pace, 0.02 * pace)), tmp_path, STOPS)
    assert (found.status, found.unit) == ("pass", "s"), found.explanation
    assert found.first_true_frame == 30 + 23
    still_runs = judged(moving(np.where(k < 30, 0.5 * pace, 0.08 * pace)), tmp_path / "runs", STOPS)
    assert still_runs.status == "fail"


def test_a_turning_point_of_a_wave_is_no_rest_and_still_water_did_not_stop(tmp_path: Path) -> None:
    pace = float(np.sqrt(G * DEPTH))
    k = np.arange(FRAMES + 24)
    wave = judged(moving(0.5 * pace * np.abs(np.sin(2 * np.pi * k / 36))), tmp_path, STOPS)
    assert wave.status == "fail", wave.explanation
    assert judged(moving(np.zeros(len(k))), tmp_path / "still", STOPS).status == "fail"


@pytest.mark.parametrize(
    ("event", "refused"),
    [
        (PUSHES, False),
        (STOPS, False),
        (PairEvent(kind="pushes", entity="crate", other="pool"), True),
        (PairEvent(kind="hits", entity="pool", other="crate"), True),
    ],
    ids=["pushes", "stops", "is pushed", "hits"],
)
def test_of_a_liquid_may_be_asked_what_it_does_by_a_definition_of_its_own(event: Any, refused: bool) -> None:
    spec = crate_in_tank(np.full(2, AFLOAT)).spec.model_copy(deep=True)
    spec.story.requirements["asked"] = Requirement(text="it does", predicate=event)
    assert ("asks for a body" in str([r.evidence for r in audit(spec).rows])) == refused
