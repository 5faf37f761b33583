"""Answers of bodies that stand, roll, hang or fly to the pushes of coupled solvers, against mechanics by hand."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.simulation.rigid import mobility
from worldagent.simulation.rigid.contact_law import IMPEDANCE
from worldagent.simulation.rigid.coupled import RigidBodies
from worldagent.testing.worlds.small_worlds import ball, box
from worldagent.tests.simulation.test_rigid_coupled import SIZE, bar, solver
from worldagent.worlds.spec import HingeJoint

MASS = 600 * float(np.prod(SIZE))
FLOOR = {"floor": box(4, 4, 0.1, at=(0, 0, 0.85 - 0.05 - 1e-3))}


def test_a_body_in_flight_answers_as_if_alone_to_the_bit() -> None:
    told = RigidBodies(solver()).state()
    linear, angular = told.mobilities()
    assert np.array_equal(linear[0], told.inverse_mass[0] * np.eye(3))
    assert np.array_equal(angular, told.inverse_inertia)


def test_a_body_that_stands_gives_way_to_no_push_by_more_than_contacts_are_soft() -> None:
    """A contact lets 1 - d of the free answer pass, and friction below its limit too; a push at the side leans the body over its foot."""
    made = solver(others=FLOOR)
    made.step_to(0.03)
    told = RigidBodies(made).state()
    linear, angular = told.mobilities()
    soft = 1.5 * (1.0 - IMPEDANCE)
    assert abs(linear[0, 2, 2]) < soft * told.inverse_mass[0]
    assert np.abs(linear[0]).max() < 2 * soft * told.inverse_mass[0]
    free = told.inverse_inertia[0].diagonal()
    assert (angular[0].diagonal() < 2 * soft * free)[:2].all(), "it is not tipped"
    assert told.inverse_mass[0] == pytest.approx(1 / MASS), "its mass is told as before"


def test_a_body_that_slides_gives_way_along_the_floor_alone() -> None:
    made = solver(others=FLOOR, crate={"velocity": (2.0, 0.0, 0.0)})
    made.step_to(0.03)
    told = RigidBodies(made).state()
    linear = told.mobilities()[0][0]
    assert linear[2, 2] < 0.1 * told.inverse_mass[0]
    assert linear[0, 0] > 0.5 * told.inverse_mass[0]


def test_a_ball_that_rolls_answers_with_five_sevenths() -> None:
    """Law: a push at the centre of a ball that does not slip moves m + I / r^2 = 7/5 m."""
    radius = 0.1
    made = solver(others={**FLOOR, "ball": ball(radius, motion="dynamic", at=(1.0, 0, 0.85 - 1e-3 + radius + 1e-3))})
    made.step_to(0.03)
    told = RigidBodies(made).state()
    row = 1 if told.inverse_mass[1] != pytest.approx(1 / MASS) else 0
    linear = told.mobilities()[0][row] / told.inverse_mass[row]
    assert linear[0, 0] == pytest.approx(5 / 7, abs=0.02)
    assert linear[2, 2] < 2 * (1.0 - IMPEDANCE)


def test_what_hangs_on_a_hinge_gives_way_along_its_arc_alone() -> None:
    """Law: a push f at distance r from the axis turns the body by f r / I; its centre moves along the arc by r times that."""
    arm = 0.5
    made = solver(joints={"h": HingeJoint(child="crate", anchor=(arm, 0, 1.0), axis=(0, 1, 0))})
    linear, angular = RigidBodies(made).state().mobilities()
    x, _, z = SIZE
    inertia = MASS * ((x * x + z * z) / 12 + arm * arm)
    assert linear[0] == pytest.approx(np.diag([0.0, 0.0, arm * arm / inertia]), abs=1e-3 / MASS)
    assert angular[0] == pytest.approx(np.diag([0.0, 1 / inertia, 0.0]), abs=1e-3 / inertia)


def test_a_push_on_a_standing_body_moves_it_as_told() -> None:
    """The engine's own answer to a small push downwards over a step, beside what was told."""
    made = solver(others=FLOOR)
    made.step_to(0.03)
    bodies = RigidBodies(made)
    told, step = bodies.state(), made.settings.step
    push = np.array([[0.0, 0.0, -20.0, 0.0, 0.0, 0.0]])
    made.step_to(0.03 + step, push)
    answer = float(bodies.state().velocity[0, 2] - told.velocity[0, 2] - step * told.acceleration[0, 2])
    assert answer == pytest.approx(step * float(told.mobilities()[0][0, 2, 2]) * push[0, 2], rel=0.1)
    assert abs(answer) < 0.06 * 20.0 * step / MASS


def test_large_islands_answer_as_if_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    made = solver(others=FLOOR)
    made.step_to(0.03)
    monkeypatch.setattr(mobility, "MOST_DOFS", 5)
    told = RigidBodies(made).state()
    assert np.array_equal(told.mobilities()[0][0], told.inverse_mass[0] * np.eye(3))


def test_pieces_of_a_bar_stand_with_it() -> None:
    """A push on any of them goes through the bar into the floor."""
    flying = RigidBodies(bar()).state().mobilities()[0]
    made = bar(others={"floor": box(4, 4, 0.1, at=(0, 0, 0.9 - 0.05 - 1e-3))})
    made.step_to(0.03)
    standing = RigidBodies(made).state().mobilities()[0]
    assert (standing[:, 2, 2] < 4 * (1.0 - IMPEDANCE) * flying[:, 2, 2]).all()
