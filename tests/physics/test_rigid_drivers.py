"""Authored drivers: holds, paths, forces, motors, preroll, and the work they do."""

import math

import numpy as np
import pytest
from worldagent.tests.physics.rigid_world import G, Run, ball, box, entity, floor, world

HELD = 1e-7
"""[m] A held body stays where it is; its pose is written anew in every frame."""
FALL = 2e-3
"""Relative error of a fall: semi-implicit Euler is dt / t off."""
WORK = 0.01
"""Driver work against the energy it goes into, relative."""


def _path(entity_name, *keys):
    return {
        "kind": "path",
        "entity": entity_name,
        "keys": {f"k{i}": {"time": t, "pose": {"position": p, "euler": e}} for i, (t, p, e) in enumerate(keys)},
    }


def test_a_released_body_is_held_exactly_and_then_falls_freely():
    drivers = {"r": {"kind": "release", "entity": "b", "time": 0.513}}
    run = Run(world({"ground": floor(), "b": ball(0.1, at=(0, 0, 3))}, seconds=1.0, drivers=drivers))
    held = run.time <= 0.513
    assert np.abs(run.of("b")[held] - (0, 0, 3)).max() < HELD
    fall = run.time[~held] - 0.513
    # Without the first frames, in which the step itself is a visible part of the time.
    dropped = 3 - run.of("b")[~held, 2]
    assert dropped[4:] == pytest.approx(0.5 * G * fall[4:] ** 2, rel=5 * FALL)
    assert run.of("b", "velocity")[-1, 2] == pytest.approx(-G * fall[-1], rel=FALL)


def test_a_held_body_stops_what_hits_it_and_does_not_move():
    drivers = {"r": {"kind": "release", "entity": "wall", "time": 5.0}}
    entities = {"wall": box(0.02, 1, 1, mass=0.1), "b": ball(0.1, at=(-1, 0, 0), v=(4, 0, 0), mass=50.0)}
    run = Run(world(entities, seconds=0.5, gravity=(0, 0, 0), restitution=0.5, drivers=drivers))
    assert np.abs(run.of("wall")).max() < 1e-6
    assert run.of("b", "velocity")[-1, 0] == pytest.approx(-2.0, abs=0.02)


def test_what_sleeps_wakes_when_its_support_is_let_go():
    drivers = {
        "a": {"kind": "release", "entity": "tray", "time": 1.0},
        "b": {"kind": "detach", "joint": "s", "time": 1.5},
    }
    entities = {
        "tray": box(0.5, 0.5, 0.02, at=(0, 0, 2), mass=1.0),
        "load": box(0.1, 0.1, 0.1, at=(0, 0, 2.06), mass=1.0),
        "lamp": ball(0.05, at=(2, 0, 2), mass=1.0),
    }
    spring = {
        "kind": "spring", "child": "lamp", "parent_point": (2, 0, 3), "child_point": (2, 0, 2),
        "stiffness": 5000.0, "damping": 140.0, "rest_length": 1 - G / 5000.0,
    }  # fmt: skip
    run = Run(world(entities, seconds=2.0, drivers=drivers, joints={"s": spring}))
    at = {n: run.of(n)[:, 2] for n in entities}
    assert run.frames[23]["asleep"].any()
    assert at["load"][round(1.4 * 24)] < 1.5
    assert at["lamp"][36] == pytest.approx(2.0, abs=1e-3)
    assert at["lamp"][-1] < 1.0


def test_a_force_gives_its_impulse_and_its_work():
    drivers = {"f": {"kind": "force", "entity": "b", "force": (3.0, 0, 1.0), "start": 0.1, "end": 0.333}}
    run = Run(world({"b": ball(0.1, mass=2.0)}, seconds=0.6, gravity=(0, 0, 0), drivers=drivers))
    expected = np.array([3.0, 0, 1.0]) * 0.233 / 2.0
    assert run.of("b", "velocity")[-1] == pytest.approx(expected, rel=1e-9, abs=1e-12)
    assert run.record("driver_work")[-1] == pytest.approx(run.record("kinetic_energy")[-1], rel=WORK)
    active = run.series("driver/active")[:, 0]
    assert active.tolist() == [0, 0, 0, 1, 1, 1, 1, 1, 1, *[0] * (len(active) - 9)]


def test_a_torque_spins_a_body_up():
    drivers = {"f": {"kind": "force", "entity": "b", "torque": (0, 0, 0.5), "end": 0.5}}
    run = Run(world({"b": box(0.2, 0.2, 0.2, mass=3.0)}, seconds=0.6, gravity=(0, 0, 0), drivers=drivers))
    inertia = 3.0 * (0.2**2 + 0.2**2) / 12
    assert run.of("b", "angular_velocity")[-1, 2] == pytest.approx(0.5 * 0.5 / inertia, rel=1e-3)


def test_a_motor_reaches_its_speed_with_limited_effort():
    joint = {"axle": {"kind": "hinge", "child": "wheel", "anchor": (0, 0, 0), "axis": (0, 0, 1)}}
    drivers = {"m": {"kind": "motor", "joint": "axle", "velocity": 6.0, "max_effort": 0.8, "end": 3.0}}
    wheel = entity({"kind": "cylinder", "radius": 0.3, "height": 0.05}, mass=4.0)
    run = Run(world({"wheel": wheel}, seconds=2.5, joints=joint, drivers=drivers))
    speed = run.of("wheel", "angular_velocity")[:, 2]
    inertia = 0.5 * 4.0 * 0.3**2
    early = run.time < 0.9 * 6.0 * inertia / 0.8
    assert speed[early] == pytest.approx(0.8 / inertia * run.time[early], rel=0.01, abs=1e-6)
    assert speed[-1] == pytest.approx(6.0, rel=0.01)
    assert run.record("driver_work")[-1] == pytest.approx(run.record("kinetic_energy")[-1], rel=WORK)


def test_a_kinematic_plate_pushes_a_box_at_its_own_speed():
    drivers = {"p": _path("plate", (0.0, (0, 0, 0.1), None), (2.0, (1.0, 0, 0.1), None))}
    entities = {
        "ground": floor(),
        "plate": box(0.05, 0.4, 0.1, at=(0, 0, 0.1), motion="kinematic"),
        "crate": box(0.2, 0.2, 0.2, at=(0.2, 0, 0.1), mass=2.0),
    }
    smooth = {"c": {"a": "plate", "b": "crate", "friction": 0.0}}
    run = Run(world(entities, seconds=1.5, friction=0.4, drivers=drivers, contacts=smooth))
    late = run.time > 0.5
    assert run.of("plate")[:, 0] == pytest.approx(0.5 * run.time, abs=1e-9)
    assert run.of("crate", "velocity")[late, 0] == pytest.approx(0.5, abs=0.01)
    gap = run.of("crate")[late, 0] - run.of("plate")[late, 0] - 0.125
    assert gap.min() > 0
    assert gap.max() < 2e-3
    # Steady pushing works against friction alone.
    work = run.record("driver_work")
    k = np.flatnonzero(late)[0]
    assert (work[-1] - work[k]) == pytest.approx(0.4 * 2.0 * G * 0.5 * (run.time[-1] - run.time[k]), rel=0.02)


def test_a_lift_does_work_against_gravity():
    keys = [(t, (0, 0, 0.4 * (1 - math.cos(math.pi * t))), None) for t in np.linspace(0, 1, 21)]
    drivers = {"p": _path("tray", *keys)}
    entities = {"tray": box(0.4, 0.4, 0.04, motion="kinematic"), "crate": box(0.2, 0.2, 0.2, at=(0, 0, 0.12), mass=2.0)}
    run = Run(world(entities, seconds=1.5, drivers=drivers))
    work, energy = run.record("driver_work"), run.record("kinetic_energy") + run.record("potential_energy")
    assert work[-1] == pytest.approx(2.0 * G * 0.8, rel=WORK)
    assert ((energy - energy[0]) - work).max() < WORK * 2.0 * G * 0.8
    assert run.of("crate")[-1, 2] == pytest.approx(0.92, abs=2e-3)


def test_what_hangs_on_an_accelerated_trolley_swings_back():
    a = 2.0
    keys = [(t, (0.5 * a * t * t, 0, 0), None) for t in np.linspace(0, 1.0, 41)]
    entities = {"trolley": box(0.1, 0.1, 0.1, motion="kinematic"), "bob": ball(0.02, at=(0, 0, -0.5))}
    joints = {"h": {"kind": "hinge", "parent": "trolley", "child": "bob", "anchor": (0, 0, 0), "axis": (0, 1, 0)}}
    run = Run(world(entities, seconds=0.9, fps=120, joints=joints, drivers={"p": _path("trolley", *keys)}))
    angle = np.arctan2(run.of("bob")[:, 0] - run.of("trolley")[:, 0], -run.of("bob")[:, 2])
    # Swings about the apparent vertical, so to twice atan(a / g).
    assert angle.min() == pytest.approx(-2 * math.atan(a / G), rel=0.02)
    energy = run.record("kinetic_energy") + run.record("potential_energy")
    assert run.record("driver_work")[-1] == pytest.approx(energy[-1] - energy[0], rel=0.02)


def test_a_turning_path_carries_what_it_touches():
    drivers = {"p": _path("arm", (0.0, (0, 0, 0), (0, 0, 0)), (1.0, (0, 0, 0), (0, 0, 1.5)), (2.0, (0, 0, 0), (0, 0, 3.0)))}
    entities = {"arm": box(2.0, 0.05, 0.1, motion="kinematic"), "b": ball(0.05, at=(0.4, 0.1, 0), mass=0.2)}
    run = Run(world(entities, seconds=0.5, gravity=(0, 0, 0), friction=0.0, drivers=drivers))
    assert run.of("arm", "angular_velocity")[5] == pytest.approx((0, 0, 1.5), abs=1e-3)
    # In the turning frame, along the arm: r'' = w^2 r; the ball starts at rest in the world.
    turn = 1.5 * (run.time[-1] - run.events("arm", "b")[0]["time"])
    start = 1.5 * run.time[-1] - turn
    r, d = 0.4 * math.cos(start) + 0.1 * math.sin(start), 0.025 + 0.05 + 0.001
    along = r * math.sinh(turn) + d * math.cosh(turn) - d
    across = r * math.cosh(turn) + d * math.sinh(turn)
    assert np.linalg.norm(run.of("b", "velocity")[-1]) == pytest.approx(1.5 * math.hypot(along, across), rel=0.02)


def test_preroll_settles_bodies_while_held_ones_wait():
    entities = {
        "ground": floor(),
        "loose": box(0.2, 0.2, 0.2, at=(0, 0, 0.15)),
        "waiting": ball(0.1, at=(1, 0, 1.0)),
        "thrown": ball(0.1, at=(2, 0, 1.0), v=(1, 0, 0)),
    }
    drivers = {"r": {"kind": "release", "entity": "waiting", "time": 0.25}}
    run = Run(world(entities, seconds=0.5, preroll=1.0, drivers=drivers))
    assert run.of("loose")[:, 2] == pytest.approx(0.101, abs=1e-4)
    assert run.of("waiting")[run.time <= 0.25, 2] == pytest.approx(1.0, abs=HELD)
    assert run.of("waiting")[-1, 2] < 0.8
    assert run.of("thrown")[0] == pytest.approx((2, 0, 1), abs=HELD)
    assert run.of("thrown", "velocity")[0] == pytest.approx((1, 0, 0), abs=1e-9)
    assert run.events("loose") == []


def test_declared_velocities_are_those_of_the_centre_of_mass():
    # The centre of mass is off the entity's origin: a light and a heavy part.
    lopsided = box(0.2, 0.1, 0.1, v=(0.3, -0.2, 0.1), w=(1.0, 2.0, -3.0), euler=(0.3, 0.4, 0.5))
    lopsided["parts"]["q"] = {
        "shape": {"kind": "box", "size": (0.1, 0.1, 0.1)},
        "pose": {"position": (0.2, 0, 0)},
        "material": "heavy",
    }
    spec = world({"b": lopsided}, seconds=0.1, gravity=(0, 0, 0), materials={"heavy": {"density": 8000.0}})
    run = Run(spec)
    assert run.of("b", "velocity")[0] == pytest.approx((0.3, -0.2, 0.1), abs=1e-12)
    assert run.of("b", "angular_velocity")[0] == pytest.approx((1.0, 2.0, -3.0), abs=1e-12)
    p = np.stack([run.record(f"momentum_{c}") for c in "xyz"], axis=1)
    assert np.abs(p - p[0]).max() < 1e-9


def test_drag_slows_a_free_body_exponentially():
    run = Run(world({"b": ball(0.1, v=(2, 0, 0), mass=1.0, drag=0.8)}, seconds=1.0, gravity=(0, 0, 0)))
    assert run.of("b", "velocity")[-1, 0] == pytest.approx(2 * math.exp(-0.8), rel=1e-3)


def test_what_moves_a_body_on_a_path_is_work_on_nothing_else():
    """A gate that turns, whose origin is far from its centre of mass, lifts itself and stops within a step: nothing takes energy."""
    drivers = {"p": _path("gate", (0.1, (0, 0, 1), (0, 0, 0)), (0.4173, (0.2, 0, 1.5), (0.3, 1.2, 0.4)))}
    gate = entity({"kind": "box", "size": (0.04, 0.3, 0.24)}, at=(0, 0, 1), motion="kinematic")
    gate["parts"]["p"]["pose"] = {"position": (0.3, 0.2, 0.1)}
    run = Run(world({"ground": floor(), "gate": gate}, seconds=0.6, drivers=drivers))
    assert np.abs(run.of("gate", "velocity")).max() > 0.5
    assert np.abs(run.record("driver_work")).max() == 0.0


def test_a_body_on_a_path_works_on_what_hangs_on_it_and_not_on_itself():
    """Own choice of the bound: a heavy trolley that turns, rises and stops, and a bob that weighs a thousandth of it."""
    drivers = {"p": _path("trolley", (0.1, (0, 0, 1), (0, 0, 0)), (0.4173, (0.2, 0, 1.5), (0.3, 0.4, 0.4)))}
    trolley = entity({"kind": "box", "size": (0.1, 0.1, 0.1)}, at=(0, 0, 1), motion="kinematic", mass=300.0)
    trolley["parts"]["p"]["pose"] = {"position": (0.3, 0.2, 0.1)}
    entities = {"trolley": trolley, "bob": ball(0.02, at=(0, 0, 0.5), mass=0.3)}
    joints = {"h": {"kind": "hinge", "parent": "trolley", "child": "bob", "anchor": (0, 0, 1), "axis": (0, 1, 0)}}
    run = Run(world(entities, seconds=0.6, joints=joints, drivers=drivers, settings={"step": 2e-4}))
    energy = run.record("kinetic_energy") + run.record("potential_energy")
    found = energy - energy[0] - run.record("driver_work")
    assert np.abs(found).max() < WORK * np.ptp(energy), (found, np.ptp(energy))


def _gun_on_its_carriage(drivers, **more):
    """A barrel of 3 kg welded to a carriage of 1 kg, without gravity."""
    entities = {"carriage": box(0.4, 0.2, 0.1, mass=1.0), "gun": box(0.4, 0.1, 0.1, at=(0, 0, 0.1), mass=3.0)}
    weld = {"kind": "weld", "parent": "carriage", "child": "gun", "anchor": (0, 0, 0.05)}
    return Run(world(entities, seconds=0.5, gravity=(0, 0, 0), joints={"w": weld}, drivers=drivers, **more))


def test_a_force_on_what_is_welded_to_a_moving_body_pushes_both():
    """Closed form: F t = (m + M) v; the weld joins the two, and the one that is pushed has no degrees of freedom of its own."""
    push = {"kind": "force", "entity": "gun", "force": (-8.0, 0, 0), "torque": (0, 0.2, 0), "start": 0.1, "end": 0.2}
    run = _gun_on_its_carriage({"p": push})
    momentum = 3.0 * run.of("gun", "velocity")[-1, 0] + run.of("carriage", "velocity")[-1, 0]
    assert momentum == pytest.approx(-8.0 * 0.1, rel=1e-6)


def test_a_release_of_what_is_welded_holds_both():
    drivers = {
        "p": {"kind": "force", "entity": "carriage", "force": (4.0, 0, 0), "start": 0.0, "end": 0.5},
        "r": {"kind": "release", "entity": "gun", "time": 0.25},
    }
    run = _gun_on_its_carriage(drivers)
    held = run.time <= 0.25
    assert np.abs(run.of("gun")[held] - (0, 0, 0.1)).max() < HELD
    assert np.abs(run.of("carriage")[held]).max() < HELD
    assert run.of("gun", "velocity")[-1, 0] > 0.1
