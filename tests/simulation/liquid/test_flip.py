"""The grid engine keeps what it is given and runs alike each time."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest
from worldagent.simulation.liquid.dfsph.engine import Dfsph
from worldagent.simulation.liquid.engine import Engine, Fluid, Inflow, LiquidSetup, Outflow
from worldagent.simulation.liquid.flip.engine import Flip
from worldagent.simulation.liquid.flip.settings import FlipSettings
from worldagent.worlds.errors import EngineError, InputError

from .flip_setup import WATER, advance, block, tank

CELL = 1 / 16


def column() -> Flip:
    return Flip(tank((1.0, 0.5, 1.0), block((0, 0, 0), (0.375, 0.5, 0.625), CELL), CELL))


def test_a_column_collapses_and_keeps_every_particle_inside() -> None:
    engine = column()
    before = engine.particles()
    reports = advance(engine, 0.5)
    after = engine.particles()
    assert sorted(after.identity) == sorted(before.identity)
    assert after.volume.sum() == pytest.approx(0.375 * 0.5 * 0.625, rel=1e-12)
    assert (after.position >= 0.0).all()
    assert (after.position <= np.array([1.0, 0.5, 1.0])).all()
    assert after.position[:, 0].max() > 0.9
    assert sum(r.capped for r in reports) == 0


def test_two_runs_give_the_same_bytes() -> None:
    one, two = column(), column()
    advance(one, 0.3)
    advance(two, 0.3)
    assert one.particles().position.tobytes() == two.particles().position.tobytes()


@pytest.mark.parametrize(
    ("name", "value"), [("cfl", 9.0), ("flip_ratio", 1.2), ("pressure_error", 0.0), ("particles_per_cell", 5)]
)
def test_settings_outside_their_range_are_refused(name: str, value: float) -> None:
    with pytest.raises(InputError, match=name):
        FlipSettings(**{name: value})


def test_a_restored_engine_continues_with_the_same_bytes() -> None:
    one, two = column(), column()
    advance(one, 0.2)
    state = one.checkpoint()
    advance(one, 0.2)
    two.restore(state)
    advance(two, 0.2)
    assert one.checkpoint() == two.checkpoint()


def test_bytes_that_are_no_checkpoint_are_refused() -> None:
    with pytest.raises(EngineError, match="no state of an engine"):
        column().restore(b"nothing")


def test_inflow_equals_outflow_and_storage_to_the_last_particle() -> None:
    """A jet along +x into a tank with an open side and a drain."""
    cell = 1 / 16
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    setup = tank(
        (1.0, 0.5, 0.75),
        block((0, 0, 0), (1.0, 0.5, 0.25), cell),
        cell,
        sides=("closed", "open", "closed", "closed", "closed", "closed"),
        inflows=(Inflow("jet", 0, np.array([0.1, 0.25, 0.4]), turn, (0.1, 0.1), False, 1.0, 0.0, 0.4),),
        outflows=(Outflow("drain", np.array([0.5, 0.25, 0.0]), np.eye(3), (0.1, 0.1, 0.05)),),
    )
    engine = Flip(setup)
    before = 1000.0 * engine.particles().volume.sum()
    reports = advance(engine, 0.7)
    added = sum(r.added["jet"] for r in reports)
    left = {name: sum(r.removed[name] for r in reports) for name in ("drain", "domain")}
    assert added == pytest.approx(1000.0 * 0.04 * 1.0 * 0.4, rel=0.1)
    assert left["drain"] > 0
    assert left["domain"] > 0
    particles = engine.particles()
    assert before + added - sum(left.values()) == pytest.approx(1000.0 * particles.volume.sum(), rel=1e-12)
    assert len(set(particles.identity)) == len(particles.identity)


def test_a_mouth_in_a_closed_side_feeds_an_even_flow() -> None:
    """Law: water that flows along a channel at the speed of its mouth goes on so, as deep, and no more comes in than the mouth gives."""
    cell, deep, speed = 1 / 16, 0.5, 1.0
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    mouth = Inflow("side", 0, np.array([0.0, 0.125, 0.5 * deep]), turn, (0.5 * deep, 0.125), False, speed)
    water = block((0, 0, 0), (2.0, 0.25, deep), cell)
    setup = tank(
        (2.0, 0.25, 0.75), water, cell, sides=("closed", "open", "closed", "closed", "closed", "closed"), inflows=(mouth,),
        velocity=np.tile([speed, 0.0, 0.0], (len(water), 1)),
    )  # fmt: skip
    engine = Flip(setup)
    reports = advance(engine, 0.25)
    assert sum(r.added["side"] for r in reports) == pytest.approx(1000.0 * 0.25 * deep * speed * 0.25, rel=0.15)
    found = engine.particles()
    near = found.position[:, 0] < 0.25
    assert found.velocity[near, 0].mean() == pytest.approx(speed, rel=0.02)
    assert found.velocity[near, 2].mean() == pytest.approx(0.0, abs=0.05)
    assert found.volume[near].sum() == pytest.approx(0.25 * 0.25 * deep, rel=0.05)


def test_an_inflow_outside_the_domain_is_refused() -> None:
    inflow = Inflow("jet", 0, np.array([5.0, 0.25, 0.4]), np.eye(3), (0.1, 0.1), True, 1.0)
    engine = Flip(tank((1.0, 0.5, 0.75), block((0, 0, 0), (1.0, 0.5, 0.25), CELL), CELL, inflows=(inflow,)))
    with pytest.raises(InputError, match="jet"):
        advance(engine, 0.01)


def test_a_velocity_that_is_not_finite_ends_with_its_place() -> None:
    water = block((0, 0, 0), (0.25, 0.25, 0.25), CELL)
    velocity = np.zeros_like(water)
    velocity[3] = np.nan
    engine = Flip(tank((0.5, 0.5, 0.5), water, CELL, velocity=velocity))
    with pytest.raises(EngineError, match=r"near \("):
        advance(engine, 0.01)


def test_what_one_density_cannot_hold_is_refused() -> None:
    setup = tank((0.5, 0.5, 0.5), block((0, 0, 0), (0.25, 0.25, 0.25), CELL), CELL)
    with pytest.raises(InputError, match="density"):
        Flip(dataclasses.replace(setup, fluids=(WATER, Fluid("oil", 800.0, 1e-3))))


@pytest.mark.parametrize("engine", [Flip, Dfsph])
def test_a_run_goes_on_without_its_outflow_from_a_state_that_has_it(engine: Callable[[LiquidSetup], Engine]) -> None:
    """As a counterfactual has it: the box keeps its number among the ways out, and takes nothing more."""
    drain = Outflow("drain", np.array([0.25, 0.25, 0.0]), np.eye(3), (0.1, 0.1, 0.1))
    setup = tank((0.5, 0.5, 0.5), block((0, 0, 0), (0.5, 0.5, 0.25), CELL), CELL, outflows=(drain,))
    whole = engine(setup)
    advance(whole, 0.05)
    state = whole.checkpoint()
    without = engine(dataclasses.replace(setup, outflows=(dataclasses.replace(drain, half_size=(-1.0, -1.0, -1.0)),)))
    without.restore(state)
    taken, kept = (sum(r.removed.get("drain", 0.0) for r in advance(run, 0.1)) for run in (whole, without))
    assert taken > 0.0
    assert kept == 0.0


@pytest.mark.parametrize("engine", [Flip, Dfsph])
def test_a_run_goes_on_without_one_of_its_inflows_from_a_state_that_has_it(engine: Callable[[LiquidSetup], Engine]) -> None:
    """A counterfactual begins at a checkpoint of the true run: the inflow that stays goes on as it was, the other gives nothing more."""
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    left, right = (
        Inflow(n, 0, np.array([0.1, y, 0.4]), turn, (0.1, 0.1), False, 1.0) for n, y in (("left", 0.2), ("right", 0.6))
    )
    setup = tank((1.0, 0.8, 1.0), block((0, 0, 0), (1.0, 0.8, 0.25), CELL), CELL, inflows=(left, right))
    whole = engine(setup)
    advance(whole, 0.15)
    state = whole.checkpoint()
    without = engine(dataclasses.replace(setup, inflows=(right,)))
    without.restore(state)
    after, kept = advance(whole, 0.15), advance(without, 0.15)
    given = [{n: sum(r.added.get(n, 0.0) for r in reports) for n in ("left", "right")} for reports in (after, kept)]
    assert given[0]["left"] == pytest.approx(given[0]["right"])
    assert given[1] == {"left": 0.0, "right": pytest.approx(given[0]["right"])}
    none = engine(dataclasses.replace(setup, inflows=(dataclasses.replace(left, name="new"),)))
    with pytest.raises(ValueError, match=r"inflows \['new'\] are not in a state with \['left', 'right'\]"):
        none.restore(state)
