"""Densities against printed ones, air against the standard atmosphere."""

from __future__ import annotations

import pytest
from worldagent.physics.substances import AIR_DENSITY, AIR_VISCOSITY, DENSITY_RANGES

PRINTED = {
    "steel": (7850,),
    "iron": (7870, 7150),  # pure, cast
    "aluminium": (2700,),
    "wood": (130, 750, 1200),  # balsa, oak, ebony
    "stone": (2650, 2750, 3000),  # granite, marble, basalt
    "concrete": (2400,),
    "brick": (1400, 2200),
    "glass": (2230, 2500),  # borosilicate, soda-lime
    "rubber": (920, 1100),
    "plastic": (900, 950, 1400),  # polypropylene, polyethylene, PVC
    "ice": (917,),
    "paper": (700, 1150),
    "water": (998.2, 1025),  # fresh, of the sea
    "oil": (920,),
}
"""[kg/m^3] CRC Handbook of Chemistry and Physics, 95th edition, "Density of Various Solids" and "Density of Liquids"."""


@pytest.mark.parametrize("substance", PRINTED)
def test_a_range_holds_the_printed_densities(substance: str) -> None:
    low, high = DENSITY_RANGES[substance]
    assert low <= min(PRINTED[substance])
    assert max(PRINTED[substance]) <= high


def test_no_range_is_so_wide_that_it_holds_any_matter() -> None:
    assert [n for n, (low, high) in DENSITY_RANGES.items() if high > 12 * low] == ["foam", "fabric", "other"]


def _air(celsius: float) -> tuple[float, float]:
    """Density at 101325 Pa and viscosity of dry air: the ideal gas and Sutherland's law with the constants of the standard."""
    kelvin = celsius + 273.15
    return 101325 * 0.0289644 / (8.31432 * kelvin), 1.458e-6 * kelvin**1.5 / (kelvin + 110.4)


def test_air_is_that_of_the_standard_atmosphere_at_twenty_degrees() -> None:
    """Printed at 15 degrees C: 1.2250 kg/m^3 and 1.7894e-5 Pa s; the same formulas at 20."""
    assert _air(15.0) == pytest.approx((1.2250, 1.7894e-5), rel=1e-4)
    assert pytest.approx(_air(20.0), rel=2e-3) == (AIR_DENSITY, AIR_VISCOSITY)
