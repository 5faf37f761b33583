"""Time scale of contacts against the speed of Rayleigh waves."""

from __future__ import annotations

import math

import pytest
from worldagent.physics.grains import rayleigh_time

RAYLEIGH = {0.0: 0.874, 0.25: 0.919, 0.5: 0.955}
"""Speed of Rayleigh waves over that of shear waves by Poisson's ratio: Achenbach, Wave Propagation in Elastic Solids (1973), section 5.11."""


@pytest.mark.parametrize("poisson", RAYLEIGH)
def test_the_time_is_that_of_a_rayleigh_wave_half_around_the_sphere(poisson: float) -> None:
    radius, density, young = 2e-3, 2600.0, 7e10
    shear_speed = math.sqrt(young / (2.0 * (1.0 + poisson)) / density)
    assert rayleigh_time(radius, density, young, poisson) == pytest.approx(
        math.pi * radius / (RAYLEIGH[poisson] * shear_speed), rel=5e-3
    )
