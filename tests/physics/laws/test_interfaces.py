"""Area of interfaces from particles, against planes and spheres."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.physics.interfaces import SUPPORT, facing_area, kernel, slope, wetted_share
from worldagent.worlds.arrays import F64

SPACING = 0.1
REACH = SUPPORT * SPACING


def _lattice(half: float) -> F64:
    axis = np.arange(-half + SPACING / 2, half, SPACING)
    return np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)


def _area(hot: F64, water: F64) -> F64:
    way = hot[:, None] - water[None]
    far = np.linalg.norm(way, axis=2)
    pull = SPACING**3 * slope(far, REACH) / np.maximum(far, 1e-12)
    both = np.einsum("ij,ijk->ik", pull, way), -np.einsum("ij,ijk->jk", pull, way)
    return np.concatenate([facing_area(np.full(len(g), SPACING**3), g) for g in both])


def test_the_kernel_fills_space_once() -> None:
    radius = np.linspace(0.0, REACH, 20001)
    assert np.trapezoid(4.0 * np.pi * radius**2 * kernel(radius, REACH), radius) == pytest.approx(1.0, abs=1e-6)


def test_the_slope_is_the_derivative_of_the_kernel() -> None:
    radius = np.linspace(0.01, 1.2 * REACH, 50)
    step = 1e-6
    found = (kernel(radius + step, REACH) - kernel(radius - step, REACH)) / (2.0 * step)
    assert np.allclose(slope(radius, REACH), found, rtol=1e-4, atol=1e-3)


def test_a_plane_between_two_liquids_has_its_area() -> None:
    points = _lattice(1.0)
    hot = points[:, 0] < 0.0
    both = np.concatenate([points[hot], points[~hot]])
    inner = (np.abs(both[:, 1:]) < 0.5).all(axis=1)
    assert float(_area(points[hot], points[~hot])[inner].sum()) == pytest.approx(1.0, rel=0.03)


@pytest.mark.parametrize("radius", [0.3, 0.5])
def test_a_ball_in_a_liquid_has_its_surface(radius: float) -> None:
    points = _lattice(1.0)
    hot = np.linalg.norm(points, axis=1) < radius
    volume = hot.sum() * SPACING**3
    own = (36.0 * np.pi * volume**2) ** (1.0 / 3.0)
    assert float(_area(points[hot], points[~hot]).sum()) == pytest.approx(own, rel=0.05)


def test_liquids_that_are_apart_have_no_area_between() -> None:
    points = _lattice(0.5)
    assert not _area(points, points + np.array([1.0 + REACH, 0.0, 0.0])).any()


def test_a_wall_under_liquid_is_wet_and_one_beyond_its_reach_dry() -> None:
    points = _lattice(0.6) + np.array([0.0, 0.0, 0.6])
    for height, share in ((0.0, 1.0), (-1.01 * REACH, 0.0), (0.6, 1.0)):
        far = np.linalg.norm(points - [0.0, 0.0, height], axis=1)
        assert float(wetted_share(np.array(SPACING**3 * kernel(far, REACH).sum()))) == pytest.approx(share, abs=0.03)
