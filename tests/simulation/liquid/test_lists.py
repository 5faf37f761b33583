"""Neighbour lists of the particle engine: packed ones (as on a GPU) say what wide ones say, and keep momentum."""

import numpy as np
import pytest
from worldagent.geometry.launch import warp
from worldagent.simulation.boundaries import BodyState
from worldagent.simulation.liquid.dfsph import Dfsph, store
from worldagent.simulation.liquid.engine import Fluid, LiquidSetup

SPACING = 0.05
NONE = BodyState(
    np.zeros((0, 3)),
    np.zeros((0, 3, 3)),
    np.zeros((0, 3)),
    np.zeros((0, 3)),
    np.zeros((0, 3)),
    np.zeros(0),
    np.zeros((0, 3, 3)),
    np.zeros((0, 3)),
)


def _splash(velocity: float, device: str = "cpu") -> Dfsph:
    """Two blocks that meet in free space."""
    one = (np.indices((6, 5, 5)).reshape(3, -1).T + 0.5) * SPACING
    position = np.concatenate([one, one + np.array([7.0, 0.3, 0.0]) * SPACING])
    n = len(position)
    speed = np.zeros((n, 3))
    speed[: n // 2, 0], speed[n // 2 :, 0] = velocity, -velocity
    return Dfsph(
        LiquidSetup(
            spacing=SPACING,
            lower=np.full(3, -1.0),
            upper=np.full(3, 2.0),
            sides=("open",) * 6,
            fluids=(Fluid("oil", 900.0, 0.5),),
            gravity=np.zeros(3),
            position=position,
            velocity=speed,
            fluid=np.zeros(n, dtype=np.int32),
            volume=np.full(n, SPACING**3),
            device=device,
        )
    )


def _run(engine: Dfsph, seconds: float) -> np.ndarray:
    while engine.time < seconds:
        engine.step(seconds - engine.time + 1e-9, NONE)
    found = engine.particles()
    return np.concatenate([found.position, found.velocity], axis=1)[np.argsort(found.identity)]


def test_packed_lists_give_the_motion_of_wide_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    wide = _run(_splash(2.0), 0.1)
    monkeypatch.setattr(store, "packs", lambda device, capacity: True)
    engine = _splash(2.0)
    packed = _run(engine, 0.1)
    assert engine.work.lists[4] < 0.02, "a unit of packed gradients"
    assert np.abs(packed[:, :3] - wide[:, :3]).max() < 0.005 * SPACING
    assert np.abs(packed[:, 3:] - wide[:, 3:]).max() < 0.01
    assert np.abs(wide[:, 3]).mean() < 1.5, "the blocks have met"


def test_packed_lists_keep_momentum(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(store, "packs", lambda device, capacity: True)
    after = _run(_splash(2.0), 0.1)
    assert np.abs(after[:, 3:].sum(axis=0)).max() < 1e-5 * len(after)


@pytest.mark.skipif(not warp().is_cuda_available(), reason="there is no GPU here")
@pytest.mark.parametrize("swift", [True, False])
def test_a_gpu_gives_the_motion_of_a_cpu(swift: bool) -> None:
    """By its own passes of the solves, and by those that a CPU runs."""
    wide = _run(_splash(2.0), 0.1)
    engine = _splash(2.0, "cuda:0")
    assert engine.work.swift is not None
    if not swift:
        engine.work.swift = None
    found = _run(engine, 0.1)
    assert np.abs(found[:, :3] - wide[:, :3]).max() < 0.005 * SPACING
    assert np.abs(found[:, 3:] - wide[:, 3:]).max() < 0.01


def test_lists_of_many_particles_are_wide() -> None:
    assert store.packs("cuda", 4_000_000)
    assert not store.packs("cuda", 5_000_000)
    assert not store.packs("cpu", 100)
