"""Lee of solids: liquid that no medium meets."""

from __future__ import annotations

import numpy as np
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.liquid_air import in_lee, surface_points

H = 0.02


def test_nothing_blows_in_the_lee_of_a_surface() -> None:
    wall = TriangleMesh(np.array([[0, -1, -1], [0, 1, -1], [0, 1, 1], [0, -1, 1.0]]), np.array([[0, 1, 2], [0, 2, 3]]))
    points = surface_points(wall, H)
    assert np.linalg.norm(points[:, None, 1:] - np.array([[0.3, 0.4]]), axis=2).min() < H
    spots = np.array([[0.02, 0.0, 0.0], [-0.03, 0.5, -0.5], [0.5, 0.0, 0.0], [0.02, 0.0, 3.0]])
    assert in_lee(spots, points, H).tolist() == [True, True, False, False]
    cut = surface_points(wall, H, np.array([-1, 0.5, 0.5]), np.array([1, 2.0, 2.0]))
    assert 0 < len(cut) < len(points) / 8
    assert cut[:, 1:].min() > 0.5 - H
