"""Batched clearance: the kernels against brute force and against the route for small jobs."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from worldagent.geometry import Solid, clearance_batch, query_noise, signed_clearance
from worldagent.geometry import batch as module
from worldagent.geometry.clearance import Care, relative_poses
from worldagent.geometry.depth import PRECISION
from worldagent.geometry.forest import Forest, grow
from worldagent.worlds.arrays import RigidPose, compose

from . import brute
from .meshes import at, ball, box, random_pose, ring
from .shapes import KINDS, random_pair, random_shape

SEPARATED = 1e-6
"""Accuracy that is promised for bodies apart, in units of their size."""
DEPTH = 0.01
"""Relative: what is promised for the depth."""


def by_kernels(monkeypatch, *arguments, **options):
    """`clearance_batch` with every list, however short, given to the kernels."""
    monkeypatch.setattr(module, "EFFORT", 0.0)
    return clearance_batch(*arguments, **options).distance


def stacked(poses):
    return np.stack([p.position for p in poses]), np.stack([p.quaternion for p in poses])


def compare(monkeypatch, seed: int, count: int, skip_above: float = np.inf) -> dict[str, int]:
    """Judge `count` random pairs by brute force; returns how many were apart, overlapped and lay beyond `skip_above`."""
    rng = np.random.default_rng(seed)
    drawn = [random_pair(rng) for _ in range(count)]
    solids = [s for a, _, b, _, _ in drawn for s in (a, b)]
    pairs = np.arange(2 * count).reshape(count, 2)
    found = by_kernels(
        monkeypatch, solids, pairs, stacked([d[1] for d in drawn]), stacked([d[3] for d in drawn]), skip_above=skip_above
    )
    seen = {"apart": 0, "overlapping": 0, "beyond": 0}
    for k, (a, pose_a, b, pose_b, kinds) in enumerate(drawn):
        expected = brute.signed(a, pose_a, b, pose_b)
        size = a.size + b.size
        if expected > skip_above:
            seen["beyond"] += 1
            assert skip_above < found[k] <= expected + SEPARATED * size, (seed, k, kinds)
        elif expected > 0.0:
            seen["apart"] += 1
            assert abs(found[k] - expected) <= SEPARATED * size, (seed, k, kinds)
        elif a.closed or b.closed:
            seen["overlapping"] += 1
            # Sampling can only miss depth: a deeper point is believed where brute force confirms that very point.
            if found[k] < (1.0 + DEPTH) * expected:
                deep = signed_clearance(a, pose_a, b, pose_b)
                expected = -brute.depth_of(deep.point_a, deep.point_b, a, pose_a, b, pose_b)
            assert abs(found[k] - expected) <= DEPTH * -found[k] + 1e-9 * size, (seed, k, kinds)
        else:
            assert found[k] <= query_noise(size), (seed, k, kinds)
    return seen


def test_random_bodies_that_are_not_convex_agree_with_brute_force(monkeypatch):
    """Law: 1e-6 of the size when apart, 1 % of the depth when overlapping, contained and nested ones included."""
    seen = compare(monkeypatch, 1, 40)
    assert seen["apart"] > 8
    assert seen["overlapping"] > 15


def test_a_bound_replaces_what_is_far(monkeypatch):
    """Beyond `skip_above` the answer is above it and never above the truth."""
    assert compare(monkeypatch, 2, 20, skip_above=0.1)["beyond"] > 0


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10, 30))
def test_thousands_of_random_bodies_agree_with_brute_force(monkeypatch, seed):
    seen = compare(monkeypatch, seed, 150)
    assert min(seen["apart"], seen["overlapping"]) > 0


def test_both_routes_agree_within_the_noise_of_a_query(monkeypatch):
    """Choice: which route a list takes depends on its length; a verdict must not."""
    rng = np.random.default_rng(5)
    solids = [random_shape(rng, kind) for kind in KINDS]
    pairs = rng.integers(0, len(solids), (120, 2))
    poses = [stacked([random_pose(rng, 0.8) for _ in pairs]) for _ in range(2)]
    fast = by_kernels(monkeypatch, solids, pairs, *poses, skip_above=np.inf)
    monkeypatch.setattr(module, "EFFORT", 1e9)
    slow = clearance_batch(solids, pairs, *poses, skip_above=np.inf).distance
    sizes = np.array([solids[i].size + solids[j].size for i, j in pairs])
    assert ((fast > 0) & (slow > 0)).sum() > 30
    overlapping = slow < -1e-9 * sizes
    assert overlapping.sum() > 10
    assert (np.abs(fast - slow)[~overlapping] <= 1e-3 * query_noise(1.0) * sizes[~overlapping]).all()
    assert (np.abs(fast - slow)[overlapping] <= 2.0 * PRECISION * -slow[overlapping]).all()


def test_noise_of_flush_contacts_through_the_kernels(monkeypatch):
    """Law of the construction, as in `test_query_noise`: boxes and rings set flush or a hair apart, carried about."""
    rng = np.random.default_rng(7)
    solids, pairs, first, second, gaps, sizes = [], [], [], [], [], []
    for k in range(200):
        size = rng.choice([0.01, 1.0, 30.0])
        half = size * rng.uniform(0.05, 0.5, (2, 3))
        axis, gap = rng.integers(3), rng.choice([0.0, 1e-9, 1e-6]) * size
        shift = rng.uniform(-1, 1, 3) * (half[0] + half[1]) * rng.choice([0.0, 0.5, 1.0], 3)
        shift[axis] = half[0, axis] + half[1, axis] + gap
        world = random_pose(rng, 30.0 * size)
        solids += [box(*(2 * half[0])), box(*(2 * half[1]))]
        pairs.append((2 * k, 2 * k + 1))
        first.append(compose(world, at(*shift)))
        second.append(world)
        gaps.append(gap)
        sizes.append(size)
    found = by_kernels(monkeypatch, solids, np.array(pairs), stacked(first), stacked(second), skip_above=np.inf)
    assert (np.abs(found - gaps) < 1e-3 * query_noise(1.0) * np.array(sizes)).all()


def test_slices_do_not_change_a_bit(monkeypatch):
    """Law: threads that only gather give equal bytes however the work is cut."""
    rng = np.random.default_rng(9)
    forest = Forest([random_shape(rng, kind) for kind in KINDS])
    pairs = rng.integers(0, len(KINDS), (400, 2)).astype(np.int32)
    poses = relative_poses(*(stacked([random_pose(rng, 0.5) for _ in pairs]) for _ in range(2)))
    wood = module.wood_on(forest, "cpu")
    touch = np.full(len(pairs), 1e-12)
    results = [module.descend(wood, pairs, poses, touch, np.full(len(pairs), 0.3), "cpu", slice_size=n) for n in (1, 7, 64, 400)]
    for one in results[1:]:
        for x, y in zip(results[0], one, strict=True):
            assert x.tobytes() == y.tobytes()
    rows = np.flatnonzero((results[0][1] & (results[0][0] <= touch)) | results[0][2])
    seen = []
    for size in (1, 5, len(rows)):
        monkeypatch.setattr(module, "DEPTH_SLICE", size)
        seen.append(module.depths(wood, pairs, poses, touch, rows, "cpu").tobytes())
    assert len(rows) > 50
    assert len(set(seen)) == 1


def test_containment_needs_a_closed_surface(monkeypatch):
    """Analytic: a ball in a ball; in the cavity of a hollow one; in an open shell; in a shell closed but for a promise."""
    core, shell = ball(0.2), ball(1.0)
    cavity = Solid(np.concatenate([ball(2.0).vertices, shell.vertices]), _joined(ball(2.0), shell), closed=True)
    leaky = Solid(shell.vertices, shell.faces[:-1], closed=True)
    bare = Solid(shell.vertices, shell.faces[:-1], closed=False)
    solids = [core, shell, cavity, leaky, bare]
    pairs = np.array([(0, k) for k in range(1, 5)])
    poses = stacked([at()] * 4)
    found = by_kernels(monkeypatch, solids, pairs, poses, poses, skip_above=0.01)
    assert found[0] == pytest.approx(-0.8, abs=0.05)
    assert found[1] > 0.01
    assert found[2] == pytest.approx(-0.8, abs=0.05)
    assert found[3] > 0.01


def _joined(outer: Solid, inner: Solid) -> np.ndarray:
    return np.concatenate([outer.faces, inner.faces[:, ::-1] + len(outer.vertices)]).astype(np.int32)


def test_a_ray_along_an_edge_is_settled_by_the_solid_angle(monkeypatch):
    """Points under vertices and edges of a ring, straight against the ray, are inside all the same."""
    from worldagent.geometry.clearance_kernels import RAY

    ray = np.array([float(x) for x in RAY])
    body = ring()
    grain = Solid(ball(0.01, 0).vertices, ball(0.01, 0).faces, closed=True)
    top = body.vertices[np.abs(body.vertices[:, 2] - 0.15) < 1e-9]
    inner = top[np.linalg.norm(top[:, :2], axis=1) < 0.4]
    middles = 0.5 * (inner + np.roll(inner, 1, axis=0)) * 1.3
    points = middles - 0.1 * ray
    # The first vertex of the grain, which the query tests, lies on the line.
    poses = stacked([RigidPose(p - grain.component_heads[0], np.array([1.0, 0, 0, 0])) for p in points])
    found = by_kernels(
        monkeypatch, [grain, body], np.tile([[0, 1]], (len(points), 1)), poses, stacked([at()] * len(points)), skip_above=1.0
    )
    expected = [signed_clearance(grain, RigidPose(p, np.array([1.0, 0, 0, 0])), body, at()).distance for p in poses[0]]
    assert found == pytest.approx(expected, abs=1e-12)
    assert (found < -0.01).any()


def test_repeats_are_answered_once(monkeypatch):
    ride = np.linspace(0, 1, 50)[:, None] * [1.0, 2.0, 0.5]
    turn = np.tile([1.0, 0, 0, 0], (50, 1))
    monkeypatch.setattr(module, "EFFORT", 0.0)
    pairs = np.repeat([[0, 1], [1, 0]], 50, axis=0)
    one = np.concatenate([ride, ride]), np.concatenate([turn, turn])
    two = np.concatenate([ride + np.array([0, 0, 1.25]), ride - np.array([0, 0, 1.5])]), one[1]
    found = clearance_batch([box(1, 1, 1), box(1, 1, 1)], pairs, one, two, skip_above=1.0)
    assert found.distance == pytest.approx(np.repeat([0.25, 0.5], 50), abs=1e-12)
    assert found.computed == 2


def test_many_overlaps_of_a_short_list_go_to_the_kernels(monkeypatch):
    """Choice: depths of bodies that are not convex are slow one by one; the answers stay the same."""
    rng = np.random.default_rng(3)
    solids = [ring(), ring(0.2, 0.5, 0.4)]
    pairs = np.tile([[0, 1]], (40, 1))
    poses = [stacked([random_pose(rng, 0.1) for _ in pairs]) for _ in range(2)]
    monkeypatch.setattr(module, "DEPTHS", 1000)
    patient = clearance_batch(solids, pairs, *poses, skip_above=0.1)
    monkeypatch.setattr(module, "DEPTHS", 3)
    found = clearance_batch(solids, pairs, *poses, skip_above=0.1)
    assert found.computed == patient.computed == patient.exact == 40
    assert found.exact < 40
    assert found.distance == pytest.approx(patient.distance, rel=2.0 * PRECISION, abs=1e-9)


@pytest.mark.parametrize("kernels", [False, True])
def test_a_depth_within_a_tolerance_is_never_too_large(monkeypatch, kernels):
    rng = np.random.default_rng(5)
    solids = [ring(), ring(0.2, 0.5, 0.4)]
    pairs = np.tile([[0, 1]], (12, 1))
    poses = [stacked([random_pose(rng, 0.1) for _ in pairs]) for _ in range(2)]
    monkeypatch.setattr(module, "DEPTHS", 0 if kernels else 1000)
    true = clearance_batch(solids, pairs, *poses, skip_above=0.1).distance
    rough = clearance_batch(solids, pairs, *poses, skip_above=0.1, care=Care(0.01)).distance
    assert (true < -0.01).sum() > 3
    assert (rough >= true - 2.0 * PRECISION * abs(true)).all()
    assert (rough <= true + 0.01 + 2.0 * PRECISION * abs(true)).all()


@pytest.mark.parametrize("kernels", [False, True])
def test_a_search_may_end_at_a_depth_that_is_enough(monkeypatch, kernels):
    """Law: a depth from `enough` on is answered by one from there on and no deeper; a lesser one as if nothing were enough."""
    monkeypatch.setattr(module, "DEPTHS", 0 if kernels else 1000)
    rng = np.random.default_rng(11)
    poses = [RigidPose(rng.uniform(-0.35, 0.35, size=3), at(quaternion=tuple(rng.normal(size=4))).quaternion) for _ in range(20)]
    solids, pairs = [ring(), ring(0.2, 0.5, 0.4)], np.tile([0, 1], (20, 1))
    placed = stacked([at()] * 20), stacked(poses)
    whole = clearance_batch(solids, pairs, *placed, skip_above=np.inf).distance
    enough = np.where(np.arange(20) % 2 == 0, 0.01, 10.0)
    short = clearance_batch(solids, pairs, *placed, skip_above=np.inf, care=Care(enough=enough)).distance
    deep = whole < -enough
    assert 3 < deep.sum() < 17
    assert (short[deep] <= -enough[deep]).all()
    assert (short[deep] >= whole[deep] * (1.0 + DEPTH)).all()
    assert np.array_equal(short[~deep], whole[~deep])


def test_trees_hold_every_box_once():
    rng = np.random.default_rng(2)
    groups = np.array([1, 2, 3, 100, 17])
    lower = rng.normal(size=(groups.sum(), 3))
    trees = grow(lower, lower + 0.1, groups, leaf=2)
    owner = np.repeat(np.arange(len(groups)), groups)
    for root in range(len(groups)):
        seen, stack = [], [root]
        while stack:
            node = stack.pop()
            if trees.span[node]:
                mine = trees.order[-1 - trees.link[node] :][: trees.span[node]]
                assert (lower[mine] >= trees.lower[node]).all()
                assert (lower[mine] + 0.1 <= trees.upper[node]).all()
                seen += mine.tolist()
            else:
                children = trees.link[node] + np.arange(2)
                assert (trees.lower[children] >= trees.lower[node]).all()
                assert (trees.upper[children] <= trees.upper[node]).all()
                stack += children.tolist()
        assert sorted(seen) == np.flatnonzero(owner == root).tolist()


def test_a_short_list_does_not_import_warp():
    code = (
        "import sys, numpy as np, trimesh; from worldagent.geometry import Solid, clearance_batch;"
        "from worldagent.worlds.built import TriangleMesh; m = trimesh.creation.box((1, 1, 1));"
        "s = Solid.from_mesh(TriangleMesh(np.array(m.vertices), np.array(m.faces, dtype=np.int32)), closed=True);"
        "p = np.array([[0.0, 0, 0], [0, 0, 1.5]]); q = np.tile([1.0, 0, 0, 0], (2, 1));"
        "print(clearance_batch([s], np.zeros((2, 2), int), (p, q), (p[::-1], q), skip_above=2.0).distance, 'warp' in sys.modules)"
    )
    answer = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout.split("]")[1].strip() == "False"


def test_an_unknown_device_is_refused():
    from worldagent.worlds.errors import InputError

    with pytest.raises(InputError, match="WORLDAGENT_DEVICE"):
        clearance_batch([box(1, 1, 1)], np.zeros((0, 2)), stacked([at()]), stacked([at()]), skip_above=1.0, device="cuda:99")


def test_the_kernels_compile_for_a_gpu(tmp_path):
    """No GPU is needed to compile for one (compute capability 9.0)."""
    from worldagent.geometry import clearance_kernels, depth_kernels
    from worldagent.geometry.launch import warp

    for kernels in (clearance_kernels, depth_kernels):
        warp().compile_aot_module(kernels, device=None, arch=90, module_dir=str(tmp_path), use_ptx=True)
    code = "".join(path.read_text() for path in tmp_path.glob("*.ptx"))
    for name in ("nearest", "contained", "deepest"):
        assert f".entry {name}" in code


def test_depths_that_are_of_no_interest_are_not_searched_for_and_deeper_ones_are_the_same(monkeypatch):
    """The contract of `Care.idle`: over it the depth, up to it any value down to minus it; and `clearance` is asked less."""
    rng = np.random.default_rng(3)
    drawn = [random_pair(rng) for _ in range(300)]
    solids = [s for a, _, b, _, _ in drawn for s in (a, b)]
    pairs = np.arange(2 * len(drawn)).reshape(-1, 2)
    poses = stacked([d[1] for d in drawn]), stacked([d[3] for d in drawn])
    monkeypatch.setattr(module, "EFFORT", 0.0)
    exact = clearance_batch(solids, pairs, *poses, skip_above=np.inf)
    sizes = np.array([a.size + b.size for a, _, b, _, _ in drawn])
    # In turn none, half of the depth, and half as much again.
    idle = np.maximum(-exact.distance, 0.0) * np.array([0.0, 0.5, 1.5])[np.arange(len(drawn)) % 3]
    told = clearance_batch(solids, pairs, *poses, skip_above=np.inf, care=Care(idle=idle))
    depth = -exact.distance
    deep, apart = depth > idle * (1.0 + DEPTH), exact.distance > 0.0
    between = ~deep & ~apart
    assert deep.sum() > 30
    assert (between & (idle > 0.0)).sum() > 30
    assert np.allclose(told.distance[deep], exact.distance[deep], rtol=2.0 * PRECISION, atol=0.0)
    assert (told.distance[apart] == exact.distance[apart]).all()
    assert (told.distance[between] >= -idle[between] * (1.0 + DEPTH) - 1e-9 * sizes[between]).all()
    assert (told.distance[between & (idle > 1e-6 * sizes)] < 0.0).all()
    assert told.exact <= exact.exact


def test_bodies_in_one_place_overlap_fully_whatever_is_of_no_interest(monkeypatch):
    """A ring in its own place has no point inside itself: no depth is over `idle`, and the bodies overlap fully all the same."""
    one = ring()
    poses = stacked([at(0, 0, 0)] * 2), stacked([at(0, 0, 0), at(5, 0, 0)])
    found = by_kernels(
        monkeypatch, [one, one], np.array([[0, 1], [0, 1]]), *poses, skip_above=0.1, care=Care(idle=1e-3 * one.size)
    )
    full = by_kernels(monkeypatch, [one, one], np.array([[0, 1], [0, 1]]), *poses, skip_above=0.1)
    assert full[0] < -1e-3 * one.size
    assert found[0] == full[0]
