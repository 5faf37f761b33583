"""Corrections of a body that misses a region: what they say is along the world's axes, and what they patch brings the body nearer."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, box, ground, make_candidate, world
from worldagent.verifiers.predicates.evaluators import evaluate
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.verifiers.story.beat_corrections import corrections_of
from worldagent.worlds.arrays import F64
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.predicates import Reaches
from worldagent.worlds.requirements import Correction
from worldagent.worlds.spec import BoxRegion

FRAMES = 12
SHELF = np.array([2.0, 1.0, 0.4])
ON_SHELF = BoxRegion(min=(-0.4, -0.1, -0.1), max=(0.4, 0.1, 0.1), relative_to="shelf")


def missing(folder: Path, yaw: float, *, turning: bool = False, start: tuple[float, ...] = (0.0, 1.0, 0.4)) -> Candidate:
    """A marble that rolls along +x and stops at 1.3 m of its start, before a shelf that is turned by `yaw` [rad]."""
    entities = {
        "floor": ground(),
        "marble": ball(0.016, motion="dynamic", at=start),
        "shelf": box(0.8, 0.2, 0.8, motion="dynamic"),
    }
    spec = world(entities, regions={"on": ON_SHELF}, frames=FRAMES)
    way = np.array(start) + np.linspace(0.0, 1.0, FRAMES)[:, None] * np.array([1.3, 0.0, 0.0])
    angle = yaw + (np.linspace(-1.0, 0.0, FRAMES) if turning else np.zeros(FRAMES))
    turned = np.stack([np.cos(angle / 2), 0 * angle, 0 * angle, np.sin(angle / 2)], axis=1)
    tracks = {"marble": (way, np.repeat([IDENTITY], FRAMES, 0)), "shelf": (np.repeat([SHELF], FRAMES, 0), turned)}
    return make_candidate(folder, spec, tracks=tracks)


def judged(candidate: Candidate, measure: str) -> tuple[Outcome, list[Correction]]:
    asked = Reaches.model_validate({"entity": "marble", "region": "on", "measure": measure, "when": "end"})
    outcome = evaluate(candidate, asked, (0, FRAMES - 1))
    return outcome, corrections_of(candidate, asked, outcome, "/story/beats/lands", (0, FRAMES - 1))


def told(text: str) -> F64:
    """The vector in a text [m]."""
    found = re.search(r"\(([-+.\d]+), ([-+.\d]+), ([-+.\d]+)\)", text)
    assert found is not None
    return np.array([float(v) for v in found.groups()])


@pytest.mark.parametrize("measure", ["center", "surface"])
@pytest.mark.parametrize("turning", [False, True])
@pytest.mark.parametrize("degrees", [0, -90, 30, 180])
def test_the_move_that_is_offered_closes_the_gap_however_the_region_is_turned(
    degrees: float, turning: bool, measure: str, tmp_path: Path
) -> None:
    candidate = missing(tmp_path / "a", math.radians(degrees), turning=turning)
    before, found = judged(candidate, measure)
    assert before.status == "fail"
    assert before.value is not None
    assert before.value > 0.1
    move = next(c for c in found if c.group == "placement")
    after = apply_patch(candidate.spec, move.patch).entities["marble"].pose.position
    closed, _ = judged(missing(tmp_path / "b", math.radians(degrees), turning=turning, start=tuple(after)), measure)
    # Of a whole surface the farthest point is brought in; one of the other side may then be the farthest.
    assert closed.value == pytest.approx(0.0, abs=2e-6 if measure == "center" else 0.033)


def test_offset_and_advice_are_along_the_world_s_axes_and_say_so(tmp_path: Path) -> None:
    """Turned by -90 degrees, the shelf's long side lies along y: from (1.3, 1) m the region begins at x = 1.9 m."""
    outcome, found = judged(missing(tmp_path, -math.pi / 2), "center")
    assert outcome.details["offset"] == pytest.approx([-0.6, 0.0, 0.0], abs=1e-9)
    assert (
        "offset (-0.600, +0.000, +0.000) m, centre at (+1.300, +1.000, +0.400) m, both in the world's frame"
        in outcome.explanation
    )
    actions = [c.action for c in found if c.group in ("placement", "initial_state")]
    assert len(actions) == 2
    for action in actions:
        assert told(action) == pytest.approx([0.6, 0.0, 0.0])
        assert "along the world's axes" in action
        assert "-0.000" not in action
