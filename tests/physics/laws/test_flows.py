"""Moving air against the laws of turbulence and vortices, attraction against Newton."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.physics.flows import attraction, gust_share, gust_waves, smooth_step, turbulence, turbulence_waves, vortex

AXIS = np.array([0.0, 0.0, 1.0])


def _correlations(distances: np.ndarray, seeds: int = 400) -> tuple[np.ndarray, np.ndarray]:
    """Correlation of velocities along and across the line between two points, over an ensemble of unit speed."""
    along, across = np.zeros((2, len(distances)))
    for seed in range(seeds):
        waves = turbulence_waves(1.0, 1.0, seed)
        swing = np.cos(np.outer(distances, waves.vector[:, 0]))
        along += swing @ (0.5 * waves.amplitude[:, 0] ** 2)
        across += swing @ (0.25 * (waves.amplitude[:, 1:] ** 2).sum(axis=1))
    return along / along[0], across / across[0]


def test_correlations_obey_the_relation_of_incompressible_isotropic_turbulence() -> None:
    """Law: g = f + r/2 df/dr (von Karman and Howarth 1938, doi:10.1098/rspa.1938.0013)."""
    distances = np.linspace(0.0, 0.6, 121)
    f, g = _correlations(distances)
    wanted = f + 0.5 * distances * np.gradient(f, distances)
    assert np.abs(g - wanted).max() < 0.05
    assert g.min() < -0.05 < f.min(), "transverse correlations of a flow without divergence turn negative first"


def test_the_velocity_has_the_declared_size_in_every_direction() -> None:
    found = np.zeros(3)
    for seed in range(60):
        waves = turbulence_waves(3.0, 1.0, seed)
        found += (turbulence(waves, np.random.default_rng(seed).uniform(-9, 9, (400, 3)), 0.3) ** 2).mean(axis=0)
    assert found / 60 == pytest.approx([3.0, 3.0, 3.0], rel=0.1)


def test_energy_falls_with_kolmogorovs_five_thirds() -> None:
    """Law: E(k) ~ k^(-5/3), so that each of three octaves holds 2^(-2/3) of the energy of the one before."""
    octaves = np.zeros(3)
    for seed in range(300):
        waves = turbulence_waves(1.0, 1.0, seed)
        place = np.log2(np.linalg.norm(waves.vector, axis=1) / (2 * np.pi)).astype(int)
        octaves += np.bincount(place, 0.5 * (waves.amplitude**2).sum(axis=1), minlength=3)
    assert octaves[1:] / octaves[:-1] == pytest.approx([2 ** (-2 / 3)] * 2, rel=0.05)


def test_a_turbulence_has_no_divergence() -> None:
    waves = turbulence_waves(3.0, 1.0, 2)
    assert np.abs((waves.vector * waves.amplitude).sum(axis=1)).max() < 1e-12 * np.abs(waves.vector).max()


def test_gusts_swell_within_one_and_come_with_their_period() -> None:
    gusts = gust_waves(4.0, 3)
    series = np.array([gust_share(gusts, t) for t in np.linspace(0.0, 4000.0, 40001)])
    assert np.abs(series).max() <= 1.0
    rises = np.count_nonzero((series[:-1] < 0) & (series[1:] >= 0))
    assert 2.0 < 4000.0 / rises < 8.0


def test_circulation_of_a_vortex_grows_to_that_of_a_line_vortex() -> None:
    """Law: v = Gamma / 2 pi r far from the core, Gamma = 4 pi V c; half of it within the core's edge (Scully 1975)."""
    radius = np.array([1e-3, 0.5, 500.0])
    v = vortex(np.outer(radius, [1.0, 0, 0]), center=np.zeros(3), axis=AXIS, speed=8.0, core=0.5)[:, 1]
    circulation = 2.0 * np.pi * radius * v
    assert circulation[2] == pytest.approx(4.0 * np.pi * 8.0 * 0.5, rel=1e-5)
    assert circulation[1] == pytest.approx(0.5 * circulation[2], rel=1e-5)
    assert v[0] == pytest.approx(16.0 * radius[0] / 0.5, rel=1e-5), "the core turns like a solid"


def test_the_updraft_of_a_vortex_falls_off_as_its_vorticity() -> None:
    r, d = 0.4, 1e-5
    points = np.array([[r - d, 0, 0], [r, 0, 0], [r + d, 0, 0], [1e-6, 0, 0], [2e-6, 0, 0]])
    v = vortex(points, center=np.zeros(3), axis=AXIS, speed=8.0, core=0.5, updraft=3.0)
    here = ((r + d) * v[2, 1] - (r - d) * v[0, 1]) / (2 * d * r)
    middle = 2.0 * v[3, 1] / 1e-6
    assert v[1, 2] / 3.0 == pytest.approx(here / middle, rel=1e-5)


def test_a_vortex_has_no_divergence() -> None:
    points, step = np.random.default_rng(0).uniform(-2, 2, (50, 3)), 1e-5
    law = {"center": np.array([0.1, 0.2, 0.3]), "axis": np.array([1.0, 2.0, 2.0]), "speed": 4.0, "core": 0.6, "updraft": 1.0}
    slopes = [(vortex(points + step * e, **law) - vortex(points - step * e, **law))[:, i] for i, e in enumerate(np.eye(3))]
    assert np.abs(sum(slopes)).max() < 1e-4 * np.abs(slopes).max()


def test_the_moon_falls_as_the_apple_does() -> None:
    """Worked example of Newton's: 9.81 m/s^2 at 6371 km is 0.0027 m/s^2 at the moon's 384400 km."""
    pull = attraction(np.array([[384.4e6, 0, 0]]), center=np.zeros(3), acceleration=9.81, distance=6.371e6)
    assert pull[0] == pytest.approx([-0.0027, 0, 0], abs=2e-5)


def test_attraction_falls_to_nothing_at_the_centre_in_proportion() -> None:
    points = np.outer([0.0, 1.0, 2.0, 4.0], [0.0, 0, 1.0])
    pull = attraction(points, center=np.zeros(3), acceleration=6.0, distance=2.0)
    assert pull[:, 2] == pytest.approx([0.0, -3.0, -6.0, -1.5])


def test_attraction_to_a_line_leaves_the_way_along_it_alone() -> None:
    pull = attraction(np.array([[0, 2.0, 9.0]]), center=np.zeros(3), acceleration=6.0, distance=2.0, axis=3.0 * AXIS)
    assert pull[0] == pytest.approx([0, -6.0, 0])


def test_a_smooth_step_has_no_slope_at_its_ends() -> None:
    share = np.array([0.0, 1e-6, 0.5, 1.0 - 1e-6, 1.0])
    assert smooth_step(share) == pytest.approx([0.0, 0.0, 0.5, 1.0, 1.0], abs=1e-11)
