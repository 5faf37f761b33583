"""Prepared passes: used again where nothing changed, the same result for any number of threads, sums in one order, chains that end."""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from worldagent.geometry.launch import warp
from worldagent.simulation import passes as module
from worldagent.simulation.passes import Passes

from . import passes_kernels as kernels


def _summed(values: np.ndarray, monkeypatch: pytest.MonkeyPatch, cores: int) -> np.ndarray:
    monkeypatch.setattr(module, "cores", lambda: cores)
    wp, passes, n = warp(), Passes("cpu"), len(values)
    given = wp.array(values, dtype=wp.float32)
    room = wp.zeros((values.shape[1], max(1, passes.parts(n))), dtype=wp.float64)
    result = wp.full(values.shape[1], -1.0, dtype=wp.float64)
    made = passes.sum("test", given, n, room, result)
    for one in made:
        one()
    assert all(len(one.launches) <= 1 for one in made)  # tiles are not shared by threads
    return np.array(result.numpy())


@pytest.mark.parametrize("count", [1, 255, 256, 257, 5000])
def test_a_sum_is_the_same_bit_for_bit_however_many_threads_share_it(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    values = (np.random.default_rng(count).normal(size=(count, 3)) * 10.0 ** np.arange(3)).astype(np.float32)
    alone, shared = (_summed(values, monkeypatch, cores) for cores in (1, 4))
    assert alone.tobytes() == shared.tobytes()
    exact = [math.fsum(float(v) for v in column) for column in values.T]
    np.testing.assert_allclose(alone, exact, rtol=1e-12, atol=1e-10)


def test_the_sum_of_nothing_is_zero(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _summed(np.zeros((0, 2), dtype=np.float32), monkeypatch, 2).tolist() == [0.0, 0.0]


def test_only_the_rows_that_are_asked_for_are_summed() -> None:
    wp, passes = warp(), Passes("cpu")
    given = wp.array(np.arange(1000, dtype=np.float32)[:, None], dtype=wp.float32)
    room, result = wp.zeros((1, 8), dtype=wp.float64), wp.zeros(1, dtype=wp.float64)
    for one in passes.sum("test", given, 300, room, result):
        one()
    assert result.numpy()[0] == 300 * 299 / 2


@pytest.mark.parametrize("count", [1, 256, 257, 5000])
def test_the_greatest_of_many_counts_is_found_wherever_it_is(count: int) -> None:
    wp, passes = warp(), Passes("cpu")
    values = np.random.default_rng(count).integers(0, 1000, count).astype(np.int32)
    room, result = wp.zeros(passes.parts(count), dtype=wp.int32), wp.zeros(1, dtype=wp.int32)
    for at in {0, count // 2, count - 1}:
        values[at] = 5000 + at
        assert passes.greatest("test", wp.array(values, dtype=wp.int32), count, room, result) == values.max()


def test_slices_cover_every_element_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "cores", lambda: 3)
    values = warp().zeros(10_001, dtype=warp().float32)
    one = Passes("cpu")("add", kernels.add, 10_001, [1.0, values])
    assert len(one.launches) == 3 * module.SLICES
    one()
    assert (values.numpy() == 1.0).all()


def test_a_pass_is_prepared_again_only_for_other_arrays() -> None:
    wp, passes = warp(), Passes("cpu")
    here, there = wp.zeros(10, dtype=wp.float32), wp.zeros(10, dtype=wp.float32)
    first = passes("add", kernels.add, 10, [1.0, here])
    second = passes("add", kernels.add, 10, [1.0, there])
    assert passes("add", kernels.add, 10, [1.0, here]) is first
    assert passes("add", kernels.add, 10, [1.0, there]) is second
    others = [passes("add", kernels.add, 10, [2.0, here]), passes("add", kernels.add, 10, [1.0, wp.zeros(10, dtype=wp.float32)])]
    assert all(a is not b for a, b in pairwise([first, second, *others]))


@pytest.mark.parametrize("many", [1, 5000])
def test_a_pass_goes_on_with_another_count(many: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "cores", lambda: 2)
    wp, passes = warp(), Passes("cpu")
    values = wp.zeros(10 * many, dtype=wp.float32)
    first = passes("add", kernels.add, 7 * many, [1.0, values])
    first()
    for count in (3 * many, 0, 9 * many):
        assert passes("add", kernels.add, count, [1.0, values]) is first
        first()
    assert values.numpy().reshape(10, many)[:, 0].tolist() == [3.0] * 3 + [2.0] * 4 + [1.0] * 2 + [0.0]
    assert first.changes == 3


def test_a_sum_goes_on_with_another_count() -> None:
    wp, passes = warp(), Passes("cpu")
    given = wp.array(np.ones((1000, 1), dtype=np.float32), dtype=wp.float32)
    room, result = wp.zeros((1, 8), dtype=wp.float64), wp.zeros(1, dtype=wp.float64)
    for count in (300, 999, 10):
        for one in passes.sum("test", given, count, room, result):
            one()
        assert result.numpy()[0] == count


def test_a_chain_runs_in_order_until_its_passes_end_it() -> None:
    wp, passes = warp(), Passes("cpu")
    values, left = wp.zeros(4, dtype=wp.float32), wp.array([5], dtype=wp.int32)
    steps = [passes("add", kernels.add, 4, [1.0, values]), passes("count", kernels.count_down, 1, [left])]
    passes.chain("until", steps, going=left)()
    assert values.numpy().tolist() == [5.0] * 4
    assert left.numpy()[0] == 0
    passes.chain("until", steps, going=left)()
    assert values.numpy().tolist() == [5.0] * 4, "it was over before it began"
    passes.chain("once", steps)()
    assert values.numpy().tolist() == [6.0] * 4


def test_the_same_chain_is_used_again() -> None:
    wp, passes = warp(), Passes("cpu")
    values, left = wp.zeros(4, dtype=wp.float32), wp.zeros(1, dtype=wp.int32)
    steps = [passes("add", kernels.add, 4, [1.0, values])]
    first = passes.chain("name", steps, going=left)
    assert passes.chain("name", steps, going=left) is first
    assert passes.chain("name", steps) is not first
    assert passes.chain("name", [passes("other", kernels.add, 4, [1.0, values])], going=left) is not first


def test_the_kernels_of_the_particle_liquid_compile_for_a_gpu(tmp_path: Path) -> None:
    """No GPU is needed to compile for one (compute capability 9.0)."""
    from worldagent.simulation import sum_kernels
    from worldagent.simulation.liquid.dfsph import grid_kernels, solve_kernels, step_kernels

    for made in (sum_kernels, grid_kernels, solve_kernels, step_kernels):
        warp().compile_aot_module(made, device=None, arch=90, module_dir=str(tmp_path), use_ptx=True)
    code = "".join(path.read_text() for path in tmp_path.glob("*.ptx"))
    for name in ("fold", "search", "relax", "judge", "close_census"):
        assert f".entry {name}" in code
