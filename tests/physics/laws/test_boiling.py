"""Boiling of water against the numbers that Incropera et al. (2007), chapter 10, print in text and examples."""

from __future__ import annotations

import pytest
from worldagent.physics.boiling import (
    BOILING,
    boiling_flux,
    film_conductance,
    greatest_flux,
    least_film_flux,
    nucleate_flux,
    steam_heat,
    with_radiation,
)


def test_a_copper_pan_at_118_degrees_boils_with_836_kilowatts_per_square_metre() -> None:
    """Example 10.1."""
    assert nucleate_flux(18.0) == pytest.approx(836e3, rel=0.002)


def test_the_greatest_flux_is_1_26_megawatts_per_square_metre() -> None:
    """Example 10.1."""
    assert greatest_flux() == pytest.approx(1.26e6, rel=0.002)


def test_the_least_flux_of_a_film_is_18_9_kilowatts_per_square_metre() -> None:
    """Example 10.1, comments."""
    assert least_film_flux() == pytest.approx(18.9e3, rel=0.004)


def test_a_black_heating_rod_of_6_mm_at_255_degrees_is_under_a_film() -> None:
    """Example 10.3: 238 W/(m^2 K) by conduction, 254 with radiation."""
    found = film_conductance(155.0, 6e-3, 0.62, 0.8)
    assert found == pytest.approx(238.0, rel=0.005)
    assert with_radiation(found, 155.0, 1.0) == pytest.approx(254.1, rel=0.005)


def test_a_film_of_a_hot_surface_gives_its_radiation_and_more() -> None:
    """Limit: at 1400 K radiation alone is 0.9 sigma (T^4 - T_boiling^4)."""
    radiated = 0.9 * 5.67e-8 * (1400.0**4 - BOILING**4)
    found = boiling_flux(1400.0 - BOILING)
    assert radiated < found < 2.5 * radiated


def test_nothing_boils_at_what_is_no_hotter_than_boiling_water() -> None:
    assert boiling_flux(0.0) == boiling_flux(-20.0) == 0.0


def test_the_curve_rises_falls_and_rises_without_jumps() -> None:
    """Shape of figure 10.4: up to the greatest flux, down to the film, up with radiation."""
    assert boiling_flux(5.0) < boiling_flux(15.0) < boiling_flux(25.0) == pytest.approx(greatest_flux())
    assert boiling_flux(40.0) > boiling_flux(80.0) > boiling_flux(120.0)
    assert boiling_flux(120.0) < boiling_flux(400.0) < boiling_flux(1000.0)
    for edge in (30.0, 120.0):
        assert boiling_flux(edge - 1e-6) == pytest.approx(boiling_flux(edge + 1e-6), rel=1e-5)


def test_steam_from_cold_water_takes_the_heat_of_warming_it_besides() -> None:
    """Incropera, table A.6: 2257 kJ/kg, and 4.18 to 4.22 kJ/(kg K) from 20 to 100 degrees C: 335 kJ/kg."""
    assert steam_heat(BOILING) == pytest.approx(2.257e6)
    assert steam_heat(293.15) - steam_heat(BOILING) == pytest.approx(335e3, rel=0.005)
