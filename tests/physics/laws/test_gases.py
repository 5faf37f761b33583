"""Extinction by smoke against printed values."""

import pytest
from worldagent.physics import gases


def test_a_sign_is_seen_through_smoke_as_far_as_jin_measured() -> None:
    """Visibility times extinction coefficient is 3 for signs that reflect: 0.1 g/m^3 of soot at 8.7 m^2/g leaves 3.4 m."""
    assert pytest.approx(3.45, abs=0.01) == gases.SIGN_DEPTH / (gases.SOOT_EXTINCTION * 1e-4)
