"""What a medium meets of a liquid: areas, lee, forces."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.fields import Medium
from worldagent.worlds.liquid_air import SKIN, air_on, in_lee, outer_area, surface_points

H = 0.02
AIR = 1.204


def lattice(low: tuple[float, ...], high: tuple[float, ...]) -> np.ndarray:
    axes = [np.arange(a + H / 2, b, H) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def wind(n: int, velocity: tuple[float, ...]) -> Medium:
    one = np.ones(n)
    return Medium(np.tile(velocity, (n, 1)).astype(float), AIR * one, 1.81e-5 * one, one)


@pytest.mark.parametrize("cells", [20, 40])
def test_the_area_of_a_ball_comes_near_that_of_its_surface(cells: int) -> None:
    points = lattice((-1,) * 3, (1,) * 3)
    radius = cells * H / 2
    points = points[(points**2).sum(axis=1) < radius**2]
    area, _ = outer_area(points, np.full(len(points), H**3), H)
    true = 4 * np.pi * (3 * len(points) * H**3 / (4 * np.pi)) ** (2 / 3)
    assert np.linalg.norm(area, axis=1).sum() == pytest.approx(true, rel=2.0 / cells)
    assert (area * points).sum() > 0


@pytest.mark.parametrize("shift", [0.0, 0.013])
def test_wind_along_a_flat_surface_gives_the_stress_of_open_water(shift: float) -> None:
    points = lattice((-0.5, -0.5, -0.2), (0.5, 0.5, 0)) + shift
    n = len(points)
    volume = np.full(n, H**3)
    area, share = outer_area(points, volume, H)
    inner = (np.abs(points[:, :2] - shift) < 0.4).all(axis=1)
    force = air_on(wind(n, (10, 0, 0)), np.zeros((n, 3)), 1000 * volume, volume, area, share).force[inner].sum(axis=0)
    # Above and below: both sides of the slab are free.
    stress = 2 * SKIN * AIR * 10**2 * 0.8**2
    assert force[0] == pytest.approx(stress, rel=0.15)
    assert np.abs(force[1:]).max() < 0.05 * stress


@pytest.mark.parametrize("cells", [20, 40])
def test_wind_presses_on_what_faces_it_and_not_behind(cells: int) -> None:
    """Edges are rounded over two spacings, so that the push nears its limit as their share of the face falls."""
    half = cells * H / 2
    points = lattice((-half,) * 3, (half,) * 3)
    n = len(points)
    volume = np.full(n, H**3)
    area, share = outer_area(points, volume, H)
    force = air_on(wind(n, (10, 0, 0)), np.zeros((n, 3)), 1000 * volume, volume, area, share).force
    front = points[:, 0] < 0
    assert force[front].sum(axis=0)[0] == pytest.approx(0.5 * AIR * 100 * 4 * half**2, rel=5.0 / cells)
    assert abs(force[~front].sum(axis=0)[0]) < 0.1 * force[front].sum(axis=0)[0]


def test_a_single_drop_is_a_sphere_in_the_flow() -> None:
    volume = np.array([H**3])
    area, share = outer_area(np.array([[0.013, 0.004, -0.007]]), volume, H)
    push = air_on(wind(1, (10, 0, 0)), np.zeros((1, 3)), 1000 * volume, volume, area, share)
    section = np.pi * (3 * H**3 / (4 * np.pi)) ** (2 / 3)
    assert push.force[0, 0] == pytest.approx(0.5 * AIR * 0.44 * section * 100, rel=0.01)
    assert push.rate[0] == pytest.approx(push.force[0, 0] / (10 * 1000 * H**3))


def test_nothing_blows_in_the_lee_of_a_surface() -> None:
    wall = TriangleMesh(np.array([[0, -1, -1], [0, 1, -1], [0, 1, 1], [0, -1, 1.0]]), np.array([[0, 1, 2], [0, 2, 3]]))
    points = surface_points(wall, H)
    assert np.linalg.norm(points[:, None, 1:] - np.array([[0.3, 0.4]]), axis=2).min() < H
    spots = np.array([[0.02, 0.0, 0.0], [-0.03, 0.5, -0.5], [0.5, 0.0, 0.0], [0.02, 0.0, 3.0]])
    assert in_lee(spots, points, H).tolist() == [True, True, False, False]
    cut = surface_points(wall, H, np.array([-1, 0.5, 0.5]), np.array([1, 2.0, 2.0]))
    assert 0 < len(cut) < len(points) / 8
    assert cut[:, 1:].min() > 0.5 - H
