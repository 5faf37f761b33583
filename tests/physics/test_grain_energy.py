"""Energy held in contacts: against the oscillators that springs of contacts make, grain on grain and grain on wall."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from worldagent.simulation.particles.energy import elastic
from worldagent.simulation.particles.engine import Grains
from worldagent.tests.physics.grains import G, grains, kind, slab, still

R, YOUNG, STICKY = 0.01, 1e7, 5.0
"""[m], [Pa], [J/m^2]"""
MODULUS = 0.5 * YOUNG / (1 - 0.25**2)
PULL = math.pi * STICKY * R
"""Pull of adhesion between two grains [N]."""
DEPTH = (0.75 * PULL / (MODULUS * math.sqrt(0.5 * R))) ** (2 / 3)
"""At which it balances Hertz's force [m]."""
MASS = 4 / 3 * math.pi * 2500.0 * R**3
SPEED, TURN = 0.01, 0.5
"""[m/s], [rad/s]"""


def _stuck(velocity: Any, spin: Any, **changes: Any) -> Grains:
    """Two grains that adhesion holds at the depth where Hertz's force balances it."""
    place = [[-R + DEPTH / 2, 0, 0], [R - DEPTH / 2, 0, 0]]
    found = grains(place, R, friction=2.0, cohesion=STICKY, step_share=0.01, **changes)
    c = found.columns()
    found.take(c["position"], np.array(velocity), np.array(spin), c["radius"], c["kind"], c["identity"])
    return found


def _books(engine: Grains) -> tuple[float, float, float]:
    """Energy of motion, by depth and in springs [J]."""
    c = engine.columns()
    moving = 0.5 * c["mass"] @ (c["velocity"] ** 2).sum(axis=1) + 0.2 * (c["mass"] * c["radius"] ** 2) @ (c["spin"] ** 2).sum(
        axis=1
    )
    held = elastic(engine)
    return float(moving), held.depth, held.springs


SHEARED = [[0, SPEED, 0], [0, -SPEED, 0]], np.zeros((2, 3)), {}, MASS / 7 * 0.5 * (2 * SPEED) ** 2
"""Slip has the mass m / 7 of two rolling spheres: 1 / m_slip = 2 (1 / m + R^2 / I)."""
ROLLED = np.zeros((2, 3)), [[0, 0, TURN], [0, 0, -TURN]], {"rolling": 0.5}, 0.5 * (0.2 * MASS * R**2) * (2 * TURN) ** 2
"""Turning against each other has half the moment of inertia of one."""


@pytest.mark.parametrize(("velocity", "spin", "changes", "most"), [SHEARED, ROLLED], ids=["sheared", "rolled"])
def test_springs_of_a_contact_hold_what_the_grains_lose(velocity: Any, spin: Any, changes: Any, most: float) -> None:
    """Law: below sliding and without dashpots, the sum stays, and all of the slip or of the turning goes into the spring and back."""
    engine = _stuck(velocity, spin, restitution=1.0, **changes)
    seen = []
    for _ in range(300):
        engine.step(2e-5)
        seen.append(_books(engine))
    moving, depth, springs = np.array(seen).T
    total = moving + depth + springs
    start = moving.max()
    assert np.ptp(total) < 0.01 * start
    assert np.ptp(moving + depth) > 0.2 * start, "the springs matter"
    assert springs.max() == pytest.approx(most, rel=0.01)
    assert springs[int(springs.argmax()) :].min() < 0.01 * most, "it comes back"
    assert depth == pytest.approx(8 / 15 * MODULUS * math.sqrt(0.5 * R) * DEPTH**2.5 - PULL * DEPTH, rel=1e-3)


def test_dashpots_only_take() -> None:
    """Law: with a restitution below one the sum falls, and what slips is at rest in the end."""
    engine = _stuck(*SHEARED[:2], restitution=0.5)
    seen = []
    for _ in range(120):
        engine.step(1e-4)
        seen.append(_books(engine))
    total = np.array(seen).sum(axis=1)
    assert (np.diff(total) < 1e-3 * seen[0][0]).all()
    assert seen[-1][2] < 1e-6 * seen[0][0]


def test_contacts_with_a_wall_hold_their_share_and_a_resumed_run_knows_it() -> None:
    """Law: Hertz's energy at the depth under the weight, and the slip of a sphere on a wall, of the mass m / 3.5, in the spring."""
    young = 0.5 * 1e6 / (1 - 0.25**2)
    deep = (0.75 * MASS * G / (young * math.sqrt(R))) ** (2 / 3)
    floor = (slab((-1, -1, -0.1), (1, 1, 0)),)
    speed, share = 1e-3, {"young": 1e6, "restitution": 1.0, "friction": 5.0, "step_share": 0.01}
    engine = grains([[0, 0, R - deep]], R, velocity=[[speed, 0, 0]], gravity=(0, 0, -G), walls=floor, **share)
    springs = []
    for _ in range(100):
        engine.step(5e-5, still(1))
        _, depth, spring = _books(engine)
        springs.append(spring)
    assert depth == pytest.approx(8 / 15 * young * math.sqrt(R) * deep**2.5, rel=0.01)
    assert max(springs) == pytest.approx(0.5 * MASS / 3.5 * speed**2, rel=0.02)
    again = grains([[0, 0, R]], R, gravity=(0, 0, -G), walls=floor, **share)
    again.restore(engine.checkpoint())
    assert elastic(again).springs == elastic(engine).springs


def test_free_grains_hold_nothing() -> None:
    engine = grains([[0, 0, 0], [0, 0, 0.5]], R, kinds=(kind(),))
    assert elastic(engine) == (0.0, 0.0)
    engine.step(1e-3)
    assert elastic(engine) == (0.0, 0.0)


def test_a_wall_that_moves_does_the_work_that_a_grain_gains() -> None:
    """Law: a grain at rest that a wall of speed v hits without loss leaves at 2 v, and the wall has done 2 m v^2 of work."""
    speed, plate = 0.2, slab((-1, -0.1, -0.1), (0, 0.1, 0.1), "kinematic")
    engine = grains([[R + 1e-4, 0, 0]], R, walls=(plate,), restitution=1.0, friction=0.0, step_share=0.02)
    work, state = 0.0, still(1, velocity=np.array([[speed, 0, 0]]))
    for k in range(100):
        state.position[0, 0] = state.center[0, 0] = speed * k * 1e-4
        work += engine.step(1e-4, state).wall_work
    moving, depth, _ = _books(engine)
    assert depth == 0.0, "it has left"
    assert engine.columns()["velocity"][0, 0] == pytest.approx(2 * speed, rel=1e-3)
    assert work == pytest.approx(2 * MASS * speed**2, rel=1e-3)
    assert work == pytest.approx(moving, rel=1e-3)
