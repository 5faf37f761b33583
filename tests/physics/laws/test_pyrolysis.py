"""Heating and gasification of solids against printed values and balances."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.physics.pyrolysis import FIRST_LAYER, LAYERS, Film, Slab, Solid, convection, layers, surface_rise

WOOD = {"conductivity": 0.12, "density": 500.0, "capacity": 1600.0}


def slab(depth: float = 0.02, *, ignition: float = 600.0, char: float = 0.9, count: int = LAYERS) -> Slab:
    k, rho, c = WOOD.values()
    solid = Solid(*(np.array([v]) for v in (depth, rho, k, c, ignition, 1.8e6, char)))
    return Slab(solid, 293.15, count)


@pytest.mark.parametrize("seconds", [2.0, 10.0, 60.0])
def test_a_thick_slab_warms_as_a_half_space_does(seconds: float) -> None:
    found, flux, steps = slab(ignition=5000.0), 2.0e4, 400
    for _ in range(steps):
        found.step(seconds / steps, np.array([flux]))
    assert float(found.surface[0]) - 293.15 == pytest.approx(surface_rise(flux, seconds, **WOOD), rel=0.04)
    assert float(found.heat[0]) == pytest.approx(flux * seconds, rel=1e-9)


def test_more_layers_come_nearer_to_the_half_space() -> None:
    def error(count: int) -> float:
        found = slab(ignition=5e3, count=count)
        for _ in range(1000):
            found.step(0.01, np.array([2.0e4]))
        # Of the surface itself: half a layer above the middle of the first.
        surface = float(found.surface[0]) - 293.15 + 2.0e4 * 0.5 * float(found.thickness[0, 0]) / WOOD["conductivity"]
        return abs(surface / surface_rise(2.0e4, 10.0, **WOOD) - 1.0)

    assert error(16) < error(8) < error(4)
    assert error(16) < 0.01


def test_ignition_of_wood_takes_as_long_as_the_law_of_thick_solids_says() -> None:
    """pi / 4 k rho c ((T - T0) / q)^2 (Quintiere 2006, eq. 7.33)."""
    found, flux, time = slab(), 3.0e4, 0.0
    first = float(found.left[0])
    while found.left[0] == first:
        found.step(0.01, np.array([flux]))
        time += 0.01
    k, rho, c = WOOD.values()
    assert time == pytest.approx(np.pi / 4.0 * k * rho * c * ((600.0 - 293.15) / flux) ** 2, rel=0.1)


def test_a_thin_sheet_warms_evenly() -> None:
    """t = rho c depth (T - T0) / q (Quintiere 2006, eq. 7.9)."""
    found, time = slab(depth=2.0e-4), 0.0
    first = float(found.left[0])
    while found.left[0] == first:
        found.step(5e-3, np.array([5.0e3]))
        time += 5e-3
    assert time == pytest.approx(500.0 * 1600.0 * 2.0e-4 * (600.0 - 293.15) / 5.0e3, rel=0.02)


def test_what_it_gives_off_takes_the_heat_that_it_gets_and_ends_with_its_mass() -> None:
    found, given, heat = slab(depth=2.0e-3, char=0.95), 0.0, 0.0
    for _ in range(4000):
        given += float(found.step(0.02, np.array([4.0e4]))[0])
        heat += 0.02 * 4.0e4
        assert found.left[0] >= 0.0
        assert float(found.heat[0]) + 1.8e6 * given == pytest.approx(heat, rel=1e-9)
    assert given == pytest.approx(0.05, rel=1e-12)
    assert found.surface[0] > 600.0


def test_a_steady_flux_gives_gas_by_the_heat_of_gasification() -> None:
    """Where all of a thin sheet is at its ignition temperature, the flux of gas is the heat flux over the heat of gasification."""
    found = slab(depth=2.0e-4, char=0.0)
    for _ in range(400):
        rate = float(found.step(0.01, np.array([3.0e4]))[0]) / 0.01
    assert rate == pytest.approx(3.0e4 / 1.8e6, rel=1e-3)


def test_gas_warms_what_is_colder_and_cools_what_is_hotter() -> None:
    hot, cold = np.array([1293.15]), np.array([293.15])
    assert float(convection(hot, cold, np.array([1.0]))[0]) == pytest.approx(1.31 * 1000.0 ** (4.0 / 3.0))
    assert float(convection(cold, hot, np.array([0.0]))[0]) == pytest.approx(-1.52 * 1000.0 ** (4.0 / 3.0))
    assert float(convection(hot, hot, np.array([0.5]))[0]) == 0.0


def test_layers_fill_their_slab_and_grow_from_the_surface() -> None:
    found = layers(np.array([1e-4, 5e-3, 0.05]), 12)
    assert found.sum(axis=1) == pytest.approx([1e-4, 5e-3, 0.05])
    assert found[1:, 0] == pytest.approx(FIRST_LAYER, rel=1e-3)
    assert (np.diff(found, axis=1) >= -1e-18).all()


def film(char: float = 0.1) -> Film:
    """Cotton of 150 g/m^2."""
    return Film(Solid(*(np.array([v]) for v in (6.0e-4, 250.0, 0.06, 1300.0, 623.0, 1.8e6, char))), 293.15)


def test_a_film_ignites_when_the_law_of_thin_solids_says() -> None:
    """t = rho c depth (T - T0) / q, whose q is what comes to both faces (Quintiere 2006, eq. 7.9)."""
    found, time, step = film(), 0.0, 1e-3
    while found.step(step, np.array([2.0e4]))[0] == 0.0:
        time += step
    assert time == pytest.approx(0.15 * 1300.0 * (623.0 - 293.15) / 2.0e4, abs=2 * step)


def test_a_film_is_consumed_but_for_its_char_and_keeps_its_books() -> None:
    """The heat that came is in what is left, or made gas at the heat of gasification; steady burning gives flux / (L - c (T - T0))."""
    found, flux, given = film(), np.array([3.0e4]), []
    for _ in range(20_000):
        given.append(float(found.step(1e-3, flux)[0]))
        took = flux[0] * 1e-3 * len(given)
        assert float(found.heat[0]) + 1.8e6 * sum(given) == pytest.approx(took, rel=1e-9)
        if found.left[0] == 0.0:
            break
    rates = np.array(given[:-1]) / 1e-3
    burning = rates[rates > 0.0][1:]
    assert burning == pytest.approx(3.0e4 / (1.8e6 - 1300.0 * (623.0 - 293.15)), rel=1e-9)
    assert sum(given) == pytest.approx(0.9 * 0.15, rel=1e-12)
    assert float(found.store[0]) == pytest.approx(1300.0 * 0.1 * 0.15)
