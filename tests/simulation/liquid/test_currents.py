"""Liquids start at rest, with one velocity, or along declared currents."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError
from worldagent.simulation.liquid.currents import start_velocity
from worldagent.worlds.arrays import RigidPose
from worldagent.worlds.spec import Current, LiquidPhysics

HERE = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))


def arc(count: int = 19) -> Current:
    """A quarter of a circle of 20 m, 4 m wide, from 1 to 2 m/s."""
    turn = np.linspace(0, np.pi / 2, count)
    line = [(20 * np.cos(t), 20 * np.sin(t), 0.0) for t in turn]
    return Current(line=line, speeds=np.linspace(1, 2, count).tolist(), width=4.0)


def test_liquid_near_a_course_runs_along_it() -> None:
    physics = LiquidPhysics(resolution=0.1, currents={"arc": arc()})
    turn = np.array([0.2, 0.7, 1.4])
    points = np.column_stack([21.5 * np.cos(turn), 21.5 * np.sin(turn), [-1.0, 0.0, 1.0]])
    found = start_velocity(physics, HERE, points)
    wanted = (1 + turn / (np.pi / 2))[:, None] * np.column_stack([-np.sin(turn), np.cos(turn), np.zeros(3)])
    assert found == pytest.approx(wanted, abs=0.02)


def test_liquid_beside_all_courses_has_the_velocity_of_the_whole() -> None:
    physics = LiquidPhysics(resolution=0.1, linear_velocity=(0.0, 0.0, 0.3), currents={"arc": arc()})
    found = start_velocity(physics, HERE, np.array([[17.9, 0.1, 0.0], [20.0, 0.1, 0.0]]))
    assert found[0] == pytest.approx([0, 0, 0.3])
    assert np.linalg.norm(found[1]) == pytest.approx(1.0, abs=0.02)


def test_currents_turn_with_their_entity() -> None:
    physics = LiquidPhysics(resolution=0.1, currents={"a": Current(line=[(0, 0, 0), (10, 0, 0)], speeds=[1, 1], width=2)})
    turned = RigidPose(np.array([5.0, 0.0, 0.0]), np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]))
    assert start_velocity(physics, turned, np.array([[5.0, 4.0, 0.0]])) == pytest.approx(np.array([[0.0, 1.0, 0.0]]))


def test_a_current_needs_a_speed_for_each_point() -> None:
    with pytest.raises(ValidationError, match="3 points and 2 speeds"):
        Current(line=[(0, 0, 0), (1, 0, 0), (2, 0, 0)], speeds=[1, 1], width=2)
