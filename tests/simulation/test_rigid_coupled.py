"""What a rigid instance tells those who push its bodies: places, mobility, accelerations, and what it received."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.bench.small_worlds import box, world
from worldagent.construction.build import build_entity
from worldagent.simulation.rigid.coupled import RigidBodies
from worldagent.simulation.rigid.solver import SolverRigid
from worldagent.worlds.spec import HingeJoint

SIZE = (0.2, 0.1, 0.3)


def solver(**more: Any) -> SolverRigid:
    entities = {"crate": box(*SIZE, at=(0, 0, 1.0), motion="dynamic", **more.pop("crate", {}))}
    spec = world({**entities, **more.pop("others", {})}, **more)
    made = SolverRigid(spec, {n: build_entity(spec, n, Path()) for n in spec.entities}, "rigid", coupled=True)
    made.prepare()
    made.begin_frame(1)
    made.begin_attempt(0)
    return made


def test_a_free_body_answers_with_its_mass_and_inertia() -> None:
    found = RigidBodies(solver()).state()
    x, y, z = SIZE
    mass = 600 * x * y * z
    assert found.inverse_mass[0] == pytest.approx(1 / mass)
    inertia = mass / 12 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])
    assert found.inverse_inertia[0] == pytest.approx(np.diag(1 / inertia), abs=1e-9 / inertia.min())
    assert found.center[0] == pytest.approx([0, 0, 1.0])


def test_a_falling_body_accelerates_with_gravity_and_a_resting_one_does_not() -> None:
    assert RigidBodies(solver()).state().acceleration[0] == pytest.approx([0, 0, -9.81], abs=1e-9)
    floor = {"floor": box(4, 4, 0.1, at=(0, 0, 0.85 - 0.05 - 1e-3))}
    rest = solver(others=floor)
    rest.step_to(0.03)
    assert np.abs(RigidBodies(rest).state().acceleration).max() < 0.4


def test_a_turning_body_off_its_hinge_feels_the_centripetal_acceleration() -> None:
    """Law: a point at distance r from the axis accelerates by w^2 r towards it; by finite differences of its velocity."""
    hinge = HingeJoint(child="crate", anchor=(0.5, 0, 1.0), axis=(0, 1, 0))
    made = solver(joints={"h": hinge})
    made.step_to(0.03)
    bodies = RigidBodies(made)
    told = bodies.state()
    step = 2e-4
    made.step_to(0.03 + step)
    change = (bodies.state().velocity - told.velocity) / step
    assert told.acceleration[0] == pytest.approx(change[0], abs=0.05)
    assert 0 < told.inverse_mass[0] < 1 / (600 * np.prod(SIZE)), "a body on a joint gives way less"


def test_held_bodies_do_not_answer() -> None:
    from worldagent.worlds.spec import ReleaseDriver

    made = solver(drivers={"hold": ReleaseDriver(entity="crate", time=0.5)})
    found = RigidBodies(made).state()
    assert found.inverse_mass[0] == 0
    assert np.abs(found.inverse_inertia).max() == 0


def test_a_wrench_is_received_as_it_was_given_and_is_no_work_of_drivers() -> None:
    """Law: impulse = force times time; momentum changes by it and by gravity; drivers did nothing."""
    made = solver(crate={"velocity": (0.5, 0, 0)})
    start = made.frame_data()["velocity"][0].copy()
    wrench = np.array([[1.0, 2.0, 30.0, 0.1, 0.0, 0.02]])
    for end in (0.01, 0.0213, 1 / 24):
        made.step_to(end, wrench)
    assert made.end_attempt()
    made.end_frame()
    data = made.frame_data()
    assert data["exchange/impulse"] == pytest.approx(wrench / 24, rel=1e-9)
    mass = 600 * np.prod(SIZE)
    assert data["velocity"][0] - start == pytest.approx(wrench[0, :3] / 24 / mass + [0, 0, -9.81 / 24], rel=1e-6)
    assert float(data["record/driver_work"]) == pytest.approx(0.0, abs=1e-12)


def test_an_uncoupled_instance_records_no_exchange() -> None:
    spec = world({"crate": box(*SIZE, at=(0, 0, 1.0), motion="dynamic")})
    made = SolverRigid(spec, {n: build_entity(spec, n, Path()) for n in spec.entities}, "rigid")
    made.prepare()
    made.advance(1)
    assert "exchange/impulse" not in made.frame_data()
