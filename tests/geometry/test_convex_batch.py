"""Compiled loops over pairs of convex solids: the answers of `clearance`, one by one."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from worldagent.geometry import Care, Solid, clearance_batch, convex_gaps, distance_to_surface, query_noise, signed_clearance
from worldagent.geometry import batch as module
from worldagent.geometry.convex_batch import convex_clearances, convex_of
from worldagent.geometry.forest import Forest
from worldagent.worlds.arrays import RigidPose

from .meshes import at, ball, box, hull, random_pose
from .shapes import KINDS, random_shape


def pairs_of(seed: int, count: int) -> tuple[list[Solid], np.ndarray, list[RigidPose], list[RigidPose]]:
    """Random convex bodies, each pair apart, touching, overlapping or one inside the other."""
    rng = np.random.default_rng(seed)
    solids = [box(*rng.uniform(0.1, 1.2, 3)) if k % 2 else hull(rng) for k in range(20)] + [ball(0.4, 1), box(5.0, 5.0, 0.1)]
    pairs = rng.integers(0, len(solids), (count, 2))
    one = [random_pose(rng, float(rng.choice([0.2, 0.6, 1.2]))) for _ in range(count)]
    return solids, pairs, one, [random_pose(rng, 0.1) for _ in range(count)]


def stacked(poses: list[RigidPose]) -> tuple[np.ndarray, np.ndarray]:
    return np.array([p.position for p in poses]), np.array([p.quaternion for p in poses])


@pytest.mark.parametrize("seed", range(3))
def test_gaps_of_convex_pairs_are_those_of_single_queries(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    """Law: distances within the noise of a query, points on both surfaces and as far apart as the distance says."""
    monkeypatch.setattr(module, "MANY", 1)
    solids, pairs, one, two = pairs_of(seed, 300)
    found = convex_gaps(Forest(solids), pairs, stacked(one), stacked(two), skip_above=np.inf)
    assert found is not None
    expected = [signed_clearance(solids[i], p, solids[j], q) for (i, j), p, q in zip(pairs, one, two, strict=True)]
    apart = [k for k, e in enumerate(expected) if e.distance > 0.0]
    assert min(len(apart), 300 - len(apart)) > 50
    # Left are those whose deepest point may lie inside a facet: deep overlaps, and a few that no plane of a facet separates.
    assert found.answered[apart].mean() > 0.9
    for k in np.flatnonzero(found.answered):
        (i, j), e = pairs[k], expected[k]
        noise = query_noise(solids[i].size + solids[j].size)
        assert found.distance[k] == pytest.approx(e.distance, abs=noise)
        assert np.linalg.norm(found.point_a[k] - found.point_b[k]) == pytest.approx(abs(e.distance), abs=noise)
        for solid, pose, point in ((solids[i], one[k], found.point_a[k]), (solids[j], two[k], found.point_b[k])):
            assert distance_to_surface(solid, pose.inverse().apply(point[None])).distance[0] < noise


def test_flush_boxes_touch_and_a_bound_is_above_what_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Limit case: faces that lie on each other have a clearance of 0, and what is far only a bound."""
    monkeypatch.setattr(module, "MANY", 1)
    forest = Forest([box(1.0, 1.0, 1.0), box(0.5, 0.5, 0.5)])
    places = [at(z=0.75), at(z=0.75, x=0.4), at(x=-0.75, y=0.3), at(z=0.751), at(z=3.0), at(z=0.749)]
    pairs = np.array([[1, 0]] * len(places))
    found = convex_gaps(forest, pairs, stacked(places), stacked([at()] * len(places)), skip_above=0.5)
    assert found is not None
    assert found.answered.all()
    assert np.abs(found.distance[:3]).max() < 1e-15
    assert found.distance[3] == pytest.approx(1e-3, abs=1e-15)
    assert found.distance[5] == pytest.approx(-1e-3, abs=1e-15)
    assert 0.5 < found.distance[4] <= 2.25 + 1e-12


def test_a_list_of_many_pairs_is_the_list_of_few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Choice: which route a list takes changes no value by more than the noise, those that are not convex among them."""
    rng = np.random.default_rng(5)
    solids, pairs, one, two = pairs_of(7, 200)
    solids += [random_shape(rng, "ring"), random_shape(rng, "ell")]
    pairs[::9, 0] = len(solids) - 1 - rng.integers(0, 2, len(pairs[::9]))
    given = (solids, pairs, stacked(one), stacked(two))
    care = Care(enough=0.3)
    few = clearance_batch(*given, skip_above=0.2, care=care).distance
    asked = []
    loops = convex_clearances
    monkeypatch.setattr(module, "convex_clearances", lambda *a, **k: asked.append(len(a[1])) or loops(*a, **k))
    monkeypatch.setattr(module, "MANY", 1)
    many = clearance_batch(*given, skip_above=0.2, care=care).distance
    assert sum(asked) > 100
    near = (few <= 0.2) & (few > -0.3)
    assert near.sum() > 50
    assert np.abs(few - many)[near].max() < query_noise(12.0)
    assert np.array_equal(few > 0.2, many > 0.2)
    assert np.array_equal(few <= -0.3, many <= -0.3)


def test_convexity_told_of_many_is_that_of_each() -> None:
    """Law: closed, watertight and no vertex above a face, of bodies of every kind."""
    rng = np.random.default_rng(2)
    shapes = [random_shape(rng, kind) for kind in KINDS for _ in range(4)]
    alone = [Solid(s.vertices, s.faces, s.closed).convex for s in shapes]
    assert 0 < sum(alone) < len(alone)
    fit = convex_of(shapes).fit
    assert [s.convex for s in shapes] == alone
    assert fit.tolist() == alone


def test_a_short_list_does_not_import_numba() -> None:
    """Choice: only worlds of a thousand pairs pay for loading the loops."""
    program = (
        "import sys, numpy as np; from worldagent.geometry import Solid, clearance_batch, convex_gaps;"
        "from worldagent.geometry.forest import Forest; from worldagent.worlds.built import TriangleMesh;"
        "v = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float); f = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)], np.int32);"
        "s = Solid.from_mesh(TriangleMesh(v, f), closed=True); p = (np.array([[2.0, 0, 0]] * 9), np.array([[1.0, 0, 0, 0]] * 9));"
        "o = (np.zeros((9, 3)), p[1]); pairs = np.zeros((9, 2), int);"
        "print(clearance_batch([s], pairs, p, o, skip_above=9.0).distance[0], end=' ');"
        "print(convex_gaps(Forest([s]), pairs, p, o, skip_above=9.0), 'numba' in sys.modules)"
    )
    answer = subprocess.run([sys.executable, "-P", "-c", program], capture_output=True, text=True, check=True)
    assert answer.stdout.split() == ["1.0", "None", "False"]
