"""Engines take a body's answer along each axis by itself: one on a rail gives way along that alone, on a CPU and on a GPU."""

from __future__ import annotations

import gc
import weakref
from typing import Any

import numpy as np
import pytest
from worldagent.geometry.launch import warp
from worldagent.simulation.boundaries import BodyState, Boundary
from worldagent.simulation.liquid.dfsph import Dfsph, DfsphSettings
from worldagent.simulation.liquid.dfsph.bodies import _State as BodiesInOneBlock
from worldagent.tests.physics.grains import grains, slab, still
from worldagent.tests.physics.liquid_column import G, lattice, liquid

DEVICES = ["cpu", pytest.param("cuda:0", marks=pytest.mark.skipif(not warp().is_cuda_available(), reason="there is no GPU here"))]
MASS = 0.2


def held(axis: int | None) -> BodyState:
    """The body on a rail along an axis; None: free."""
    state = still(1, inverse_mass=np.array([1.0 / MASS]), inverse_inertia=np.zeros((1, 3, 3)))
    if axis is not None:
        state.mobility, state.turning = np.zeros((1, 3, 3)), np.zeros((1, 3, 3))
        state.mobility[0, axis, axis] = 1.0 / MASS
    return state


def _plate() -> Boundary:
    return slab((-0.1, -0.1, -0.02), (0.1, 0.1, 0.0), "dynamic", friction=0.5)


def _poured(device: str, state: BodyState) -> tuple[Any, Any]:
    """Grains that fall aslant on a plate: what it got and how it then moves."""
    rng = np.random.default_rng(5)
    place = rng.uniform(-0.03, 0.03, (40, 3)) * (1, 1, 0) + np.stack(
        [np.zeros(40), np.zeros(40), 0.05 + 0.012 * np.arange(40)], axis=1
    )
    speed = np.tile([0.5, 0.0, -1.0], (40, 1))
    engine = grains(place, 0.005, gravity=(0, 0, -G), walls=(_plate(),), velocity=speed, friction=0.5, device=device)
    report = engine.step(0.08, state)
    return report.impulse[0], engine.walls.bodies.velocity.numpy()[0]


def _flowed(device: str, state: BodyState) -> tuple[Any, Any]:
    """Water that slides against a wall on a plate: what the plate got in a few steps in which it stays where it is, and its speed in the last."""
    tray = slab((0.16, -0.05, -0.05), (0.24, 0.25, 0.25), "dynamic")
    setup = liquid(
        0.02,
        (0.16, 0.2, 0.1),
        (0.5, 0.2, 0.5),
        velocity=lambda x: np.tile([0.5, 0.0, 0.0], (len(x), 1)),
        boundaries=(tray,),
        device=device,
    )
    assert len(setup.position) == len(lattice((0, 0, 0), (0.16, 0.2, 0.1), 0.02))
    engine = Dfsph(setup, DfsphSettings(density_error=1e-4))
    total = np.zeros(6)
    for _ in range(6):
        report = engine.step(2e-3, state)
        total += report.impulse[0]
    return total, engine.coupling.bodies.velocity.numpy()[0]


CASES = {"grains": (_poured, 0), "particle liquid": (_flowed, 2)}
"""Run and axis of the rail: grains push down and aslant, the water along x."""


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("name", CASES)
def test_a_body_on_a_rail_gives_way_along_it_alone(name: str, device: str) -> None:
    run, axis = CASES[name]
    given, speed = run(device, held(axis))
    assert abs(given[0]) > 1e-4
    assert np.abs(np.delete(speed, axis)).max() < 1e-12
    free, _ = run(device, held(None))
    assert np.abs(given - free).max() > 1e-3 * np.abs(given).max(), "a rail makes a difference"


@pytest.mark.parametrize("device", DEVICES[1:])
@pytest.mark.parametrize("name", CASES)
def test_a_gpu_gives_what_a_cpu_gives(name: str, device: str) -> None:
    """Own choice: within 1e-3 of the largest; grains sum in double precision, liquids in single, and contacts multiply rounding."""
    run, axis = CASES[name]
    one, two = run("cpu", held(axis))[0], run(device, held(axis))[0]
    assert np.abs(one - two).max() < 1e-3 * np.abs(one).max()


def test_what_is_read_of_the_bodies_stays_when_the_engine_is_gone() -> None:
    """All quantities of a step lie in one block of memory; a reader of one keeps it."""
    state = BodiesInOneBlock(1, "cpu")
    block = weakref.ref(state._block)
    state.arrays["velocity"].fill_(warp().vec3(1.0, 2.0, 3.0))
    velocity = state.arrays["velocity"].numpy()
    del state
    gc.collect()
    assert block() is not None
    assert velocity.tolist() == [[1.0, 2.0, 3.0]]
    del velocity
    gc.collect()
    assert block() is None
