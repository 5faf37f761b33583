"""Boxes over time and candidate pairs."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.geometry import aabb_of, candidate_pairs
from worldagent.geometry.broadphase import BLOCK, FEW, meetings, turned_boxes

from .meshes import hull, random_pose


@pytest.mark.parametrize("frames", [1, 7, 2 * BLOCK + 3])
@pytest.mark.parametrize("count", [FEW - 4, 3 * FEW])
def test_candidate_pairs_are_those_of_the_double_loop(frames, count):
    rng = np.random.default_rng(4)
    lo = rng.uniform(0, 4, (count, 1, 3)) + rng.normal(size=(count, frames, 3)) * 0.2
    hi = lo + rng.uniform(0, 0.6, (count, frames, 3))
    expected = [
        (i, j)
        for i in range(count)
        for j in range(i + 1, count)
        if (np.maximum(lo[i] - hi[j], lo[j] - hi[i]).max(axis=1) <= 0.05).any()
    ]
    assert candidate_pairs(lo, hi, 0.05) == expected


def test_boxes_that_touch_are_candidates_without_margin():
    lo = np.array([[[0.0, 0, 0]], [[1.0, 0, 0]], [[2.5, 0, 0]]])
    assert candidate_pairs(lo, lo + 1.0, 0.0) == [(0, 1)]
    assert candidate_pairs(lo[:1], lo[:1] + 1.0, 0.0) == []


def test_boxes_hold_the_moved_vertices_tightly():
    rng = np.random.default_rng(5)
    solid = hull(rng)
    poses = [random_pose(rng, 2.0) for _ in range(4)]
    poses = [poses[0], poses[0], *poses[1:]]
    lo, hi = aabb_of(solid.vertices, np.stack([p.position for p in poses]), np.stack([p.quaternion for p in poses]))
    for k, pose in enumerate(poses):
        moved = pose.apply(solid.vertices)
        assert lo[k] == pytest.approx(moved.min(axis=0), abs=1e-14)
        assert hi[k] == pytest.approx(moved.max(axis=0), abs=1e-14)


@pytest.mark.parametrize("count", [FEW, 4 * FEW])
def test_meetings_name_pairs_and_frames_without_two_still_bodies(count):
    """One body as large as the scene, some that never move, some whose pose is broken (empty boxes)."""
    rng = np.random.default_rng(6)
    frames = BLOCK + 5
    lo = rng.uniform(0, 6, (count, 1, 3)) + np.cumsum(rng.normal(size=(count, frames, 3)) * 0.05, axis=1)
    still = rng.random(count) < 0.3
    lo[still] = lo[still, :1]
    hi = lo + rng.uniform(0, 0.8, (count, 1, 3))
    lo[0], hi[0], still[0] = -1.0, 7.0, True
    lo[5, 9:], hi[5, 9:] = 1e300, -1e300
    still[5] = False
    met = meetings(lambda part: (lo[:, part], hi[:, part]), frames, 0.01, still=still)
    gap = np.maximum(lo[:, None] - hi[None], lo[None] - hi[:, None]).max(axis=3)
    near = (
        (gap <= 0.01) & ~(still[:, None] & still[None])[:, :, None] & (np.arange(count)[:, None] < np.arange(count))[:, :, None]
    )
    assert np.stack(met, axis=1).tolist() == np.argwhere(near).tolist()


def test_turned_boxes_hold_the_moved_vertices():
    rng = np.random.default_rng(5)
    solids = [hull(rng) for _ in range(5)]
    poses = [[random_pose(rng, 2.0) for _ in range(4)] for _ in solids]
    lo, hi = turned_boxes(
        np.stack([s.sphere_center for s in solids]),
        np.stack([0.5 * (s.upper - s.lower) for s in solids]),
        np.array([s.sphere_radius for s in solids]),
        np.array([[p.position for p in row] for row in poses]),
        np.array([[p.quaternion for p in row] for row in poses]),
    )
    assert lo.shape == hi.shape == (5, 4, 3)
    for i, solid in enumerate(solids):
        for k, pose in enumerate(poses[i]):
            moved = pose.apply(solid.vertices)
            assert (lo[i, k] <= moved.min(axis=0) + 1e-14).all()
            assert (hi[i, k] >= moved.max(axis=0) - 1e-14).all()
            assert (hi[i, k] - lo[i, k]).max() <= 2.0 * solid.sphere_radius + 1e-14
