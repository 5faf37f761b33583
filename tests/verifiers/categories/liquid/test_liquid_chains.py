"""Causes that act through a liquid: a paddle stirs the pool, and the pool moves a duck; cut either and nothing arrives."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.liquid_worlds import Flow, pool_in_tank
from worldagent.testing.worlds.small_worlds import IDENTITY, box
from worldagent.verifiers.categories.liquid.judge import STIRRED, LiquidJudge
from worldagent.verifiers.story.chains import Chains
from worldagent.worlds.candidate import Candidate

FRAMES, STIRS, CARRIES = 24, 6, 12
WAVE = 0.3
"""[m/s] of the stirred pool."""


def pool(folder: Path, *, stirring: float = 2.0, carrying: float = 0.5) -> Candidate:
    """The paddle moves from frame `STIRS` on and pushes the pool; the pool pushes the duck from `CARRIES` on."""
    others: dict[str, Any] = {
        "paddle": box(0.05, 0.2, 0.1, at=(-0.15, 0, 0.1), motion="dynamic"),
        "duck": box(0.05, 0.05, 0.05, at=(0.1, 0, 0.16), motion="dynamic"),
    }
    flow = pool_in_tank(others=others, frames=FRAMES, two_way=True)
    time = np.arange(FRAMES) / 24
    moves = {
        "paddle": 0.2 * np.maximum(time - (STIRS - 1) / 24, 0),
        "duck": 0.1 * np.maximum(time - (CARRIES - 1) / 24, 0),
    }
    tracks = {n: (np.array(others[n].pose.position) + np.outer(x, [1, 0, 0]), IDENTITY) for n, x in moves.items()}
    names = [n.split("/")[0] for n in flow.colliders]
    share = {names.index(n): np.zeros((FRAMES, 6)) for n in others}
    share[names.index("paddle")][STIRS:, 0] = -stirring
    share[names.index("duck")][CARRIES:, 0] = carrying
    order = [n for n, e in flow.spec.entities.items() if e.motion == "dynamic" and e.physics.category == "rigid"]
    velocity = np.zeros((FRAMES, len(order), 3))
    velocity[STIRS:, order.index("paddle"), 0] = 0.2
    velocity[CARRIES:, order.index("duck"), 0] = 0.1
    shape = flow.velocity[0].shape
    stream = [np.broadcast_to([WAVE if k >= STIRS else 0.0, 0, 0], shape).copy() for k in range(FRAMES)]
    moved: Flow = flow.edited(velocity=stream)
    moved = dataclasses.replace(moved, share=share, tracks=tracks, rigid={"velocity": velocity})
    return moved.candidate(folder)


def test_a_chain_goes_through_the_liquid(tmp_path: Path) -> None:
    chains = Chains(pool(tmp_path))
    reach = chains.spread(["paddle"], (STIRS - 1) / 24, FRAMES - 1, subject="duck")
    assert [(h.source, h.target) for h in reach.chain("duck")] == [("paddle", "pool"), ("pool", "duck")]
    assert (STIRS - 1) / 24 <= (reach.time("pool") or 0.0) < (reach.time("duck") or 0.0) <= CARRIES / 24
    assert not reach.ever("tank") or not reach.chain("tank") or reach.chain("tank")[-1].target == "tank"


@pytest.mark.parametrize("cut", ["stirring", "carrying"])
def test_no_push_no_chain(tmp_path: Path, cut: str) -> None:
    chains = Chains(pool(tmp_path, **{cut: 0.0}))
    reach = chains.spread(["paddle"], (STIRS - 1) / 24, FRAMES - 1, subject="duck")
    assert not reach.ever("duck")
    assert reach.ever("pool") is (cut == "carrying")


def test_a_liquid_is_still_until_it_is_stirred(tmp_path: Path) -> None:
    candidate = pool(tmp_path)
    found = LiquidJudge().moments(candidate, "pool")
    speed, momentum = found.speed, np.linalg.norm(found.momentum, axis=1)
    assert speed[:STIRS] == pytest.approx(0.0)
    assert speed[STIRS:] == pytest.approx(WAVE)
    mass = 0.4 * 0.3 * 0.16 * 1000
    assert momentum[STIRS:] == pytest.approx(mass * WAVE, rel=1e-5)
    assert LiquidJudge().moving(candidate, "pool").tolist() == [k >= STIRS for k in range(FRAMES)]
    assert STIRRED < WAVE


def test_pushes_are_those_of_the_cache(tmp_path: Path) -> None:
    pushes = LiquidJudge().pushes(pool(tmp_path))
    assert {(a, b): j for a, b, _, _, j, _ in pushes[STIRS] if b != "tank"} == {("pool", "paddle"): pytest.approx(2.0)}
    assert {b for _, b, *_ in pushes[CARRIES]} == {"tank", "paddle", "duck"}
    assert not [b for _, b, *_ in pushes[0] if b != "tank"]


def test_liquids_of_one_instance_share_pushes_by_what_touches_the_body(tmp_path: Path) -> None:
    """Oil fills the half where the duck floats, water that of the paddle; both lie on the floor."""
    others: dict[str, Any] = {
        "paddle": box(0.05, 0.2, 0.1, at=(-0.15, 0, 0.1), motion="dynamic"),
        "duck": box(0.05, 0.05, 0.05, at=(0.1, 0, 0.16), motion="dynamic"),
    }
    flow = pool_in_tank(others=others, frames=3, two_way=True)
    plan = flow.spec.simulation
    water = plan.solvers["water"]
    solvers = {**plan.solvers, "water": water.model_copy(update={"members": ["pool", "oil"]})}
    entities = {**flow.spec.entities, "oil": flow.spec.entities["pool"]}
    spec = flow.spec.model_copy(update={"entities": entities, "simulation": plan.model_copy(update={"solvers": solvers})})
    fluid = (flow.position[0][:, 0] > 0).astype(np.int32)
    names = [n.split("/")[0] for n in flow.colliders]
    share = {names.index(n): np.array([np.zeros(6), [1.0, 0, 0, 0, 0, 0], np.zeros(6)]) for n in others}
    made = dataclasses.replace(flow, spec=spec, share=share, change={(k, "particle/fluid"): fluid for k in range(3)})
    pushes = LiquidJudge().pushes(made.candidate(tmp_path))[1]
    assert [(a, j) for a, b, _, _, j, _ in pushes if b == "duck"] == [("oil", pytest.approx(1.0))]
    assert [(a, j) for a, b, _, _, j, _ in pushes if b == "paddle"] == [("pool", pytest.approx(1.0))]
    tank = {a: j for a, b, _, _, j, _ in pushes if b == "tank"}
    assert tank["oil"] == pytest.approx(tank["pool"], rel=0.1)
