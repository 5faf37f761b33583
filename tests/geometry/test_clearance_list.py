"""Clearances of many pairs at once are those of one pair after the other."""

from __future__ import annotations

import numpy as np
from worldagent.geometry import signed_clearance, signed_clearances
from worldagent.geometry.point_kernels import to_triangles
from worldagent.geometry.triangles import nearest_on_triangles

from .shapes import random_pair


def test_clearances_of_a_list_are_those_of_its_pairs_to_the_last_bit() -> None:
    """Law: the same queries in the same order of operations, whatever else is asked about."""
    rng = np.random.default_rng(3)
    asked = [random_pair(rng)[:4] for _ in range(150)]
    found = signed_clearances(asked)
    assert {"mesh", "depth"} <= {f.method for f in found}
    for query, one in zip(asked, found, strict=True):
        alone = signed_clearance(*query)
        assert (one.distance, one.method) == (alone.distance, alone.method)
        np.testing.assert_array_equal(one.point_a, alone.point_a)
        np.testing.assert_array_equal(one.point_b, alone.point_b)
    assert signed_clearances([]) == []


def test_a_compiled_distance_to_triangles_is_that_of_numpy_to_the_last_bit() -> None:
    """Law: the same formula in the same order; the place on the axis of a hinge is chosen by such distances, and ties decide."""
    rng = np.random.default_rng(5)
    for trial in range(300):
        triangles = rng.normal(size=(rng.integers(1, 40), 3, 3))
        point = rng.normal(size=3) * rng.choice([0.1, 1.0, 10.0])
        if trial % 2:  # ties, corners and flat ones
            triangles, point = np.round(2.0 * triangles) / 2.0, np.round(2.0 * point) / 2.0
        expected = nearest_on_triangles(point[None, None], triangles[None]).distance.min()
        assert to_triangles(point, triangles) == expected
