"""Surface tension of the particle engine is what is asked for: drops swing, round themselves and stand on walls as they must."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.optimize import curve_fit
from scipy.spatial.transform import Rotation
from worldagent.simulation.boundaries import Boundary
from worldagent.simulation.liquid.dfsph import Dfsph
from worldagent.simulation.liquid.engine import Fluid, LiquidSetup, Particles
from worldagent.tests.physics.liquid_cases.world import OPEN, advance, box_mesh, lattice, liquid, make, momentum, still
from worldagent.worlds.arrays import F64

RADIUS = 0.01
TENSION = 0.072


def water(viscosity: float = 1e-3) -> Fluid:
    return Fluid("water", 1000.0, viscosity, surface_tension=TENSION)


def floating(position: F64, spacing: float) -> LiquidSetup:
    """Free of gravity and walls."""
    return liquid(spacing, position + 3 * RADIUS, (6 * RADIUS,) * 3, sides=OPEN, gravity=(0, 0, 0), fluid=water())


def round_radius(setup: LiquidSetup) -> float:
    return float((3 * setup.volume.sum() / (4 * np.pi)) ** (1 / 3))


def length(p: Particles) -> float:
    """Second moment along z less that across, over that of a ball."""
    x = p.position - p.position.mean(axis=0)
    return float((x[:, 2] ** 2 - 0.5 * (x[:, 0] ** 2 + x[:, 1] ** 2)).mean() / RADIUS**2)


@cache
def swing(cells: int, seed: int, stretch: float = 1.15) -> tuple[float, float, float]:
    """Frequency of a drop over Lamb's sqrt(8 tension / (density R^3)), its change of momentum over sum |m v|, and the
    largest torque of the tension over the sum of its parts."""
    spacing = RADIUS / cells
    points = Rotation.random(random_state=seed).apply(lattice((-1.7 * RADIUS,) * 3, (1.7 * RADIUS,) * 3, spacing))
    ball = points[(points**2).sum(axis=1) < RADIUS**2] * np.array([stretch**-0.5, stretch**-0.5, stretch])
    setup = floating(ball, spacing)
    exact = float(np.sqrt(8 * TENSION / (1000.0 * round_radius(setup) ** 3)))
    engine, course, turned = make("dfsph", setup), [], []
    assert isinstance(engine, Dfsph)
    before, pull = momentum(engine, []), engine.tension.apply

    def watched(work: Any, state: Any, *more: Any) -> None:
        x, v = state.x.numpy()[: len(ball)].astype(float), state.v.numpy()[: len(ball)].astype(float)
        pull(work, state, *more)
        given = np.cross(x, state.v.numpy()[: len(ball)].astype(float) - v)
        turned.append(float(np.abs(given.sum(axis=0)).max() / np.abs(given).sum()))

    engine.tension.apply = watched  # type: ignore[assignment, method-assign]
    advance(engine, 0.55, (), lambda t, _: course.append((t, length(engine.particles()))))
    after, p = momentum(engine, []), engine.particles()
    t, found = np.array([c for c in course if c[0] > 0.5 * np.pi / exact]).T

    def damped(t: F64, size: float, loss: float, rate: float, phase: float, middle: float) -> F64:
        return np.asarray(size * np.exp(-loss * t) * np.cos(rate * t + phase) + middle)

    fits = []
    for guess in (0.8, 1.0, 1.2):
        fit, _ = curve_fit(damped, t, found, p0=(0.08, 2.0, guess * exact, 0.0, 0.0), maxfev=20000)
        fits.append((float(((damped(t, *fit) - found) ** 2).sum()), abs(float(fit[2])) / exact))
    scale = 1000.0 * float((p.volume * np.linalg.norm(p.velocity, axis=1)).sum())
    moved = float(np.abs(after[0] - before[0]).max()) / scale
    return min(fits)[1], moved, max(turned)


def test_a_drop_swings_at_lambs_frequency() -> None:
    """Rayleigh 1879, Lamb: 10 %, five spacings radius (measured 0.98); momentum stays, and tension makes no torque."""
    rate, moved, spun = swing(5, 1)
    assert rate == pytest.approx(1.0, abs=0.1)
    assert moved < 1e-5
    assert spun < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize(("cells", "seed"), [(6, 2), (7, 3), (8, 4)])
def test_finer_drops_swing_at_lambs_frequency(cells: int, seed: int) -> None:
    """Measured 0.96, 0.98, 0.99."""
    assert swing(cells, seed)[0] == pytest.approx(1.0, abs=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(("stretch", "low", "high"), [(1.07, 0.95, 1.05), (1.3, 0.9, 1.0)])
def test_small_swings_are_no_faster_than_large_ones_by_more_than_they_must(stretch: float, low: float, high: float) -> None:
    """An arrangement of particles that resists small changes of shape would swing faster the smaller they are (1.21 and 1.02 without the
    push). Measured 1.02, 0.95; large swings are slower in nature too (Tsamopoulos and Brown 1983)."""
    assert low < swing(7, 3, stretch)[0] < high


@pytest.mark.slow
@pytest.mark.parametrize("cells", [5, 8])
def test_the_pressure_inside_a_drop_is_laplaces(cells: int) -> None:
    """2 tension / R within 10 %, three spacings and more below the surface, over a fifth of a second."""
    spacing = RADIUS / cells
    points = Rotation.random(random_state=cells).apply(lattice((-1.7 * RADIUS,) * 3, (1.7 * RADIUS,) * 3, spacing))
    setup = floating(points[(points**2).sum(axis=1) < RADIUS**2], spacing)
    engine, found, radius = make("dfsph", setup), [], round_radius(setup)

    def look(t: float, _: Any) -> None:
        p = engine.particles()
        away = np.linalg.norm(p.position - p.position.mean(axis=0), axis=1)
        if t > 0.2:
            found.append(float(p.pressure[away < radius - 3 * spacing].mean()))

    advance(engine, 0.4, (), look)
    assert np.median(found) == pytest.approx(2 * TENSION / radius, rel=0.1)


@pytest.mark.slow
def test_a_cube_becomes_a_ball() -> None:
    """Ten spacings wide; a cube reaches 1.40 of the ball's radius at its corners and 0.81 in the middle of its faces."""
    spacing = RADIUS / 6
    side = 10 * spacing
    setup = floating(lattice((-side / 2,) * 3, (side / 2,) * 3, spacing), spacing)
    engine = make("dfsph", setup)
    advance(engine, 0.6)
    x = engine.particles().position
    x = x - x.mean(axis=0)
    away = np.linalg.norm(x, axis=1)
    ways = Rotation.random(200, random_state=0).apply([0.0, 0.0, 1.0])
    reach = np.array([(x @ way).max() for way in ways]) + 0.5 * spacing
    radius = round_radius(setup)
    assert away.max() + 0.5 * spacing < 1.15 * radius
    assert reach.min() > 0.93 * radius
    assert reach.max() < 1.1 * radius


@pytest.mark.parametrize("kind", ["side", "body"])
def test_a_drop_stands_on_a_wall_at_about_a_right_angle(kind: str) -> None:
    """Half a ball of thick water stays half a ball on closed sides, middle 0.375 R over the wall; on bodies it draws up to some 105 degrees (0.45 R). Wall and drop give each other the same."""
    spacing = RADIUS / 6
    points = lattice((-1.5 * RADIUS, -1.5 * RADIUS, 0), (1.5 * RADIUS, 1.5 * RADIUS, 1.5 * RADIUS), spacing)
    half = points[(points**2).sum(axis=1) < RADIUS**2] + np.array([2 * RADIUS, 2 * RADIUS, 0])
    plate = Boundary("plate", box_mesh((4 * RADIUS, 4 * RADIUS, 4 * spacing), (2 * RADIUS, 2 * RADIUS, -2 * spacing)), "static")
    boundaries, low, sides = ((), 0.0, ("closed",) * 6) if kind == "side" else ((plate,), -4 * spacing, OPEN)
    setup = liquid(
        spacing,
        half,
        (4 * RADIUS,) * 3,
        lower=(0, 0, low),
        sides=sides,
        gravity=(0, 0, 0),
        fluid=water(1e-2),
        boundaries=boundaries,
    )
    engine = make("dfsph", setup)
    reports = advance(engine, 0.3, boundaries)
    radius = (3 * setup.volume.sum() / (2 * np.pi)) ** (1 / 3)
    p = engine.particles()
    assert len(p.position) == len(half)
    low, high = (0.325, 0.425) if kind == "side" else (0.375, 0.475)
    assert low < p.position[:, 2].mean() / radius < high
    if kind == "body":
        given = sum(np.abs(r.impulse).sum() for r in reports)
        assert given > 0
        assert sum(np.abs(r.impulse + r.reaction).sum() for r in reports) < 1e-3 * given


def test_steps_follow_capillary_waves_where_tension_is_felt() -> None:
    spacing = 0.001
    fine = Dfsph(floating(lattice((0, 0, 0), (0.005,) * 3, spacing), spacing))
    assert fine.stable_dt() == pytest.approx(0.2 * np.sqrt(1000.0 * spacing**3 / TENSION))
    assert fine.step(1.0, still(())).dt <= 0.2 * np.sqrt(1000.0 * spacing**3 / TENSION)


def test_where_gravity_leaves_nothing_to_tension_it_costs_nothing() -> None:
    """Water from 8.6 mm on: equal bytes with and without."""
    states = []
    for tension in (0.0, TENSION):
        block = lattice((0, 0, 0), (0.1, 0.1, 0.1), 0.02)
        setup = liquid(0.02, block, (0.2, 0.1, 0.2), fluid=Fluid("water", 1000.0, 1e-3, surface_tension=tension))
        engine = make("dfsph", setup)
        advance(engine, 0.05)
        states.append(engine.particles().position.tobytes())
    assert states[0] == states[1]
