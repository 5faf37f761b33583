"""Bodies that lie within a cell of something in a grid liquid: lifted by all that they displace, at any distance (R99).

Before gaps had cells, a box within half a cell of its bed was pressed down by up to 2.7 times the weight of the water it displaces, a log by
up to 1.9, and neither rose.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from worldagent.simulation.boundaries import BodyState, Boundary
from worldagent.simulation.liquid.engine import LiquidSetup
from worldagent.simulation.liquid.flip.engine import Flip
from worldagent.tests.simulation.liquid.flip_setup import advance, block, no_bodies, tank
from worldagent.worlds.arrays import F64
from worldagent.worlds.built import TriangleMesh

from .test_flip import G, box_mesh

DEPTH, SIDE, BED = 0.8, 1.0, 0.2
BOX = (0.5, 0.3, 0.3)
RADIUS, LENGTH = 0.15, 0.6


def log() -> TriangleMesh:
    """A round log along x, a prism of 48 sides of its volume."""
    made = trimesh.creation.cylinder(radius=RADIUS, height=LENGTH, sections=48)
    wider = math.sqrt(math.pi * RADIUS**2 * LENGTH / made.volume)
    return TriangleMesh((np.asarray(made.vertices) * [wider, wider, 1.0])[:, [2, 0, 1]], np.asarray(made.faces, np.int32))


def outside(shape: str, points: F64) -> F64:
    """Which points are not in a body about the origin."""
    if shape == "box":
        return np.asarray((np.abs(points) > np.array(BOX) / 2).any(axis=1))
    return np.asarray((np.abs(points[:, 0]) > LENGTH / 2) | (np.hypot(points[:, 1], points[:, 2]) > RADIUS))


def moved(mesh: TriangleMesh, by: F64) -> TriangleMesh:
    return TriangleMesh(mesh.vertices + by, mesh.faces)


def lying(shape: str, bed: str, cell: float, gap: float) -> tuple[LiquidSetup, BodyState, float]:
    """A body `gap` cells over a slab, whose top cuts cells, or over the domain's floor, 0.8 m under water; its volume."""
    base = BED if bed == "slab" else 0.0
    volume = float(np.prod(BOX)) if shape == "box" else math.pi * RADIUS**2 * LENGTH
    at = np.array([0.507, 0.493, base + gap * cell + 0.15])
    water = block((0, 0, 0), (SIDE, SIDE, base + DEPTH), cell / 2)
    water = water[(water[:, 2] > base) & outside(shape, water - at)]
    bodies = [Boundary("body", box_mesh(BOX) if shape == "box" else log(), "dynamic")]
    if bed == "slab":
        slab = moved(box_mesh((1.6, 1.6, 0.6)), np.array([0.5, 0.5, base - 0.3]))
        bodies.append(Boundary("bed", slab, "static"))
    setup = tank((SIDE, SIDE, base + DEPTH + 0.2), water, cell / 2, boundaries=tuple(bodies))
    state = no_bodies(len(bodies))
    state.position[0] = state.center[0] = at
    return LiquidSetup(**{**vars(setup), "spacing": cell}), state, volume


def push(setup: LiquidSetup, state: BodyState) -> F64:
    """Mean force on the held first body from 0.05 to 0.1 s [N]."""
    engine = Flip(setup)
    advance(engine, 0.05, state)
    reports = advance(engine, 0.05, state)
    assert sum(r.capped for r in reports) == 0
    return np.asarray(sum(r.impulse[0, :3] for r in reports) / sum(r.dt for r in reports))


@pytest.mark.parametrize("cell", [1 / 16, 1 / 24])
@pytest.mark.parametrize("gap", [0.0, 0.25, 0.5, 1.0, 2.0])
@pytest.mark.parametrize("bed", ["slab", "floor"])
def test_a_log_is_lifted_by_the_water_it_displaces_at_any_distance_from_its_bed(bed: str, gap: float, cell: float) -> None:
    """Archimedes, 4.8 and 7.2 cells across; measured 0.982 to 1.015."""
    setup, state, volume = lying("log", bed, cell, gap)
    force = push(setup, state) / (1000 * G * volume)
    assert force[2] == pytest.approx(1.0, abs=0.02)
    assert np.abs(force[:2]).max() < 0.025


@pytest.mark.parametrize(("cell", "within"), [(1 / 16, 0.065), (1 / 24, 0.03)])
@pytest.mark.parametrize("gap", [0.0, 0.25, 0.5, 1.0, 2.0])
@pytest.mark.parametrize("bed", ["slab", "floor"])
def test_a_box_that_lies_flat_is_lifted_too(bed: str, gap: float, cell: float, within: float) -> None:
    """4.8 and 7.2 cells high; all its underside is a gap. Measured 0.974 to 1.000, but 1.061 a quarter of a cell over a slab at 4.8."""
    setup, state, volume = lying("box", bed, cell, gap)
    force = push(setup, state) / (1000 * G * volume)
    assert force[2] == pytest.approx(1.0, abs=within)
    assert np.abs(force[:2]).max() < 0.045


def rise(shape: str, bed: str, ratio: float, seconds: float) -> float:
    """Way up of a body that touched its bed, moved by the reported impulses only [cells of 1/16 m]."""
    cell = 1 / 16
    setup, state, volume = lying(shape, bed, cell, 0.0)
    engine, mass = Flip(setup), 1000 * ratio * volume
    at, speed, floor = state.position[0].copy(), np.zeros(3), float(state.position[0, 2])
    state.inverse_mass[0], state.acceleration[0] = 1.0 / mass, (0.0, 0.0, -G)
    for _ in range(round(48 * seconds)):
        state.position[0] = state.center[0] = at
        state.velocity[0] = speed
        report = engine.step(1 / 48, state)
        assert np.abs(report.impulse + report.reaction)[:, :3].max() <= 1e-5 * mass * G * report.dt
        speed = speed + report.dt * state.acceleration[0] + report.impulse[0, :3] / mass
        if at[2] + report.dt * speed[2] < floor:
            speed[2] = max(speed[2], 0.0)
        at = at + report.dt * speed
    return float((at[2] - floor) / cell)


@pytest.mark.parametrize("bed", ["slab", "floor"])
@pytest.mark.parametrize(("shape", "seconds"), [("log", 0.6), ("box", 1.0)])
def test_a_light_body_let_go_on_the_bed_rises(shape: str, seconds: float, bed: str) -> None:
    """Half the water's density; free of the bed both are 4 cells up after 0.5 s.

    On it they have to draw water in below. A flat box is some 0.4 s later (measured 6.4 and 9.3 cells after a second): what runs in the gap
    begins anew in each step, and particles come in from a quarter of a cell on.
    """
    assert rise(shape, bed, 0.5, seconds) > 2.5


def test_a_heavy_body_stays_on_the_bed() -> None:
    assert rise("box", "slab", 1.5, 0.3) == pytest.approx(0.0, abs=0.02)


def test_a_log_beside_a_pier_is_not_drawn_to_it() -> None:
    """A quarter of a cell from an upright wall, and from the bed: what is missing in a gap at its side would press it there."""
    cell = 1 / 16
    setup, state, volume = lying("log", "slab", cell, 0.25)
    wall = moved(box_mesh((0.8, 0.3, 1.6)), state.position[0] + [0.0, RADIUS + 0.25 * cell + 0.15, 0.3])
    held = setup.position[outside("box", (setup.position - wall.vertices.mean(axis=0)) * [0.5 / 0.8, 1.0, 0.3 / 1.6])]
    setup = LiquidSetup(
        **{**vars(setup), "position": held, "velocity": np.zeros_like(held), "fluid": setup.fluid[: len(held)],
           "volume": setup.volume[: len(held)], "boundaries": (*setup.boundaries, Boundary("pier", wall, "static"))}
    )  # fmt: skip
    more = no_bodies(3)
    more.position[0] = more.center[0] = state.position[0]
    force = push(setup, more) / (1000 * G * volume)
    assert force[2] == pytest.approx(1.0, abs=0.05)
    assert abs(force[1]) < 0.05


def test_two_logs_that_touch_are_each_lifted() -> None:
    """One on the other, a tenth of a cell between them, two cells over the bed."""
    cell = 1 / 16
    setup, state, volume = lying("log", "slab", cell, 1.0)
    above = state.position[0] + [0.0, 0.0, 2 * RADIUS + 0.1 * cell]
    keep = outside("log", setup.position - above)
    held = setup.position[keep]
    setup = LiquidSetup(
        **{**vars(setup), "position": held, "velocity": np.zeros_like(held), "fluid": setup.fluid[: len(held)],
           "volume": setup.volume[: len(held)], "boundaries": (*setup.boundaries, Boundary("other", log(), "dynamic"))}
    )  # fmt: skip
    both = no_bodies(3)
    both.position[0] = both.center[0] = state.position[0]
    both.position[2] = both.center[2] = above
    engine = Flip(setup)
    advance(engine, 0.05, both)
    reports = advance(engine, 0.05, both)
    force = np.sum([r.impulse[:, 2] for r in reports], axis=0) / sum(r.dt for r in reports) / (1000 * G * volume)
    assert force[[0, 2]] == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("height", [1.2, 2.0])
def test_a_hull_wider_than_the_grid_reaches_from_its_sides_is_lifted_under_its_middle(height: float) -> None:
    """14 cells across and aground in 8 cells of water: the cells under its middle are far from every particle."""
    cell, width, draft = 0.1, 1.4, 0.8
    size, at = (width, width, height), np.array([1.2, 1.2, BED + 0.2 * cell + height / 2])
    water = block((0, 0, 0), (2.4, 2.4, BED + draft), cell / 2)
    water = water[(water[:, 2] > BED) & (np.abs(water - at) > np.array(size) / 2).any(axis=1)]
    bed = moved(box_mesh((4.0, 4.0, 1.0)), np.array([1.2, 1.2, BED - 0.5]))
    bodies = (Boundary("hull", box_mesh(size), "dynamic"), Boundary("bed", bed, "static"))
    setup = tank((2.4, 2.4, 1.4), water, cell / 2, boundaries=bodies)
    state = no_bodies(2)
    state.position[0] = state.center[0] = at
    force = push(LiquidSetup(**{**vars(setup), "spacing": cell}), state)
    assert force[2] == pytest.approx(1000 * G * width**2 * (draft - 0.2 * cell), rel=0.04)


def test_a_body_that_closes_a_channel_holds_the_water() -> None:
    """A free wall on the bed, a fifth of a cell over it, between water and air: nothing gets through under it in half a second."""
    cell, size = 1 / 20, (0.3, 0.5, 0.8)
    at = np.array([0.75, 0.25, BED + 0.2 * cell + 0.4])
    water = block((0, 0, 0), (0.6, 0.5, BED + 0.5), cell / 2)
    water = water[water[:, 2] > BED]
    bed = moved(box_mesh((2.1, 1.1, 0.6)), np.array([0.75, 0.25, BED - 0.3]))
    bodies = (Boundary("wall", box_mesh(size), "dynamic"), Boundary("bed", bed, "static"))
    setup = tank((1.5, 0.5, BED + 1.0), water, cell / 2, boundaries=bodies)
    state = no_bodies(2)
    state.position[0] = state.center[0] = at
    engine = Flip(LiquidSetup(**{**vars(setup), "spacing": cell}))
    advance(engine, 0.5, state)
    found = engine.particles()
    assert found.position[:, 0].max() < 0.9
    assert found.volume[found.position[:, 0] < 0.6].sum() == pytest.approx(0.15, rel=0.01)


@pytest.mark.parametrize(
    ("angle", "thick", "gap", "wall"),
    [(0.614, 1.55, 0.058, 0.1569), (1.074, 1.023, 0.236, 0.1015), (0.861, 0.876, 0.054, 0.1028)],
)
def test_a_leaf_beside_bed_and_wall_gets_what_the_water_loses(angle: float, thick: float, gap: float, wall: float) -> None:
    """A free leaf some cells thick, turned about its upright and a gap from bed and wall, lengths in cells but `wall` [m].

    Two solids close the faces there, in parts that add up to one: where one had more than all, 1e-3 of a step's impulse came from nowhere.
    """
    cell = 1 / 16
    size, turn = (thick * cell, 0.4, 0.6), trimesh.transformations.rotation_matrix(angle, [0, 0, 1])[:3, :3]
    at = np.array([0.5, wall, BED]) + np.array([0, 1, 1]) * (np.abs(turn) @ np.array(size) / 2 + gap * cell)
    water = block((0, 0, BED), (0.9, 0.6, BED + 0.4), cell / 2)
    water = water[(np.abs((water - at) @ turn) > np.array(size) / 2).any(axis=1) & (water[:, 1] > wall)]
    bed = moved(box_mesh((1.5, 1.1, 0.6)), np.array([0.5, 0.3, BED - 0.3]))
    side = moved(box_mesh((1.5, 0.6, 2.0)), np.array([0.5, wall - 0.3, 0.5]))
    bodies = (Boundary("leaf", box_mesh(size), "dynamic"), Boundary("bed", bed, "static"), Boundary("side", side, "static"))
    setup = tank((0.9, 0.6, BED + 0.8), water, cell / 2, boundaries=bodies)
    engine, state, weight = Flip(LiquidSetup(**{**vars(setup), "spacing": cell})), no_bodies(3), 60.0 * G
    state.position[0] = state.center[0] = at
    state.rotation[0], state.inverse_mass[0], state.inverse_inertia[0] = turn, G / weight, np.eye(3)
    for _ in range(2):
        report = engine.step(0.02, state)
        assert np.abs(report.impulse + report.reaction).max() <= 5e-7 * weight * report.dt


@pytest.mark.parametrize(("size", "gap", "wall", "draft", "depth"), [
    ((0.9549, 0.7182, 0.7919), -0.0251, 0.1487, 0.123, 0.4742),
    ((0.9361, 0.837, 0.6216), 0.0128, 0.1334, 0.0984, 0.3428),
])  # fmt: skip
def test_a_wide_body_at_a_wall_gets_what_the_water_loses(
    size: tuple[float, float, float], gap: float, wall: float, draft: float, depth: float
) -> None:
    """Columns end in the gap between it and the wall: what pressed on the upper face of their last cell, which has none, reached nobody."""
    cell = 1 / 16
    at = np.array([0.8, wall + size[1] / 2 + gap * cell, BED + depth - draft + size[2] / 2])
    water = block((0, 0, BED), (1.6, 1.4, BED + depth), cell / 2)
    water = water[(np.abs(water - at) > np.array(size) / 2).any(axis=1) & (water[:, 1] > wall)]
    bed = moved(box_mesh((3.0, 1.8, 0.6)), np.array([0.6, 0.5, BED - 0.3]))
    side = moved(box_mesh((3.0, 0.6, 4.0)), np.array([0.5, wall - 0.3, 0.5]))
    bodies = (Boundary("hull", box_mesh(size), "dynamic"), Boundary("bed", bed, "static"), Boundary("side", side, "static"))
    setup = tank((1.6, 1.4, BED + 1.6), water, cell / 2, boundaries=bodies)
    engine, state, mass = Flip(LiquidSetup(**{**vars(setup), "spacing": cell})), no_bodies(3), 1000.0 * size[0] * size[1] * draft
    state.position[0] = state.center[0] = at
    state.inverse_mass[0], state.inverse_inertia[0] = 1.0 / mass, 20.0 / mass * np.eye(3)
    for _ in range(2):
        report = engine.step(0.015, state)
        assert np.abs(report.impulse + report.reaction).max() <= 1e-6 * mass * G * report.dt
