"""Cells that are known to lie outside a solid hide no point that is in it."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from worldagent.geometry import Solid
from worldagent.verifiers.categories.liquid import outside, solids
from worldagent.verifiers.categories.liquid.solids import Piece
from worldagent.worlds.built import TriangleMesh


def cup() -> Solid:
    """A thick cup: not convex, with an inner space that is outside it."""
    profile = [(0.0, 0.0), (0.6, 0.0), (0.6, 1.0), (0.5, 1.0), (0.5, 0.1), (0.0, 0.1)]
    mesh = trimesh.creation.revolve(np.array(profile), sections=48)
    return Solid.from_mesh(
        TriangleMesh(np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces, dtype=np.int32)), closed=True
    )


def piece(solid: Solid) -> Piece:
    return Piece("cup", "body", "part", solid, np.zeros((1, 3)), np.eye(3)[None], True, True)


@pytest.mark.parametrize("seed", range(3))
def test_points_in_a_cup_are_as_deep_with_cells_as_without(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Law: a point is skipped only where the middle of its cell is farther outside than away from it."""
    points = np.random.default_rng(seed).uniform([-0.7, -0.7, -0.1], [0.7, 0.7, 1.1], (20_000, 3))
    own = piece(cup())
    quick = own.depth(points)
    again = own.depth(points)  # with all cells known
    monkeypatch.setattr(solids, "MANY", len(points) + 1)
    plain = piece(cup()).depth(points)
    inside = plain > 0
    assert 0.1 < inside.mean() < 0.6
    assert (quick[inside] == plain[inside]).all()
    assert (quick[~inside] <= 0).all()
    assert (again == quick).all()


@pytest.mark.parametrize("many", [1, 10**6])
def test_depths_that_change_nothing_are_told_as_none(many: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Law: with a least depth, deeper points are as deep as without, and no other point is told to be deeper than it."""
    monkeypatch.setattr(solids, "MANY", many)
    points = np.random.default_rng(4).uniform([-0.7, -0.7, -0.1], [0.7, 0.7, 1.1], (20_000, 3))
    plain, found = piece(cup()).depth(points), piece(cup()).depth(points, 0.02)
    deep = plain > 0.02
    assert 0.05 < deep.mean() < (plain > 0).mean() - 0.05
    assert (found[deep] == plain[deep]).all()
    assert (found[~deep] <= 0.02).all()


def test_most_points_far_from_the_surface_are_not_asked_about(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few points of a cloud in the cup's inner space, which cells away from its wall, reach the query again."""
    asked: list[int] = []
    measured = Piece._measured

    def counted(self: Piece, points: np.ndarray, sides: np.ndarray | None = None, least: float = 0.0) -> np.ndarray:
        asked.append(len(points))
        return measured(self, points, sides, least)

    monkeypatch.setattr(Piece, "_measured", counted)
    own, points = piece(cup()), np.random.default_rng(1).uniform([-0.3, -0.3, 0.3], [0.3, 0.3, 0.9], (20_000, 3))
    own.depth(points)
    asked.clear()
    own.depth(points)
    assert sum(asked) < 0.01 * len(points)


def test_a_flat_solid_gets_no_more_cells_than_memory_bears() -> None:
    """A sheet of ground 100 m wide and a millimetre thick: its cells are no finer than a thousandth of its width."""
    box = trimesh.creation.box((100.0, 100.0, 1e-3))
    solid = Solid.from_mesh(TriangleMesh(np.array(box.vertices), np.array(box.faces, dtype=np.int32)), closed=True)
    cells = outside.OutsideCells(solid, lambda points: np.full(len(points), -1.0))
    assert len(cells._distance) < 3e6


@pytest.mark.parametrize("axes", [2, 3])
def test_points_in_a_box_are_those_that_all_comparisons_find(axes: int) -> None:
    """Points on its sides count, and points that are not numbers lie nowhere."""
    points = np.random.default_rng(axes).uniform(-1.0, 1.0, (5_000, axes)).round(2)
    points[7, axes - 1] = np.nan
    low, high = np.full(axes, -0.5), np.full(axes, 0.25)
    wanted = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
    assert len(wanted) > 100
    assert (solids.rows_within(points, low, high) == wanted).all()
    open_ = np.flatnonzero(((points > low) & (points < high)).all(axis=1))
    assert len(open_) < len(wanted)
    assert (solids.rows_within(points, np.nextafter(low, np.inf), np.nextafter(high, -np.inf)) == open_).all()
    assert len(solids.rows_within(points[:0], low, high)) == 0
