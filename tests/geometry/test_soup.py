"""Crossing triangles: brute force on random soups, and surfaces that touch, fold or pass through themselves."""

from __future__ import annotations

import time

import numpy as np
import pytest
import trimesh
from worldagent.geometry import Solid, mutual_crossings, self_crossings
from worldagent.geometry.triangles import triangle_pair_segments
from worldagent.worlds.built import TriangleMesh

from .meshes import solid_of

NOISE = 1e-9


def merged(*meshes: trimesh.Trimesh) -> Solid:
    return solid_of(trimesh.util.concatenate(meshes))


def pierces(a: np.ndarray, b: np.ndarray) -> bool:
    """True if an edge of one triangle goes through the inside of the other, by solving for the point: another route."""
    for one, other in ((a, b), (b, a)):
        for k in range(3):
            p, q = one[k], one[(k + 1) % 3]
            matrix = np.column_stack([q - p, other[0] - other[1], other[0] - other[2]])
            if abs(np.linalg.det(matrix)) < 1e-15:
                continue
            t, u, v = np.linalg.solve(matrix, other[0] - p)
            if 0 < t < 1 and u > 0 and v > 0 and u + v < 1:
                return True
    return False


def test_crossing_pairs_of_one_random_soup_are_those_of_brute_force():
    rng = np.random.default_rng(9)
    corners = rng.uniform(size=(120, 1, 3)) + 0.3 * rng.normal(size=(120, 3, 3))
    solid = Solid.from_mesh(TriangleMesh(corners.reshape(-1, 3), np.arange(360, dtype=np.int32).reshape(-1, 3)), closed=False)
    found = {tuple(p) for p in self_crossings(solid, noise=1e-12).pairs.tolist()}
    t = solid.triangles
    assert found == {(i, j) for i in range(120) for j in range(i + 1, 120) if pierces(t[i], t[j])}


@pytest.mark.parametrize(
    "mesh",
    [
        trimesh.creation.icosphere(3),
        trimesh.creation.torus(0.5, 0.2),
        trimesh.creation.annulus(0.3, 0.31, 1.0),
        trimesh.creation.box((1, 2, 3)).subdivide(),
        trimesh.util.concatenate([trimesh.creation.box((1, 1, 1)), trimesh.creation.box((1, 1, 1)).apply_translation([1, 0, 0])]),
        trimesh.util.concatenate([trimesh.creation.box((1, 1, 1)), trimesh.creation.box((2, 2, 1)).apply_translation([0, 0, 1])]),
        trimesh.util.concatenate([trimesh.creation.torus(0.5, 0.1), trimesh.creation.icosphere(3, radius=0.39)]),
    ],
    ids=["ball", "torus", "tube", "box", "welded boxes", "stacked boxes", "ball in ring"],
)
def test_sound_and_touching_surfaces_do_not_cross(mesh):
    assert len(self_crossings(solid_of(mesh), noise=NOISE).pairs) == 0


@pytest.mark.parametrize("shift", [(0.5, 0.1, 0.2), (0.5, 0, 0), (0.5, 0.5, 0.5), (0.25, 0.25, 0), (0.5, 0.5, 0)])
def test_two_overlapping_boxes_in_one_mesh_cross_even_with_aligned_faces(shift):
    one = trimesh.creation.box((1, 1, 1)).subdivide()
    assert len(self_crossings(merged(one, one.copy().apply_translation(shift)), noise=NOISE).pairs) > 0


@pytest.mark.parametrize("depth", [1e-6, 1e-3, 0.1])
def test_the_reach_grows_with_the_overlap_and_vanishes_within_the_noise(depth):
    one = trimesh.creation.box((1, 1, 1))
    two = trimesh.creation.icosphere(2, radius=0.3).apply_translation([0.01, 0.02, 0.8 - depth])
    found = self_crossings(merged(one, two), noise=NOISE)
    assert 0 < found.reach.max() <= depth * 1.001
    assert len(self_crossings(merged(one, two), noise=2 * depth).pairs) == 0


def test_folded_neighbours_cross_and_flat_ones_do_not():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.9, 0.9, 0], [0.3, 0.3, 0]])
    flat = solid_of(trimesh.Trimesh(vertices, [[0, 1, 2], [1, 3, 2]], process=False), closed=False)
    folded = solid_of(trimesh.Trimesh(vertices, [[0, 1, 2], [1, 4, 2]], process=False), closed=False)
    assert len(self_crossings(flat, noise=NOISE).pairs) == 0
    assert self_crossings(folded, noise=NOISE).pairs.tolist() == [[0, 1]]


def test_triangles_that_share_a_corner_may_cross_beyond_it():
    vertices = np.array([[0, 0, 0], [2, -1, 0], [2, 1, 0], [2, 0, -1], [2, 0.3, 1], [-2, 0, -1], [-2, 0, 1]])
    crossing = solid_of(trimesh.Trimesh(vertices, [[0, 1, 2], [0, 3, 4]], process=False), closed=False)
    apart = solid_of(trimesh.Trimesh(vertices, [[0, 1, 2], [0, 5, 6]], process=False), closed=False)
    assert len(self_crossings(crossing, noise=NOISE).pairs) == 1
    assert len(self_crossings(apart, noise=NOISE).pairs) == 0


def test_a_hundred_thousand_triangles_with_one_crossing_are_searched():
    sheet = trimesh.creation.icosphere(6)
    spike = trimesh.creation.cone(radius=0.01, height=0.2, sections=8).apply_translation([0.3, 0.5, 0.75])
    solid = merged(sheet, spike)
    assert len(solid.faces) > 80_000
    begin = time.process_time()
    found = self_crossings(solid, noise=NOISE)
    assert time.process_time() - begin < 60.0
    assert 0 < len(found.pairs) < 200
    assert (found.pairs[:, 1] >= len(sheet.faces)).all() or (found.pairs[:, 0] < len(sheet.faces)).all()


def test_mutual_crossings_are_those_that_edges_pierce_and_touching_is_none() -> None:
    """By another route: an edge of one triangle goes through the other."""
    rng = np.random.default_rng(3)
    one, two = (rng.uniform(-1, 1, (n, 1, 3)) + rng.uniform(-0.3, 0.3, (n, 3, 3)) for n in (150, 200))
    i, j = (k.ravel() for k in np.meshgrid(range(150), range(200), indexing="ij"))
    pierced = ~np.isnan(triangle_pair_segments(one[i], two[j])).all(axis=(1, 2))
    found = mutual_crossings(one, two, noise=1e-12).pairs
    assert {tuple(p) for p in found.tolist()} == set(zip(i[pierced].tolist(), j[pierced].tolist(), strict=True))
    assert len(found) > 50
    flat = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]], dtype=float)
    standing = np.array([[[0.2, 0.2, 0], [0.2, 0.4, 0], [0.2, 0.3, 1]]])
    aside = flat + np.array([0.1, 0.1, 0])
    assert len(mutual_crossings(flat, standing, noise=1e-9).pairs) == 0
    assert len(mutual_crossings(flat, standing - [0, 0, 1e-3], noise=1e-9).pairs) == 1
    assert len(mutual_crossings(flat, aside, noise=1e-9).pairs) == 1  # coplanar, facing the same way
    assert len(mutual_crossings(flat, aside[:, ::-1], noise=1e-9).pairs) == 0  # face to face


def test_many_small_surfaces_searched_as_groups_cross_where_they_do_by_the_grid() -> None:
    """Choice: a sweep over each surface finds the pairs that one grid over all does."""
    rng = np.random.default_rng(3)
    meshes = []
    for k in range(30):
        boxes = [trimesh.creation.box(rng.uniform(0.2, 1.0, 3)) for _ in range(3)]
        for box in boxes:
            box.apply_translation(rng.uniform(-0.5, 0.5, 3) + np.array([10.0 * k, 0.0, 0.0]))
        meshes.append(trimesh.util.concatenate(boxes))
    solid = merged(*meshes)
    counts = np.array([len(m.faces) for m in meshes])
    assert counts.sum() == len(solid.faces)
    grid, swept = self_crossings(solid, noise=1e-9), self_crossings(solid, noise=1e-9, groups=counts)
    assert len(grid.pairs) > 30
    assert np.array_equal(grid.pairs, swept.pairs)
    assert np.array_equal(grid.reach, swept.reach)
