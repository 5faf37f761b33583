"""Buries: grains that come to lie on a body, not beside it, past it, or on it all the time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.testing.worlds.small_grains import SAND_PROMPT, sand_spec
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.arrays import F64
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.categories.particles.events import BuryEvent
from worldagent.worlds.spec import WorldSpec

FRAMES, RADIUS, BALL = 4, 0.014, 0.025
COME = 2
"""Frame at which the grains are where they end."""
Frame = dict[str, Any]


def sand(folder: Path) -> Candidate:
    """Sand in a tray and a ball, whose places the tests write anew."""
    spec = sand_spec(radius=RADIUS, depth=0.05, frames=FRAMES, ball_at=0.12, young=2e5, preroll=0.0)
    return simulate(folder, WorldSpec.model_validate({"prompt": SAND_PROMPT, **spec}))


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    return sand(tmp_path_factory.mktemp("sand"))


def layer(count: int, *, beside: float = 0.0) -> F64:
    """Grains side by side at the height at which they lie on a ball on the floor, so far beside it [m]."""
    side = int(np.ceil(np.sqrt(count)))
    k = np.arange(count)
    pitch = 2 * RADIUS
    return np.stack(
        [(k % side - side // 2) * pitch + beside, (k // side - side // 2) * pitch, np.full(count, 2 * BALL + RADIUS)], axis=1
    )


def laid(
    run: Candidate, folder: Path, *, come: int = COME, beside: float = 0.0, half: bool = False, speed: float = 0.0
) -> Candidate:
    """The run with its ball at rest on the floor and its grains on it from a frame on."""

    def grains(k: int, data: Frame) -> None:
        count = len(data["particle/id"])
        place = layer(count, beside=beside) if k >= come else layer(count, beside=1.0)
        if half:
            place[place[:, 0] > -0.001] += [1.0, 0.0, 0.0]
        data["particle/position"] = (place - data["origin"]).astype(np.float32)
        data["particle/velocity"] = np.tile(np.array([0.0, 0.0, -speed], dtype=np.float32), (count, 1))

    def ball(k: int, data: Frame) -> None:
        data["position"][:] = [0.0, 0.0, BALL]
        data["velocity"][:] = 0.0

    still = edited(run, folder / "ball", "bodies", ball)
    return edited(still, folder / "sand", "grains", grains)


def judged(run: Candidate, folder: Path, **how: Any) -> Outcome:
    bound = {"min": how.pop("min")} if "min" in how else {}
    event = BuryEvent.model_validate({"kind": "buries", "entity": "sand", "other": "ball", **bound})
    return evaluate(laid(run, folder, **how), event, (0, FRAMES - 1))


def test_grains_that_come_to_lie_on_a_ball_bury_it(run: Candidate, tmp_path: Path) -> None:
    found = judged(run, tmp_path)
    assert (found.status, found.value, found.first_true_frame) == ("pass", 1.0, COME), found.explanation


@pytest.mark.parametrize(
    "other",
    [{"beside": 0.3}, {"half": True}, {"speed": 2.0}, {"come": 0}, {"come": FRAMES}],
    ids=["beside it", "on half of it", "flying past", "on it all the time", "at rest elsewhere"],
)
def test_grains_elsewhere_or_from_the_start_do_not_bury_it(run: Candidate, tmp_path: Path, other: dict[str, Any]) -> None:
    assert judged(run, tmp_path, **other).status == "fail"


def test_what_is_no_rigid_body_is_no_evidence(run: Candidate) -> None:
    event = BuryEvent(kind="buries", entity="sand", other="sand")
    assert evaluate(run, event, (0, 1)).status == "unverified"
