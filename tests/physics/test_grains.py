"""Grains against theory: Hertz's collision, restitution, rolling and sliding, adhesion, momentum, repeat and resumed runs."""

import math

import numpy as np
import pytest
from worldagent.tests.physics.grains import G, grains, kind, slab, still

R = 5e-3
HERTZ = 0.01
"""Own choice: relative error of the closed forms of Hertz."""


def _collision(speed, **changes):
    """Largest depth, contact time and speed of separation of two equal grains that meet head on."""
    engine = grains([[-1.02 * R, 0, 0], [1.02 * R, 0, 0]], R, velocity=[[speed / 2, 0, 0], [-speed / 2, 0, 0]], **changes)
    dt, deepest, touching, gaps = engine.stable_dt(speed) / 8, 0.0, [], []
    for k in range(20000):
        engine.step(dt)
        c = engine.columns()
        depth = 2 * R - float(np.linalg.norm(np.diff(c["position"], axis=0)))
        gaps.append(depth)
        if depth > 0:
            touching.append(k)
        elif touching:
            break
        deepest = max(deepest, depth)
    # Where the depth passes zero, between steps.
    begin = touching[0] - gaps[touching[0]] / (gaps[touching[0]] - gaps[touching[0] - 1])
    end = touching[-1] + gaps[touching[-1]] / (gaps[touching[-1]] - gaps[touching[-1] + 1])
    return deepest, (end - begin) * dt, float(np.diff(c["velocity"][:, 0])[0])


@pytest.mark.parametrize("speed", [0.1, 1.0])
def test_depth_and_time_of_a_collision_are_hertz(speed):
    depth, time, after = _collision(speed, restitution=1.0, young=1e7)
    mass, modulus, radius = 2500 * 4 / 3 * math.pi * R**3 / 2, 1e7 / (2 * (1 - 0.25**2)), R / 2
    expected = (15 * mass * speed**2 / (16 * modulus * math.sqrt(radius))) ** 0.4
    assert depth == pytest.approx(expected, rel=HERTZ)
    assert time == pytest.approx(2.943 * expected / speed, rel=HERTZ)
    assert after == pytest.approx(speed, rel=1e-3)


@pytest.mark.parametrize("restitution", [0.9, 0.5, 0.2])
def test_restitution_is_the_declared_one_at_any_speed(restitution):
    for speed in (0.05, 1.5):
        assert _collision(speed, restitution=restitution)[2] == pytest.approx(restitution * speed, rel=0.01, abs=0.003 * speed)


def _on_slope(angle, seconds, **changes):
    """Speed down the slope and spin of a ball after some seconds, and the speed that friction alone would leave."""
    gravity = G * np.array([math.sin(angle), 0, -math.cos(angle)])
    engine = grains([[0, 0, R]], R, gravity=gravity, walls=(slab((-2, -2, -1), (2, 2, 0)),), young=1e8, **changes)
    steps = 50
    for _ in range(steps):
        engine.step(seconds / steps, still(1))
    c = engine.columns()
    return c["velocity"][0, 0], c["spin"][0, 1]


def test_a_ball_rolls_down_a_gentle_slope_and_slides_down_a_steep_one():
    speed, spin = _on_slope(0.3, 0.2, friction=0.5)
    assert speed == pytest.approx(5 / 7 * G * math.sin(0.3) * 0.2, rel=0.01)
    assert spin * R == pytest.approx(speed, rel=0.01)
    speed, spin = _on_slope(1.1, 0.2, friction=0.2)
    assert speed == pytest.approx(G * (math.sin(1.1) - 0.2 * math.cos(1.1)) * 0.2, rel=0.01)
    assert spin * R == pytest.approx(2.5 * 0.2 * G * math.cos(1.1) * 0.2, rel=0.02)


def test_rolling_resistance_holds_a_ball_below_its_angle_only():
    # The couple of gravity about the contact is m g R sin(a), that of resistance at most its share of R times m g cos(a).
    held, _ = _on_slope(math.atan(0.1) * 0.9, 0.4, friction=0.6, rolling=0.1, restitution=0.1)
    assert abs(held) < 1e-3
    free, _ = _on_slope(math.atan(0.1) * 2.0, 0.4, friction=0.6, rolling=0.1)
    slope = math.atan(0.1) * 2.0
    assert free == pytest.approx(5 / 7 * G * (math.sin(slope) - 0.1 * math.cos(slope)) * 0.4, rel=0.03)


@pytest.mark.parametrize(("share", "holds"), [(0.9, True), (1.1, False)])
def test_adhesion_carries_what_its_pull_can_bear(share, holds):
    # Derjaguin, Muller, Toporov: 2 pi w R*, with R* the ball's own radius against a plane.
    weight = 2500 * 4 / 3 * math.pi * R**3 * G
    work = weight / (2 * math.pi * R) / share
    ceiling = slab((-1, -1, 0), (1, 1, 1))
    engine = grains([[0, 0, -R + 1e-6]], R, gravity=(0, 0, -G), walls=(ceiling,), cohesion=work, restitution=0.1)
    engine.step(0.1, still(1))
    assert (engine.columns()["position"][0, 2] > -1.1 * R) == holds


def test_momentum_and_spin_of_a_cloud_that_collides_are_kept():
    rng = np.random.default_rng(3)
    place = np.stack(np.meshgrid(*[np.arange(6)] * 3), axis=-1).reshape(-1, 3) * 2.15 * R + rng.normal(0, 0.02 * R, (216, 3))
    velocity = -8.0 * (place - place.mean(axis=0)) + rng.normal(0, 0.1, (216, 3))
    engine = grains(place, R * rng.uniform(0.8, 1.0, 216), velocity=velocity, rolling=0.1, cohesion=0.05)

    def momenta():
        c = engine.columns()
        p, spin = c["mass"][:, None] * c["velocity"], (0.4 * c["mass"] * c["radius"] ** 2)[:, None] * c["spin"]
        return (
            p.sum(axis=0),
            (np.cross(c["position"], p) + spin).sum(axis=0),
            np.abs(p).sum(),
            np.abs(np.cross(c["position"], p)).sum(),
        )

    before = momenta()
    engine.step(0.05)
    after = momenta()
    assert engine.columns()["spin"].any()
    assert np.abs(after[0] - before[0]).max() < 1e-9 * before[2]
    # The rolling couples act at the middles, friction at the contact: angular momentum closes to the overlap.
    assert np.abs(after[1] - before[1]).max() < 1e-3 * before[3]


def test_walls_give_what_grains_get_and_free_bodies_give_way():
    rng = np.random.default_rng(5)
    place = rng.uniform(-0.03, 0.03, (40, 3)) * (1, 1, 0) + np.stack(
        [np.zeros(40), np.zeros(40), 0.05 + 0.012 * np.arange(40)], axis=1
    )
    plate = slab((-0.1, -0.1, -0.02), (0.1, 0.1, 0.0), "dynamic")
    engine = grains(place, R, gravity=(0, 0, -G), walls=(plate,), velocity=np.tile([0, 0, -1.0], (40, 1)))
    mass, inertia = 0.2, 0.2 * 0.04 / 12
    body = still(1, inverse_mass=np.array([1 / mass]), inverse_inertia=np.diag([1 / inertia] * 3)[None])
    before = engine.columns()
    total = float(before["mass"].sum())
    report = engine.step(0.08, body)
    after = engine.columns()
    change = after["mass"] @ after["velocity"] - before["mass"] @ before["velocity"]
    assert report.impulse[0, 2] < -1e-3
    assert np.abs(report.impulse + report.reaction).max() < 1e-12
    assert change == pytest.approx(report.reaction[0, :3] + total * np.array([0, 0, -G]) * 0.08, abs=1e-9)
    assert engine.walls.bodies.velocity.numpy()[0] == pytest.approx(report.impulse[0, :3] / mass, abs=1e-9)


def _heap():
    rng = np.random.default_rng(7)
    place = np.stack(np.meshgrid(np.arange(5), np.arange(5), np.arange(6), indexing="ij"), axis=-1).reshape(-1, 3) * 2.1 * R
    place += (-4 * R, -4 * R, 1.5 * R) + rng.uniform(-1, 1, (150, 3)) * 0.04 * R
    walls = (slab((-0.5, -0.5, -0.1), (0.5, 0.5, 0)),)
    return grains(place, R * rng.uniform(0.8, 1.0, 150), gravity=(0, 0, -G), walls=walls, rolling=0.1)


def test_equal_starts_and_a_resumed_run_give_equal_bytes():
    first, again, other = _heap(), _heap(), _heap()
    for engine in (first, again):
        engine.step(0.08, still(1))
    assert first.checkpoint() == again.checkpoint()
    state = first.checkpoint()
    for engine in (first, other):
        engine.restore(state)
        engine.step(0.03, still(1))
    assert first.checkpoint() == other.checkpoint()
    assert len(first.columns()["mass"]) == 150


def test_lists_change_nothing_but_the_cost():
    """The same fall with lists made anew in every exchange ends in the same place."""
    often, seldom = _heap(), _heap()
    for _ in range(15):
        often.forget_lists() if often.listed else None
        for engine in (often, seldom):
            engine.step(0.002, still(1))
    assert often.rebuilds > seldom.rebuilds
    order = [np.argsort(e.columns()["identity"]) for e in (often, seldom)]
    a, b = (e.columns()["position"][o] for e, o in zip((often, seldom), order, strict=True))
    assert np.abs(a - b).max() < 1e-3 * R


def test_what_leaves_the_domain_is_counted():
    engine = grains([[0, 0, 0], [0, 0, 0.5]], R, velocity=[[50, 0, 0], [0, 0, 0]], lower=np.full(3, -1.0), upper=np.full(3, 1.0))
    report = engine.step(0.03)
    assert engine.count == 1
    assert report.left[0] == 1
    assert report.left[2] == pytest.approx(50 * report.left[1], rel=1e-6)


def test_two_kinds_meet_by_their_own_law():
    kinds = (kind(), kind(name="heavy", density=7800.0, restitution=0.9))
    engine = grains(
        [[0, 0, 0], [2.1 * R, 0, 0]], R, velocity=[[1, 0, 0], [0, 0, 0]], kinds=kinds, kind=np.array([0, 1], dtype=np.int32)
    )
    engine.step(0.01)
    c = engine.columns()
    order = np.argsort(c["identity"])
    v, m = c["velocity"][order, 0], c["mass"][order]
    assert v[1] - v[0] == pytest.approx(0.5, rel=0.01)
    assert m @ v == pytest.approx(m[0], rel=1e-9)
