"""Detail of flows (`bench/gas_detail.py`) on fields whose detail is known, and the smoke of the benchmarks."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.bench.gas import smoke_box
from worldagent.bench.gas_detail import centred, detail, spectrum

CELLS = 32


def helix(waves: int) -> np.ndarray:
    """Velocities of one size whose direction turns about the vertical with height, in a cube of cells."""
    turn = 2 * np.pi * waves * (np.arange(CELLS) + 0.5) / CELLS
    field = np.zeros((CELLS,) * 3 + (3,))
    field[..., 0], field[..., 1] = np.sin(turn), np.cos(turn)
    return field


@pytest.mark.parametrize("waves", [4, 8])
def test_the_spectrum_of_one_wave_stands_at_its_number(waves: int) -> None:
    found = spectrum(helix(waves))
    assert found.sum() == pytest.approx(1.0)
    assert int(found.argmax()) == waves
    assert found[waves - 2 : waves + 3].sum() > 0.98


@pytest.mark.parametrize("waves", [1, 2, 4])
def test_enstrophy_over_energy_is_the_square_of_the_wave_number(waves: int) -> None:
    """Central differences see sin(k h) / h of a wave number k."""
    step = 2 * np.pi * waves / CELLS
    assert detail(helix(waves))["enstrophy_per_energy"] == pytest.approx(np.sin(step) ** 2, rel=1e-9)


def test_shares_of_small_waves_grow_with_the_wave_number() -> None:
    coarse, fine = detail(helix(2)), detail(helix(8))
    assert coarse["energy_from_n_8_on"] < 0.05
    assert fine["energy_from_n_8_on"] > 0.95


def test_velocities_in_the_middle_are_means_of_the_faces() -> None:
    faces = np.zeros((5, 5, 5, 3))
    faces[..., 0] = np.arange(5)[:, None, None]
    assert np.array_equal(centred(faces)[..., 0], np.broadcast_to((np.arange(4) + 0.5)[:, None, None], (4, 4, 4)))


def test_the_smoke_of_the_benchmarks_rises_past_the_ball() -> None:
    """It fell once: what it weighed by its soot was more than its heat lifts."""
    gas, cells = smoke_box(24, "reflection"), 24
    heights = []
    for _ in range(2):
        for _ in range(18):
            gas.advance(1.0 / 24.0)
        soot = gas.state[..., 1]
        heights.append(float((soot.sum(axis=(0, 1)) * (np.arange(cells) + 0.5)).sum() / soot.sum() / cells))
    assert 0.1 < heights[0] < heights[1]
    assert gas.state[:, :, int(0.75 * cells) :, 1].max() > 1e-5
