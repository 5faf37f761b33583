"""The grid engine keeps what it is given and runs alike each time."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.simulation.liquid.flip.engine import Flip
from worldagent.simulation.liquid.flip.settings import FlipSettings
from worldagent.worlds.errors import InputError

from .flip_setup import advance, block, tank

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
