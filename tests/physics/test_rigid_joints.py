"""Joints, springs, ropes and free rotation against closed forms."""

import math
import re

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipk
from worldagent.tests.physics.rigid_world import G, Run, ball, box, entity, floor, solver, world
from worldagent.worlds.errors import InputError

PERIOD = 1e-3
"""Gate of the table, relative."""
ENERGY = 5e-3
"""Gate of the table: drift over 10 s relative to the energy scale."""
ANGULAR_MOMENTUM, PRECESSION = 5e-4, 5e-3
"""Gates of the table, relative."""
SAG = 0.03
"""Sag of a hanging chain against the catenary, relative."""
LENGTH = 0.01
"""Change of a rope's length, relative: the connection at its far end is a soft constraint."""


def _crossings(time, value):
    """Times at which `value` rises through zero, interpolated."""
    k = np.flatnonzero((value[:-1] < 0) & (value[1:] >= 0))
    return time[k] - value[k] * (time[k + 1] - time[k]) / (value[k + 1] - value[k])


@pytest.mark.parametrize("amplitude", [0.1, 1.5])
def test_a_pendulum_has_the_period_of_the_elliptic_integral(amplitude):
    length, radius = 0.8, 0.05
    at = (length * math.sin(amplitude), 0, -length * math.cos(amplitude))
    joint = {"h": {"kind": "hinge", "child": "bob", "anchor": (0, 0, 0), "axis": (0, 1, 0)}}
    run = Run(world({"bob": ball(radius, at=at)}, seconds=10, fps=120, joints=joint))
    angle = np.arctan2(run.of("bob")[:, 0], -run.of("bob")[:, 2])
    periods = np.diff(_crossings(run.time, angle))
    reduced = length * (1 + 0.4 * (radius / length) ** 2)
    exact = 4 * ellipk(math.sin(amplitude / 2) ** 2) * math.sqrt(reduced / G)
    assert periods.mean() == pytest.approx(exact, rel=PERIOD)
    # The joint's coordinate is zero at frame 0 and measures the same motion.
    assert np.allclose(run.joint("h"), amplitude - angle, atol=1e-6) or np.allclose(run.joint("h"), angle - amplitude, atol=1e-6)


@pytest.mark.parametrize("speed", [0.5, -1.2])
def test_a_pendulum_that_starts_with_a_velocity_rises_as_high_as_its_energy_says(speed):
    length, radius = 0.8, 0.05
    joint = {"h": {"kind": "hinge", "child": "bob", "anchor": (0, 0, 0), "axis": (0, 1, 0)}}
    bob = ball(radius, at=(0, 0, -length), v=(speed, 0, 0), w=(0, -speed / length, 0))
    run = Run(world({"bob": bob}, seconds=2, fps=120, joints=joint))
    assert run.of("bob", "velocity")[0] == pytest.approx((speed, 0, 0), abs=1e-9)
    assert run.of("bob", "angular_velocity")[0] == pytest.approx((0, -speed / length, 0), abs=1e-9)
    energy = 0.5 * speed**2 * (1 + 0.4 * (radius / length) ** 2)
    assert run.of("bob")[:, 2].max() + length == pytest.approx(energy / G, rel=2e-3)


def test_a_chain_starts_with_the_velocities_of_all_its_links():
    """A double pendulum whose rods turn at different rates: the second one's joint is carried along by the first."""
    spins, length, top, speed = (2.0, -3.0), 0.5, np.zeros(3), np.zeros(3)
    rods, joints = {}, {}
    for k, spin in enumerate(spins):
        arm = np.array([0, 0, -length / 2])
        turn = np.array([0, spin, 0])
        linear = speed + np.cross(turn, arm)
        rods[f"r{k}"] = box(0.02, 0.02, length, at=top + arm, mass=1.0, v=linear, w=turn)
        joints[f"j{k}"] = {
            "kind": "hinge", "child": f"r{k}", "parent": f"r{k - 1}" if k else None, "anchor": tuple(top), "axis": (0, 1, 0),
        }  # fmt: skip
        top, speed = top + 2 * arm, speed + np.cross(turn, 2 * arm)
    run = Run(world(rods, seconds=0.1, fps=60, joints=joints))
    for channel in ("velocity", "angular_velocity"):
        declared = "linear_velocity" if channel == "velocity" else channel
        for name in ("r0", "r1"):
            assert run.of(name, channel)[0] == pytest.approx(rods[name]["physics"][declared], abs=1e-9)


def test_a_velocity_that_a_joint_does_not_allow_is_refused_with_the_nearest_that_it_allows():
    joint = {"h": {"kind": "hinge", "child": "bob", "anchor": (0, 0, 0), "axis": (0, 1, 0)}}

    def started(linear, angular):
        return world({"bob": ball(0.05, at=(0, 0, -0.8), v=linear, w=angular)}, joints=joint)

    with pytest.raises(InputError, match="do not let it start") as refused:
        solver(started((0, 1, 0), (0, 0, 0)))
    assert "linear_velocity (0, 0, 0)" in str(refused.value)
    with pytest.raises(InputError, match="nearest that they allow") as refused:
        solver(started((1, 0, 0), (0, 0, 0)))
    numbers = re.search(r"Declare that one, linear_velocity \((.*?)\) and angular_velocity \((.*?)\)", str(refused.value))
    assert numbers is not None
    linear, angular = (tuple(float(v) for v in numbers[k].split(",")) for k in (1, 2))
    solver(started(linear, angular))  # the numbers of the message are taken


def test_what_hangs_on_a_moving_body_declares_its_own_velocity():
    def cart(**wheel):
        made = {"cart": box(0.4, 0.2, 0.1, at=(0, 0, 1), v=(1, 0, 0)), "wheel": ball(0.05, at=(0, 0, 0.9), **wheel)}
        joint = {"axle": {"kind": "hinge", "child": "wheel", "parent": "cart", "anchor": (0, 0, 0.9), "axis": (0, 1, 0)}}
        return world(made, joints=joint)

    rolling = solver(cart(v=(1, 0, 0), w=(0, 20, 0)))
    wheel = rolling.index().bodies.index("wheel/body")
    assert rolling.frame_data()["angular_velocity"][wheel] == pytest.approx((0, 20, 0))
    with pytest.raises(InputError, match=r"'wheel'.*linear_velocity \(1, 0, 0\).*brake or hold that in the preroll"):
        solver(cart())


def _double_pendulum(seconds, start=(1.2, 0.9)):
    rods, joints = {}, {}
    top, length = np.zeros(3), 0.5
    for k, theta in enumerate(start):
        along = np.array([math.sin(theta), 0, -math.cos(theta)])
        rods[f"r{k}"] = box(0.02, 0.02, length, at=top + along * length / 2, euler=(0, -theta, 0), mass=1.0)
        joints[f"j{k}"] = {
            "kind": "hinge", "child": f"r{k}", "parent": f"r{k - 1}" if k else None, "anchor": tuple(top), "axis": (0, 1, 0),
        }  # fmt: skip
        top = top + along * length
    return Run(world(rods, seconds=seconds, fps=60, joints=joints)), length


def test_a_double_pendulum_keeps_its_energy_for_ten_seconds():
    run, length = _double_pendulum(10.0)
    energy = run.record("kinetic_energy") + run.record("potential_energy")
    assert np.abs(energy - energy[0]).max() < ENERGY * 2.0 * 2 * G * length


def test_a_double_pendulum_follows_an_independent_integration():
    run, length = _double_pendulum(2.0)
    inertia = (length**2 + 0.02**2) / 12

    def rhs(_, y):
        a, b, va, vb = y
        half = length / 2
        mass = np.array(
            [
                [inertia + half**2 + length**2, length * half * math.cos(a - b)],
                [length * half * math.cos(a - b), inertia + half**2],
            ]
        )
        force = [
            -length * half * math.sin(a - b) * vb**2 - G * (half + length) * math.sin(a),
            length * half * math.sin(a - b) * va**2 - G * half * math.sin(b),
        ]
        return [va, vb, *np.linalg.solve(mass, force)]

    exact = solve_ivp(rhs, (0, 2), [1.2, 0.9, 0, 0], method="DOP853", t_eval=run.time, rtol=1e-11, atol=1e-12).y
    x = length * np.sin(exact[0]) + length / 2 * np.sin(exact[1])
    z = -length * np.cos(exact[0]) - length / 2 * np.cos(exact[1])
    error = np.hypot(run.of("r1")[:, 0] - x, run.of("r1")[:, 2] - z)
    assert error.max() < 0.01 * length


def _spinning(size, w, seconds):
    return Run(
        world({"b": box(*size, w=w)}, seconds=seconds, fps=120, gravity=(0, 0, 0), settings={"sleep": False, "step": 2.5e-4})
    )


def _angular_momentum(run, size):
    from worldagent.worlds.arrays import rotation_matrix

    x, y, z = size
    mass = 1000.0 * x * y * z
    inertia = mass / 12 * np.diag([y * y + z * z, x * x + z * z, x * x + y * y])
    turn = rotation_matrix(run.of("b", "quaternion"))
    return np.einsum("nij,jk,nlk,nl->ni", turn, inertia, turn, run.of("b", "angular_velocity"))


def test_an_intermediate_axis_spin_tumbles_and_keeps_its_angular_momentum():
    size = (0.1, 0.2, 0.3)
    run = _spinning(size, (0.01, 5.0, 0.01), 10.0)
    momentum = _angular_momentum(run, size)
    assert np.abs(momentum - momentum[0]).max() < ANGULAR_MOMENTUM * np.linalg.norm(momentum[0])
    energy = run.record("kinetic_energy")
    assert np.abs(energy / energy[0] - 1).max() < ENERGY
    from worldagent.worlds.arrays import rotation_matrix

    axis = rotation_matrix(run.of("b", "quaternion"))[:, :, 1] @ (momentum[0] / np.linalg.norm(momentum[0]))
    assert axis.min() < -0.9, "the body should flip over"


def test_a_symmetric_body_precesses_freely_at_the_rate_of_euler():
    size, tilt, rate = (0.3, 0.3, 0.1), 0.3, 8.0
    w = (rate * math.sin(tilt), 0.0, rate * math.cos(tilt))
    run = _spinning(size, w, 6.0)
    momentum = _angular_momentum(run, size)
    assert np.abs(momentum - momentum[0]).max() < ANGULAR_MOMENTUM * np.linalg.norm(momentum[0])
    from worldagent.worlds.arrays import rotation_matrix

    axis = rotation_matrix(run.of("b", "quaternion"))[:, :, 2]
    up = momentum[0] / np.linalg.norm(momentum[0])
    side = axis[0] - (axis[0] @ up) * up
    side /= np.linalg.norm(side)
    phase = np.unwrap(np.arctan2(axis @ np.cross(up, side), axis @ side))
    transverse = 1000.0 * 0.3 * 0.3 * 0.1 / 12 * (0.3**2 + 0.1**2)
    assert phase[-1] / run.time[-1] == pytest.approx(np.linalg.norm(momentum[0]) / transverse, rel=PRECESSION)


def test_a_mass_on_a_spring_has_the_period_of_a_harmonic_oscillator():
    mass, stiffness = 2.0, 300.0
    joint = {
        "s": {
            "kind": "spring", "child": "b", "parent_point": (0, 0, 1), "child_point": (0, 0, 0),
            "stiffness": stiffness, "rest_length": 0.9,
        }
    }  # fmt: skip
    run = Run(world({"b": ball(0.05, mass=mass)}, seconds=5, fps=240, joints=joint))
    z = run.of("b")[:, 2]
    periods = np.diff(_crossings(run.time, z - z.mean()))
    assert periods.mean() == pytest.approx(2 * math.pi * math.sqrt(mass / stiffness), rel=PERIOD)
    energy = run.record("kinetic_energy") + run.record("potential_energy")
    assert np.ptp(energy) < ENERGY * mass * G * np.ptp(z)


def _lifted(seconds, *, rest=0.96, rope=False, parent=None, drivers=None, others=None):
    """A box of 1 kg on a floor, whose top hangs on a spring of 200 N/m; 1 m long, it is stretched by 1 m - `rest`."""
    spring = {
        "kind": "spring", "child": "b", "child_point": (0, 0, 0.2), "parent": parent, "parent_point": (0, 0, 1.2),
        "stiffness": 200.0, "damping": 1.0, "rest_length": rest, "rope": rope,
    }  # fmt: skip
    bodies = {"ground": floor(), "b": box(0.2, 0.2, 0.2, at=(0, 0, 0.1), mass=1.0), **(others or {})}
    run = Run(world(bodies, seconds=seconds, joints={"s": spring}, drivers=drivers or {}))
    energy = run.record("kinetic_energy") + run.record("potential_energy") - run.record("driver_work")
    return run, energy - energy[0], run.series("asleep")[:, run.index.bodies.index("b/body")]


@pytest.mark.parametrize(("rest", "rope"), [(0.96, False), (1.04, False), (0.98, True), (1.3, True)])
def test_a_spring_on_a_sleeping_body_gains_no_energy(rest, rope):
    """It is stretched, pressed or slack, and less than the weight of what it is tied to: nothing moves, so nothing may be stored."""
    run, energy, asleep = _lifted(1.0, rest=rest, rope=rope)
    assert asleep[0] == 0
    assert asleep[-6:].all()
    assert np.abs(energy).max() < 1e-4  # it settles 5 micrometres into the skins
    assert run.record("potential_energy")[-1] == pytest.approx(
        1.0 * G * 0.101 + 0.5 * 200.0 * (0.0 if rope and rest > 1 else 0.999 - rest) ** 2, abs=1e-4
    )


def test_a_spring_whose_far_end_moves_on_pulls_a_resting_body_up():
    hook = box(0.1, 0.1, 0.1, at=(0, 0, 1.25), motion="kinematic")
    keys = {k: {"time": t, "pose": {"position": (0, 0, z)}} for k, t, z in (("a", 0, 1.25), ("b", 1, 1.25), ("c", 2, 2.25))}
    up = {"up": {"kind": "path", "entity": "hook", "keys": keys}}
    run, energy, asleep = _lifted(3.0, rest=1.0, parent="hook", drivers=up, others={"hook": hook})
    z = run.of("b")[:, 2]
    assert np.ptp(z[:24]) < 1e-4
    assert z[-1] == pytest.approx(1.101 - G / 200.0, abs=0.1)
    assert energy.max() < 1e-3
    assert not asleep[30:].any()


def test_what_adds_to_the_spring_of_a_sleeping_body_wakes_it():
    """8 N of the spring and 5 N of a driver are more than its weight; 1 N more alone is not."""
    more = {"kind": "force", "entity": "b", "start": 1.5, "end": 1.75}
    for force, rises in ((1.0, False), (5.0, True)):
        run, energy, asleep = _lifted(3.0, drivers={"f": more | {"force": (0, 0, force)}})
        assert asleep[20:36].all()
        assert (run.of("b")[:, 2].max() > 0.11) == rises
        assert energy.max() < 1e-3


def test_a_hinge_with_a_spring_sleeps_without_a_gain():
    plank = box(0.4, 0.05, 0.05, at=(0.25, 0, 0.0255), mass=1.0)
    hinge = {"kind": "hinge", "child": "b", "anchor": (0, 0, 0.0255), "axis": (0, 1, 0), "stiffness": 30.0, "damping": 0.5}
    run = Run(world({"ground": floor(), "b": plank}, seconds=2.0, joints={"h": hinge}))
    energy = run.record("kinetic_energy") + run.record("potential_energy")
    assert run.series("asleep")[-6:].all()
    assert np.abs(energy - energy[0]).max() < 1e-3


def test_a_rope_spring_only_pulls():
    joint = {
        "s": {
            "kind": "spring", "child": "b", "parent_point": (0, 0, 1), "child_point": (0, 0, 0.5),
            "stiffness": 1e4, "damping": 5.0, "rest_length": 0.7, "rope": True,
        }
    }  # fmt: skip
    run = Run(world({"b": ball(0.05, at=(0, 0, 0.5), mass=1.0)}, seconds=1.0, fps=120, joints=joint))
    z = run.of("b")[:, 2]
    free = run.time < 0.15
    assert np.allclose(z[free], 0.5 - 0.5 * G * run.time[free] ** 2, atol=1e-3)
    assert z.min() == pytest.approx(1 - 0.7, abs=0.03)


def _rope(points, *, radius=0.005, segments=40, **more):
    return entity(generator={"kind": "rope", "points": points, "radius": radius, "segments": segments, **more})


def _joint_positions(run, name, half):
    """Ends of the capsules of a rope, shape (segments + 1, 3), at the last frame."""
    from worldagent.worlds.arrays import rotation_matrix

    count = sum(b.startswith(f"{name}/") for b in run.index.bodies)
    ends = []
    for k in range(count):
        p, q = run.of(name, body=f"seg{k:03d}")[-1], run.of(name, "quaternion", f"seg{k:03d}")[-1]
        axis = rotation_matrix(q)[:, 2]
        ends.append(p - half * axis)
    return np.array([*ends, p + half * axis])


@pytest.mark.parametrize("anchor", ["world", "post"])
def test_a_rope_between_two_points_hangs_in_a_catenary(anchor):
    span, length, segments = 1.0, 1.3, 30
    # Starts as a V of the right length.
    depth = math.sqrt((length / 2) ** 2 - (span / 2) ** 2)
    rope = _rope(
        [(0, 0, 0), (span / 2, 0, -depth), (span, 0, 0)], segments=segments, damping=2e-3, attach_start=anchor, attach_end=anchor
    )
    entities = {"r": rope}
    if anchor == "post":
        entities["post"] = box(span + 0.2, 0.02, 0.02, at=(span / 2, 0, 0.02), motion="static")
    run = Run(world(entities, seconds=6.0))
    points = _joint_positions(run, "r", length / segments / 2)
    c = brentq(lambda c: 2 * c * math.sinh(span / 2 / c) - length, 0.05, 10)
    assert -points[:, 2].min() == pytest.approx(c * (math.cosh(span / 2 / c) - 1), rel=SAG)
    assert np.linalg.norm(np.diff(points, axis=0), axis=1).sum() == pytest.approx(length, rel=LENGTH)
    assert np.linalg.norm(points[0]) < 1e-3
    assert np.linalg.norm(points[-1] - (span, 0, 0)) < 1e-3
    assert run.record("joint_error")[-1] < 1e-4


def test_a_rope_carries_a_dynamic_body():
    rope = _rope([(0, 0, 0), (0, 0, -0.5)], segments=10, attach_start="world", attach_end="load")
    run = Run(world({"r": rope, "load": ball(0.1, at=(0, 0, -0.6), mass=5.0)}, seconds=1.0))
    assert run.of("load")[-1] == pytest.approx((0, 0, -0.6), abs=2e-3)


def test_a_weld_holds_until_it_is_detached_and_the_pair_collides_afterwards():
    beam = box(0.4, 0.1, 0.1, at=(0, 0, 1.0), motion="static")
    load = box(0.1, 0.1, 0.1, at=(0.0, 0, 0.9), mass=2.0)
    run = Run(
        world(
            {"ground": floor(), "beam": beam, "load": load},
            seconds=1.0,
            joints={"w": {"kind": "weld", "parent": "beam", "child": "load", "anchor": (0, 0, 0.95)}},
            drivers={"cut": {"kind": "detach", "joint": "w", "time": 0.5}},
        )
    )
    z = run.of("load")[:, 2]
    held = run.time <= 0.5
    assert np.ptp(z[held]) < 1e-4
    assert z[held][0] == pytest.approx(0.9, abs=1e-3)
    assert run.record("joint_error")[held].max() < 1e-4
    fall = run.time[-1] - 0.5
    bottom = max(z[held][-1] - 0.5 * G * fall**2, 0.05)
    assert z[-1] == pytest.approx(bottom, abs=5e-3)


def test_a_weld_between_dynamic_bodies_keeps_their_pose_and_opens():
    a, b = (
        box(0.1, 0.1, 0.1, at=(0, 0, 0), w=(0, 0, 3.0)),
        box(0.1, 0.1, 0.1, at=(0.2, 0, 0.05), mass=0.5, w=(0, 0, 3.0), v=(0, 0.6, 0)),
    )
    spec = world(
        {"a": a, "b": b},
        seconds=1.0,
        gravity=(0, 0, 0),
        joints={"w": {"kind": "weld", "parent": "a", "child": "b", "anchor": (0.1, 0, 0)}},
        drivers={"cut": {"kind": "detach", "joint": "w", "time": 0.6}},
    )
    run = Run(spec)
    distance = np.linalg.norm(run.of("a") - run.of("b"), axis=1)
    held = run.time < 0.6
    assert np.ptp(distance[held]) < 1e-3
    assert distance[-1] > distance[0] + 0.01
    p = np.stack([run.record(f"momentum_{c}") for c in "xyz"], axis=1)
    assert np.abs(p - p[0]).max() < 1e-3


def test_a_slide_with_friction_moves_only_under_more_than_its_friction():
    def pushed(force):
        spec = world(
            {"b": box(0.1, 0.1, 0.1, mass=2.0)},
            seconds=1.0,
            joints={"s": {"kind": "slide", "child": "b", "anchor": (0, 0, 0), "axis": (1, 0, 0), "friction": 5.0}},
            drivers={"f": {"kind": "force", "entity": "b", "force": (force, 0, 0), "end": 2.0}},
        )
        return Run(spec).of("b")[-1]

    assert abs(pushed(4.5)[0]) < 2e-4
    moved = pushed(9.0)
    assert moved[0] == pytest.approx(0.5 * (9.0 - 5.0) / 2.0, rel=0.01)
    assert abs(moved[2]) < 1e-9


def test_a_hinge_stops_at_its_range():
    joint = {"h": {"kind": "hinge", "child": "door", "anchor": (0, 0, 0), "axis": (0, 0, 1), "range": (-0.1, 0.8)}}
    spec = world(
        {"door": box(0.6, 0.04, 1.0, at=(0.3, 0, 0))},
        seconds=2.0,
        joints=joint,
        drivers={"f": {"kind": "force", "entity": "door", "torque": (0, 0, 5.0), "end": 5.0}},
    )
    angle = Run(spec).joint("h")
    assert angle[-1] == pytest.approx(0.8, abs=0.01)
    assert angle.max() < 0.85


def test_a_child_of_a_static_or_nested_parent_turns_about_its_world_anchor():
    frame = box(0.1, 0.1, 0.1, at=(1, 2, 0.9), euler=(0, 0, 0.7), motion="static")
    arm = box(0.5, 0.05, 0.05, at=(1.3, 2.0, 0.9), euler=(0, 0, 0.0))
    hand = box(0.05, 0.05, 0.3, at=(1.55, 2.0, 0.75))
    joints = {
        "a": {"kind": "hinge", "parent": "frame", "child": "arm", "anchor": (1.05, 2.0, 0.9), "axis": (0, 1, 0)},
        "b": {"kind": "ball", "parent": "arm", "child": "hand", "anchor": (1.55, 2.0, 0.9)},
    }
    run = Run(world({"frame": frame, "arm": arm, "hand": hand}, seconds=0.6, fps=120, joints=joints))
    arm_arm = np.linalg.norm(run.of("arm") - (1.05, 2.0, 0.9), axis=1)
    assert np.ptp(arm_arm) < 1e-9
    assert np.ptp(run.of("arm")[:, 1]) < 1e-9
    assert np.linalg.norm(run.of("hand") - run.of("arm"), axis=1).max() < 0.45
    energy = run.record("kinetic_energy") + run.record("potential_energy")
    assert np.abs(energy - energy[0]).max() < 0.02 * np.ptp(run.record("kinetic_energy"))
