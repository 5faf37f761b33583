"""Fire in a gas: what is released is what has burnt, it goes out without oxygen, and it needs to be lit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from worldagent.bench.gas import CLOSED
from worldagent.physics.combustion import FUELS, OXYGEN_SHARE, Fuel, greatest_power
from worldagent.physics.substances import AIR_HEAT_CAPACITY, SEA_LEVEL, air_density
from worldagent.simulation.gas.engine import FUEL, LIGHTNESS, PRODUCT, SOOT, Gas
from worldagent.simulation.gas.settings import GasSettings, Side

METHANE, WOOD = FUELS["methane"], FUELS["wood"]
CELLS = 10
AMBIENT = 293.15


def _gas(fuel: Fuel, sides: tuple[Side, ...] = CLOSED, cells: int = CELLS) -> Gas:
    """A box of 1 m."""
    return Gas((cells,) * 3, 1.0 / cells, sides, GasSettings(expands=True, fuel=fuel))


def _amounts(gas: Gas) -> np.ndarray:
    """Sums of lightness, soot, fuel and product [m^3, kg, kg, kg]."""
    return gas.totals() * gas.cell**3


def _block(gas: Gas, amount: float) -> None:
    """Fuel in the lower half of a box [kg/m^3], air elsewhere; lit everywhere."""
    state = np.zeros((*gas.shape, 4), np.float32)
    state[:, :, : gas.shape[2] // 2, FUEL] = amount
    gas.state = state
    gas.ignite(np.ones(gas.shape))


@pytest.mark.parametrize("fuel", [METHANE, WOOD], ids=lambda f: f.name)
def test_heat_in_a_sealed_box_is_fuel_burnt_times_heating_value(fuel: Fuel) -> None:
    """30 g of fuel and air in 1 m^3: heat and pressure within 1 %, species and soot as the reaction says."""
    gas = _gas(fuel)
    _block(gas, 0.06)
    before = _amounts(gas)
    gas.advance(1.0)
    after, fire = _amounts(gas), gas.fire
    assert fire is not None
    burnt = before[FUEL] - after[FUEL]
    assert burnt > 0.015
    assert fire.released == pytest.approx(burnt * fuel.heat, rel=0.01)
    assert fire.radiated >= fuel.radiant * fire.released * 0.999
    rise = 0.4 * (fire.released - fire.radiated)
    assert gas.pressure.max() - SEA_LEVEL == pytest.approx(rise, rel=0.01)
    assert after[SOOT] == pytest.approx(fuel.soot * burnt, rel=1e-4, abs=1e-9)
    assert after[PRODUCT] == pytest.approx((1.0 + fuel.air - fuel.soot) * burnt, rel=1e-4)
    # Gas that became soot is gas no more.
    assert after[LIGHTNESS] - before[LIGHTNESS] == pytest.approx(after[SOOT] / gas.density, abs=1e-5)


def test_a_burner_in_the_open_gives_its_heat_to_the_gas_that_leaves() -> None:
    """Methane for 50 kW into a box with an open top: enthalpy in the box and through the top is what was released and not radiated."""
    gas = _gas(METHANE, (*CLOSED[:5], "open"), 12)
    rate = np.zeros(gas.shape)
    rate[5:7, 5:7, 0] = 1.0
    flow = 5.0e4 / METHANE.heat / gas.density
    gas.emit(rate * flow / (4 * gas.cell**3), [0.0, 0.0, gas.density, 0.0])
    gas.ignite(rate)
    gas.advance(1.5)
    inside, out = _amounts(gas), gas.border.take()[:4] * gas.cell**3
    fire = gas.fire
    assert fire is not None
    burnt = 1.5 * flow * gas.density - inside[FUEL] - out[FUEL]
    assert burnt > 0.3 * 1.5 * flow * gas.density
    assert fire.released == pytest.approx(burnt * METHANE.heat, rel=0.01)
    warmth = gas.density * AIR_HEAT_CAPACITY * AMBIENT
    assert (inside[LIGHTNESS] + out[LIGHTNESS]) * warmth == pytest.approx(fire.released - fire.radiated, rel=0.01)
    assert gas.temperature.max() > 700.0
    assert gas.power[..., 0].max() <= 1.001 * greatest_power(gas.cell)


def test_a_closed_box_goes_out_when_its_oxygen_is_spent() -> None:
    """A burner of 300 kW in 0.2 m^3: it burns what the oxygen lets it (1 %), then less than a hundredth of what comes, pilot or not."""
    gas = Gas((6,) * 3, 0.1, CLOSED, GasSettings(expands=True, fuel=METHANE))
    rate = np.zeros(gas.shape)
    rate[2:4, 2:4, 0] = 1.0
    gas.emit(rate * 3.0e5 / METHANE.heat / gas.density / (4 * gas.cell**3), [0.0, 0.0, gas.density, 0.0])
    gas.ignite(rate)
    gas.advance(1.0)
    early, fire = gas.power[..., 0].sum() * gas.cell**3, gas.fire
    assert fire is not None
    gas.advance(8.0)
    most = 0.6**3 * gas.density / METHANE.air * METHANE.heat
    assert early > 1e5
    assert gas.power[..., 0].sum() * gas.cell**3 < 3.0e3
    assert 0.95 * most < fire.released <= most * 1.01
    assert _amounts(gas)[FUEL] == pytest.approx((9.0 * 3.0e5 - fire.released) / METHANE.heat, rel=0.01)


def test_fuel_burns_only_where_it_is_lit_or_hot() -> None:
    gas = _gas(METHANE)
    _block(gas, 0.06)
    gas.ignite(np.zeros(gas.shape))
    gas.advance(0.3)
    assert gas.fire is not None
    assert gas.fire.released == 0.0
    state = gas.state
    state[..., LIGHTNESS] = 1.0 - AMBIENT / (METHANE.ignition + 50.0)
    gas.state = state
    gas.advance(0.1)
    assert gas.fire.released > 0.0


def test_a_flame_does_not_cross_air_that_holds_too_little_oxygen() -> None:
    """A mixture in which products have thinned the oxygen to a third does not burn, lit or not; to two thirds it does."""
    for share, burns in ((0.33, False), (0.75, True)):
        gas = _gas(METHANE, cells=6)
        state = np.zeros((*gas.shape, 4), np.float32)
        air = share * gas.density / (1.0 + 1.0 / METHANE.air)
        state[..., FUEL] = air / METHANE.air
        state[..., PRODUCT] = gas.density - air - air / METHANE.air
        gas.state = state
        gas.ignite(np.ones(gas.shape))
        gas.advance(0.05)
        assert gas.fire is not None
        assert (gas.fire.released > 0.0) == burns


def test_mixing_limits_how_fast_it_burns() -> None:
    """Still gas of the same make everywhere burns by 1 - exp(-t / tau), tau = sqrt(2 cell / g) (FDS), where little heat keeps it still."""
    weak = replace(METHANE, heat=METHANE.heat * 1e-4, least_oxygen=1e-6)
    gas = _gas(weak, cells=6)
    state = np.zeros((*gas.shape, 4), np.float32)
    state[..., FUEL] = 0.01
    gas.state = state
    gas.ignite(np.ones(gas.shape))
    for _ in range(10):
        gas.step(0.01)
    tau = (2.0 * gas.cell / 9.81) ** 0.5
    assert gas.state[..., FUEL].mean() == pytest.approx(0.01 * np.exp(-0.1 / tau), rel=0.01)


def test_sooty_gas_cools_by_the_fourth_power_of_its_temperature() -> None:
    """Uniform gas at 1200 K with 1 mg/l of soot: 4 kappa sigma T^4, kappa = 1500 f T for a volume share f of soot."""
    gas = _gas(WOOD, cells=6)
    state = np.zeros((*gas.shape, 4), np.float32)
    state[..., LIGHTNESS], state[..., SOOT] = 1.0 - AMBIENT / 1200.0, 1e-3
    gas.state = state
    gas.step(0.01)
    kappa = 1500.0 * 1e-3 / 1800.0 * 1200.0
    power = 4.0 * kappa * 5.670374e-8 * 1200.0**4
    assert gas.fire is not None
    assert gas.fire.radiated == pytest.approx(power * 0.01, rel=0.05)
    assert gas.pressure.max() - SEA_LEVEL == pytest.approx(-0.4 * gas.fire.radiated, rel=1e-3)
    hot = gas.temperature.mean()
    gas.advance(20.0)
    assert AMBIENT - 1.0 < gas.temperature.mean() < hot - 100.0


def test_fire_is_for_gas_that_expands() -> None:
    with pytest.raises(ValueError, match="expands"):
        Gas((4,) * 3, 0.1, CLOSED, GasSettings(expands=False, fuel=METHANE))


def test_oxygen_share_of_air_is_that_of_its_moles() -> None:
    assert pytest.approx(0.2095 * 31.998 / 28.9644, rel=1e-3) == OXYGEN_SHARE
    assert air_density(AMBIENT) == pytest.approx(1.204, rel=1e-3)
