"""Open shares around rigid bodies: those of boxes by their volumes and areas, standing, on their way, and thinner than a cell."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.simulation.bodies import resting
from worldagent.simulation.boundaries import Boundary, Surround
from worldagent.simulation.gas.obstacles import Obstacles
from worldagent.simulation.gas.solids import cut
from worldagent.tests.physics.test_flip import box_mesh
from worldagent.worlds.arrays import RigidPose
from worldagent.worlds.built import BuiltBody, TriangleMesh
from worldagent.worlds.categories.gas.facts import Grid

GRID = Grid((16, 16, 16), 0.1, np.zeros(3))
HERE = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
MIDDLE = (0.83, 0.77, 0.85)
"""Middle of the bodies [m]: no face of theirs lies in one of the cells'."""


def obstacles(half: tuple[float, float, float], *, moves: bool) -> tuple[Obstacles, Surround]:
    """A box of half sizes [m] in the middle."""
    mesh, at = box_mesh((2 * half[0], 2 * half[1], 2 * half[2])), np.array(MIDDLE)
    mesh = mesh if moves else TriangleMesh(mesh.vertices + at, mesh.faces)
    body = BuiltBody("b", HERE, 1.0, np.zeros(3), np.eye(3), 1.0)
    place = RigidPose(at, HERE.quaternion) if moves else HERE
    around = Surround((Boundary("a/b", mesh, "dynamic" if moves else "static"),), (body,), (place,), ((0, mesh),))
    return Obstacles(around, GRID), around


@pytest.mark.parametrize("moves", [False, True])
def test_a_body_takes_its_volume_and_closes_its_cross_section(moves: bool) -> None:
    """A cube of 0.6 m in cells of 0.1 m: within a twentieth, edges of bodies being cut."""
    found, _ = obstacles((0.3, 0.3, 0.3), moves=moves)
    closed = 1.0 - found.start.opening
    assert found.moves is moves
    assert (1.0 - found.start.room[:-1, :-1, :-1]).sum() * 1e-3 == pytest.approx(0.216, rel=0.05)
    assert closed[:-1, :-1, 8, 2].sum() * 0.01 == pytest.approx(0.36, rel=0.05)
    assert closed[:-1, :-1, 13, 2].sum() == 0.0


@pytest.mark.parametrize("moves", [False, True])
def test_a_plate_thinner_than_a_cell_lets_nothing_pass(moves: bool) -> None:
    """4 cm thick and 0.6 m wide in the middle of a layer of cells of 10 cm, whose corners are all outside: one layer of faces is closed."""
    found, _ = obstacles((0.3, 0.3, 0.02), moves=moves)
    closed = (1.0 - found.start.opening)[:-1, :-1, :, 2].sum(axis=(0, 1)) * 0.01
    assert np.count_nonzero(closed) == 1
    assert closed.max() == pytest.approx(0.36, rel=0.05)


def test_a_body_on_its_way_is_where_its_velocity_takes_it() -> None:
    """Half a second at 0.2 m/s is one cell: shares move by a cell, and closed faces have the velocity."""
    found, around = obstacles((0.3, 0.3, 0.3), moves=True)
    state = resting(around)
    state.velocity = np.array([[0.2, 0.0, 0.0]])
    later = found.at(state, 0.5)
    assert later.room[1:-1] == pytest.approx(found.start.room[:-2], abs=1e-6)
    assert later.velocity[8, 8, 8] == pytest.approx([0.2, 0.0, 0.0])
    assert found.at(state, 0.0).room == pytest.approx(found.start.room)


def test_a_body_that_turns_carries_its_surface_along() -> None:
    found, around = obstacles((0.3, 0.3, 0.3), moves=True)
    state = resting(around)
    state.angular_velocity = np.array([[0.0, 0.0, 2.0]])
    turned = found.at(state, 0.0)
    assert turned.velocity[10, 8, 8] == pytest.approx([-2.0 * (0.8 - MIDDLE[1]), 2.0 * (1.0 - MIDDLE[0]), 0.0], abs=1e-6)


def test_a_body_outside_of_the_box_closes_nothing() -> None:
    found, around = obstacles((0.3, 0.3, 0.3), moves=True)
    state = resting(around)
    state.velocity = np.array([[10.0, 0.0, 0.0]])
    assert (found.at(state, 1.0).room[:-1, :-1, :-1] == 1.0).all()


@pytest.mark.parametrize("noise", [0.0, 1e-8, -1e-8])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_corner_between_a_floor_and_a_wall_on_the_faces_of_cells_is_open(side: float, noise: float) -> None:
    x, z = np.meshgrid(np.arange(-2.0, 3.0), np.arange(-1.0, 3.0), indexing="ij")
    plane = np.minimum(side * x, z)
    distance = np.repeat(np.where(plane == 0.0, noise, plane)[:, None, :], 3, axis=1)
    found = cut(distance)
    wall = (np.arange(-2.0, 2.0) + 0.5) * side < 0.0
    under = np.arange(-1.0, 2.0) + 0.5 < 0.0
    expected = (~wall[:, None] & ~under[None, :]).astype(float)
    assert (found.room[:-1, 0, :-1] == expected).all()
    assert (found.opening[:-1, 0, :-1, 1] == expected).all()
