"""Signed clearance: analytic cases, then random pairs against an independent brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from worldagent.geometry import Solid, clearance_series, query_noise, signed_clearance

from .meshes import at, ball, box, brute_depth, brute_distance, hull, mesh_of, random_pose, ring, solid_of

EXACT = 1e-12
"""[m] for bodies of about 1 m: a few hundred roundings."""
DEPTH = 0.01
"""Relative: the promise for depths of meshes of any shape."""


def distance(a: Solid, pose_a, b: Solid, pose_b=None) -> float:
    return signed_clearance(a, pose_a, b, pose_b or at()).distance


@pytest.mark.parametrize(
    ("position", "expected"),
    [
        ((2.0, 0.0, 0.0), 1.0),
        ((2.0, 2.0, 0.0), math.sqrt(2.0)),
        ((2.0, 2.0, 2.0), math.sqrt(3.0)),
        ((1.0, 0.0, 0.0), 0.0),
        ((0.0, 0.0, 1.0), 0.0),
        ((0.25, 0.125, 1.0), 0.0),
        ((1.0, 1.0, 0.0), 0.0),
        ((1.0, 1.0, 1.0), 0.0),
        ((0.9, 0.0, 0.0), -0.1),
        ((0.9, 0.9, 0.9), -0.1),
        ((0.0, 0.0, 1.0 - 1e-7), -1e-7),
        ((0.0, 0.0, 0.0), -0.5),
    ],
)
def test_unit_boxes_side_by_side(position, expected):
    """Analytic; the last one is a body placed twice in the same place, which no surface point shows."""
    unit = box(1, 1, 1)
    assert distance(unit, at(*position), unit) == pytest.approx(expected, abs=EXACT)


def test_a_box_inside_a_box_is_as_deep_as_its_deepest_point():
    """Analytic: the largest distance of the small surface to the big one, 0.5 in the middle."""
    assert distance(box(0.2, 0.2, 0.2), at(0.3), box(1, 1, 1)) == pytest.approx(-0.3, abs=EXACT)


def test_crossed_beams_overlap_without_any_vertex_inside():
    """Analytic: the flush overlap has depth 0.3; no corner of either lies in the other."""
    assert distance(box(4, 1, 1), at(0, 0, 0.7), box(1, 4, 1)) == pytest.approx(-0.3, abs=EXACT)


@pytest.mark.parametrize("gap", [1e-3, 1e-9, 0.0])
def test_crossed_edges_keep_their_gap(gap):
    """Analytic: two beams on edge, at right angles; only an edge pair separates them."""
    turn = math.pi / 8
    beam_a = at(0, 0, math.sqrt(2.0) + gap, quaternion=(math.cos(turn), math.sin(turn), 0, 0))
    beam_b = at(quaternion=(math.cos(turn), 0, math.sin(turn), 0))
    assert distance(box(4, 1, 1), beam_a, box(1, 4, 1), beam_b) == pytest.approx(gap, abs=EXACT)


def test_crossed_edges_that_bite_are_negative():
    """Analytic: along the diagonal by 1e-4; the lowest edge point lies 1e-4 / sqrt 2 below each face."""
    turn = math.pi / 8
    beam_a = at(0, 0, math.sqrt(2.0) - 1e-4, quaternion=(math.cos(turn), math.sin(turn), 0, 0))
    beam_b = at(quaternion=(math.cos(turn), 0, math.sin(turn), 0))
    assert distance(box(4, 1, 1), beam_a, box(1, 4, 1), beam_b) == pytest.approx(-1e-4 / math.sqrt(2.0), rel=1e-6)


@pytest.mark.parametrize(("apart", "expected"), [(3.0, 1.0), (2.0, 0.0), (1.7, -0.3), (0.3, -1.0)])
def test_spheres_measure_like_spheres(apart, expected):
    """Analytic up to the facet error of the mesh (0.5 % of the radius); fcl alone answers 0 or a positive number."""
    small = ball(0.3 if apart == 0.3 else 1.0)
    assert distance(small, at(apart), ball(1.0)) == pytest.approx(expected if apart != 0.3 else -1.0, abs=0.02)


def test_a_sphere_inside_a_sphere_is_contained_not_apart():
    assert distance(ball(0.3), at(0.0), ball(1.0)) == pytest.approx(-0.7, abs=0.02)


def test_a_ball_in_the_hole_of_a_torus_touches_nothing():
    """Analytic: hole radius 0.65 less ball 0.2; hull-based queries say -0.55 here."""
    torus = solid_of(trimesh.creation.torus(1.0, 0.35, major_sections=48, minor_sections=24))
    found = signed_clearance(ball(0.2), at(), torus, at())
    assert found.distance == pytest.approx(0.45, abs=0.005)
    assert np.linalg.norm(found.point_a - found.point_b) == pytest.approx(found.distance, abs=EXACT)
    assert distance(ball(0.2), at(1.0), torus) == pytest.approx(-0.35, abs=0.005)
    assert distance(ball(0.2), at(0.6), torus) == pytest.approx(-0.15, abs=0.005)


def test_a_mesh_that_rests_flush_on_a_mesh_does_not_penetrate():
    """Analytic: a ring on a table, on a ring turned by a facet, with a plug that fits its hole loosely."""
    table = box(3, 3, 0.3)
    assert distance(ring(), at(0, 0, 0.3), table) == pytest.approx(0.0, abs=EXACT)
    assert distance(ring(), at(0.1, 0.05, 0.3), ring()) == pytest.approx(0.0, abs=EXACT)
    assert distance(ring(), at(0, 0, 0.3 - 1e-5), table) == pytest.approx(-1e-5, rel=DEPTH)
    assert distance(box(0.1, 0.1, 0.3), at(), ring()) > 0.2


def test_the_same_ring_twice_overlaps_fully():
    assert distance(ring(), at(), ring()) < -0.05


def test_an_open_sheet_has_no_inside():
    """Choice: nested open shells are apart, and only a crossing counts."""
    shell, core = ball(1.0), ball(0.5)
    open_shell = Solid(shell.vertices, shell.faces[:-1], closed=False)
    open_core = Solid(core.vertices, core.faces[:-1], closed=False)
    assert distance(open_core, at(), open_shell) == pytest.approx(0.5, abs=0.02)
    assert distance(core, at(), open_shell) == pytest.approx(0.5, abs=0.02)
    assert distance(open_core, at(), shell) == pytest.approx(-1.0, abs=0.52)
    assert distance(open_core, at(0.8), open_shell) < -1e-3


def test_two_sheets_touch_or_cross():
    """Analytic: a vertical sheet through a horizontal one by 0.2; standing on it; lying on it."""
    corners = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    sheet = solid_of(trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], process=False), closed=False)
    upright = (math.cos(math.pi / 4), math.sin(math.pi / 4), 0, 0)
    assert distance(sheet, at(0.3, 0.1, 0.8, quaternion=upright), sheet) == pytest.approx(-0.2, abs=EXACT)
    assert distance(sheet, at(0.3, 0.1, 1.0, quaternion=upright), sheet) == pytest.approx(0.0, abs=EXACT)
    assert distance(sheet, at(0.3, 0.1, 0.0), sheet) == pytest.approx(0.0, abs=EXACT)


def test_nested_closed_shells_are_contained_component_by_component():
    """Analytic: of two balls in one mesh only the second lies in the big one."""
    pair = trimesh.util.concatenate(
        [trimesh.creation.icosphere(2, 0.2).apply_translation([5, 0, 0]), trimesh.creation.icosphere(2, 0.2)]
    )
    assert distance(solid_of(pair), at(), ball(1.0)) == pytest.approx(-0.8, abs=0.02)


@pytest.mark.parametrize("kinds", ["box-box", "hull-box", "hull-hull", "ring-box", "ring-ring"])
def test_random_pairs_agree_with_brute_force(kinds):
    """Separated exactly; depth never shallower than 1 % below any sampled point, and zero only when nothing is inside."""
    rng = np.random.default_rng(3)
    make = {"box": lambda: box(*rng.uniform(0.1, 1.5, 3)), "hull": lambda: hull(rng), "ring": ring}
    first, second = kinds.split("-")
    for k in range(4):
        a, b = make[first](), make[second]()
        pose_a, pose_b = random_pose(rng, 0.3 + 0.3 * (k % 2)), random_pose(rng, 0.3 + 0.3 * (k % 2))
        found = signed_clearance(a, pose_a, b, pose_b)
        assert np.linalg.norm(found.point_a - found.point_b) == pytest.approx(abs(found.distance), abs=1e-9)
        if found.distance > 0:
            assert found.distance == pytest.approx(brute_distance(a, pose_a, b, pose_b), abs=EXACT)
            assert brute_depth(a, pose_a, b, pose_b, 10) == 0.0
        else:
            assert -found.distance >= (1.0 - DEPTH) * brute_depth(a, pose_a, b, pose_b, 10)


def test_the_deep_point_proves_the_depth():
    """The reported point lies on one surface, inside the other, at the reported distance from it."""
    from worldagent.geometry import contains, distance_to_surface

    rng = np.random.default_rng(8)
    for k in range(6):
        a, b = (ring() if k % 2 else box(1, 0.5, 0.7)), box(0.8, 0.6, 0.9)
        pose = random_pose(rng, 0.2)
        found = signed_clearance(a, pose, b, at())
        assert found.distance < 0
        on_a, on_b = pose.inverse().apply(found.point_a[None]), found.point_b[None]
        assert distance_to_surface(a, on_a).distance[0] < 1e-9
        assert distance_to_surface(b, on_b).distance[0] < 1e-9
        in_b = contains(b, found.point_a[None])[0]
        own = distance_to_surface(b, found.point_a[None]) if in_b else distance_to_surface(a, pose.inverse().apply(on_b))
        assert own.distance[0] == pytest.approx(-found.distance, rel=1e-9)


def test_a_series_equals_single_queries_and_bounds_what_it_skips():
    rng = np.random.default_rng(1)
    for a, b in ((box(0.01, 0.05, 0.1), box(0.01, 0.05, 0.1)), (ring(0.02, 0.05, 0.03), box(0.05, 0.05, 0.1))):
        poses = [random_pose(rng, 0.08) for _ in range(40)]
        positions, quaternions = np.stack([p.position for p in poses]), np.stack([p.quaternion for p in poses])
        still = np.zeros((40, 3)), np.tile([1.0, 0, 0, 0], (40, 1))
        series = clearance_series(a, (positions, quaternions), b, still, skip_above=0.02)
        single = np.array([distance(a, p, b) for p in poses])
        near = single <= 0.02
        assert near.sum() > 5
        assert series[near] == pytest.approx(single[near], abs=1e-14)
        assert (series <= single + 1e-14).all()


def test_a_repeated_relative_pose_is_not_measured_again(monkeypatch):
    """Both bodies ride along together: one measurement for all frames."""
    import importlib

    module = importlib.import_module("worldagent.geometry.clearance")
    seen = []
    original = module.examine

    def counting(a, b, poses, **options):
        seen.append(len(poses.translation))
        return original(a, b, poses, **options)

    monkeypatch.setattr(module, "examine", counting)
    ride = np.linspace(0, 1, 50)[:, None] * [1.0, 2.0, 0.5]
    turn = np.tile([1.0, 0, 0, 0], (50, 1))
    series = clearance_series(box(1, 1, 1), (ride, turn), box(1, 1, 1), (ride + np.array([0, 0, 1.25]), turn), skip_above=1.0)
    assert series == pytest.approx(np.full(50, 0.25), abs=1e-12)
    assert seen == [1]


def test_welding_makes_a_mesh_with_split_corners_convex():
    """A box drawn as 36 loose corners is the same solid."""
    loose = mesh_of(trimesh.creation.box((1, 1, 1)))
    split = type(loose)(loose.vertices[loose.faces].reshape(-1, 3), np.arange(36, dtype=np.int32).reshape(-1, 3))
    assert Solid.from_mesh(split, closed=True).convex
    assert query_noise(1.0) == pytest.approx(1e-9)


def test_a_convex_pair_that_the_planes_tell_apart_builds_no_tree_of_triangles():
    """Choice: a room has thousands of such pairs, and the trees of fcl took longer than the answer."""
    a, b = box(1, 1, 1), box(2, 1, 1)
    assert distance(a, at(), b, at(z=1.25)) == pytest.approx(0.25, abs=EXACT)
    assert "bvh" not in vars(a)
    assert "bvh" not in vars(b)
