"""Greatest depth under planes, where facets are parallel up to rounding too."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.geometry import polytopes


@pytest.mark.parametrize("order", [[3, 4, 5], [4, 3, 5], [5, 3, 4]])
def test_planes_that_are_parallel_up_to_rounding_still_have_a_greatest_depth(order: list[int]) -> None:
    g = np.zeros((1, 6, 3))
    g[0, 0, 2] = g[0, 1, 0] = g[0, 2, 1] = 1.0
    g[0, 3:] = [[1.0, 0.0, 1.0], [1.0, 0.0, 1.0 + 1e-16], [-1.0, 0.0, 1.0]]
    h = np.array([[2.0, 2.0, 2.0, 0.3, 0.3 - 1e-9, 0.1]])
    rows = [0, 1, 2, *order]
    assert polytopes._maximise_last(g[:, rows], h[:, rows])[0, 2] == pytest.approx(0.2, abs=1e-6)


def test_a_basis_without_a_corner_is_solved_by_another_method() -> None:
    """Its inverse does not exist: numpy raised an error before."""
    flat = np.array([[[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.3, 0.0, 1.0], [-0.3, 0.0, 1.0], [0.0, 1.0, 1.0]]])
    h = np.array([[2.0, 2.0, 2.0, 0.2, 0.2, 0.2]])
    assert polytopes._maximise_last(flat, h)[0, 2] == pytest.approx(0.2, abs=1e-9)
