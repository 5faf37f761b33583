"""Extinction by smoke against printed values."""

import pytest
from worldagent.physics import gases


def test_a_sign_is_seen_through_smoke_as_far_as_jin_measured() -> None:
    """Visibility times extinction coefficient is 3 for signs that reflect: 0.1 g/m^3 of soot at 8.7 m^2/g leaves 3.4 m."""
    assert pytest.approx(3.45, abs=0.01) == gases.SIGN_DEPTH / (gases.SOOT_EXTINCTION * 1e-4)


def test_drops_and_grains_take_out_twice_their_section() -> None:
    """Per mass 3 / (2 density radius): drops of 5 micrometres of water, grains of 3 micrometres of quartz."""
    assert gases.mass_extinction("water") == pytest.approx(3.0 / (2.0 * 1000.0 * 5e-6))
    assert gases.mass_extinction("sand") == pytest.approx(3.0 / (2.0 * 2650.0 * 3e-6), rel=0.01)
    assert gases.mass_extinction("other") == gases.SOOT_EXTINCTION
