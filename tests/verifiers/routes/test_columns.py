"""Triangles in columns: shortcuts give what cutting gives, bit for bit; heights and layers of floor."""

from __future__ import annotations

import numpy as np
from worldagent.verifiers.routes.column_kernels import _cut, _part, floors_of
from worldagent.verifiers.routes.columns import Grid, Soup, heights_of, rasterise
from worldagent.worlds.arrays import F64


def _both(corner: F64, *, alone: bool = False) -> tuple[F64, bool, F64, bool]:
    """A triangle in the cell (0, 0) of 0.05 m by the way that takes shortcuts, and cut by all four sides."""
    one, two, cut = (np.zeros((7, 3)) for _ in range(3))
    alive = _part(corner, 0.0, 0.0, 0.05, alone, one, two)
    return two, alive, cut, _cut(corner, 0.0, 0.0, 0.05, one, cut)


def test_a_triangle_inside_its_cell_comes_out_as_cutting_leaves_it():
    """Own choice: most triangles of small things are not cut, and no verdict may depend on that."""
    rng = np.random.default_rng(4)
    corner = rng.uniform(0.0, 1.0, size=(400, 3, 3)) * np.array([0.065, 0.065, 1.0])
    corner[:40, :, 0] = corner[:40, :1, 0]  # upright, seen from above a line
    corner[40:50, 0, 0] = 0.0  # on the border of the cell
    inside = (corner[:, :, :2] <= 0.05).all(axis=(1, 2))
    assert 20 < inside.sum() < 380
    for k in np.flatnonzero(inside):
        for alone in (False, True):
            found, alive, expected, kept = _both(corner[k], alone=alone)
            assert alive
            assert kept
            assert np.array_equal(found, expected)


def test_a_cell_inside_a_triangle_and_one_beside_it_come_out_as_cutting_leaves_them():
    rng = np.random.default_rng(6)
    whole = beside = 0
    for _ in range(300):
        corner = rng.uniform(-0.3, 0.3, size=(3, 3))
        found, alive, expected, kept = _both(corner)
        assert alive == kept
        beside += not alive
        if alive:
            whole += int(np.isin(found[:, 0], (found[:, 0].min(), found[:, 0].max())).all())
            assert np.allclose(found[:, :2].min(axis=0), expected[:, :2].min(axis=0), atol=1e-9)
            assert np.allclose(found[:, :2].max(axis=0), expected[:, :2].max(axis=0), atol=1e-9)
            assert np.allclose([found[:, 2].min(), found[:, 2].max()], [expected[:, 2].min(), expected[:, 2].max()], atol=1e-9)
    assert whole > 10
    assert beside > 10


def _soup(triangles: F64) -> Soup:
    count = len(triangles)
    return Soup(triangles, np.zeros(count, dtype=np.intp), np.zeros(count, dtype=bool), np.ones(count, dtype=bool))


def test_pieces_lie_in_the_order_of_the_cells_and_outlines_are_within_them():
    rng = np.random.default_rng(5)
    triangles = rng.uniform(0.0, 0.4, size=(60, 3, 3))
    grid = Grid(np.zeros(2), 0.1, 4, 4)
    columns = rasterise(_soup(triangles), grid)
    pieces = columns.pieces
    assert (np.diff(pieces.cell) >= 0).all()
    assert (np.diff(pieces.triangle) < 0).any()
    assert np.array_equal(columns.piece_start, np.searchsorted(pieces.cell, np.arange(17)))
    low = grid.centers(pieces.cell) - 0.05
    outline = columns.outline(np.arange(len(pieces.cell)))
    assert (outline >= low[:, None] - 1e-9).all()
    assert (outline <= low[:, None] + 0.1 + 1e-9).all()
    areas = np.zeros(60)
    following = np.roll(outline, -1, axis=1)
    np.add.at(
        areas,
        pieces.triangle,
        0.5 * np.abs((outline[..., 0] * following[..., 1] - outline[..., 1] * following[..., 0]).sum(axis=1)),
    )
    side, other = triangles[:, 1, :2] - triangles[:, 0, :2], triangles[:, 2, :2] - triangles[:, 0, :2]
    assert np.allclose(areas, 0.5 * np.abs(side[:, 0] * other[:, 1] - side[:, 1] * other[:, 0]), atol=1e-8), (
        "the cells share each triangle"
    )


def test_hits_are_where_the_lines_through_the_centres_meet_triangles():
    rng = np.random.default_rng(7)
    triangles = rng.uniform(0.0, 0.4, size=(60, 3, 3))
    grid = Grid(np.zeros(2), 0.1, 4, 4)
    columns = rasterise(_soup(triangles), grid)
    found = {(int(c), int(t)): (float(z), bool(u)) for c, z, u, t in zip(*(columns.hits[k] for k in (0, 1, 2, 4)), strict=True)}
    cell, triangle = np.divmod(np.arange(16 * 60), 60)
    z, covered, up, _ = heights_of(triangles[triangle], grid.centers(cell))
    expected = {
        (int(c), int(t)): (float(h), bool(u))
        for c, t, h, u in zip(cell[covered], triangle[covered], z[covered], up[covered], strict=True)
    }
    assert found == expected
    assert len(found) > 50
    order = np.lexsort((columns.hits.z, columns.hits.cell))
    assert np.array_equal(order, np.arange(len(order)))


def test_height_at_is_that_of_the_nearest_gentle_surface_within_reach():
    level = np.array([[0.0, 0.0], [0.4, 0.0], [0.0, 0.4]])
    triangles = np.stack([np.column_stack([level, np.full(3, z)]) for z in (0.0, 0.1, 0.5)])
    triangles[2] = triangles[2][::-1]  # its back is up: no floor
    columns = rasterise(_soup(triangles), Grid(np.zeros(2), 0.1, 4, 4))
    points = np.array([[0.05, 0.05], [0.05, 0.05], [0.05, 0.05], [0.35, 0.35], [0.9, 0.9]])
    found = columns.height_at(points, np.array([0.02, 0.06, 0.5, 0.0, 0.0]), 0.08, 0.5)
    assert np.allclose(found[:2], [0.0, 0.1], atol=1e-12)
    assert np.isnan(found[2:]).all(), "no floor within reach, off the triangle, outside the grid"


def test_layers_of_floor_in_a_column():
    """A floor, a low thing on it with its underside, a table over both; a closed body around the last."""
    z = np.array([0.0, 0.02, 0.1, 0.8, 0.83, 1.0])
    up = np.array([True, False, True, False, True, True])
    closed = np.array([False, True, True, True, True, True])
    cell = np.array([0, 0, 0, 0, 0, 1])
    floor, blocked = np.zeros((2, 6), dtype=bool)
    floors_of(cell, z, up, up.copy(), closed, 0.2, 1e-4, floor, blocked)
    assert floor.tolist() == [False, False, True, False, True, True], "the floor is covered by the thing that is stepped on"
    assert blocked[floor].tolist() == [False, False, False]
    floors_of(cell, z, up, up.copy(), closed, 0.05, 1e-4, floor, blocked)
    assert floor[0]
    assert blocked[0], "the underside of something is within a step over the floor"
