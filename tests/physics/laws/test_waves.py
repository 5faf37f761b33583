"""Linear waves against printed tables, spectra against printed ratios of periods and variances."""

from __future__ import annotations

import math

import numpy as np
import pytest
from worldagent.physics.waves import Sea, breaking_steepness, group_speed, spectral_density, wavelength, wavenumber

G = 9.81
TABLE = {0.01: (0.04032, 0.9792), 0.1: (0.1410, 0.8103), 0.2: (0.2251, 0.6677), 0.5: (0.5018, 0.5117)}
"""Depth over deep-water length: depth over length, group speed over phase speed. Shore Protection Manual (1984), table C-1."""


@pytest.mark.parametrize("relative", TABLE)
def test_length_and_group_speed_are_those_of_the_shore_protection_manual(relative: float) -> None:
    period = 8.0
    deep = G * period**2 / (2 * math.pi)
    depth = relative * deep
    length = wavelength(period, depth, G)
    assert depth / length == pytest.approx(TABLE[relative][0], rel=5e-4)
    assert group_speed(period, depth, G) / (length / period) == pytest.approx(TABLE[relative][1], rel=5e-4)


def test_a_wave_of_ten_seconds_on_three_metres_is_as_long_as_the_manual_says() -> None:
    """Worked example II-1-1 of the Coastal Engineering Manual: d / L = 0.05641, L = 53.2 m."""
    length = wavelength(10.0, 3.0, 2 * math.pi * 1.56)
    assert 3.0 / length == pytest.approx(0.05641, rel=2e-3)
    assert length == pytest.approx(53.2, abs=0.1)


def test_wavenumbers_solve_the_dispersion_relation_from_shallow_to_deep_water() -> None:
    omega = np.geomspace(0.05, 20.0, 60)
    for depth in (0.2, 3.0, 400.0):
        k = wavenumber(omega, depth, G)
        np.testing.assert_allclose(G * k * np.tanh(k * depth), omega**2, rtol=1e-12)


def test_the_limits_of_shallow_and_deep_water_are_met() -> None:
    assert wavelength(60.0, 1.0, G) == pytest.approx(60.0 * math.sqrt(G * 1.0), rel=1e-3)
    assert wavelength(5.0, 500.0, G) == pytest.approx(G * 25.0 / (2 * math.pi), rel=1e-6)
    assert group_speed(60.0, 1.0, G) == pytest.approx(math.sqrt(G * 1.0), rel=5e-3)
    assert group_speed(5.0, 5000.0, G) == pytest.approx(0.5 * G * 5.0 / (2 * math.pi), rel=1e-6)


def test_waves_break_at_a_seventh_of_their_length_on_deep_water_and_at_nine_tenths_of_the_depth_on_shallow() -> None:
    """Limits of Miche's law: 0.142 L and 0.142 2 pi d = 0.89 d."""
    assert breaking_steepness(5.0, 500.0, G) == pytest.approx(1.0 / 7.0, rel=0.01)
    assert breaking_steepness(60.0, 1.0, G) * wavelength(60.0, 1.0, G) == pytest.approx(0.89, rel=5e-3)


def _moments(peakedness: float) -> tuple[float, float, float]:
    """Moments 0, 1 and 2 of a spectrum with the peak period 2 pi."""
    omega = np.geomspace(0.3, 60.0, 40001)
    density = spectral_density(omega, 2 * math.pi, peakedness)
    zero, one, two = (float(np.trapezoid(density * omega**n, omega)) for n in range(3))
    return zero, one, two


@pytest.mark.parametrize(("peakedness", "crossing", "mean"), [(1.0, 1.4049, 1.2957), (3.3, 1.2859, 1.1984)])
def test_peak_over_mean_periods_are_as_tabulated(peakedness: float, crossing: float, mean: float) -> None:
    """Peak period over zero-crossing and over mean period: DNV-RP-C205 (2010), section 3.5.5."""
    zero, one, two = _moments(peakedness)
    assert math.sqrt(two / zero) == pytest.approx(crossing, rel=5e-3)
    assert one / zero == pytest.approx(mean, rel=5e-3)


@pytest.mark.parametrize("peakedness", [2.0, 3.3, 5.0])
def test_the_peak_of_jonswap_adds_the_variance_that_is_tabulated(peakedness: float) -> None:
    """Variance over that of Pierson and Moskowitz: 1 / (1 - 0.287 ln gamma), DNV-RP-C205 (2010), section 3.5.5."""
    assert _moments(peakedness)[0] / _moments(1.0)[0] == pytest.approx(1.0 / (1.0 - 0.287 * math.log(peakedness)), rel=0.02)


def test_a_spectrum_of_pierson_and_moskowitz_integrates_to_a_fifth() -> None:
    """Closed form: the integral of x^-5 exp(-5/4 x^-4) is 1/5; its peak is at x = 1."""
    assert _moments(1.0)[0] == pytest.approx(0.2, rel=1e-3)
    omega = np.linspace(0.5, 2.0, 1501)
    assert omega[int(np.argmax(spectral_density(omega, 2 * math.pi)))] == pytest.approx(1.0, abs=2e-3)


def test_a_crest_travels_with_the_phase_speed_in_the_direction_of_its_wave() -> None:
    k = float(wavenumber(2.0, 30.0, G))
    way = np.array([[0.6, 0.8]])
    sea = Sea(np.array([0.5]), np.array([2.0]), np.array([k]), way, np.zeros(1), 0.0, 30.0, G, -10.0, 1.0)
    later = sea.elevation(way * (2.0 / k) * 1.7, 1.7)
    assert later[0] == pytest.approx(0.5)
    assert sea.variance == pytest.approx(0.125)
    assert sea.elevation(np.zeros((1, 2)), -10.0)[0] == 0.0
    assert sea.elevation(np.zeros((1, 2)), 0.3, quadrature=True)[0] == pytest.approx(
        0.5 * math.cos(-2.0 * 0.3 - math.pi / 2), abs=1e-12
    )
