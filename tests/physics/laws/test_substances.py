"""Air against the standard atmosphere."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.physics.substances import AIR_DENSITY, AIR_VISCOSITY, air_density, air_viscosity


def test_air_is_that_of_the_standard_atmosphere() -> None:
    """Printed at 15 degrees C: 1.2250 kg/m^3 and 1.7894e-5 Pa s, at -56.5 degrees C 1.4216e-5 Pa s; constants are those at 20."""
    assert air_density(288.15) == pytest.approx(1.2250, rel=1e-4)
    assert air_viscosity(np.array([288.15, 216.65])) == pytest.approx([1.7894e-5, 1.4216e-5], rel=1e-4)
    assert (air_density(293.15), float(air_viscosity(np.array(293.15)))) == pytest.approx((AIR_DENSITY, AIR_VISCOSITY), rel=2e-3)
