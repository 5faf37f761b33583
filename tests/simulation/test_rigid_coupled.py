"""A rigid instance tells those who push its bodies their places, mobility and accelerations, and what it received."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits
from worldagent.construction.build import build_entity
from worldagent.simulation.rigid.coupled import RigidBodies, lasting
from worldagent.simulation.rigid.solver import SolverRigid
from worldagent.testing.worlds.small_worlds import box, world
from worldagent.worlds.spec import ForceDriver, HingeJoint, RigidPhysics

SIZE = (0.2, 0.1, 0.3)


def solver(**more: Any) -> SolverRigid:
    entities = {"crate": box(*more.pop("size", SIZE), at=(0, 0, 1.0), motion="dynamic", **more.pop("crate", {}))}
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


def test_answers_of_what_lies_on_another_are_solved_in_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    """Threads of BLAS spin between the small inverses of an island: ten times the processor time at 140 degrees of freedom."""
    seen: list[int] = []
    plain = np.linalg.inv

    def watched(matrix: Any) -> Any:
        seen.extend(int(lib["num_threads"]) for lib in threadpool_info() if lib["user_api"] == "blas")
        return plain(matrix)

    rest = solver(others={"floor": box(4, 4, 0.1, at=(0, 0, 0.85 - 0.05 - 1e-3))})
    rest.step_to(0.03)
    bodies = RigidBodies(rest)
    monkeypatch.setattr(np.linalg, "inv", watched)
    with threadpool_limits(limits=2, user_api="blas"):
        bodies.state()
        assert {int(lib["num_threads"]) for lib in threadpool_info() if lib["user_api"] == "blas"} == {2}, "given back"
    assert seen
    assert set(seen) == {1}


def test_a_falling_body_accelerates_with_gravity_and_a_resting_one_does_not() -> None:
    assert RigidBodies(solver()).state().acceleration[0] == pytest.approx([0, 0, -9.81], abs=1e-9)
    floor = {"floor": box(4, 4, 0.1, at=(0, 0, 0.85 - 0.05 - 1e-3))}
    rest = solver(others=floor)
    rest.step_to(0.03)
    assert np.abs(RigidBodies(rest).state().acceleration).max() < 0.4


def test_a_body_that_hits_in_a_short_exchange_tells_no_acceleration_that_nobody_can_go_on_with() -> None:
    """Partners go on for milliseconds with what is told: after an exchange of a microsecond it is that of a step, not a million m/s^2.

    Own choice: at most ten times what was told right before.
    """
    floor = {"floor": box(4, 4, 0.1, at=(0, 0, 0.85 - 0.05 - 1.5e-3))}
    falling = solver(others=floor, crate={"velocity": (0, 0, -0.5)})
    bodies = RigidBodies(falling)
    while (before := bodies.state().acceleration[0, 2]) < 0.0:
        falling.step_to(falling.time + falling.settings.step)
    falling.step_to(falling.time + 1e-6)
    after = bodies.state().acceleration[0, 2]
    assert abs(after) < 10.0 * before
    assert falling.model.opt.timestep == pytest.approx(1e-6), "reading changes nothing"


def test_a_leaf_that_comes_to_its_stop_shortens_the_exchange_until_it_stands() -> None:
    """Law: over an exchange no told acceleration turns a speed into more than that speed against its way.

    Without a limit, a leaf that came to its stop with 0.5 m/s was expected to fly back with 6 m/s for a step of 12 ms, and threw its water.
    """
    hinge = HingeJoint(child="crate", anchor=(0.05, 0, 1.0), axis=(0, 0, 1), range=(-1.0, 0.2))
    leaf = solver(
        joints={"h": hinge}, crate={"physics": RigidPhysics(linear_velocity=(0.0, -0.25, 0.0), angular_velocity=(0.0, 0.0, 5.0))}
    )
    bodies, usual, least = RigidBodies(leaf), 0.012, leaf.settings.step
    lengths, back = [], []
    while leaf.time < 0.08 - 1e-9:
        told = bodies.state()
        lengths.append(lasting(told, usual))
        after = told.velocity[0] + min(lengths[-1], usual) * told.acceleration[0]
        speed = float(np.linalg.norm(told.velocity[0]))
        if speed > 0.05:
            back.append(-float(after @ told.velocity[0]) / speed - speed)
        leaf.step_to(leaf.time + min(lengths[-1], least))
    assert max(back) <= 1e-6
    assert min(lengths) < 0.5 * usual
    assert lengths[0] > usual, "swinging shortens nothing"
    assert lengths[-1] > usual, "and what stands neither"


def test_what_falls_shortens_no_exchange() -> None:
    assert lasting(RigidBodies(solver()).state(), 0.02) >= 0.02


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


def bar(fixed: tuple[str, ...] = (), tension: float = 1e6, **more: Any) -> SolverRigid:
    """Four blocks in a row, 10 kg each, 1 m up."""
    broken = {
        "pattern": {"kind": "bricks", "size": (0.2, 0.2, 0.2), "joint": 0.0},
        "bond": {"tension": tension, "shear": tension},
    }
    return solver(
        crate={"breakable": {**broken, "fixed": fixed}, "physics": {"category": "rigid", "mass": 40.0}},
        size=(0.8, 0.2, 0.2),
        **more,
    )


def test_pieces_answer_with_their_cluster_and_alone_as_any_body() -> None:
    """A force shared by mass moves the cluster as each piece expects, and never more than they expect."""
    made = bar()
    found = RigidBodies(made).state()
    assert (found.inverse_mass[1:3] >= 1 / 10.0).all()
    assert found.inverse_mass[0] > found.inverse_mass[1], "ends give way by turning too"
    assert found.acceleration == pytest.approx(np.tile([0, 0, -9.81], (4, 1)), abs=1e-9)
    assert found.center[:, 0] == pytest.approx([-0.3, -0.1, 0.1, 0.3])
    made.breakage._bodies[0].whole[:] = False
    made._split(made.time)
    alone = RigidBodies(made).state()
    assert alone.inverse_mass == pytest.approx([0.1] * 4)
    assert alone.inverse_inertia[0] == pytest.approx(np.eye(3) / (10.0 * 0.2**2 / 6))


def test_what_the_world_holds_does_not_answer_and_takes_up_what_it_is_given() -> None:
    made = bar(("x-",))
    assert RigidBodies(made).state().inverse_mass == pytest.approx([0.0] * 4)
    wrench = np.zeros((4, 6))
    wrench[3, 2] = 5.0
    made.step_to(1 / 24, wrench)
    assert made._exchange.received == pytest.approx(wrench / 24)
    assert RigidBodies(made).state().velocity == pytest.approx(np.zeros((4, 3)))


def test_partners_load_the_bonds_and_go_on_pushing_the_pieces_that_came_off() -> None:
    """Two ends of a free bar are pulled apart by 2 kN over a section of 0.04 m^2: 50 kPa, over 30 and under 100."""
    wrench = np.zeros((4, 6))
    wrench[0, 0], wrench[3, 0] = -2e3, 2e3
    for tension, breaks in ((1e5, False), (3e4, True)):
        made = bar(tension=tension)
        bodies = RigidBodies(made)
        made.step_to(0.03, wrench)
        assert (not made.breakage.whole()["crate"].all()) is breaks
        assert made._exchange.received == pytest.approx(0.03 * wrench)
        speed = bodies.state().velocity
        assert 10.0 * speed.sum(axis=0) == pytest.approx([0, 0, -40 * 9.81 * 0.03], abs=1e-6)
        assert bool(speed[3, 0] - speed[0, 0] > 1.0) is breaks
        if breaks:
            made.end_frame()
            assert set(made.frame_data()["break/cause"].tolist()) == {-2}


@pytest.mark.parametrize("end", [1 / 24, 0.03, 1.0])
def test_a_restored_run_tells_the_accelerations_of_the_run_that_goes_on(end: float) -> None:
    """A force ends with the frame of the checkpoint, before it, or acts on: partners go on with what is told first, so that a byte of it counts."""
    push = ForceDriver(entity="crate", force=(3.0, 0.0, 0.0), torque=(0.0, 0.5, 0.0), start=0.0, end=end)
    going = solver(drivers={"push": push})
    going.step_to(1 / 24)
    assert going.end_attempt()
    going.end_frame()
    state = going.checkpoint()
    told = RigidBodies(going).state()
    fresh = solver(drivers={"push": push})
    fresh.restore(state, 1)
    found = RigidBodies(fresh).state()
    assert (found.acceleration == told.acceleration).all()
    mass = 600 * float(np.prod(SIZE))
    assert told.acceleration[0, 0] == pytest.approx(3.0 / mass if end > 1 / 24 else 0.0, abs=1e-9)
