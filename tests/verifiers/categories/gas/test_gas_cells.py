"""Compiled sweeps over cells beside the same in numpy, to the last bit; and what is kept of frames."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from scipy.ndimage import maximum_filter, minimum_filter
from worldagent.verifiers.categories.gas.cells import Fields, GasFrame, Grid, most_near, squares
from worldagent.verifiers.categories.gas.extreme_kernels import extremes, hottest_beyond, out_of_reach, sootiest_beyond
from worldagent.verifiers.categories.gas.flow import mirrored, net_outflow
from worldagent.verifiers.categories.gas.flow_kernels import blurred, driven, moving, through

SHAPE = (13, 9, 17)


def draw(*more: int) -> Any:
    return np.random.default_rng(5).normal(size=(*SHAPE, *more))


def part(array: Any, axis: int, first: int, count: int) -> Any:
    return np.take(array, range(first, first + count), axis=axis)


@pytest.mark.parametrize("reach", [1, 2, 5, 40])
def test_the_greatest_value_about_a_cell_is_that_of_a_filter(reach: int) -> None:
    for values in (draw(), draw().astype(np.float32)):
        assert most_near(values, reach).tobytes() == maximum_filter(values, size=2 * reach + 1, mode="nearest").tobytes()
    free = draw() < 1.5
    assert (~most_near(~free, reach) == minimum_filter(free, size=2 * reach + 1, mode="nearest")).all()


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_squared_lengths_are_the_sums_of_numpy(kind: type) -> None:
    vectors = draw(3).astype(kind)
    assert squares(vectors).tobytes() == np.square(vectors).sum(axis=-1).tobytes()
    assert np.sqrt(squares(vectors)).tobytes() == np.linalg.norm(vectors, axis=-1).tobytes()


@pytest.mark.parametrize("sides", [("closed",) * 6, ("open",) * 6, ("open", "closed", "closed", "open", "closed", "open")])
def test_outflow_is_that_of_differences_and_means_along_each_axis(sides: tuple[str, ...]) -> None:
    velocity = draw(3).astype(np.float32)
    field = np.pad(velocity.astype(np.float64), ((1, 1), (1, 1), (1, 1), (0, 0)), mode="edge")
    for side, kind in enumerate(sides):
        at: list[Any] = [slice(None)] * 3
        at[side // 2] = -1 if side % 2 else 0
        if kind == "closed":
            field[(*at, side // 2)] *= -1.0
        else:
            field[tuple(at)] = np.nan
    total = np.zeros(SHAPE)
    for axis in range(3):
        speed = field[..., axis]
        for other in range(3):
            low, middle, high = (part(speed, other, k, speed.shape[other] - 2) for k in range(3))
            speed = (high - low) / 0.2 if other == axis else 0.25 * (low + 2.0 * middle + high)
        total += speed
    np.testing.assert_array_equal(mirrored(velocity, sides), field)
    np.testing.assert_array_equal(net_outflow(field, 0.1), total)


def test_blurred_values_are_means_along_each_axis_and_sides_go_on() -> None:
    expected = np.pad(draw(), 1, mode="edge")
    for axis in range(3):
        low, middle, high = (part(expected, axis, k, SHAPE[axis]) for k in range(3))
        expected = 0.25 * (low + 2.0 * middle + high)
    assert blurred(draw()).tobytes() == expected.tobytes()


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_faces_take_what_the_cell_has_that_gas_comes_from(axis: int) -> None:
    amount, velocity = draw(), draw(3).astype(np.float32)
    (a, b), (u, v) = ([part(x, axis, k, SHAPE[axis] - 1) for k in (0, 1)] for x in (amount, velocity[..., axis]))
    middle = 0.5 * (u.astype(np.float64) + v.astype(np.float64))
    assert through(amount, velocity, axis).tobytes() == (np.where(middle > 0.0, a, b) * middle).tobytes()


def frame(index: int, fields: Fields, grid: Grid | None = None) -> GasFrame:
    cells = np.full(SHAPE, float(index), dtype=np.float32)
    return GasFrame(index, 0.1, np.zeros(3), cells, cells, draw(3).astype(np.float32), cells, None, None, grid, fields)


def test_fields_are_made_once_while_the_frame_is_one_of_the_last_two() -> None:
    fields, made = Fields(), list[tuple[int, str]]()
    frames = [frame(k, fields) for k in range(3)]

    def make(index: int, name: str) -> tuple[int, str]:
        made.append((index, name))
        return index, name

    for index, name in ((0, "a"), (1, "a"), (0, "a"), (1, "b"), (2, "a"), (1, "a"), (0, "a")):
        assert fields.of(frames[index], name, partial(make, index, name)) == (index, name)
    assert made == [(0, "a"), (1, "a"), (1, "b"), (2, "a"), (0, "a")]
    assert fields.of(frame(0, fields), "a", partial(make, 0, "another")) == (0, "another"), "another frame of that number"


def test_frames_of_a_box_that_stands_still_share_their_places() -> None:
    grid = Grid(np.array([1.0, 2.0, 3.0]), 0.1, SHAPE)
    one, other = (frame(k, Fields(), grid) for k in range(2))
    assert one.centers is other.centers
    assert one.centers[2, 3, 4] == pytest.approx([1.25, 2.35, 3.45])
    assert (one.places.arms == one.centers - grid.middle).all()
    assert grid.middle == pytest.approx([1.65, 2.45, 3.85])


def test_energies_and_weights_of_cells_are_products_in_their_order() -> None:
    density, room, velocity = np.abs(draw()), np.abs(draw()).astype(np.float32), draw(3)
    assert moving(0.37, density, room, velocity).tobytes() == (0.37 * density * room * squares(velocity)).tobytes()
    soot, light = draw().astype(np.float32), 0.3 * draw()
    assert driven(soot, light, 1.2, room, 0.37).tobytes() == ((soot - 1.2 * light) * room * 0.37).tobytes()


def test_what_is_out_of_reach_is_the_greatest_excess_of_cells_with_room() -> None:
    rng = np.random.default_rng(9)
    held, highest, lowest = draw(), draw() + rng.random(SHAPE) - 0.5, -draw() - rng.random(SHAPE) + 0.5
    room = rng.choice(np.array([0.0, 0.3, 0.31, 1.0], dtype=np.float32), size=SHAPE)
    held[3, 4, 5], highest[1, 2, 3], lowest[2, 3, 4] = np.nan, -np.inf, np.inf
    soot = np.where(room > 0.3, held, np.nan)
    expected: list[float] = []
    for excess in (soot - highest, -lowest - soot):
        excess = np.where(np.isfinite(excess), excess, 0.0)
        expected += [float(excess.max()), int(excess.argmax())]
    assert (room == np.float32(0.3)).any()
    assert min(expected[::2]) > 0.0
    assert [*out_of_reach(held, room, np.float32(0.3), highest, lowest)] == expected


def test_extremes_are_those_of_open_cells_and_none_is_beyond_within_the_bounds() -> None:
    room = np.random.default_rng(2).choice(np.array([0.0, 0.5, 1.0], dtype=np.float32), size=SHAPE)
    light, soot = draw(), draw().astype(np.float32)
    assert extremes(soot, room) == (soot[room > 0.0].min(), soot[room > 0.0].max())
    assert extremes(soot, np.zeros_like(room)) == (np.inf, -np.inf)
    off = np.maximum(-0.5 - light, light - 0.7) * (room > 0.0) / 0.3
    assert hottest_beyond(light, room, -0.5, 0.7, 0.3) == (off.max(), off.argmax())
    thick = np.maximum(-soot, soot - 0.7) * (room > 0.0) / 0.3
    assert thick.dtype == np.float32
    assert sootiest_beyond(soot, room, np.float32(0.7), np.float32(0.3)) == (thick.max(), thick.argmax())
    assert hottest_beyond(light, room, -9.0, 9.0, 0.3)[0] == 0.0
    assert sootiest_beyond(np.abs(soot), room, np.float32(9.0), np.float32(0.3))[0] == 0.0
