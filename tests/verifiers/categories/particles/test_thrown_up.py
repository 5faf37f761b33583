"""Grains that a body's impact throws up splash; grains into which it is set down do not."""

from __future__ import annotations

from pathlib import Path

import pytest
from worldagent.construction import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.small_grains import SAND_PROMPT, sand_spec
from worldagent.verifiers.predicates.evaluators import evaluate
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.categories.liquid.events import SplashEvent
from worldagent.worlds.spec import WorldSpec

FRAMES = 14
SPLASHES = SplashEvent(kind="splashes", entity="sand", other="ball")


def _run(folder: Path, ball_at: float) -> Candidate:
    """A steel ball that is let go at a height over a tray of coarse grains, whose settled bed is 6 cm deep."""
    document = {**sand_spec(radius=0.009, depth=0.07, frames=FRAMES, ball_at=ball_at, preroll=0.15), "prompt": SAND_PROMPT}
    document["entities"]["ball"] |= {
        "dimensions": {"size": [0.08, 0.08, 0.08]},
        "parts": {"body": {"shape": {"kind": "sphere", "radius": 0.04}}},
    }
    spec = WorldSpec.model_validate(document)
    built = {n: build_entity(spec, n, folder) for n in spec.entities}
    caches = run_frames(spec, built, folder / "run", frames=FRAMES)
    return Candidate(folder, spec, built, "probe", caches, "run", cache_digest(caches))


@pytest.fixture(scope="module")
def dropped(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    return _run(tmp_path_factory.mktemp("dropped"), 0.65)


def test_a_ball_that_falls_into_grains_throws_some_up(dropped: Candidate) -> None:
    found = evaluate(dropped, SPLASHES, (0, FRAMES - 1))
    assert found.status == "pass", found.explanation
    assert found.details["body"] == "ball"
    struck = found.details["struck_at"][0]
    assert found.first_true_frame is not None
    assert found.first_true_frame >= struck > 4


def test_a_ball_that_is_not_yet_there_throws_nothing_up(dropped: Candidate) -> None:
    assert evaluate(dropped, SPLASHES, (0, 5)).status == "fail"


def test_a_ball_that_is_let_go_on_the_grains_throws_none_up(tmp_path: Path) -> None:
    found = evaluate(_run(tmp_path, 0.1), SPLASHES, (0, FRAMES - 1))
    assert found.status == "fail"
