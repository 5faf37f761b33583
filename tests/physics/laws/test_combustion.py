"""Stoichiometry and heats of fuels against printed values."""

from __future__ import annotations

import pytest
from worldagent.physics.combustion import FUELS, greatest_power


@pytest.mark.parametrize(
    ("name", "air"), [("methane", 17.2), ("propane", 15.7), ("methanol", 6.47), ("heptane", 15.2), ("wood", 5.8)]
)
def test_air_that_burns_a_kilogram_of_fuel(name: str, air: float) -> None:
    """Printed in textbooks (Turns, An Introduction to Combustion, appendix B), wood by its formula: within 1.5 %."""
    assert FUELS[name].air == pytest.approx(air, rel=0.015)


@pytest.mark.parametrize("name", sorted(FUELS))
def test_heat_per_oxygen_is_that_of_most_fuels(name: str) -> None:
    """13.1 MJ/kg of oxygen (Huggett 1980): within 5 %."""
    assert FUELS[name].heat / FUELS[name].oxygen == pytest.approx(13.1e6, rel=0.05)


@pytest.mark.parametrize("name", sorted(FUELS))
def test_the_weakest_mixture_heats_itself_to_a_flame(name: str) -> None:
    """Limits of flames lie between 1300 and 1700 K (Beyler, SFPE Handbook); 1250 J/(kg K) is the mean heat capacity up to there."""
    assert 1300.0 < 293.0 + FUELS[name].least_heat / 1250.0 < 1700.0


def test_greatest_power_falls_with_the_cell() -> None:
    assert greatest_power(0.1) == pytest.approx(4.5e6)
    assert greatest_power(0.01) == pytest.approx(22.5e6)
