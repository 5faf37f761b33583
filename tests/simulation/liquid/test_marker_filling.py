"""Markers of a grid in shallow water over a sloping bed, around solids, and in boxes that no lattice fits."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from worldagent.geometry.solids import Solid
from worldagent.simulation.liquid.filling import PlacedSolid
from worldagent.simulation.liquid.marker_filling import fill_markers
from worldagent.tests.physics.liquid_cases.world import box_mesh
from worldagent.worlds.arrays import RigidPose
from worldagent.worlds.built import TriangleMesh

UPRIGHT = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
SPACING = 0.11


def placed(name: str, mesh: TriangleMesh) -> PlacedSolid:
    return PlacedSolid(name, Solid.from_mesh(mesh, closed=True), UPRIGHT)


def hull(points: list[tuple[float, float, float]]) -> TriangleMesh:
    made = trimesh.convex.convex_hull(np.array(points))
    return TriangleMesh(np.array(made.vertices), np.array(made.faces, dtype=np.int32))


def test_a_box_that_the_lattice_fits_has_a_marker_in_each_cell() -> None:
    made = fill_markers(placed("water", box_mesh((0.4, 0.3, 0.2))), [], 0.025, 0)
    assert len(made.position) == 16 * 12 * 8
    assert made.volume == pytest.approx(0.025**3, rel=1e-9)
    cell = np.floor((made.position + np.array([0.2, 0.15, 0.1])) / 0.025).astype(int)
    assert len(np.unique(cell, axis=0)) == len(cell)


def test_shallow_water_on_a_slope_is_as_dense_everywhere_and_lies_outside_of_the_bed() -> None:
    """Five to six markers deep, level and bed askew to the lattice: each of six lengths, 18 markers long, holds the water that is there."""
    size, slope = (12.0, 3.0), 0.02
    water = hull([(x, y, z - slope * x) for x in (0.0, size[0]) for y in (0.0, size[1]) for z in (-0.8, 0.0)])
    bed = hull([(x, y, z) for x in (-1.0, 13.0) for y in (-1.0, 4.0) for z in (-2.0, -0.61 - slope * x + 0.05 * y)])
    made = fill_markers(placed("water", water), [placed("bed", bed)], SPACING, 0)
    x, y, z = made.position.T
    deep = 0.61 - 0.05 * y
    assert (z + slope * x <= 1e-6).all()
    assert (z + slope * x >= -deep - 1e-6).all()
    exact = size[0] / 6 * (0.61 * size[1] - 0.025 * size[1] ** 2)
    held = np.histogram(x, 6, (0.0, size[0]))[0] * made.volume
    assert held == pytest.approx(exact, rel=0.03)
    assert made.volume == pytest.approx(SPACING**3, rel=0.02)
    shares = np.histogram((z + slope * x) / deep, 4, (-1.0, 0.0))[0] / len(z)
    assert shares == pytest.approx(0.25, abs=0.015)


def test_a_crate_in_the_water_displaces_markers() -> None:
    made = fill_markers(placed("water", box_mesh((1.0, 1.0, 0.5))), [placed("crate", box_mesh((0.31, 0.3, 0.37)))], 0.04, 3)
    assert (np.abs(made.position) >= np.array([0.155, 0.15, 0.185])).any(axis=1).all()
    assert len(made.position) * made.volume == pytest.approx(0.5 - 0.31 * 0.3 * 0.37, rel=0.01)
