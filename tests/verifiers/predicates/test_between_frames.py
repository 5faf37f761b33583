"""Denied events between two written frames."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, ground, make_candidate, world
from worldagent.verifiers.predicates.evaluators import evaluate
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.predicates import Crosses, Displacement, Not, Or, Reaches, Tilts
from worldagent.worlds.spec import BoxRegion

FRAMES = 9


def never(
    folder: Path, predicate: Any, *, fps: int, place: Any, spin: float = 0.0, low: float = 0.48, high: float = 0.52
) -> Outcome:
    time = np.arange(FRAMES) / fps
    position = np.array([place(t) for t in time])
    channels = {
        "velocity": np.array([(np.array(place(t + 1e-6)) - np.array(place(t - 1e-6))) / 2e-6 for t in time])[:, None],
        "angular_velocity": np.tile([0.0, spin, 0.0], (FRAMES, 1, 1)),
    }
    line = BoxRegion(min=(low, -1, -1), max=(high, 1, 3))
    spec = world({"floor": ground(), "b": ball(0.1, motion="dynamic", at=tuple(position[0]))}, frames=FRAMES, fps=fps)
    spec = spec.model_copy(update={"graph": spec.graph.model_copy(update={"regions": {"line": line}})})
    candidate = make_candidate(folder, spec, tracks={"b": (position, IDENTITY)}, channels=channels)
    return evaluate(candidate, Not(predicate=predicate), (0, FRAMES - 1))


def along(speed: float, start: float = 0.0) -> Any:
    return lambda t: (start + speed * t, 0.0, 0.1)


@pytest.mark.parametrize("nested", [False, True])
def test_a_body_that_jumps_over_a_region_from_frame_to_frame_has_been_in_it(tmp_path: Path, nested: bool) -> None:
    asked: Any = Reaches(entity="b", region="line")
    outcome = never(tmp_path, Or(of=[asked, asked]) if nested else asked, fps=4, place=along(1.4))
    assert outcome.status == "fail"
    assert outcome.first_failing_frame == 2  # x = 0.35 and 0.70
    assert "from frame 1 to frame 2" in outcome.explanation


@pytest.mark.parametrize("speed", [0.0, 0.2, -1.4])
def test_a_body_that_keeps_away_from_the_region_holds_the_negation(tmp_path: Path, speed: float) -> None:
    assert never(tmp_path, Reaches(entity="b", region="line"), fps=4, place=along(speed)).status == "pass"


def test_a_throw_over_a_plane_and_back_between_frames_is_seen_on_its_parabola(tmp_path: Path) -> None:
    def thrown(t: float) -> tuple[float, float, float]:
        return 0.0, 0.0, 1.0 + 2.4 * (t - 0.1) - 4.905 * (t - 0.1) ** 2 if t < 0.6 else 0.5 - (t - 0.6)

    asked = Crosses(entity="b", point=(0, 0, 1.29), normal=(0, 0, 1))  # the top of 1.2936 m lies between frames 1 and 2 at 4 fps
    assert never(tmp_path, asked, fps=4, place=thrown).status == "fail"
    higher = Crosses(entity="b", point=(0, 0, 1.30), normal=(0, 0, 1))
    assert never(tmp_path / "higher", higher, fps=4, place=thrown).status == "pass"


def test_a_band_of_distance_that_is_passed_between_frames_is_met(tmp_path: Path) -> None:
    asked = Displacement(entity="b", min=0.4, max=0.6)
    assert never(tmp_path, asked, fps=4, place=along(1.4)).status == "fail"


@pytest.mark.parametrize(("spin", "wanted"), [(0.0, "pass"), (25.13, "unverified")])
def test_a_body_that_turns_once_per_frame_may_have_tilted_and_finer_frames_are_asked_for(
    tmp_path: Path, spin: float, wanted: str
) -> None:
    outcome = never(tmp_path, Tilts(entity="b", min=0.5), fps=4, place=along(0.0), spin=spin)
    assert outcome.status == wanted
    assert ("raise simulation.fps" in outcome.explanation) is (wanted == "unverified")
