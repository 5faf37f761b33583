"""Triangles in columns: shortcuts give what clipping gives, bit for bit."""

from __future__ import annotations

import numpy as np
from worldagent.verifiers.routes.columns import Grid, Soup, _clip_fully, _clip_to_cells, rasterise


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


def test_outlines_of_pieces_are_those_of_their_triangles_in_their_cells():
    """Own choice: outlines stay as they were made, in the order of the triangles, for few are asked for; pieces are in that of the cells."""
    rng = np.random.default_rng(5)
    triangles = rng.uniform(0.0, 0.4, size=(60, 3, 3))
    soup = Soup(triangles, np.zeros(60, dtype=np.intp), np.zeros(60, dtype=bool), np.ones(60, dtype=bool))
    grid = Grid(np.zeros(2), 0.1, 4, 4)
    columns = rasterise(soup, grid)
    pieces = columns.pieces
    assert (np.diff(pieces.cell) >= 0).all()
    assert (np.diff(pieces.triangle) < 0).any()
    for piece in rng.permutation(len(pieces.cell))[:40]:
        corner = triangles[pieces.triangle[piece]][None]
        low = grid.centers(pieces.cell[piece : piece + 1]) - 0.05
        expected, _ = _clip_to_cells(corner, low, 0.1)
        outline = pieces.outline(np.array([piece]))
        assert np.allclose(outline, expected[:, :, :2], atol=1e-12)
