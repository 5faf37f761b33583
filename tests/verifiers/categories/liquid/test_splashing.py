"""Splashes: what the impact of the named body throws up, and not what rises by itself or round a body that goes in slowly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.worlds.bodies_in_liquid import EDGE, crate_in_tank
from worldagent.testing.worlds.liquid_worlds import Flow, G
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.arrays import F64
from worldagent.worlds.categories.liquid.events import SplashEvent

FRAMES, DEPTH, HIT = 18, 0.2, 6
SPLASHES = SplashEvent(kind="splashes", entity="pool", other="crate")
THROWN = 2.0
"""[m/s] upwards of what is thrown: it rises by 0.2 m."""


def drop(*, speed: float = 2.0) -> F64:
    """Heights of a crate that comes down onto the water at a speed and goes on slowly under it."""
    k = np.arange(FRAMES) - HIT
    surface = DEPTH + EDGE / 2
    return np.where(k < 0, surface - speed * k / 24, np.maximum(surface - 0.3 * (k + 1) / 24, EDGE))


def thrown(flow: Flow, count: int = 40, at: int = HIT) -> Flow:
    """Some of the uppermost water beside the crate goes up and falls back."""
    out = flow.edited()
    for k in range(at, FRAMES):
        x = out.position[k]
        side = (np.abs(x[:, 0]) > EDGE / 2) & (np.abs(x[:, 0]) < 0.15)
        rows = np.flatnonzero(side & (x[:, 2] > DEPTH - 0.03))[:count]
        t = (k - at + 1) / 24
        x[rows, 2] += max(THROWN * t - 0.5 * G * t * t, 0.0)
    return out


def judged(flow: Flow, folder: Path, event: SplashEvent = SPLASHES) -> Outcome:
    return evaluate(flow.candidate(folder), event, (0, FRAMES - 1))


def struck(*, speed: float = 2.0) -> Flow:
    """The crate with what the water gives it: nothing while it is in the air."""
    flow = crate_in_tank(drop(speed=speed), density=900.0, depth=DEPTH)
    row = flow.colliders.index("crate/body")
    flow.share[row][:HIT] = 0.0
    return flow


def test_a_crate_that_strikes_the_water_and_throws_it_up_splashes(tmp_path: Path) -> None:
    found = judged(thrown(struck()), tmp_path)
    assert found.status == "pass", found.explanation
    assert found.first_true_frame in range(HIT, HIT + 4)
    assert found.value == pytest.approx(0.2 / (EDGE / 2), abs=0.6)
    assert judged(thrown(struck()), tmp_path / "b", SPLASHES.model_copy(update={"min": 9.0})).status == "fail"


def test_a_crate_that_goes_in_without_throwing_water_up_does_not_splash(tmp_path: Path) -> None:
    assert judged(struck(), tmp_path).status == "fail"


def test_seven_drops_are_no_splash(tmp_path: Path) -> None:
    assert judged(thrown(struck(), count=7), tmp_path).status == "fail"


def test_water_that_rises_beside_a_crate_that_is_let_in_slowly_is_no_splash(tmp_path: Path) -> None:
    assert judged(thrown(struck(speed=0.2)), tmp_path).status == "fail"


def test_water_that_rises_before_the_crate_comes_is_not_its_splash(tmp_path: Path) -> None:
    early = thrown(struck(), at=0)
    found = evaluate(early.candidate(tmp_path), SPLASHES, (0, HIT - 1))
    assert (found.status, found.details["struck_at"]) == ("fail", [])


def test_a_crate_at_rest_throughout_does_not_splash(tmp_path: Path) -> None:
    assert judged(thrown(crate_in_tank(np.full(FRAMES, DEPTH))), tmp_path).status == "fail"


def test_a_body_that_the_liquid_does_not_meet_is_no_evidence(tmp_path: Path) -> None:
    found = judged(struck(), tmp_path, SplashEvent(kind="splashes", entity="pool", other="nobody"))
    assert found.status == "unverified"
