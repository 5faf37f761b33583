"""Depth where it is nearly the same all along a line: in the axis of a cylinder, in a thin wall, in a sheet that a body pierces."""

from __future__ import annotations

import importlib
import math

import numpy as np
import pytest
import trimesh
from scipy.optimize import linprog
from worldagent.geometry import Solid, contains, signed_clearance
from worldagent.geometry.depth import PRECISION
from worldagent.geometry.inside import GRID_PAIRS

from .meshes import at, solid_of

depth_module = importlib.import_module("worldagent.geometry.depth")
HALF = math.sqrt(0.5)
LYING = (HALF, HALF, 0.0, 0.0)
"""Quaternion that lays a cylinder along y."""


def flat_sheet(columns: int, rows: int, width: float = 1.2, length: float = 0.8) -> Solid:
    """An open level sheet of two triangles a cell."""
    x, y = np.meshgrid(np.linspace(-width / 2, width / 2, columns + 1), np.linspace(-length / 2, length / 2, rows + 1))
    k = np.arange((columns + 1) * rows).reshape(rows, columns + 1)[:, :columns].ravel()
    up = columns + 1
    faces = np.concatenate([np.c_[k, k + 1, k + up + 1], np.c_[k, k + up + 1, k + up]])
    return solid_of(trimesh.Trimesh(np.c_[x.ravel(), y.ravel(), 0.0 * x.ravel()], faces, process=False), closed=False)


def wavy_slab(thickness: float = 0.004) -> Solid:
    """A closed sheet of cloth of that thickness [m], 1.2 m wide, in waves."""
    made = trimesh.creation.box((1.2, 0.8, thickness)).subdivide().subdivide()
    made.vertices[:, 2] += 0.05 * np.sin(5.0 * made.vertices[:, 0])
    return solid_of(made)


def rod(radius: float, length: float) -> Solid:
    return solid_of(trimesh.creation.cylinder(radius, length, sections=64))


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Number of points whose depth the refinement asked for, call by call."""
    counts: list[int] = []
    original = depth_module._sample

    def counting(other, points):
        counts.append(points.size // 3)
        return original(other, points)

    monkeypatch.setattr(depth_module, "_sample", counting)
    return counts


@pytest.mark.parametrize("cells", [(6, 4), (60, 40)])
@pytest.mark.parametrize("tilt", [0.0, 0.01])
def test_a_sheet_through_the_axis_of_a_rod_is_as_deep_as_its_flats(asked, cells, tilt):
    """Analytic: the axis lies an apothem below all 64 sides. Samples never meet it, the bound of a ridge points at it."""
    sheet, pole = flat_sheet(*cells), rod(0.02, 1.0)
    turned = tuple(np.add(LYING, (0.0, 0.0, tilt / 2.0, 0.0)))
    found = signed_clearance(sheet, at(0.0123), pole, at(quaternion=turned))
    assert -found.distance == pytest.approx(0.02 * math.cos(math.pi / 64), rel=PRECISION)
    assert sum(asked) < 3000, "a plateau is bounded at once, not split down to the precision"


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("pose", [LYING, (1.0, 0.0, 0.0, 0.0)], ids=["along", "across"])
def test_a_thin_closed_sheet_through_a_rod_is_not_searched_for_its_own_half_thickness(asked, swapped, pose):
    """The rod is 25 times as deep as the sheet is; both ways round the answer and its witness points are the same."""
    pair = [(wavy_slab(), at(0.0123)), (rod(0.1, 1.0), at(quaternion=pose))]
    (a, pose_a), (b, pose_b) = pair[::-1] if swapped else pair
    found = signed_clearance(a, pose_a, b, pose_b)
    assert -found.distance == pytest.approx(0.1 * math.cos(math.pi / 64), rel=0.01)
    assert np.linalg.norm(found.point_a - found.point_b) == pytest.approx(-found.distance, rel=1e-9)
    assert sum(asked) < 3000


def test_a_sheet_through_the_wall_of_a_pipe_is_half_a_wall_deep(asked):
    """Analytic: 15 mm in a wall of 30 mm, less the facet error; the same all around."""
    pipe = solid_of(trimesh.creation.annulus(0.05, 0.08, 1.0, sections=64))
    found = signed_clearance(flat_sheet(6, 4), at(0.0123, 0.0031, 0.0007), pipe, at(quaternion=LYING))
    assert -found.distance == pytest.approx(0.015 * math.cos(math.pi / 64), rel=2.0 * PRECISION)
    assert sum(asked) < 3000


def test_a_sheet_whose_grid_lines_meet_the_ends_of_a_cylinder_is_as_deep_as_ever():
    """Analytic: half the length. Triangles that touch an end along a grid line are in no pair, and both sides of it are asked."""
    found = signed_clearance(flat_sheet(24, 16), at(0.0123), rod(0.3, 0.5), at(quaternion=LYING))
    assert -found.distance == pytest.approx(0.25, rel=PRECISION)


def tube(radius: float = 0.056, wall: float = 0.0004, length: float = 0.12) -> Solid:
    """The side of a tin can: triangles as long as the can, walls thinner than what its neighbour reaches into."""
    return solid_of(trimesh.creation.annulus(radius - wall, radius, length, sections=32))


@pytest.mark.parametrize(("reach", "turn"), [(0.0015, 0.0), (0.0009, 0.0), (0.0015, 0.3)])
def test_cans_that_lean_on_each_other_are_searched_where_they_cut_each_other(asked, monkeypatch, reach, turn):
    """Their walls are half as deep in each other as they are thick; whole triangles take many times as many places, and say the same."""
    half = 0.5 * turn
    pose = at(2 * 0.056 - reach, 0.003, 0.011, quaternion=(math.cos(half), 0.0, math.sin(half), 0.0))
    found = signed_clearance(tube(), at(), tube(), pose).distance
    few = sum(asked)
    asked.clear()
    monkeypatch.setattr(
        depth_module, "clipped", lambda corners, within, names, pairs, other, noise: [corners[np.isin(names, pairs[:, 0])]]
    )
    whole = signed_clearance(tube(), at(), tube(), pose).distance
    assert found == pytest.approx(whole, rel=2 * PRECISION)
    assert found < -0.00012
    assert few < 0.2 * sum(asked)


def test_the_least_mixture_is_the_value_of_the_game():
    """Against a linear programme; and no convex combination of corners lies above it."""
    rng = np.random.default_rng(4)
    games = rng.normal(size=(60, 3, 3)) + 1.0
    games[::5] = np.round(games[::5])  # ties, and games without a full mixture
    bound, weights = depth_module._least_mixture(games)
    peak = depth_module._least_mixture(-games.swapaxes(1, 2))[1]
    for game, value, weight, corner in zip(games, bound, weights, peak, strict=True):
        least = linprog(
            [0, 0, 0, 1], np.c_[game, -np.ones(3)], np.zeros(3), [[1, 1, 1, 0]], [1], [(0, None)] * 3 + [(None, None)]
        )
        assert value == pytest.approx(least.fun, abs=1e-9)
        assert weight.min() >= 0.0
        assert weight.sum() == pytest.approx(1.0)
        assert (corner @ game).min() == pytest.approx(value, abs=1e-9), "the peak attains the bound"
        mixed = rng.dirichlet(np.ones(3), 200) @ game
        assert mixed.min(axis=1).max() <= value + 1e-12


def test_many_points_are_told_inside_as_one_by_one():
    """Counted crossings against solid angles, in a hole, a wall and outside."""
    pipe = solid_of(trimesh.creation.annulus(0.3, 0.6, 0.3, sections=40))
    points = np.random.default_rng(2).uniform(-0.7, 0.7, (2000, 3)) * (1.0, 1.0, 0.3)
    assert len(points) * len(pipe.faces) > GRID_PAIRS
    few = np.concatenate([contains(pipe, part) for part in np.array_split(points, 50)])
    assert np.array_equal(contains(pipe, points), few)
    assert 0.3 < few.mean() < 0.7
