"""Samples of surfaces."""

import numpy as np
import pytest
import trimesh
from worldagent.simulation.liquid.boundary import sample_surface
from worldagent.worlds.built import TriangleMesh

S = 0.05


def solid(mesh):
    return TriangleMesh(np.array(mesh.vertices, dtype=float), np.array(mesh.faces, dtype=np.int32))


def test_samples_lie_on_the_surface_evenly_and_alike_for_equal_seeds():
    mesh = solid(trimesh.creation.box((1.0, 1.0, 1.0)))
    one, two = sample_surface(mesh, S, seed=3), sample_surface(mesh, S, seed=3)
    assert np.array_equal(one.position, two.position)
    assert np.abs(one.position).max(axis=1) == pytest.approx(0.5)
    flat = one.position[:, 2] == 0.5
    inner = flat & (np.abs(one.position[:, :2]) < 0.35).all(axis=1)
    assert abs(one.volume[inner].sum() / (0.7**2 * S) - 1) < 0.06


def test_of_a_huge_ground_only_the_part_in_the_box_is_sampled():
    ground = TriangleMesh(np.array([(-500.0, -500, 0), (500, -500, 0), (0, 800, 0)]), np.array([(0, 1, 2)], dtype=np.int32))
    low, high = np.array([-0.5, -0.5, -1.0]), np.array([0.5, 0.5, 1.0])
    found = sample_surface(ground, S, lower=low, upper=high)
    assert (np.abs(found.position[:, :2]) <= 0.5).all()
    assert 0.9 < found.volume.sum() / S < 1.25
