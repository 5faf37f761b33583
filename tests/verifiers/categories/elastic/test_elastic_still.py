"""Soft bodies at rest: what shivers by micrometres faster than frames is still, what creeps, turns or wobbles visibly is not."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import entity, ground, world
from worldagent.testing.worlds.soft_worlds import Motion, block_mesh, deformed_candidate
from worldagent.verifiers.categories.registry import judge_of
from worldagent.verifiers.predicates.evaluators import evaluate
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.arrays import F64
from worldagent.worlds.predicates import BodyEvent
from worldagent.worlds.spec import Box, ElasticPhysics

FRAMES, FPS, LANDED = 30, 24, 0.4
"""It comes down by 0.2 m until `LANDED` seconds."""
SIDE = 0.1


def _down(time: float, rest: F64) -> F64:
    return rest - np.array([0.0, 0.0, 0.2 * min(time / LANDED, 1.0)])


def shivering(speed: float, rate: float) -> Motion:
    """Goes to and fro along z, and turns about x, at a frequency [Hz], at that speed at most [m/s]."""

    def move(time: float, rest: F64) -> F64:
        swing = speed / (2 * math.pi * rate) * math.sin(2 * math.pi * rate * time) if time > LANDED else 0.0
        turned = np.cross(np.array([swing / SIDE, 0.0, 0.0]), rest - rest.mean(axis=0))
        return _down(time, rest) + turned + np.array([0.0, 0.0, swing])

    return move


def creeping(speed: float) -> Motion:
    """Creeps along x once it is down [m/s]."""
    return lambda time, rest: _down(time, rest) + np.array([speed * max(0.0, time - LANDED), 0.0, 0.0])


def judged(folder: Path, move: Motion) -> Outcome:
    physics = ElasticPhysics(young_modulus=1e4, resolution=SIDE / 2)
    block = entity(Box(size=(SIDE,) * 3), motion="dynamic", at=(0, 0, 0.25), physics=physics)
    spec = world({"floor": ground(), "block": block}, frames=FRAMES, fps=FPS)
    mesh = block_mesh((SIDE,) * 3, (2, 2, 2))
    candidate = deformed_candidate(folder, spec, {"block": mesh}, {"block": move})
    assert judge_of(spec, "block").moving(candidate, "block")[1 : int(LANDED * FPS)].all()
    return evaluate(candidate, BodyEvent(kind="stops", entity="block"), (0, FRAMES - 1))


@pytest.mark.parametrize("rate", [31.0, 53.0, 90.0])
def test_a_block_that_only_shivers_has_stopped(tmp_path: Path, rate: float) -> None:
    """Its speed at the frames is twice what a rigid body may have."""
    found = judged(tmp_path, shivering(1e-3, rate))
    assert found.status == "pass", found.explanation


def test_a_block_that_creeps_has_not_stopped(tmp_path: Path) -> None:
    assert judged(tmp_path, creeping(2e-3)).status == "fail"
    assert judged(tmp_path / "slower", creeping(2e-4)).status == "pass"


@pytest.mark.parametrize(("speed", "rate"), [(0.02, 3.0), (0.005, 7.0), (0.1, 24.0)])
def test_a_block_that_wobbles_visibly_has_not_stopped(tmp_path: Path, speed: float, rate: float) -> None:
    """The last one is where it was at every frame, and too fast there."""
    assert judged(tmp_path, shivering(speed, rate)).status == "fail"
