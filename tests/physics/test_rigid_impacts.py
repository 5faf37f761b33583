"""Impacts: restitution, momentum, events, energy."""

import math

import numpy as np
import pytest
from worldagent.tests.physics.rigid_world import G, Run, ball, box, floor, world

RESTITUTION = 0.01
"""Gate of the table, absolute."""
PLASTIC = 0.02
"""Largest rebound of a material without restitution: what is pushed out of the skin comes back as speed."""
MOMENTUM = 5e-4
"""Gate of the table, relative."""
IMPULSE, CLOSING = 0.01, 0.02
"""Relative errors of logged impulses and closing speeds."""


@pytest.mark.parametrize("shape", ["ball", "box"])
@pytest.mark.parametrize("e", [0.0, 0.3, 0.6, 0.9, 1.0])
def test_restitution_is_the_ratio_of_speeds(shape, e):
    height = 0.37
    body = ball(0.1, at=(0, 0, 0.1 + height)) if shape == "ball" else box(0.3, 0.2, 0.1, at=(0, 0, 0.05 + height))
    # Without gravity the speeds before and after are free of where within a frame the impact falls.
    body["physics"]["linear_velocity"] = (0, 0, -2.7)
    run = Run(world({"ground": floor(), "b": body}, seconds=0.5, restitution=e, gravity=(0, 0, 0)))
    rebound = run.of("b", "velocity")[-1, 2] / 2.7
    assert rebound == pytest.approx(e, abs=PLASTIC if e == 0 else RESTITUTION)


def test_a_ball_that_lands_sliding_does_not_hop_while_it_settles():
    """Nine drops from heights that differ by parts of a step's travel: what follows the landing is no rebound."""
    for k in range(9):
        thrown = ball(0.1, at=(0, 0, 0.4 + 2e-4 * k), v=(8, 0, 0), mass=30.0)
        spec = world({"ground": floor(60.0), "b": thrown}, seconds=0.4, friction=0.8, fps=240, settings={"step": 5e-4})
        up = Run(spec).of("b", "velocity")[:, 2]
        assert up[int(np.argmin(up)) :].max() < 0.05


@pytest.mark.parametrize("e", [0.5, 0.9])
def test_a_dropped_ball_rises_to_e_squared_of_its_height(e):
    height = 0.5
    run = Run(world({"ground": floor(), "b": ball(0.1, at=(0, 0, 0.1 + height))}, seconds=1.0, restitution=e, fps=240))
    z = run.of("b")[:, 2] - 0.1 - 0.001
    bounce = round(math.sqrt(2 * height / G) * 240) + 2
    fall = height - 0.001
    assert math.sqrt(z[bounce : bounce + round(0.6 * 240)].max() / fall) == pytest.approx(e, abs=RESTITUTION)


def test_a_perfectly_elastic_ball_keeps_its_energy_over_many_bounces():
    run = Run(world({"ground": floor(), "b": ball(0.1, at=(0, 0, 0.4))}, seconds=5.0, restitution=1.0))
    energy = run.record("kinetic_energy") + run.record("potential_energy")
    scale = energy[0] - run.solver.model.body_mass[-1] * G * 0.101
    assert np.abs(energy - energy[0]).max() < 0.02 * scale
    assert len(run.events("b", "ground")) >= 9


@pytest.mark.parametrize("ratio", [1.0, 3.0, 1e4])
def test_two_bodies_keep_their_momentum_and_separate_as_they_should(ratio):
    e, v = 0.7, 2.0
    bodies = {"a": ball(0.05, at=(0, 0, 0), v=(v, 0, 0), mass=1.0), "b": ball(0.05, at=(0.3, 0, 0), mass=ratio)}
    run = Run(world(bodies, seconds=0.6, restitution=e, gravity=(0, 0, 0)))
    assert np.abs(run.record("momentum_x") / v - 1).max() < MOMENTUM
    va, vb = (run.of(n, "velocity")[-1, 0] for n in "ab")
    assert (vb - va) / v == pytest.approx(e, abs=RESTITUTION)
    assert va == pytest.approx((1 - ratio * e) / (1 + ratio) * v, abs=RESTITUTION * v)


def test_a_newton_cradle_with_gaps_hands_the_speed_on():
    balls = {f"b{k}": ball(0.05, at=(0.105 * k + (0.05 if k else 0.0), 0, 0)) for k in range(5)}
    balls["b0"]["physics"]["linear_velocity"] = (1.0, 0, 0)
    run = Run(world(balls, seconds=0.5, restitution=1.0, gravity=(0, 0, 0)))
    p = run.record("momentum_x")
    assert np.abs(p / p[0] - 1).max() < MOMENTUM
    speeds = [run.of(f"b{k}", "velocity")[-1, 0] for k in range(5)]
    assert speeds == pytest.approx([0, 0, 0, 0, 1.0], abs=0.01)


ENERGY = 1e-3
"""Largest gain of energy, relative to what was there at first."""


def chain(shape, let, e, gap, friction=None, fps=240):
    """Five equal bodies in line, the first `let` of which run at 1 m/s, touching each other, into the rest; with friction on a floor."""
    made, line = {}, 0.05 * (friction is not None) + 0.001
    for k in range(5):
        at = ((0.1 + gap) * k - (0.05 if k < let else 0.0), 0, line)
        v = (1.0 if k < let else 0.0, 0, 0)
        made[f"b{k}"] = ball(0.05, at=at, mass=1.0, v=v) if shape == "ball" else box(0.1, 0.1, 0.1, at=at, mass=1.0, v=v)
    if friction is None:
        return Run(world(made, seconds=0.25, restitution=e, gravity=(0, 0, 0), fps=fps))
    return Run(world({"ground": floor(), **made}, seconds=0.25, restitution=e, friction=friction, fps=fps))


@pytest.mark.parametrize("gap", [0.001, 0.0012])
@pytest.mark.parametrize("let", [1, 2])
@pytest.mark.parametrize("e", [0.0, 0.5, 0.9, 1.0])
def test_a_chain_of_touching_balls_gains_no_energy_and_keeps_its_momentum(e, let, gap):
    run = chain("ball", let, e, gap)
    energy, p = run.record("kinetic_energy"), run.record("momentum_x")
    assert np.diff(energy).max() < ENERGY * energy[0]
    assert energy[-1] < energy[0] * ((0.25 + 0.75 * e**2) * (1 + ENERGY) if e else 0.5)
    assert energy[-1] > 0.95 * energy[0] or e < 1.0
    assert np.abs(p / p[0] - 1).max() < 1e-12
    # What leaves goes on leaving: a contact that opens neither sticks nor pushes.
    if e == 1.0:
        speeds = np.array([run.of(f"b{k}", "velocity")[-10:, 0] for k in range(5)])
        assert np.ptp(speeds, axis=1).max() < 1e-3


@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("shape", ["ball", "box"])
@pytest.mark.parametrize("let", [1, 2])
@pytest.mark.parametrize("e", [0.0, 0.5, 0.9, 1.0])
def test_a_touching_chain_on_a_floor_gains_no_energy_in_any_frame(e, let, shape, friction):
    run = chain(shape, let, e, 0.001, friction)
    energy = run.record("kinetic_energy") + run.record("potential_energy") - run.record("potential_energy")[0]
    energy -= 0.5 * 5e-4 * G * run.record("momentum_z")  # velocities are half a step behind
    assert np.diff(energy).max() < (ENERGY + PLASTIC**2) * energy[0]
    assert energy.max() < energy[0] * (1 + 1e-9)
    assert run.record("momentum_x")[-1] < let * (1 + ENERGY)


@pytest.mark.parametrize("spin", [-8.0, 0.0, 8.0])
def test_a_box_that_lands_obliquely_on_an_edge_gains_nothing(spin):
    """Newton's restitution with Coulomb's friction would give it a third of what the impact exchanged."""
    lands = box(0.1, 0.1, 0.1, at=(0, 0, 0.25), euler=(0, 0.5, 0), v=(2.0, 0, -2.0), w=(0, spin, 0), mass=1.0)
    run = Run(world({"ground": floor(), "b": lands}, seconds=1.0, restitution=1.0, friction=0.5, fps=240))
    energy = run.record("kinetic_energy") + run.record("potential_energy")
    energy[1:] -= 0.5 * 5e-4 * G * run.record("momentum_z")[1:]  # velocities are half a step behind
    assert np.diff(energy).max() < ENERGY * energy[0]


def test_a_head_on_collision_is_logged_once_with_its_impulse_and_closing_speed():
    m, v, e = 1.5, 1.3, 0.4
    bodies = {"a": ball(0.1, at=(-0.4, 0, 0), v=(v, 0, 0), mass=m), "b": ball(0.1, at=(0.4, 0, 0), v=(-v, 0, 0), mass=m)}
    run = Run(world(bodies, seconds=0.6, restitution=e, gravity=(0, 0, 0)))
    (event,) = run.events("a", "b")
    assert event["speed"] == pytest.approx(2 * v, rel=CLOSING)
    assert event["impulse"] == pytest.approx(m * v * (1 + e), rel=IMPULSE)
    assert event["time"] == pytest.approx((0.6 - 0.001) / (2 * v), abs=2 * 5e-4)
    assert np.linalg.norm(event["point"]) < 0.01
    total = sum(f["contact/impulse"].sum() for f in run.frames)
    assert total == pytest.approx(m * v * (1 + e), rel=IMPULSE)


def test_the_floor_carries_the_weight_of_a_resting_body():
    run = Run(
        world({"ground": floor(), "b": box(0.2, 0.2, 0.2, at=(0, 0, 0.1), mass=3.0)}, seconds=0.5, settings={"sleep": False})
    )
    given = sum(f["contact/impulse"].sum() for f in run.frames[3:])
    assert given == pytest.approx(3.0 * G * (len(run.frames) - 3) / 24, rel=IMPULSE)
    assert run.events() == []


def test_a_bouncing_ball_is_logged_once_per_bounce_and_never_after_it_lies_still():
    run = Run(world({"ground": floor(), "b": ball(0.1, at=(0, 0, 0.6))}, seconds=4.0, restitution=0.5))
    events = run.events("b", "ground")
    speeds = [e["speed"] for e in events]
    assert speeds[0] == pytest.approx(math.sqrt(2 * G * 0.499), rel=CLOSING)
    assert np.allclose(np.array(speeds[1:5]) / np.array(speeds[:4]), 0.5, atol=0.02)
    # Hops shorter than the debounce time continue the contact: 2 v / g > 5 ms.
    assert all(s > 0.5 * G * 0.005 * 0.8 for s in speeds)
    assert len(events) <= 9
    assert run.frames[-1]["asleep"][0]


def test_a_sleeping_stack_that_is_hit_logs_only_real_touches():
    boxes = {f"b{k}": box(0.1, 0.1, 0.1, at=(0, 0, 0.05 + 0.1 * k)) for k in range(3)}
    far = ball(0.05, at=(-0.3, 0, 3.0), v=(0.40, 0, 0), mass=0.01)
    run = Run(world({"ground": floor(), **boxes, "far": far}, seconds=1.5, friction=0.9))
    assert any(f["asleep"][:3].all() for f in run.frames[: round(0.6 * 24)])
    first = run.events("far")[0]
    before = run.frames[math.floor(24 * first["time"])]
    assert before["asleep"][:3].tolist() == [1, 1, 1]
    # It wakes when it is hit and falls asleep again: the first frame of its sleep says so, the next one that it slept on.
    after = [f["asleep"][0] for f in run.frames[math.floor(24 * first["time"]) + 1 :]]
    awake_or_late = [k for k, value in enumerate(after) if value != 1]
    assert after[awake_or_late[-1]] == 2
    quiet = [e for e in run.events() if "far" not in e["names"] and e["time"] < first["time"]]
    assert quiet == []
    # The stack hardly moves under one per cent of its mass: its own contacts never end.
    if max(np.abs(run.of(f"b{k}") - run.of(f"b{k}")[0]).max() for k in range(3)) < 2e-4:
        assert [e for e in run.events() if "far" not in e["names"]] == []


@pytest.mark.parametrize("degrees", [30.0, 45.0, 60.0])
def test_a_ball_that_rolls_under_a_slope_is_not_wedged_by_friction(degrees):
    """Its friction cones on floor and slope see each other, so that either could press it without end; the roll ends instead."""
    r, mass, speed, tilt = 0.28, 194.0, 0.4, math.radians(degrees)
    towards = np.array([math.cos(tilt), 0.0, math.sin(tilt)])
    place = np.array([0.1, 0.0, r]) + (r + 0.053) * towards
    slope = box(0.1, 2.0, 2.0, at=tuple(place), euler=(0, -tilt, 0), motion="static")
    rolls = ball(r, at=(0, 0, r + 0.001), v=(speed, 0, 0), w=(0, speed / r, 0), mass=mass)
    spec = world({"ground": floor(), "slope": slope, "b": rolls}, seconds=0.6, friction=0.7, fps=240, settings={"step": 4e-4})
    run = Run(spec)
    own = run.index.colliders.index("slope")
    given = [float(f["contact/impulse"][(f["contact/pair"] == own).any(axis=1)].sum()) for f in run.frames]
    assert 0.5 * mass * speed < max(given) < 2.5 * mass * speed
