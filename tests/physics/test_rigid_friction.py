"""Coulomb friction against closed forms."""

import math

import numpy as np
import pytest
from worldagent.tests.physics.rigid_world import G, Run, ball, box, world

REST = 1e-3
"""[m/s] Speed below which a body counts as at rest on the incline (gate of the table)."""
ACCELERATION = 0.02
"""Gate of the table, relative."""
STOPPING = 0.02
"""Gate of the table, relative."""
ROLL_SPEED, ROLL_TIME = 0.01, 0.02
"""Gates of the table, relative."""
MU = 0.5


def _incline(slope: float, *, seconds: float = 1.0, restitution: float = 0.0) -> Run:
    """A box on a slab tilted by atan(slope) about y; both start at rest."""
    angle = math.atan(slope)
    normal = np.array([math.sin(angle), 0, math.cos(angle)])
    slab = box(30, 4, 1, at=-0.5 * normal, euler=(0, angle, 0), motion="static")
    crate = box(0.2, 0.2, 0.1, at=0.05 * normal, euler=(0, angle, 0))
    return Run(world({"slab": slab, "crate": crate}, seconds=seconds, friction=MU, restitution=restitution, fps=48))


@pytest.mark.parametrize("restitution", [0.0, 0.9])
def test_a_box_rests_on_an_incline_below_the_friction_angle(restitution):
    run = _incline(0.95 * MU, restitution=restitution)
    assert np.linalg.norm(run.of("crate", "velocity")[2:], axis=1).max() < REST


@pytest.mark.parametrize("share", [1.05, 1.2, 2.0])
def test_a_box_slides_down_an_incline_above_the_friction_angle_as_coulomb_says(share):
    slope = share * MU
    run = _incline(slope)
    angle = math.atan(slope)
    expected = G * (math.sin(angle) - MU * math.cos(angle))
    speed = np.linalg.norm(run.of("crate", "velocity"), axis=1)
    late = run.time > 0.25
    measured = np.polyfit(run.time[late], speed[late], 1)[0]
    assert measured == pytest.approx(expected, rel=ACCELERATION)


@pytest.mark.parametrize(("mu", "restitution"), [(0.3, 0.0), (0.7, 0.0), (0.3, 0.9)])
def test_a_sliding_box_stops_after_v_squared_over_two_mu_g(mu, restitution):
    v = 2.0
    ground = box(20, 20, 1, at=(0, 0, -0.5), motion="static")
    crate = box(0.3, 0.3, 0.1, at=(0, 0, 0.05), v=(v, 0, 0))
    run = Run(world({"ground": ground, "crate": crate}, seconds=1.4, friction=mu, restitution=restitution))
    x = run.of("crate")[:, 0]
    assert x[-1] - x[0] == pytest.approx(v**2 / (2 * mu * G), rel=STOPPING)
    assert np.linalg.norm(run.of("crate", "velocity")[-1]) < REST


@pytest.mark.parametrize("restitution", [0.0, 0.8])
def test_a_sliding_sphere_ends_up_rolling_at_five_sevenths_of_its_speed(restitution):
    v, mu, radius = 2.0, 0.2, 0.1
    ground = box(20, 20, 1, at=(0, 0, -0.5), motion="static")
    run = Run(
        world(
            {"ground": ground, "s": ball(radius, at=(0, 0, radius), v=(v, 0, 0))},
            seconds=0.6,
            friction=mu,
            restitution=restitution,
            fps=240,
        )
    )
    speed, spin = run.of("s", "velocity")[:, 0], run.of("s", "angular_velocity")[:, 1]
    assert speed[-1] == pytest.approx(5 / 7 * v, rel=ROLL_SPEED)
    slip = speed - radius * spin
    # Slip falls linearly at 7/2 mu g: its zero crossing is found to better than a frame by extrapolation.
    sliding = slip > 0.2 * v
    slope, offset = np.polyfit(run.time[sliding], slip[sliding], 1)
    assert -offset / slope == pytest.approx(2 * v / (7 * mu * G), rel=ROLL_TIME)


def test_rolling_resistance_stops_a_ball_and_without_it_the_ball_rolls_on():
    ground = box(20, 20, 1, at=(0, 0, -0.5), motion="static")
    length, v, radius = 0.004, 1.0, 0.1
    ends = {}
    for name, value in (("felt", length), ("m", 0.0)):
        start = ball(radius, at=(0, 0, radius), v=(v, 0, 0), w=(0, v / radius, 0), material=name)
        materials = {"felt": {"density": 1000.0, "friction": 0.5, "rolling_friction": value}}
        ends[name] = Run(world({"ground": ground, "s": start}, seconds=2.0, materials=materials)).of("s", "velocity")[:, 0]
    # Deceleration of a rolling ball: rolling resistance length / radius x g / (1 + 2/5).
    expected = v - length / radius * G / 1.4 * 2.0
    assert ends["felt"][-1] == pytest.approx(expected, rel=0.03)
    assert ends["m"][-1] == pytest.approx(v, rel=0.002)


def test_a_contact_pair_has_its_own_friction():
    ground = box(20, 20, 1, at=(0, 0, -0.5), motion="static")
    crates = {n: box(0.3, 0.3, 0.1, at=(0, y, 0.05), v=(1, 0, 0)) for n, y in (("icy", 0.0), ("plain", 1.0))}
    run = Run(
        world(
            {"ground": ground, **crates}, seconds=1.0, friction=0.5, contacts={"c": {"a": "ground", "b": "icy", "friction": 0.0}}
        )
    )
    assert run.of("icy", "velocity")[-1, 0] == pytest.approx(1.0, abs=1e-3)
    assert run.of("plain")[-1, 0] == pytest.approx(1 / (2 * 0.5 * G), rel=STOPPING)
