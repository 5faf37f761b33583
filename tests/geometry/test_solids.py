"""Solids and point queries."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from worldagent.geometry import Solid, contains, distance_to_surface, solids, winding_number
from worldagent.geometry.crossings import RayGrid
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.errors import InputError

from .meshes import ball, box, hull, ring, solid_of


def test_mass_properties_of_a_box_are_exact():
    """Analytic, away from the origin."""
    moved = trimesh.creation.box((1, 2, 3)).apply_translation([5, -4, 3])
    solid = solid_of(moved)
    assert solid.volume == pytest.approx(6.0, rel=1e-13)
    assert solid.center == pytest.approx([5, -4, 3], rel=1e-13)
    assert solid.inertia(2.0) == pytest.approx(np.diag([13.0, 10.0, 5.0]), abs=1e-11)


def test_mass_properties_of_a_ring_agree_with_trimesh():
    shape = trimesh.creation.annulus(0.3, 0.6, 0.3, sections=10)
    shape.density = 3.0
    solid = solid_of(shape)
    assert solid.volume == pytest.approx(shape.volume, rel=1e-12)
    assert solid.inertia(3.0) == pytest.approx(shape.moment_inertia, abs=1e-12)


def test_shapes_are_told_apart():
    assert box(1, 2, 3).convex
    assert ball(1.0).convex
    assert not ring().convex
    assert ring().is_watertight
    opened = Solid(box(1, 1, 1).vertices, box(1, 1, 1).faces[:-1], closed=True)
    assert not opened.is_watertight
    assert not opened.convex


def test_a_box_has_six_facets_and_twelve_edges():
    facets = box(1, 2, 3).facets
    assert len(facets.normals) == 6
    assert len(facets.edges) == 12


def test_a_mesh_without_area_is_refused_with_a_reason():
    with pytest.raises(InputError, match="none with area"):
        Solid.from_mesh(TriangleMesh(np.zeros((3, 3)), np.array([[0, 1, 2]], dtype=np.int32)), closed=False)


def test_containment_agrees_with_the_formula():
    """Analytic: points in and out of a ring's polygon and height, by winding number and by crossings."""
    rng = np.random.default_rng(0)
    points = rng.uniform(-0.7, 0.7, (4000, 3)) * [1, 1, 0.4]
    angle = np.arctan2(points[:, 1], points[:, 0])
    sector = np.pi / 5
    along = np.hypot(points[:, 0], points[:, 1]) * np.cos((angle % sector) - sector / 2) / np.cos(sector / 2)
    expected = (along > 0.3) & (along < 0.6) & (np.abs(points[:, 2]) < 0.15)
    solid = ring()
    assert (contains(solid, points) == expected).all()
    crossings, doubtful = RayGrid(solid.triangles).winding(points)
    assert not doubtful.any()
    assert ((crossings != 0) == expected).all()


def test_an_open_mesh_contains_nothing():
    shell = ball(1.0)
    assert not contains(Solid(shell.vertices, shell.faces, closed=False), np.zeros((1, 3))).any()


def test_the_winding_number_counts_nested_shells():
    """Law: two nested outward spheres wind twice around the centre."""
    triangles = np.concatenate([ball(1.0).triangles, ball(0.5).triangles])
    points = np.array([[0.0, 0, 0], [0.7, 0, 0], [1.5, 0, 0]])
    assert winding_number(triangles, points) == pytest.approx([2.0, 1.0, 0.0], abs=1e-12)


@pytest.mark.parametrize("detail", [0, 1, 4])
def test_distance_to_a_surface_is_exact_with_and_without_the_tree(detail):
    """Against every triangle in turn: 20 of them, 80 with boxes, many with the tree."""
    from .meshes import _point_triangle

    rng = np.random.default_rng(2)
    solid = ball(1.0, detail)
    points = rng.normal(size=(6, 3))
    found = distance_to_surface(solid, points)
    for p, d, q in zip(points, *found, strict=True):
        assert d == pytest.approx(min(_point_triangle(p, t) for t in solid.triangles), abs=1e-14)
        assert np.linalg.norm(p - q) == pytest.approx(d, abs=1e-14)


def test_the_interior_point_lies_inside():
    for solid in (ring(), box(1, 1, 1), hull(np.random.default_rng(0))):
        assert solid.interior_point is not None
        assert contains(solid, solid.interior_point[None])[0]


def test_a_convex_body_is_one_piece_without_a_search_for_pieces(monkeypatch):
    """Choice: most parts of a room are convex, and searching each for its pieces took a tenth of the check `support`."""
    calls = []
    searched = solids.connected
    monkeypatch.setattr(solids, "connected", lambda *given: calls.append(given) or searched(*given))
    for body in (box(1, 2, 3), hull(np.random.default_rng(3))):
        assert np.array_equal(body.component_heads, body.vertices[:1])
    assert not calls
    two = solid_of(trimesh.util.concatenate([trimesh.creation.box(), trimesh.creation.box().apply_translation((3, 0, 0))]))
    assert len(two.component_heads) == 2
    assert len(calls) == 1
