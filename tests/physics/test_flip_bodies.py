"""The grid liquid at rest for long, and round bodies in it: held, let go, afloat."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from worldagent.simulation.boundaries import BodyState, Boundary
from worldagent.simulation.liquid.engine import LiquidSetup
from worldagent.simulation.liquid.flip.engine import Flip
from worldagent.tests.simulation.liquid.flip_setup import advance, block, no_bodies, tank
from worldagent.worlds.arrays import F64
from worldagent.worlds.built import TriangleMesh

from .test_flip import G, box_mesh, drift_of, one_body, pool


def ball(radius: float) -> TriangleMesh:
    """A polyhedron of the ball's volume."""
    mesh = trimesh.creation.icosphere(subdivisions=3, radius=radius)
    scale = np.cbrt(4 / 3 * np.pi * radius**3 / mesh.volume)
    return TriangleMesh(np.asarray(mesh.vertices) * scale, np.asarray(mesh.faces, np.int32))


def around(radius: float, at: F64, cell: float, motion: str) -> LiquidSetup:
    """A pool of 1 x 1 x 0.8 m around a ball."""
    water = block((0, 0, 0), (1.0, 1.0, 0.8), cell / 2)
    water = water[np.linalg.norm(water - at, axis=1) > radius]
    body = Boundary("ball", ball(radius), motion)  # type: ignore[arg-type]
    return LiquidSetup(**{**vars(tank((1.0, 1.0, 1.0), water, cell / 2, boundaries=(body,))), "spacing": cell})


def at_rest(position: F64, *, mass: float = 0.0, radius: float = 0.0, speed: float = 0.0) -> BodyState:
    """A ball; without a mass it is held."""
    state = no_bodies(1)
    state.position[0] = state.center[0] = position
    if mass:
        state.velocity[0] = (0.0, 0.0, speed)
        state.inverse_mass[0] = 1.0 / mass
        state.inverse_inertia[0] = np.eye(3) / (0.4 * mass * radius**2)
        state.acceleration[0] = (0.0, 0.0, -G)
    return state


@pytest.mark.slow
@pytest.mark.parametrize("cell", [1 / 16, 1 / 32])
def test_water_is_still_for_five_seconds(cell: float) -> None:
    """A closed tank: the energy of its settling decays, its volume stays."""
    depth = 0.28125
    water = block((0, 0, 0), (0.5, 0.5, depth), cell / 2)
    setup = tank((0.5, 0.5, 0.5), water, cell / 2)
    engine = Flip(LiquidSetup(**{**vars(setup), "spacing": cell}))
    energy = []
    for _ in range(5):
        reports = advance(engine, 1.0)
        energy.append(0.5 * (engine.particles().velocity ** 2).sum(axis=1).mean() / (G * depth / 2))
    assert energy[-1] <= energy[0]
    assert energy[-1] < 1e-5
    assert engine.volume == pytest.approx(0.25 * depth, rel=0.01)
    assert abs(reports[-1].density_error[0]) <= 1e-3


@pytest.mark.parametrize("cell", [1 / 20, pytest.param(1 / 32, marks=pytest.mark.slow)])
def test_a_held_ball_is_pushed_up_by_the_water_it_displaces(cell: float) -> None:
    """Radius 0.2 m."""
    at = np.array([0.513, 0.487, 0.41])
    engine = Flip(around(0.2, at, cell, "static"))
    advance(engine, 0.1, at_rest(at))
    reports = advance(engine, 0.1, at_rest(at))
    force = sum(r.impulse[0] for r in reports) / sum(r.dt for r in reports)
    assert force[2] == pytest.approx(1000 * G * 4 / 3 * np.pi * 0.2**3, rel=0.02)
    assert np.abs(force[:2]).max() < 0.01 * force[2]


def first_rise(cell: float) -> float:
    """Acceleration of a ball of half the water's density in its first 0.1 s [g]."""
    radius, at, speed = 0.12, np.array([0.5, 0.5, 0.35]), 0.0
    mass = 500.0 * 4 / 3 * np.pi * radius**3
    engine = Flip(around(radius, at, cell, "dynamic"))
    for _ in range(10):
        report = engine.step(0.01, at_rest(at, mass=mass, radius=radius, speed=speed))
        speed += -G * report.dt + report.impulse[0, 2] / mass
        at = at + np.array([0.0, 0.0, speed * report.dt])
    return float(speed / (0.1 * G))


@pytest.mark.parametrize("cell", [1 / 24, pytest.param(1 / 32, marks=pytest.mark.slow)])
def test_a_ball_let_go_rises_with_its_added_mass(cell: float) -> None:
    """(density - own) g / (own + added); the added mass of a ball is half of the water it displaces, 4 % more within these walls.

    At cells of 1/20 m, 5 across the ball, it rises 10.1 % too slowly, at 1/32 4 %.
    """
    added = 0.5 * (1 + 1.56 * (0.12 / 0.5) ** 3)
    assert first_rise(cell) == pytest.approx(0.5 / (0.5 + added), rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "cell"), [(0.3, 1 / 32), (0.5, 1 / 20), (0.5, 1 / 32), (0.8, 1 / 32)])
def test_a_box_floats_as_deep_as_its_density_says_at_either_resolution(ratio: float, cell: float) -> None:
    """As `test_flip.test_a_box_floats_as_deep_as_its_density_says`, which has 1/20 m for the other two."""
    size, depth = (0.4, 0.4, 0.2), 0.5
    height = depth + size[2] / 2 - ratio * size[2] + 0.01
    body = Boundary("box", box_mesh(size), "dynamic")
    engine = Flip(pool(1.0, depth, cell, body, np.array([0.5, 0.5, height]), size))
    heights = drift_of(body, size, 1000 * ratio, height, 3.0, engine)
    level = engine.particles().volume.sum() + ratio * np.prod(size)
    draft = level - (heights[-48:].mean() - size[2] / 2)
    assert draft == pytest.approx(ratio * size[2], abs=0.02 * size[2])


def test_a_board_thinner_than_a_cell_floats_and_gets_what_the_water_loses() -> None:
    """Half a cell thick, half as heavy as water, from its draft: no cell inside it carries pressure, the half cells at it do."""
    cell, size, depth = 0.1, (0.4, 0.3, 0.05), 0.4
    water = block((0, 0, 0), (1.2, 1.0, depth), cell / 2)
    at, speed, spin, turn = np.array([0.61, 0.48, depth]), np.zeros(3), np.zeros(3), np.eye(3)
    water = water[(np.abs(water - at) > np.array(size) / 2).any(axis=1)]
    board = Boundary("board", box_mesh(size), "dynamic")
    engine = Flip(LiquidSetup(**{**vars(tank((1.2, 1.0, 0.8), water, cell / 2, boundaries=(board,))), "spacing": cell}))
    mass = 500.0 * float(np.prod(size))
    for _ in range(40):
        state = one_body(at, mass=mass, size=size, velocity=speed, spin=spin)
        state.rotation[0] = turn
        report = engine.step(0.02, state)
        assert np.abs(report.impulse + report.reaction).max() <= 1e-5 * mass * G * report.dt
        speed = speed + report.impulse[0, :3] / mass - np.array([0.0, 0.0, G * report.dt])
        spin = spin + state.inverse_inertia[0] @ report.impulse[0, 3:]
        at = at + report.dt * speed
        turn = trimesh.transformations.euler_matrix(*(report.dt * spin))[:3, :3] @ turn
    assert abs(at[2] - depth) < 0.5 * cell
    assert abs(speed[2]) < 0.1
    assert turn[2, 2] > 0.95
