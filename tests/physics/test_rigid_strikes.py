"""Impacts against closed forms: rows of balls, oblique bounces, wedges, rolling of small balls, random closed scenes."""

import math

import numpy as np
import pytest
from worldagent.bench.rigid_impacts import SCENES, gained, random_scene
from worldagent.tests.physics.rigid_world import G, Run, ball, box, entity, floor, world

SENT = 0.02
"""[m/s] Of 1 m/s: what balls that touch may keep that should stand still; depth inside a skin comes out as that much speed."""
APART = 1e-3
"""The same where they do not touch."""
SLIDE = 2e-3
"""Relative: impulse of friction against Coulomb's, and what gravity of no step can change; measured 1e-3 and below."""
REBOUND = 0.02
"""Relative: what is pushed out of its skin comes back as up to so much of the speed."""
ROLLING = 5e-3
"""Relative: gate of the acceleration of what rolls."""
ENERGY = 1e-3
"""Largest rise of the energy of a closed scene, in parts of what it had at first."""
AGAIN = 2e-3
"""The same over what it had at any time before: what sank into a skin comes out of it by some hundredths of a millimetre."""


def row_of_balls(let, e, gap, *, count=5, fps=240):
    """Speeds of five equal balls after the first `let` ran into the rest at 1 m/s."""
    at = [(0.1 + gap) * k - (0.03 if k < let else 0.0) for k in range(count)]
    balls = {f"b{k}": ball(0.05, at=(x, 0, 1), mass=1.0, v=(1.0 if k < let else 0.0, 0, 0)) for k, x in enumerate(at)}
    run = Run(world(balls, seconds=0.3, restitution=e, gravity=(0, 0, 0), fps=fps))
    return np.array([run.of(f"b{k}", "velocity")[-1, 0] for k in range(count)])


@pytest.mark.parametrize("gap", [0.001, 0.0012, 0.006])
@pytest.mark.parametrize("let", [1, 2, 3, 4])
def test_as_many_balls_leave_a_row_as_run_into_it(let, gap):
    """Touching, a fifth of a millimetre apart, and five."""
    expected = np.array([0.0] * (5 - let) + [1.0] * let)
    assert np.abs(row_of_balls(let, 1.0, gap) - expected).max() < (SENT if gap == 0.001 else APART)


@pytest.mark.parametrize("gap", [0.001, 0.006])
@pytest.mark.parametrize("e", [0.5, 0.9])
def test_the_last_ball_of_a_row_leaves_as_one_impact_after_another_says(e, gap):
    """Each of four impacts of equal balls hands on (1 + e) / 2 of the speed, touching or not."""
    speeds = row_of_balls(1, e, gap)
    assert speeds[-1] == pytest.approx(((1 + e) / 2) ** 4, abs=2 * APART)
    assert speeds.sum() == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("e", [0.0, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("along", [0.5, 2.0, 6.0])
@pytest.mark.parametrize("mu", [0.1, 0.3, 0.6, 1.0])
def test_a_ball_that_bounces_obliquely_loses_the_slide_that_coulomb_asks(mu, along, e):
    """Friction takes mu (1 + e) v m while the slide lasts, and at most 2/7 of the speed along the floor: then the ball rolls."""
    down = 2.0
    thrown = ball(0.1, at=(0, 0, 0.3), v=(along, 0, -down), mass=1.0)
    run = Run(world({"ground": floor(60.0), "b": thrown}, seconds=0.15, restitution=e, friction=mu, gravity=(0, 0, 0), fps=240))
    expected = min(mu * (1 + e) * down, 2 / 7 * along)
    # Without restitution the ball is still in contact afterwards, and comes out of its skin with friction.
    most = SLIDE * expected + (mu * 0.02 * down if e == 0 else 0.0)
    assert along - run.of("b", "velocity")[-1, 0] == pytest.approx(expected, abs=most)
    assert run.of("b", "angular_velocity")[-1, 1] * 0.1 == pytest.approx(2.5 * expected, abs=2.5 * most)


def rod_after(tilt, mu, along, e):
    """Velocities of a rod after the impact of its lower end on a floor [m/s, rad/s], and its regime; from Routh's impulses.

    The plane of the impact is x z; n is the inverse mass along the normal at the contact, t that along the floor, b what couples them.
    """
    length, radius, mass = 0.4, 0.02, 1.0
    rod = {"kind": "capsule", "radius": radius, "length": length}
    height = length / 2 * math.sin(tilt) + radius + 0.03
    thrown = entity(rod, at=(0, 0, height), euler=(0, math.pi / 2 + tilt, 0), v=(along, 0, -2.0), mass=mass)
    run = Run(world({"ground": floor(60.0), "b": thrown}, seconds=0.04, restitution=e, friction=mu, gravity=(0, 0, 0), fps=240))
    inertia = run.solver.built["b"].bodies[0].inertia
    turn = float(np.linalg.eigvalsh(inertia)[-1])
    # Euler angles turn the rod's axis, z, to (cos tilt, 0, -sin tilt): that end is the lower one.
    x, z = length / 2 * math.cos(tilt), -length / 2 * math.sin(tilt) - radius
    n, t, b = 1 / mass + x * x / turn, 1 / mass + z * z / turn, -x * z / turn
    v_n, v_t = -2.0, along
    way = math.copysign(1.0, v_t)
    p_n = -v_n / (n - mu * way * b) if n > mu * way * b else -1.0
    slides = p_n > 0 and (v_t + (b - mu * way * t) * p_n) * way > 0
    if slides and (v_t + (1 + e) * (b - mu * way * t) * p_n) * way > 0:
        push, drag, regime = (1 + e) * p_n, -mu * way * (1 + e) * p_n, "slides"
    else:
        p_n, p_t = np.linalg.solve([[n, b], [b, t]], [-v_n, -v_t])
        holds = p_n > 0 and abs(p_t) <= mu * p_n and abs(b / t) <= mu
        push, drag, regime = (1 + e) * p_n, p_t - e * b / t * p_n, "sticks" if holds else "turns"
    expected = np.array([along + drag / mass, -2.0 + push / mass, (z * drag - x * push) / turn])
    v, w = run.of("b", "velocity")[-1], run.of("b", "angular_velocity")[-1]
    given = 0.5 * mass * (expected[:2] @ expected[:2] - along**2 - 4.0) + 0.5 * turn * expected[2] ** 2
    return np.array([v[0], v[2], w[1]]), expected, regime if given <= 0 else "gives"


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_a_rod_that_lands_on_its_end_follows_coulombs_impact_formula(e):
    """The regimes in which the slide keeps its way or ends; those where it turns round or the formula would give energy have others."""
    met = set()
    for tilt in (0.3, 0.8, 1.2):
        for mu in (0.1, 0.3, 0.8):
            for along in (0.2, 3.0, -1.0):
                found, expected, regime = rod_after(tilt, mu, along, e)
                if regime in ("turns", "gives"):
                    continue
                met.add(regime)
                assert found == pytest.approx(expected, abs=0.03, rel=REBOUND if e == 0 else 0.0), (tilt, mu, along)
    assert met == {"slides", "sticks"}


def wedged(half, mu, e, *, speed=2.0):
    """A ball of 1 kg that falls into a groove of two walls, each at `half` degrees from the vertical, without gravity."""
    a, walls = math.radians(half), {}
    for name, side in (("left", -1), ("right", 1)):
        normal = np.array([-side * math.cos(a), 0, math.sin(a)])
        walls[name] = box(4, 4, 1, at=tuple(-0.5 * normal), euler=(0, math.atan2(normal[0], normal[2]), 0), motion="static")
    falls = ball(0.1, at=(0, 0, 0.101 / math.sin(a) + 0.05), v=(0, 0, -speed), mass=1.0)
    return Run(world({**walls, "b": falls}, seconds=0.05, restitution=e, friction=mu, gravity=(0, 0, 0), fps=240))


@pytest.mark.parametrize("e", [0.0, 0.8])
@pytest.mark.parametrize(("half", "mu"), [(15, 0.5), (15, 1.0), (30, 1.0), (45, 1.0)])
def test_a_ball_wedged_between_walls_stays_and_is_not_pressed_without_end(half, mu, e):
    """Its friction cones see each other: tan of half the angle <= mu. It had got ten thousand times its momentum."""
    run = wedged(half, mu, e)
    assert np.abs(run.of("b", "velocity")[-1]).max() < 0.02
    assert max(float(f["contact/impulse"].sum()) for f in run.frames) < 6 * 2.0


@pytest.mark.parametrize(("half", "mu"), [(15, 0.1), (45, 0.1), (45, 0.5), (60, 0.5)])
def test_a_ball_leaves_a_wide_groove_with_no_more_than_its_restitution(half, mu):
    """By friction that opposes both ways it keeps (sin - mu cos) / (sin + mu cos) of it at least, all of it at most."""
    e, a = 0.8, math.radians(half)
    up = wedged(half, mu, e).of("b", "velocity")[-1, 2] / 2.0
    lost = mu * math.cos(a)
    assert e * (math.sin(a) - lost) / (math.sin(a) + lost) - 1e-3 <= up <= e * (math.sin(a) - lost) / math.sin(a) + 1e-3


@pytest.mark.parametrize("radius", [0.005, 0.01, 0.1])
def test_a_small_ball_rolls_down_a_slope_as_its_own_radius_says(radius):
    angle = 0.2
    normal = np.array([math.sin(angle), 0, math.cos(angle)])
    slab = box(30, 4, 1, at=-0.5 * normal, euler=(0, angle, 0), motion="static")
    run = Run(world({"slab": slab, "s": ball(radius, at=(radius + 0.001) * normal)}, friction=0.8, fps=48))
    speed, late = np.linalg.norm(run.of("s", "velocity"), axis=1), run.time > 0.25
    assert np.polyfit(run.time[late], speed[late], 1)[0] == pytest.approx(5 / 7 * G * math.sin(angle), rel=ROLLING)
    # It rolls without slip on its own surface.
    assert speed[-1] == pytest.approx(radius * np.linalg.norm(run.of("s", "angular_velocity")[-1]), rel=ROLLING)


def test_a_small_wheel_on_its_side_rolls_down_a_slope_as_its_own_radius_says():
    """A cylinder of 10 mm: 2/3 g sin a."""
    angle, radius = 0.2, 0.01
    normal = np.array([math.sin(angle), 0, math.cos(angle)])
    slab = box(30, 4, 1, at=-0.5 * normal, euler=(0, angle, 0), motion="static")
    wheel = entity(
        {"kind": "cylinder", "radius": radius, "height": 0.04}, at=tuple((radius + 0.001) * normal), euler=(math.pi / 2, 0, 0)
    )
    run = Run(world({"slab": slab, "s": wheel}, friction=0.8, fps=48))
    speed, late = np.linalg.norm(run.of("s", "velocity"), axis=1), run.time > 0.25
    assert np.polyfit(run.time[late], speed[late], 1)[0] == pytest.approx(2 / 3 * G * math.sin(angle), rel=ROLLING)


@pytest.mark.parametrize("seed", range(12))
def test_a_random_closed_scene_gains_no_energy(seed):
    first, before, _ = gained(random_scene(seed))
    assert first <= ENERGY
    assert before <= AGAIN


@pytest.mark.slow
@pytest.mark.parametrize("tens", range(SCENES // 10))
def test_two_hundred_random_closed_scenes_gain_no_energy(tens):
    """Piles, chains and cradles, restitution from 0 to 1."""
    found = np.array([gained(random_scene(seed))[:2] for seed in range(10 * tens, 10 * tens + 10)])
    assert found.shape == (10, 2)
    assert found[:, 0].max() <= ENERGY, 10 * tens + int(found[:, 0].argmax())
    assert found[:, 1].max() <= AGAIN, 10 * tens + int(found[:, 1].argmax())
