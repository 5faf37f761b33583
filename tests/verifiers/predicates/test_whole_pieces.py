"""Breakable bodies roll, slide and tip as one body as long as their bonds hold; their loose pieces do so each by itself."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.tests.physics import rigid_world
from worldagent.tests.physics.fracture_world import STONE, bond, bricks, simulate
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.ledgers.pieces import whole_frames
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import TouchEvent

SIZE = (0.48, 0.11, 0.07)


def slab(folder: Path, *, height: float, speed: float, tension: float) -> Candidate:
    """Two bricks that are one stone, thrown level over a floor from a height."""
    broken = {"pattern": bricks(joint=0.0), "bond": bond(tension, crumble=1e-3)}
    stone: dict[str, Any] = rigid_world.box(
        *SIZE, at=(0, 0, height + SIZE[2] / 2 + 1e-3), v=(speed, 0, 0), material="brick", breakable=broken
    )
    stone["dimensions"] = {"size": SIZE}
    spec = rigid_world.world(
        {"floor": rigid_world.floor(), "stone": stone}, seconds=0.75, materials=STONE, settings={"step": 2.5e-4, "refine": 2}
    )
    return simulate(folder, spec)


def slides(candidate: Candidate) -> Any:
    return evaluate(candidate, TouchEvent(kind="slides", entity="stone", other="floor"), (0, candidate.last_frame))


def test_a_stone_of_bonded_pieces_slides_as_one_body(tmp_path: Path) -> None:
    speed = 1.5
    candidate = slab(tmp_path, height=0.0, speed=speed, tension=1e8)
    assert whole_frames(candidate, "stone").all()
    outcome = slides(candidate)
    assert outcome.status == "pass", outcome.explanation
    assert outcome.value == pytest.approx(speed**2 / (2 * 0.6 * rigid_world.G), rel=0.1)


def test_pieces_that_came_apart_slide_each_by_itself_and_not_as_the_stone(tmp_path: Path) -> None:
    """Broken on purpose: it comes apart where it lands, and its pieces go on as far as the whole would."""
    candidate = slab(tmp_path, height=0.1, speed=3.0, tension=1e3)
    whole = whole_frames(candidate, "stone")
    assert whole[0]
    assert not whole[-1]
    landed = int(np.argmin(whole))
    assert np.ptp(candidate.track("stone", candidate.entity("stone").bodies[0].name)[0][landed:, 0]) > 0.05
    outcome = slides(candidate)
    assert outcome.status == "fail", outcome.explanation
