"""Courses of rivers: smooth, in the world's coordinates, and fixed at their ends."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.geometry.watercourses import centre_line

SHAPE, CELL = (40, 60), 5.0


def _stairs(count: int) -> np.ndarray:
    """Cells two east and one north, again and again, from row 5 and column 4."""
    steps = np.array([[0, 0], [0, 1], [1, 2]])
    places = np.unique(np.concatenate([steps + np.array([k + 5, 2 * k + 4]) for k in range(count)]), axis=0)
    return places[:, 0] * SHAPE[1] + places[:, 1]


def test_a_course_of_stairs_becomes_a_straight_line_between_its_ends() -> None:
    cells = _stairs(12)
    line = centre_line(cells, 1.0, SHAPE, CELL)
    ends = np.stack([cells[[0, -1]] % SHAPE[1] - 29.5, cells[[0, -1]] // SHAPE[1] - 19.5], axis=1) * CELL
    assert line[[0, -1]] == pytest.approx(ends)
    steps = np.diff(line, axis=0)[4:-4]
    turn = np.degrees(np.abs(np.arctan2(steps[:, 1], steps[:, 0]) - np.arctan2(1.0, 2.0)))
    assert turn.max() < 5.0, "the cells turn by 45 degrees at every step"


def test_three_cells_are_too_few_to_smooth() -> None:
    cells = np.array([0, 1, SHAPE[1] + 2])
    assert centre_line(cells, 50.0, SHAPE, CELL) == pytest.approx(
        np.array([[-29.5, -19.5], [-28.5, -19.5], [-27.5, -18.5]]) * CELL
    )
