"""Air on the surface of a liquid: areas and forces against those of a ball, a slab, a cube, a drop."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.physics.drag import Medium
from worldagent.physics.liquid_air import SKIN, outer_area, push_on_liquid

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
    force = push_on_liquid(wind(n, (10, 0, 0)), np.zeros((n, 3)), 1000 * volume, volume, area, share).force[inner].sum(axis=0)
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
    force = push_on_liquid(wind(n, (10, 0, 0)), np.zeros((n, 3)), 1000 * volume, volume, area, share).force
    front = points[:, 0] < 0
    assert force[front].sum(axis=0)[0] == pytest.approx(0.5 * AIR * 100 * 4 * half**2, rel=5.0 / cells)
    assert abs(force[~front].sum(axis=0)[0]) < 0.1 * force[front].sum(axis=0)[0]


def test_a_single_drop_is_a_sphere_in_the_flow() -> None:
    volume = np.array([H**3])
    area, share = outer_area(np.array([[0.013, 0.004, -0.007]]), volume, H)
    push = push_on_liquid(wind(1, (10, 0, 0)), np.zeros((1, 3)), 1000 * volume, volume, area, share)
    section = np.pi * (3 * H**3 / (4 * np.pi)) ** (2 / 3)
    assert push.force[0, 0] == pytest.approx(0.5 * AIR * 0.44 * section * 100, rel=0.01)
    assert push.rate[0] == pytest.approx(push.force[0, 0] / (10 * 1000 * H**3))


@pytest.mark.parametrize(("speed", "stress"), [(5.0, 0.0361), (10.0, 0.1445)])
def test_the_stress_of_a_wind_is_that_of_large_and_pond(speed: float, stress: float) -> None:
    """Printed: drag coefficient 1.2e-3 for winds of 4 to 11 m/s; with air of 1.204 kg/m^3 these stresses [Pa]."""
    level = np.array([[0.0, 0.0, 1.0]])
    push = push_on_liquid(wind(1, (speed, 0, 0)), np.zeros((1, 3)), np.ones(1), np.full(1, 1e-3), level, np.ones(1))
    assert push.force[0] == pytest.approx([stress, 0.0, 0.0], rel=2e-3, abs=1e-12)


def test_the_front_of_a_ball_meets_half_of_the_stagnation_pressure() -> None:
    """Closed form: the integral of cos^3 over a hemisphere is half of its cross-section. Skin drag is left out of the bound."""
    rng = np.random.default_rng(3)
    normal = rng.normal(size=(200_000, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    n = len(normal)
    area = normal * (4 * np.pi / n)
    force = push_on_liquid(wind(n, (10, 0, 0)), np.zeros((n, 3)), np.ones(n), np.full(n, 1e-9), area, np.ones(n)).force
    assert force.sum(axis=0)[0] == pytest.approx(0.5 * AIR * 100 * np.pi * 0.5, rel=0.02)
