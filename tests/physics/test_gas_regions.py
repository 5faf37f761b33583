"""Sealed boxes, closed regions beside each other, and solids that move in a gas."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from worldagent.bench.gas import CLOSED, ball
from worldagent.physics.substances import AIR_HEAT_CAPACITY, SEA_LEVEL
from worldagent.simulation.gas.engine import SOOT, Gas, Solids
from worldagent.simulation.gas.settings import GasSettings
from worldagent.simulation.gas.solids import corners_of, cut, open_volume
from worldagent.worlds.arrays import F64

CELLS = 12
OPEN_TOP = (*CLOSED[:5], "open")


def _corners(cells: int = CELLS) -> F64:
    return corners_of((cells,) * 3, 1.0 / cells, np.zeros(3))


def _mass(gas: Gas) -> float:
    """Mass of the gas [kg]."""
    return float(((1.0 - gas.state[..., 0].astype(float)) * gas.room).sum() * gas.cell**3 * gas.density)


def _energy(gas: Gas) -> float:
    """Inner energy, mass x heat capacity at constant volume x temperature [J]."""
    mass = (1.0 - gas.state[..., 0].astype(float)) * gas.room * gas.cell**3 * gas.density
    return float((mass * AIR_HEAT_CAPACITY / 1.4 * gas.temperature).sum())


def _warmed(cells: int, power: float, seconds: float, **options: object) -> tuple[Gas, float]:
    """A cubic metre in which an eighth is heated with a power [W], and the heat that it got [J]."""
    gas = Gas((cells,) * 3, 1.0 / cells, CLOSED, GasSettings(expands=True), **options)  # type: ignore[arg-type]
    rate = np.zeros((cells,) * 3)
    rate[: cells // 2, : cells // 2, : cells // 2] = 8.0 * power / (gas.density * AIR_HEAT_CAPACITY * 293.15)
    gas.heat(rate)
    gas.advance(seconds)
    return gas, power * seconds


def test_a_sealed_room_with_hot_gas_keeps_mass_and_takes_the_heat_up_as_pressure() -> None:
    """20 kW for 2 s in 1 m^3, hot air that rises: dp = (gamma - 1) Q / V and the energy within 1 % (solvers.md 4.2: "hot gas in a room")."""
    start = Gas((CELLS,) * 3, 1.0 / CELLS, CLOSED, GasSettings(expands=True))
    gas, heat = _warmed(CELLS, 2.0e4, 2.0)
    assert gas.pressure.min() == pytest.approx(SEA_LEVEL + 0.4 * heat, rel=1e-3)
    assert _energy(gas) - _energy(start) == pytest.approx(heat, rel=0.01)
    assert _mass(gas) == pytest.approx(_mass(start), rel=1e-6)
    assert np.abs(gas.velocity).max() > 0.1
    assert gas.temperature.max() > gas.temperature.min() + 20.0


def test_a_source_in_a_sealed_box_brings_its_mass_and_its_enthalpy() -> None:
    """0.2 m^3 of air at 500 K into 1 m^3: dU = m cp T, dp = (gamma - 1) dU / V."""
    gas = Gas((CELLS,) * 3, 1.0 / CELLS, CLOSED, GasSettings(expands=True))
    mass, energy = _mass(gas), _energy(gas)
    rate = np.zeros((CELLS,) * 3)
    rate[5:7, 5:7, 2:4] = 0.2 * CELLS**3 / 8
    gas.emit(rate, [1.0 - 293.15 / 500.0, 0.0, 0.0, 0.0])
    gas.advance(1.0)
    added = 0.2 * gas.density * 293.15 / 500.0
    assert _mass(gas) - mass == pytest.approx(added, rel=1e-4)
    assert _energy(gas) - energy == pytest.approx(added * AIR_HEAT_CAPACITY * 500.0, rel=0.01)
    assert gas.pressure.max() == pytest.approx(SEA_LEVEL * (1.0 + 1.4 * 0.2), rel=0.01)


def _wall(position: float, thickness: float = 0.1) -> Solids:
    """A wall across x."""
    return cut(np.abs(_corners()[..., 0] - position) - 0.5 * thickness)


def test_two_rooms_have_pressures_of_their_own() -> None:
    """A wall halves a closed box; one half is heated: the other stays as it was, and both flows are free of divergence."""
    gas = Gas((CELLS,) * 3, 1.0 / CELLS, CLOSED, GasSettings(expands=True), solids=_wall(0.5))
    rate = np.zeros((CELLS,) * 3)
    rate[:3, :, :6] = 0.1
    gas.heat(rate)
    reports = gas.advance(1.0)
    assert len(gas.regions.sealed) == 2
    left, right = gas.pressure[0, 0, 0], gas.pressure[-1, 0, 0]
    volume = gas.room[:6].sum()
    assert left == pytest.approx(SEA_LEVEL * (1.0 + 1.4 * 0.1 * 3 * 12 * 6 / volume), rel=0.001)
    assert right == pytest.approx(SEA_LEVEL, rel=1e-9)
    assert max(r.divergence for r in reports) < 1e-5
    assert not any(r.capped for r in reports)
    assert np.abs(gas.velocity[7:]).max() < 1e-6


def test_a_closed_chamber_in_an_open_box_does_not_stop_the_solver() -> None:
    """A shell with air in it: its pressure is its own, the rest has that of the air beyond the open top."""
    shell = cut(np.abs(np.linalg.norm(_corners(16) - 0.5, axis=-1) - 0.25) - 0.08)
    gas = Gas((16,) * 3, 1.0 / 16, OPEN_TOP, GasSettings(expands=True), solids=shell)
    rate = np.zeros((16,) * 3)
    rate[7:9, 7:9, 7:9] = 0.5
    gas.heat(rate)
    reports = gas.advance(0.5)
    assert list(gas.regions.sealed) in ([False, True], [True, False])
    assert gas.pressure[8, 8, 8] > 1.02 * SEA_LEVEL
    assert gas.pressure[0, 0, 0] == SEA_LEVEL
    assert max(r.divergence for r in reports) < 1e-5


@pytest.mark.parametrize("place", [0.31, 0.5, 0.77])
def test_open_volumes_of_planes_are_exact(place: float) -> None:
    corners = _corners(2) @ np.array([0.6, 0.64, 0.48])
    assert open_volume(corners - place).sum() == pytest.approx(_below(place), abs=1e-12)
    assert open_volume(_corners(3)[..., 0] - place).sum() / 27 == pytest.approx(1.0 - place)


def _below(place: float) -> float:
    """8 x volume of the unit cube where (0.6, 0.64, 0.48) . x > place, by counting inclusion of corners."""
    n = np.array([0.6, 0.64, 0.48])
    total = 0.0
    for corner in np.ndindex(2, 2, 2):
        rest = max(0.0, place - float(n @ np.array(corner)))
        total += (-1) ** sum(corner) * rest**3
    return 8.0 * (1.0 - total / (6.0 * float(np.prod(n))))


def _piston(time: float) -> Solids:
    """A piston from the left, at 0.25 m + 0.25 m/s."""
    velocity = np.zeros((CELLS + 1, CELLS + 1, CELLS + 1, 3), np.float32)
    velocity[..., 0] = 0.25
    return cut(_corners()[..., 0] - (0.25 + 0.25 * time), velocity)


def test_a_piston_compresses_a_sealed_gas_by_adiabats() -> None:
    """From 0.75 to 0.5 m^3 in a second: mass kept, p V^1.4 constant, everywhere as dense."""
    gas = Gas((CELLS,) * 3, 1.0 / CELLS, CLOSED, GasSettings(expands=True), solids=_piston(0.0), moves=True, gravity=(0, 0, 0))
    mass = _mass(gas)
    assert mass == pytest.approx(0.75 * gas.density, rel=1e-6)
    reports = gas.advance(1.0, _piston)
    assert gas.room.sum() * gas.cell**3 == pytest.approx(0.5, rel=1e-6)
    assert _mass(gas) == pytest.approx(mass, rel=1e-5)
    assert gas.pressure.max() == pytest.approx(SEA_LEVEL * 1.5**1.4, rel=1e-3)
    inside = gas.room > 0.0
    assert gas.state[..., 0][inside] == pytest.approx(-0.5, abs=5e-3)
    assert np.abs(gas.state[~inside]).max() == 0.0
    assert gas.temperature[inside].mean() == pytest.approx(293.15 * 1.5**0.4, rel=2e-3)
    assert max(r.divergence for r in reports) < 1e-5


def test_a_piston_pushes_out_the_volume_that_it_sweeps() -> None:
    """The far side is open: what leaves is what the piston takes, and soot of one density stays at it."""
    sides = ("closed", "open", *CLOSED[2:])
    gas = Gas((CELLS,) * 3, 1.0 / CELLS, sides, GasSettings(expands=True), solids=_piston(0.0), moves=True, gravity=(0, 0, 0))
    state = np.zeros((CELLS,) * 3 + (4,), np.float32)
    state[..., SOOT] = 0.01
    gas.state = state * (gas.room > 0.0)[..., None]
    gas.load = 0.0
    for before, after in pairwise(np.linspace(0.0, 1.0, 25)):
        gas.step(after - before, _piston(after))
        assert gas.velocity[CELLS, :CELLS, :CELLS, 0] == pytest.approx(0.25, rel=1e-3)
    inside = gas.room > 0.0
    assert _mass(gas) == pytest.approx(0.5 * gas.density, rel=1e-4)
    assert gas.totals()[SOOT] * gas.cell**3 == pytest.approx(0.005, rel=1e-3)
    assert gas.state[..., SOOT][inside] == pytest.approx(0.01, rel=0.01)


def test_a_plate_that_sweeps_through_smoke_keeps_it() -> None:
    """A plate crosses a closed box with gaps around it: mass and soot stay, none is inside, none below zero."""

    def plate(time: float) -> Solids:
        c = _corners(16) - [0.3 + 0.5 * time, 0.5, 0.5]
        velocity = np.zeros((17, 17, 17, 3), np.float32)
        velocity[..., 0] = 0.5
        return cut(np.maximum(np.abs(c[..., 0]) - 0.07, np.maximum(np.abs(c[..., 1]), np.abs(c[..., 2])) - 0.3), velocity)

    gas = Gas((16,) * 3, 1.0 / 16, CLOSED, GasSettings(expands=True), solids=plate(0.0), moves=True)
    state = np.zeros((16, 16, 16, 4), np.float32)
    state[6:10, 4:12, 4:12, SOOT] = 0.01
    gas.state = state * (gas.room > 0.0)[..., None]
    before, mass = gas.totals()[SOOT], _mass(gas)
    reports = gas.advance(0.6, plate)
    found = gas.state
    assert gas.totals()[SOOT] == pytest.approx(before, rel=1e-5)
    assert _mass(gas) == pytest.approx(mass, rel=1e-5)
    assert np.abs(gas.transport.crushed).max() < 1e-4
    assert np.abs(found[gas.room == 0.0]).max() == 0.0
    assert found[..., SOOT].min() > -1e-6
    assert 0.4 < np.abs(gas.velocity).max() < 3.0
    assert max(r.divergence for r in reports) < 1e-5
    front = (found[..., SOOT] * gas.room).sum(axis=(1, 2)) @ np.arange(16) / gas.totals()[SOOT]
    assert front > 8.0  # it was at 7.5: the plate has pushed it on


def test_a_sealed_sliver_that_solids_close_within_a_step_is_crushed_and_the_rest_stays_at_rest() -> None:
    """Its gas has nowhere to go: no pressure can be asked for, and air elsewhere does not hear of it."""

    def solids(left: float) -> Solids:
        room, opening = np.zeros((9, 9, 9), np.float32), np.zeros((9, 9, 9, 3), np.float32)
        room[3, :8, :8], room[5:8, :8, :8] = left, 1.0
        opening[3, :8, :8, 1:], opening[5:8, :8, :8], opening[6:9, :8, :8, 0] = 10.0 * left, 1.0, 1.0
        opening[5, ..., 0] = 0.0
        return Solids(room, opening, np.zeros((9, 9, 9, 3), np.float32))

    sides = ("closed", "open", *CLOSED[2:])
    gas = Gas((8,) * 3, 1.0 / 8, sides, GasSettings(expands=True), solids=solids(0.01), moves=True, gravity=(0, 0, 0))
    report = gas.step(0.01, solids(0.0))
    assert np.abs(gas.velocity).max() < 1e-3
    assert report.divergence < 1e-3
    assert gas.transport.crushed[0] == pytest.approx(0.64, rel=1e-3)
    assert gas.state == pytest.approx(0.0, abs=1e-6)
    assert gas.regions.ratio == pytest.approx(1.0, abs=1e-3)


def test_solids_that_stand_refuse_to_move() -> None:
    gas = Gas((8,) * 3, 1.0 / 8, CLOSED, GasSettings(), solids=cut(ball(8)))
    with pytest.raises(ValueError, match="moves=True"):
        gas.step(0.01, cut(ball(8)))


def test_room_that_opens_where_no_air_can_reach_it_has_that_of_outside() -> None:
    """A plate as wide as the box leaves the wall that it touches: the air that came in behind it stays as it is let in, and expands as the
    room grows."""

    def plate(time: float) -> Solids:
        behind = _corners()[..., 0] - 0.3 * time
        return cut(
            np.maximum(-behind, behind - 0.3), np.broadcast_to(np.array([0.3, 0.0, 0.0], np.float32), (CELLS + 1,) * 3 + (3,))
        )

    gas = Gas((CELLS,) * 3, 1.0 / CELLS, CLOSED, GasSettings(expands=True), solids=plate(0.0), moves=True, gravity=(0, 0, 0))
    mass = _mass(gas)
    gas.step(0.1, plate(0.1))
    born = gas.room[0, 0, 0]
    assert born == pytest.approx(0.03 * CELLS, rel=1e-5)
    assert gas.state[0, :, :, 0] == pytest.approx(0.0, abs=1e-6)
    assert gas.transport.let_in == pytest.approx(born * CELLS**2, rel=1e-6)
    for time in (0.2, 0.3, 0.4):
        gas.step(0.1, plate(time))
    assert gas.transport.let_in == pytest.approx(born * CELLS**2, rel=1e-6)
    assert _mass(gas) - mass == pytest.approx(gas.transport.let_in * gas.cell**3 * gas.density, rel=1e-3)
    assert gas.state[0, :, :, 0] == pytest.approx(0.75, abs=5e-3)
    assert gas.pressure[0, 0, 0] == pytest.approx(SEA_LEVEL * 0.25**1.4, rel=1e-3)
    assert gas.temperature[0, 0, 0] == pytest.approx(293.15 * 0.25**0.4, rel=1e-2)


def test_a_plate_that_air_can_follow_is_let_in_none() -> None:
    """With a gap around the plate the air behind it comes through that."""

    def plate(time: float) -> Solids:
        c = _corners() - [0.3 * time, 0.5, 0.5]
        velocity = np.broadcast_to(np.array([0.3, 0.0, 0.0], np.float32), (CELLS + 1,) * 3 + (3,))
        return cut(
            np.maximum(np.maximum(-c[..., 0], c[..., 0] - 0.3), np.maximum(np.abs(c[..., 1]), np.abs(c[..., 2])) - 0.3), velocity
        )

    gas = Gas((CELLS,) * 3, 1.0 / CELLS, CLOSED, GasSettings(expands=True), solids=plate(0.0), moves=True, gravity=(0, 0, 0))
    mass = _mass(gas)
    for time in (0.1, 0.2, 0.3, 0.4):
        gas.step(0.1, plate(time))
    assert gas.transport.let_in == 0.0
    assert _mass(gas) == pytest.approx(mass, rel=1e-5)
    assert np.abs(gas.state[..., 0]).max() < 0.01
