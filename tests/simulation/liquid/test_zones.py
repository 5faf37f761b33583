"""Zones that make and take in waves: the motion they aim at, what they give, equal bytes (R57, R58, R99)."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from worldagent.geometry.launch import launch, warp
from worldagent.simulation.liquid.engine import LiquidSetup
from worldagent.simulation.liquid.zones import Zones

from . import wave_kernels
from .wave_flume import G, engine_of, flume, nobody

SPACING, DEPTH, PERIOD, HEIGHT = 0.1, 0.5, 1.0, 0.06


def small(**changes: Any) -> LiquidSetup:
    return flume(SPACING, between=0.5, period=PERIOD, depth=DEPTH, height=HEIGHT, **changes)


def pulled(setup: LiquidSetup, points: Any, velocity: Any, *, time: float, dt: float) -> tuple[Any, Any]:
    """Velocities after a pull and what it gave; particles of 1 kg."""
    wp, n = warp(), len(points)
    zones = Zones(setup, np.zeros(3), "cpu")
    v = wp.array(np.asarray(velocity, dtype=np.float32), dtype=wp.vec3)
    arrays = [
        wp.array(np.asarray(points, dtype=np.float32), dtype=wp.vec3),
        wp.full(n, 1e-3, dtype=wp.float32),
        wp.full(n, 1e-3, dtype=wp.float32),
        v,
    ]
    given = zones.pull(lambda k, many, of: launch(k, many, of, device="cpu"), "pull_particles", n, arrays, time, dt)
    return v.numpy().astype(float), given


def aimed(setup: LiquidSetup, points: Any, time: float) -> tuple[Any, Any]:
    """Velocity and force that the zones aim at, long after the waves began."""
    zones = Zones(setup, np.zeros(3), "cpu")._made[0]
    zones.at(time, 0.01)
    wp, n = warp(), len(points)
    x = wp.array(np.asarray(points, dtype=np.float32), dtype=wp.vec3)
    velocity, force = (wp.zeros(n, dtype=wp.vec3) for _ in range(2))
    launch(wave_kernels.aims, n, [zones.zones, zones.state, zones.wave, zones.pace, x, velocity, force], device="cpu")
    return velocity.numpy().astype(float), force.numpy().astype(float)


def patch() -> LiquidSetup:
    """A square of sea with a zone on every side and waves from many directions."""
    length = 4.0
    setup = small(spectrum="jonswap", spreading=30.0, direction=20.0, generate=["-x", "+x", "-y", "+y"], absorb=[])
    return dataclasses.replace(setup, upper=np.array([length, length, 0.9]))


def slope(setup: LiquidSetup, points: Any, time: float, axis: int, which: int) -> Any:
    """Derivative along an axis of what is aimed at: velocity (0) or force (1)."""
    step = np.zeros(3)
    step[axis] = 2e-3
    return (aimed(setup, points + step, time)[which] - aimed(setup, points - step, time)[which]) / (2 * step[axis])


def within(setup: LiquidSetup, count: int = 200) -> Any:
    """Places in the zones below still water."""
    random = np.random.default_rng(5)
    return random.uniform((0.02, 0.02, 0.02), (*(setup.upper[:2] - 0.02), DEPTH - 0.02), (count, 3))


def test_water_beyond_the_zones_is_left_alone() -> None:
    setup = small()
    length = setup.waves[0].width
    points = np.array([[1.01 * length, 0.1, 0.3], [1.49 * length, 0.1, 0.5]])
    velocity = np.full((2, 3), 0.3)
    after, given = pulled(setup, points, velocity, time=5.0, dt=0.05)
    np.testing.assert_array_equal(after, velocity.astype(np.float32))
    np.testing.assert_array_equal(given, 0.0)


def test_a_zone_that_absorbs_only_slows_down_most_at_its_side() -> None:
    setup = small()
    end = setup.upper[0]
    points = np.array([[end - q * setup.waves[0].width, 0.1, 0.3] for q in (0.05, 0.3, 0.6, 0.9)])
    after, given = pulled(setup, points, np.tile([0.2, 0.1, -0.3], (4, 1)), time=5.0, dt=0.05)
    share = np.linalg.norm(after, axis=1) / np.linalg.norm([0.2, 0.1, -0.3])
    assert (np.diff(share) > 0).all()
    assert 0.0 < share[0] < share[-1] < 1.0
    assert given[3] < 0.0


def test_what_a_zone_gives_is_the_change_of_momentum_and_energy() -> None:
    setup = small()
    random = np.random.default_rng(3)
    points = random.uniform((0.0, 0.0, 0.0), (setup.waves[0].width, 0.2, 0.55), (500, 3))
    velocity = random.normal(0.0, 0.2, (500, 3)).astype(np.float32).astype(float)
    after, given = pulled(setup, points, velocity, time=3.0, dt=0.02)
    np.testing.assert_allclose(given[:3], (after - velocity).sum(axis=0), rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(given[3], 0.5 * (after**2 - velocity**2).sum(), rtol=1e-5)


def test_nothing_is_aimed_through_the_sides_that_make_waves() -> None:
    setup = patch()
    random = np.random.default_rng(1)
    for axis, end in ((0, 0.0), (0, setup.upper[0]), (1, 0.0), (1, setup.upper[1])):
        points = random.uniform((0.0, 0.0, 0.0), (*setup.upper[:2], 0.55), (40, 3))
        points[:, axis] = end
        velocity, _ = aimed(setup, points, 20.0)
        np.testing.assert_allclose(velocity[:, axis], 0.0, atol=1e-6)


def test_what_is_aimed_at_keeps_volume() -> None:
    setup = patch()
    points = within(setup)
    spread = sum(slope(setup, points, 20.0, a, 0)[:, a] for a in range(3))
    rate = np.abs(slope(setup, points, 20.0, 2, 0)[:, 2]).max()
    assert np.abs(spread).max() < 5e-3 * rate


def test_inside_its_zone_the_declared_sea_is_aimed_at() -> None:
    setup = small()
    sea = setup.waves[0].sea
    a, w, k, d = float(sea.amplitude[0]), float(sea.omega[0]), float(sea.number[0]), sea.depth
    z = np.linspace(0.0, DEPTH, 9)
    x, time = setup.waves[0].width, 20.3
    velocity, force = aimed(setup, np.column_stack([np.full(9, x), np.full(9, 0.1), z]), time)
    angle = k * x - w * time
    drift = G * a * a * k / (2 * w * d)
    np.testing.assert_allclose(velocity[:, 0], a * w * np.cosh(k * z) / math.sinh(k * d) * math.cos(angle) - drift, atol=1e-5)
    np.testing.assert_allclose(velocity[:, 2], a * w * np.sinh(k * z) / math.sinh(k * d) * math.sin(angle), atol=1e-5)
    np.testing.assert_allclose(force, 0.0, atol=1e-5)


def test_the_force_of_a_zone_makes_its_motion_one_that_water_follows() -> None:
    """Acceleration less force has no curl, and at the surface it is that of the slope which the motion itself has lifted."""
    setup = patch()
    points, time, dt = within(setup, 60), 20.0, 2e-3

    def rest(at: Any) -> Any:
        return (aimed(setup, at, time + dt)[0] - aimed(setup, at, time - dt)[0]) / (2 * dt) - aimed(setup, at, time)[1]

    step = 5e-3 * np.eye(3)
    turn = {(i, j): (rest(points + step[j])[:, i] - rest(points - step[j])[:, i]) / 1e-2 for i in range(3) for j in range(3)}
    size = max(np.abs(v).max() for v in turn.values())
    for i, j in ((0, 1), (0, 2), (1, 2)):
        assert np.abs(turn[i, j] - turn[j, i]).max() < 0.02 * size
    surface = points.copy()
    surface[:, 2] = DEPTH

    def lifted(at: Any) -> Any:
        """A period of the longest beat is too long to integrate: elevation of the same motion, from its components."""
        total = np.zeros(len(at))
        for one in parts(setup):
            omega = float(one.waves[0].sea.omega[0])
            later = aimed(one, at, time + 0.5 * math.pi / omega)[0][:, 2]
            drift = 0.5 * (later + aimed(one, at, time + 1.5 * math.pi / omega)[0][:, 2])
            total -= (later - drift) / omega  # w = d eta / dt is a quarter of a period ahead
        return total

    for axis in (0, 1):
        tilt = (lifted(surface + step[axis]) - lifted(surface - step[axis])) / 1e-2
        found = rest(surface)[:, axis]
        assert np.abs(found + G * tilt).max() < 0.02 * np.abs(found).max()


def parts(setup: LiquidSetup) -> list[LiquidSetup]:
    """The same with one wave of the sea each."""
    zones = setup.waves[0]
    sea = zones.sea
    return [
        dataclasses.replace(
            setup,
            waves=(
                dataclasses.replace(
                    zones,
                    sea=dataclasses.replace(
                        sea,
                        amplitude=sea.amplitude[k : k + 1], omega=sea.omega[k : k + 1], number=sea.number[k : k + 1],
                        direction=sea.direction[k : k + 1], phase=sea.phase[k : k + 1],
                    ),
                ),
            ),
        )
        for k in range(len(sea.omega))
    ]  # fmt: skip


@pytest.mark.parametrize("kind", ["flip", "dfsph"])
def test_engines_with_waves_continue_from_their_bytes(kind: str) -> None:
    one, other = (engine_of(kind, small()) for _ in range(2))
    for _ in range(6):
        one.step(0.01, nobody())
    other.restore(one.checkpoint())
    reports = [[e.step(0.01, nobody()) for _ in range(4)] for e in (one, other)]
    assert one.particles().position.tobytes() == other.particles().position.tobytes()
    assert [r.driven.tobytes() for r in reports[0]] == [r.driven.tobytes() for r in reports[1]]
    assert any(r.driven[3] != 0.0 for r in reports[0])


@pytest.mark.parametrize("kind", ["flip", "dfsph"])
def test_zones_of_a_sea_that_has_not_begun_leave_still_water_still(kind: str) -> None:
    engine = engine_of(kind, small(start=1e4))
    plain = engine_of(kind, dataclasses.replace(small(), waves=()))
    for _ in range(30):
        for one in (engine, plain):
            one.step(0.01, nobody())
    fastest = [float(np.linalg.norm(e.particles().velocity, axis=1).max()) for e in (engine, plain)]
    assert fastest[0] <= 1.05 * fastest[1]
