"""Air against the standard atmosphere."""

from __future__ import annotations

import pytest
from worldagent.physics.substances import AIR_DENSITY, AIR_VISCOSITY


def _air(celsius: float) -> tuple[float, float]:
    """Density at 101325 Pa and viscosity of dry air: the ideal gas and Sutherland's law with the constants of the standard."""
    kelvin = celsius + 273.15
    return 101325 * 0.0289644 / (8.31432 * kelvin), 1.458e-6 * kelvin**1.5 / (kelvin + 110.4)


def test_air_is_that_of_the_standard_atmosphere_at_twenty_degrees() -> None:
    """Printed at 15 degrees C: 1.2250 kg/m^3 and 1.7894e-5 Pa s; the same formulas at 20."""
    assert _air(15.0) == pytest.approx((1.2250, 1.7894e-5), rel=1e-4)
    assert pytest.approx(_air(20.0), rel=2e-3) == (AIR_DENSITY, AIR_VISCOSITY)
