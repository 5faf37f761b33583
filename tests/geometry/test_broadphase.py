"""Boxes over time and candidate pairs."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.geometry import aabb_of, candidate_pairs

from .meshes import hull, random_pose


@pytest.mark.parametrize("frames", [1, 7])
def test_candidate_pairs_are_those_of_the_double_loop(frames):
    rng = np.random.default_rng(4)
    lo = rng.uniform(0, 4, (60, 1, 3)) + rng.normal(size=(60, frames, 3)) * 0.2
    hi = lo + rng.uniform(0, 0.6, (60, frames, 3))
    expected = [
        (i, j)
        for i in range(60)
        for j in range(i + 1, 60)
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
