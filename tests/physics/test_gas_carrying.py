"""Things that a gas carries: a ball in a stream follows the law of drag, and a gas carries as a wind of the same speed blows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.physics.substances import air_density
from worldagent.testing.worlds.carried_worlds import BALL, JET_PROMPT, stream_spec
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.worlds.arrays import F64
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.spec import WorldSpec

SPEED, MASS, FRAMES = 3.0, 2e-4, 17


def streamed(folder: Path, thing: str, by: str) -> Candidate:
    document = stream_spec(thing=thing, by=by, frames=FRAMES, speed=SPEED, mass=MASS)
    return simulate(folder / f"{thing}-{by}", WorldSpec.model_validate({"prompt": JET_PROMPT, **document}))


def way_of(candidate: Candidate) -> F64:
    return np.asarray(candidate.caches["bodies"].series("position"))[:, 0]


def test_a_ball_in_a_stream_of_gas_comes_to_its_speed_by_the_law_of_drag(tmp_path: Path) -> None:
    """dv/dt = k (U - v)^2, so that x = U t - ln(1 + k U t) / k with k = rho C A / (2 m): 78 % of the stream's speed at the end."""
    time = np.arange(FRAMES) / 24
    k = 0.5 * air_density(293.15) * 0.47 * np.pi * BALL["radius"] ** 2 / MASS
    assert k * SPEED * time[-1] / (1 + k * SPEED * time[-1]) > 0.75
    law = SPEED * time - np.log1p(k * SPEED * time) / k
    gas, wind = (way_of(streamed(tmp_path, "ball", by)) for by in ("gas", "wind"))
    assert gas[1:, 0] == pytest.approx(law[1:], rel=0.01, abs=2e-4)
    assert gas[:, 0] == pytest.approx(wind[:, 0], rel=1e-3, abs=1e-5)
    assert np.abs(gas[:, 1:] - gas[0, 1:]).max() < 1e-5


def test_a_sheet_in_a_stream_of_gas_hangs_as_in_a_wind(tmp_path: Path) -> None:
    """Mean way of its vertices: 10 cm along the stream, alike within a percent."""
    gas, wind = (streamed(tmp_path, "sheet", by).caches["sheets"].series("vertex/position") for by in ("gas", "wind"))
    moved = [np.asarray(p).mean(axis=1) - np.asarray(p)[0].mean(axis=0) for p in (gas, wind)]
    assert moved[1][:, 0].max() > 0.08
    assert np.abs(moved[0] - moved[1]).max() < 0.01 * moved[1][:, 0].max()


def test_a_card_in_a_stream_of_gas_is_lifted_and_turned_as_in_a_wind(tmp_path: Path) -> None:
    """Half a second: 0.7 m along, 0.25 m across; places alike within a percent of the way."""
    gas, wind = (way_of(streamed(tmp_path, "card", by)) for by in ("gas", "wind"))
    assert wind[-1, 0] > 0.7
    assert abs(wind[:, 2] - wind[0, 2]).max() > 0.2
    assert np.abs(gas - wind)[:13].max() < 0.01 * np.linalg.norm(wind[12] - wind[0])
