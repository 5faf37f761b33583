"""A gas that feels what it carries: two fluids come to one speed, a curtain of grains takes the air along, nothing of their momentum is lost."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.physics.drag import sphere_drag_rate
from worldagent.simulation.gas.reaction import YieldingGas
from worldagent.simulation.gas.settings import GasSettings, Side
from worldagent.testing.worlds.carried_worlds import JET_PROMPT, cloud_spec
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.worlds.arrays import F64
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.fields import Dragged
from worldagent.worlds.spec import WorldSpec

CELL = 0.1
ROUND: list[Side] = ["periodic"] * 6
DOWN = np.array([0.0, 0.0, -9.81])


def gas_of(shape: tuple[int, int, int], scheme: str = "reflection") -> YieldingGas:
    return YieldingGas(shape, CELL, ROUND, GasSettings(scheme=scheme), gravity=(0.0, 0.0, 0.0))  # type: ignore[arg-type]


def lattice(low: F64, high: F64) -> F64:
    """Eight points in every cell between two corners [cells]."""
    axes = [np.arange(2 * a, 2 * b) / 2 + 0.25 for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


class Dust:
    """Particles that a gas slows at one rate [1/s]: exact for a steady stream."""

    def __init__(self, place: F64, velocity: F64, mass: F64, rate: float, pull: F64 | None = None) -> None:
        self.place, self.velocity, self.mass, self.rate = place, velocity, mass, rate
        self.pull = np.zeros(3) if pull is None else pull

    def step(self, gas: YieldingGas, seconds: float) -> None:
        gas.open(seconds)
        flow, _ = gas.look(self.place)
        share, rate = (np.full(len(self.mass), value) for value in (-np.expm1(-self.rate * seconds), self.rate))
        felt = gas.ask(self.place, Dragged(self.velocity, self.mass, share, rate, seconds))
        end = flow + felt.change + self.pull / self.rate
        later = end + (self.velocity - end) * np.exp(-self.rate * seconds)
        felt.take(self.mass[:, None] * (later - self.velocity - seconds * self.pull))
        self.place = np.mod(self.place + 0.5 * seconds * (self.velocity + later) / CELL, gas.shape)
        self.velocity = later
        gas.step(seconds)

    @property
    def momentum(self) -> F64:
        return np.asarray(self.mass @ self.velocity)


def momentum_of(gas: YieldingGas) -> F64:
    """Momentum of the gas of a periodic box of one density [kg m/s], with what waits for its velocities."""
    faces = gas.velocity[:-1, :-1, :-1].astype(np.float64)
    return np.asarray(faces.sum(axis=(0, 1, 2)) * gas.density * CELL**3 + gas.owed)


@pytest.mark.parametrize("scheme", ["reflection", "maccormack"])
@pytest.mark.parametrize(("rate", "load", "seconds"), [(10.0, 1.0, 0.01), (500.0, 3.0, 0.02), (5000.0, 100.0, 0.02)])
def test_two_fluids_come_to_one_speed_as_the_law_says(scheme: str, rate: float, load: float, seconds: float) -> None:
    """Their velocity past each other decays at rate (1 + load), about that of both together, however long the steps are (Marble 1970)."""
    gas, place = gas_of((6, 6, 6), scheme), lattice(np.zeros(3), np.full(3, 6))
    start = np.array([1.0, 0.0, 0.3])
    mass = np.full(len(place), load * gas.density * (6 * CELL) ** 3 / len(place))
    dust = Dust(place, np.tile(start, (len(place), 1)), mass, rate)
    common = load / (1.0 + load) * start
    for number in range(1, 9):
        dust.step(gas, seconds)
        left = np.exp(-rate * (1.0 + load) * number * seconds)
        assert dust.velocity == pytest.approx(np.tile(common + (start - common) * left, (len(place), 1)), abs=1e-9)
        assert gas.look(dust.place)[0] == pytest.approx(np.tile(common - common * left, (len(place), 1)), abs=1e-9)


def test_a_curtain_of_grains_falls_with_the_air_between_them() -> None:
    """Exact for a curtain between still air: v - u = -g / (k (1 + load)) (1 - exp(-k (1 + load) t)), and both together fall freely by the share that
    grains have of the mass: -load g t / (1 + load). A grain alone would fall at g / k."""
    rate, load, seconds, count = 20.0, 2.0, 0.005, 60
    gas = gas_of((16, 4, 8))
    place = lattice(np.array([4, 0, 0]), np.array([12, 4, 8]))
    dust = Dust(place, np.zeros_like(place), np.full(len(place), load * gas.density * CELL**3 / 8), rate, DOWN)
    for _ in range(count):
        dust.step(gas, seconds)
    time = count * seconds
    past = -9.81 / (rate * (1 + load)) * (1 - np.exp(-rate * (1 + load) * time))
    both = -load * 9.81 * time / (1 + load)
    middle = np.abs(place[:, 0] - 8.0) < 1.0
    assert dust.velocity[middle, 2] == pytest.approx(both + past / (1 + load), rel=2e-3)
    assert gas.look(dust.place[middle])[0][:, 2] == pytest.approx(both - load * past / (1 + load), rel=2e-3)
    assert dust.velocity[middle, 2].max() < 3.0 * -9.81 / rate
    assert (momentum_of(gas) + dust.momentum)[2] == pytest.approx(dust.mass.sum() * -9.81 * time, rel=1e-6)


def cloud(seed: int = 1, count: int = 3000) -> tuple[YieldingGas, Dust]:
    rng = np.random.default_rng(seed)
    gas = gas_of((12, 12, 12))
    place = np.mod(rng.normal(6.0, 1.5, (count, 3)), 12.0)
    velocity = np.array([2.0, 0.0, 0.0]) + rng.normal(0.0, 0.2, (count, 3))
    return gas, Dust(place, velocity, np.full(count, 5 * gas.density * (3 * CELL) ** 3 / count), 30.0)


def test_momentum_of_a_cloud_and_its_gas_stays() -> None:
    """In a closed (periodic) box: 70 % of it goes over to the gas, and 1e-4 is lost to how velocities are carried."""
    gas, dust = cloud()
    start = dust.momentum
    for _ in range(20):
        dust.step(gas, 0.01)
    assert momentum_of(gas)[0] > 0.5 * start[0]
    assert momentum_of(gas) + dust.momentum == pytest.approx(start, abs=3e-4 * start[0])


def test_what_is_taken_is_what_was_got_to_the_last_bits() -> None:
    gas, dust = cloud()
    gas.open(0.01)
    rng = np.random.default_rng(2)
    share, rate = np.full(len(dust.mass), 0.3), np.full(len(dust.mass), 30.0)
    felt = gas.ask(dust.place, Dragged(dust.velocity, dust.mass, share, rate, 0.01))
    got = dust.mass[:, None] * rng.normal(0.0, 1.0, dust.velocity.shape)
    felt.take(got)
    assert gas.owed == pytest.approx(-got.sum(axis=0), rel=1e-12, abs=1e-15)
    felt.take(got, back=True)
    assert np.abs(gas.owed).max() < 1e-15
    assert np.abs(gas._whole(gas._kick)).max() < 1e-12


def test_heavy_grains_that_stand_stop_the_gas_and_throw_it_nowhere() -> None:
    """Dust on a floor, a hundred times as heavy as its gas: within the time that `stopping` allows no face turns round by more than
    what flows to its neighbours makes of it (half a percent)."""
    rng = np.random.default_rng(3)
    gas = gas_of((8, 8, 8))
    moving = gas.velocity
    moving[..., 0] = 3.0
    gas.velocity = moving
    place = rng.uniform(2.0, 5.0, (300, 3))
    place[:150] = place[0] + rng.normal(0.0, 0.01, (150, 3))
    mass, rate, still = np.full(300, 100 * gas.density * CELL**3 / 300), 200.0, np.zeros((300, 3))

    def asked(seconds: float) -> Dragged:
        return Dragged(still, mass, np.full(300, -np.expm1(-rate * seconds)), np.full(300, rate), seconds)

    gas.open(0.01)
    left = 0.01
    while left > 1e-12:
        seconds = min(left, 1.0 / gas.ask(place, asked(left)).stopping)
        felt = gas.ask(place, asked(seconds))
        felt.take(mass[:, None] * rate * seconds * (gas.look(place)[0] + felt.change))
        left -= seconds
    now = gas.velocity[:-1, :-1, :-1, 0] + gas._whole(gas._kick)[:-1, :-1, :-1, 0]
    assert now.min() > -0.015
    assert now.max() <= 3.0 + 1e-6
    assert (now < 0.1).sum() > 10


def fallen(folder: Path, name: str, **more: object) -> Candidate:
    spec = WorldSpec.model_validate({"prompt": JET_PROMPT, **cloud_spec(**more)})  # type: ignore[arg-type]
    return simulate(folder / name, spec)


def drop_of(candidate: Candidate) -> float:
    cache = candidate.caches["swarm"]
    first, last = (cache.read(k, ("particle/position",))["particle/position"][:, 2].mean() for k in (0, cache.index.frames - 1))
    return float(first - last)


def test_a_cloud_falls_faster_than_one_grain_and_one_grain_as_in_a_gas_that_feels_nothing(tmp_path: Path) -> None:
    """A cloud of 0.16 g in 1.4 litres (a tenth of what their air weighs) takes its air along and falls 7 % farther; one grain weighs 2e-4 of the gas of a cell."""
    alone = [drop_of(fallen(tmp_path, d, direction=d, count=1)) for d in ("one_way", "two_way")]
    assert alone[1] == pytest.approx(alone[0], rel=2e-4)
    drops = [drop_of(fallen(tmp_path, f"cloud-{d}", direction=d, count=6000)) for d in ("one_way", "two_way")]
    assert drops[0] == pytest.approx(alone[0], rel=1e-3)
    assert drops[1] > 1.05 * drops[0]


def test_drag_on_a_ball_as_wide_as_a_cell_is_as_the_register_says(tmp_path: Path) -> None:
    """It drags on part of its own wake: 8 % less than a sphere in still air, one a fifth as wide hardly less."""
    found = []
    for radius in (0.1, 0.5):
        gas, place, forces = gas_of((30, 14, 14)), np.array([[4.3, 7.2, 7.4]]), []
        area = np.pi * (radius * CELL) ** 2
        for _ in range(60):
            gas.open(0.03)
            past = 1.0 - float(gas.look(np.mod(place, gas.shape))[0][0, 0])
            rate = np.array([0.5 * gas.density * 0.47 * area * abs(past) / 1e3])
            felt = gas.ask(
                np.mod(place, gas.shape), Dragged(np.array([[1.0, 0.0, 0.0]]), np.array([1e3]), 0.03 * rate, rate, 0.03)
            )
            forces.append(1e3 * rate[0] * (past - felt.change[0, 0]))
            felt.take(np.array([[-0.03 * forces[-1], 0.0, 0.0]]))
            place = place + np.array([0.03 / CELL, 0.0, 0.0])
            gas.step(0.03)
        found.append(np.mean(forces[-20:]) / (0.5 * gas.density * 0.47 * area))
    assert found[0] == pytest.approx(1.0, abs=0.01)
    assert found[1] == pytest.approx(0.92, abs=0.02)


def test_a_grain_in_still_air_is_slowed_by_the_law_of_spheres(tmp_path: Path) -> None:
    """The rate that the gas was asked with is that of `sphere_drag_rate` in air of its density and viscosity."""
    candidate = fallen(tmp_path, "one", count=1)
    cache = candidate.caches["swarm"]
    speed = -float(cache.read(cache.index.frames - 1, ("particle/velocity",))["particle/velocity"][0, 2])
    from worldagent.physics.drag import Medium
    from worldagent.physics.substances import air_density, air_viscosity

    air = Medium(np.zeros((1, 3)), np.array([air_density(293.15)]), air_viscosity(np.array([293.15])), np.ones(1))
    radius, mass = np.array([5e-4]), np.array([50.0 * 4 / 3 * np.pi * 5e-4**3])
    rate = float(sphere_drag_rate(air, radius, mass, np.array([[0.0, 0.0, -speed]]))[0])
    assert speed * rate == pytest.approx(9.81, rel=0.02)
