"""Greatest depth under planes, where facets are parallel up to rounding too."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.geometry import Care, polytopes
from worldagent.geometry.clearance import measure, relative_poses

from .meshes import at, hull


@pytest.mark.parametrize("order", [[3, 4, 5], [4, 3, 5], [5, 3, 4]])
def test_planes_that_are_parallel_up_to_rounding_still_have_a_greatest_depth(order: list[int]) -> None:
    g = np.zeros((1, 6, 3))
    g[0, 0, 2] = g[0, 1, 0] = g[0, 2, 1] = 1.0
    g[0, 3:] = [[1.0, 0.0, 1.0], [1.0, 0.0, 1.0 + 1e-16], [-1.0, 0.0, 1.0]]
    h = np.array([[2.0, 2.0, 2.0, 0.3, 0.3 - 1e-9, 0.1]])
    rows = [0, 1, 2, *order]
    assert polytopes._maximise_last(g[:, rows], h[:, rows])[0, 2] == pytest.approx(0.2, abs=1e-6)


def test_a_basis_without_a_corner_is_solved_by_another_method() -> None:
    """Its inverse does not exist: numpy raised an error before."""
    flat = np.array([[[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.3, 0.0, 1.0], [-0.3, 0.0, 1.0], [0.0, 1.0, 1.0]]])
    h = np.array([[2.0, 2.0, 2.0, 0.2, 0.2, 0.2]])
    assert polytopes._maximise_last(flat, h)[0, 2] == pytest.approx(0.2, abs=1e-9)


def test_a_vertex_that_is_deep_enough_ends_the_search_over_facets(monkeypatch: pytest.MonkeyPatch) -> None:
    """Law: any depth from `enough` on is an answer, never more than the whole one; own choice: without a programme for each facet."""
    searched: list[int] = []
    search = polytopes._facet_depth
    monkeypatch.setattr(polytopes, "_facet_depth", lambda *given: searched.append(1) or search(*given))
    rng = np.random.default_rng(6)
    for _ in range(20):
        a, b = hull(rng), hull(rng)
        poses = relative_poses(
            *((np.array([p.position]), np.array([p.quaternion])) for p in (at(*rng.uniform(-0.1, 0.1, 3)), at()))
        )
        whole = -measure(a, b, poses)[0]
        count = len(searched)
        vertex = -measure(a, b, poses, care=Care(enough=1e-6))[0]
        assert len(searched) == count
        assert 1e-6 <= vertex <= whole
        assert -measure(a, b, poses, care=Care(enough=2.0 * whole))[0] == whole
    assert searched


@pytest.mark.parametrize("facets", [polytopes.MANY_FACETS, 3 * polytopes.MANY_FACETS])
def test_compiled_bounds_of_facets_are_those_of_numpy(facets: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Law: the same maxima and minima, to the last bit."""
    rng = np.random.default_rng(facets)
    slack = rng.normal(size=(4, 20, 50))
    members = rng.random((facets, 50)) < 0.1
    members[:, 0] = True  # no facet without a corner
    compiled = polytopes._facet_bounds(slack, members)
    monkeypatch.setattr(polytopes, "MANY_FACETS", 10**9)
    np.testing.assert_array_equal(compiled, polytopes._facet_bounds(slack, members))
