"""Triangles in columns: shortcuts give what clipping gives, bit for bit."""

from __future__ import annotations

import numpy as np
from worldagent.verifiers.routes.columns import _clip_fully, _clip_to_cells


def test_a_triangle_inside_its_cell_comes_out_as_clipping_leaves_it():
    """Own choice: most triangles of small things are not clipped, and no verdict may depend on that."""
    rng = np.random.default_rng(4)
    corner = rng.uniform(0.0, 1.0, size=(400, 3, 3)) * np.array([0.065, 0.065, 1.0])
    corner[:40, :, 0] = corner[:40, :1, 0]  # upright, seen from above a line
    corner[40:50, 0, 0] = 0.0  # on the border of the cell
    low = np.zeros((400, 2))
    found, alive = _clip_to_cells(corner, low, 0.05)
    expected, kept = _clip_fully(corner, low, 0.05)
    inside = (corner[:, :, :2] <= 0.05).all(axis=(1, 2))
    assert 20 < inside.sum() < 380
    assert alive[inside].all()
    assert kept[inside].all()
    assert np.array_equal(found[inside], expected[inside])
