"""Surface tension against gravity, by the capillary length of water."""

import pytest
from worldagent.physics.capillarity import bond_number, is_felt


def test_the_bond_number_is_one_at_the_capillary_length() -> None:
    """Printed: 2.7 mm for water (de Gennes, Brochard-Wyart and Quere 2004, section 2.1)."""
    assert bond_number(0.0728, 998.0, 9.81, 2.7e-3) == pytest.approx(1.0, rel=0.03)


def test_tension_of_water_is_felt_below_eight_millimetres_and_not_above_nine() -> None:
    assert [is_felt(0.0728, 998.0, 9.81, h) for h in (0.008, 0.009)] == [True, False]


def test_nothing_is_felt_without_tension_and_everything_without_gravity() -> None:
    assert not is_felt(0.0, 998.0, 9.81, 1e-4)
    assert is_felt(0.0728, 998.0, 0.0, 10.0)
