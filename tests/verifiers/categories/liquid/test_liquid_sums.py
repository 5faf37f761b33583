"""Sums of the judge of liquids, by kernels and grids, against brute force and formulas."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from worldagent.geometry import Solid
from worldagent.testing.defects import _liquid_scenes as scenes
from worldagent.testing.worlds.liquid_worlds import lattice
from worldagent.verifiers.categories.clumps import clumps_of
from worldagent.verifiers.categories.liquid import density as liquid_density
from worldagent.verifiers.categories.liquid.barriers import Barrier
from worldagent.verifiers.categories.liquid.density import crowding_of
from worldagent.verifiers.categories.liquid.frames import liquid_of
from worldagent.verifiers.categories.liquid.leaks import _joined
from worldagent.verifiers.categories.liquid.samples import samples
from worldagent.verifiers.categories.liquid.solids import Piece
from worldagent.verifiers.categories.liquid.surface import _measures
from worldagent.worlds.arrays import F64
from worldagent.worlds.built import TriangleMesh


def piece_of(mesh: trimesh.Trimesh) -> Piece:
    solid = Solid.from_mesh(TriangleMesh(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int32)), closed=True)
    return Piece("it", "body", "p", solid, np.zeros((1, 3)), np.eye(3)[None], True, True)


def test_depth_in_a_ring_is_that_of_its_formula() -> None:
    piece = piece_of(trimesh.creation.torus(1.0, 0.3, major_sections=96, minor_sections=48))
    points = np.random.default_rng(0).uniform(-1.3, 1.3, (4000, 3)) * [1, 1, 0.3]
    true = 0.3 - np.hypot(np.hypot(points[:, 0], points[:, 1]) - 1.0, points[:, 2])
    found = piece.depth(points)
    assert np.abs(found - true)[found > -1.0].max() < 2e-3
    assert ((found > 0) == (true > 0))[np.abs(true) > 2e-3].all()


def test_depth_in_a_box_is_exact() -> None:
    piece = piece_of(trimesh.creation.box((1.0, 2.0, 3.0)))
    points = np.random.default_rng(0).uniform(-1, 1, (500, 3)) * [0.4, 0.9, 1.4]
    true = (np.array([0.5, 1.0, 1.5]) - np.abs(points)).min(axis=1)
    assert piece.depth(points) == pytest.approx(true, abs=1e-12)


def brute(points: F64, velocity: F64, volume: float, support: float) -> tuple[F64, F64]:
    way = points[:, None] - points
    q = np.linalg.norm(way, axis=2) / support
    scale = 8.0 / (np.pi * support**3)
    kernel = scale * np.where(q > 1, 0.0, np.where(q > 0.5, 2 * (1 - q) ** 3, 6 * q**2 * (q - 1) + 1))
    slope = scale / support * np.where(q > 1, 0.0, np.where(q > 0.5, -6 * (1 - q) ** 2, 6 * q * (3 * q - 2)))
    along = np.einsum("ijk,ijk->ij", velocity[None] - velocity[:, None], way) / np.maximum(np.linalg.norm(way, axis=2), 1e-12)
    return volume * kernel.sum(axis=1), volume * (slope * along).sum(axis=1)


def test_crowding_and_divergence_are_those_of_all_pairs(tmp_path: Path) -> None:
    """A field that swells evenly, v = x, has divergence 3 in the bulk."""
    flow = scenes.falling(np.random.default_rng(2), frames=2)
    liquid = liquid_of(flow.candidate(tmp_path), "water")
    frame = liquid.read(0)
    rng = np.random.default_rng(0)
    object.__setattr__(frame, "position", frame.position + rng.normal(0, 0.1 * scenes.SPACING, frame.position.shape))
    object.__setattr__(frame, "velocity", frame.position - frame.position.mean(axis=0))
    filled, spread, count, _ = crowding_of(liquid, frame)
    wanted = brute(frame.position, frame.velocity, flow.volume, 2.0 * liquid.pitch)
    assert filled == pytest.approx(wanted[0], rel=2e-4)
    assert spread == pytest.approx(wanted[1], rel=2e-3, abs=2e-3)
    assert count.max() <= 45


def test_a_full_lattice_fills_its_space_and_swells_as_it_is_told(tmp_path: Path) -> None:
    flow = scenes.block((0.2, 0.2, 0.2), (0, 0, 2.2), frames=2)
    liquid = liquid_of(flow.candidate(tmp_path), "water")
    frame = liquid.read(0)
    object.__setattr__(frame, "velocity", frame.position - np.array([0, 0, 2.2]))
    filled, spread, count, _ = crowding_of(liquid, frame)
    bulk = count >= 26
    assert bulk.sum() >= 6**3
    assert filled[bulk] == pytest.approx(1.0, abs=2e-3)
    assert spread[bulk] == pytest.approx(3.0, rel=0.05)


def test_clumps_part_where_a_cube_is_empty() -> None:
    a, b = lattice((0, 0, 0), (0.2, 0.2, 0.2), 0.02), lattice((0.35, 0, 0), (0.1, 0.1, 0.1), 0.02)
    label = clumps_of(np.concatenate([a, b]), 0.06)
    assert len(np.unique(label)) == 2
    assert len(np.unique(label[: len(a)])) == 1
    assert len(np.unique(clumps_of(np.concatenate([a, b - [0.12, 0, 0]]), 0.06))) == 1


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.785])
@pytest.mark.parametrize(("gap", "open_"), [(0.0, False), (0.002, False), (0.004, False), (0.05, True)])
def test_cubes_close_slits_that_are_narrower_and_leave_wide_ways_open(angle: float, gap: float, open_: bool) -> None:
    """Two plates side by side, aslant to the cubes: the way through the slit between them."""
    plates = [trimesh.creation.box((0.3, 0.6, 0.03)), trimesh.creation.box((0.3, 0.6, 0.03))]
    for plate, sign in zip(plates, (-1.0, 1.0), strict=True):
        plate.apply_translation((sign * (0.15 + gap / 2), 0, 0))
        plate.apply_transform(trimesh.transformations.rotation_matrix(angle, (0.2, 1.0, 0.3)))
    barrier = Barrier(tuple(piece_of(p) for p in plates), np.full(3, -0.2), np.full(3, 0.2), 0.01)
    up = trimesh.transformations.rotation_matrix(angle, (0.2, 1.0, 0.3))[:3, 2]
    ends, inside = barrier.cells(np.stack([-0.05 * up, 0.05 * up]))
    assert inside.all()
    assert _joined(barrier, ends, 8) == open_


def test_samples_cover_a_surface_evenly() -> None:
    solid = piece_of(trimesh.creation.cylinder(0.2, 0.5)).solid
    points, normals = samples(solid, 0.02, solid.lower, solid.upper)
    from scipy.spatial import cKDTree

    asked, _ = trimesh.sample.sample_surface(trimesh.Trimesh(solid.vertices, solid.faces), 2000, seed=1)
    assert cKDTree(points).query(asked)[0].max() <= 0.02
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0)


def test_some_particles_tell_the_means_of_all(tmp_path: Path) -> None:
    """Values of some particles equal those among all, and their means are near those of all."""
    flow = scenes.block((0.4, 0.3, 0.2), (0, 0, 2.2), frames=2)
    liquid = liquid_of(flow.candidate(tmp_path), "water")
    frame = liquid.read(0)
    rng = np.random.default_rng(3)
    object.__setattr__(frame, "position", frame.position + rng.normal(0, 0.1 * scenes.SPACING, frame.position.shape))
    object.__setattr__(frame, "velocity", rng.normal(0, 1.0, frame.position.shape))
    everything = crowding_of(liquid, frame)
    some = crowding_of(liquid, frame, 1000)
    assert len(everything[0]) == frame.count > 2000
    assert len(np.unique(some[3])) == len(some[0]) == 1000
    assert all(np.array_equal(a[some[3]], b) for a, b in zip(everything[:3], some[:3], strict=True))
    assert some[0].mean() == pytest.approx(everything[0].mean(), rel=0.01)
    assert np.abs(some[1]).mean() == pytest.approx(np.abs(everything[1]).mean(), rel=0.05)


def test_crowding_is_the_same_where_far_cells_share_their_places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    flow = scenes.block((0.4, 0.3, 0.2), (0, 0, 2.2), frames=2)
    liquid = liquid_of(flow.candidate(tmp_path), "water")
    plain = crowding_of(liquid, liquid.read(0))
    monkeypatch.setattr(liquid_density, "MOST_CELLS", 100)
    shared = crowding_of(liquid, liquid.read(0))
    assert all(np.array_equal(a, b) for a, b in zip(plain[1:], shared[1:], strict=True))
    assert shared[0] == pytest.approx(plain[0], rel=1e-6)


def test_ways_and_the_cubes_beside_them_are_those_of_a_plain_search() -> None:
    """Two plates aslant: against the same questions asked point by point."""
    rng = np.random.default_rng(5)
    plate = trimesh.creation.box((0.3, 0.6, 0.03))
    plate.apply_transform(trimesh.transformations.rotation_matrix(0.4, (0.2, 1.0, 0.3)))
    barrier = Barrier((piece_of(plate),), np.full(3, -0.2), np.full(3, 0.2), 0.01)
    start, end = rng.uniform(-0.25, 0.25, (2, 400, 3))

    def is_closed(points: np.ndarray) -> np.ndarray:
        cell, inside = barrier.cells(points)
        found = np.zeros(len(points), dtype=bool)
        found[inside] = barrier.closed[tuple(cell[inside].T)]
        return found

    count = 4 ** (1 + np.floor(np.log(np.ceil(np.linalg.norm(end - start, axis=1) / 0.005) + 1) / np.log(4) + 1e-9).astype(int))
    wanted = [
        bool(is_closed(a + np.linspace(0, 1, n)[1:-1, None] * (b - a)).any()) for a, b, n in zip(start, end, count, strict=True)
    ]
    assert barrier.blocked(start, end).tolist() == wanted
    assert 20 < sum(wanted) < 380

    steps = np.stack(np.meshgrid(*[np.arange(-2, 3)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    shut = start[is_closed(start)]
    beside = barrier.beside(shut)
    assert len(shut) > 5
    for point, found in zip(shut, beside, strict=True):
        middles = barrier.low + (barrier.cells(point[None])[0] + steps + 0.5) * 0.01
        middles = middles[~is_closed(middles)]
        gaps = np.linalg.norm(middles - point, axis=1)
        assert np.isnan(found[0]) if not len(gaps) else np.linalg.norm(found - point) == pytest.approx(gaps.min(), abs=1e-12)


def test_a_mesh_is_measured_and_every_open_edge_of_it_counted() -> None:
    ball = trimesh.creation.icosphere(3, 0.3)
    volume, area, gaps = _measures(ball.vertices + 5.0, ball.faces)
    assert [volume, area] == pytest.approx([ball.volume, ball.area], rel=1e-9)
    assert gaps == 0
    assert _measures(ball.vertices, ball.faces[1:])[2] == 3
    turned = ball.faces.copy()
    turned[7] = turned[7, ::-1]
    assert _measures(ball.vertices, turned)[2] == 6


def test_no_particle_that_a_turning_barrier_may_meet_is_left_out() -> None:
    """A bar that turns and moves through a cloud: every way that leads through its space, seen from it, is among those that it follows."""
    rng = np.random.default_rng(7)
    solid = piece_of(trimesh.creation.box((0.6, 0.1, 0.1))).solid
    angle = 0.3
    turn = np.stack([np.eye(3), trimesh.transformations.rotation_matrix(angle, (0.3, 1.0, 0.2))[:3, :3]])
    bar = Piece("bar", "body", "p", solid, np.array([[0.0, 0, 0], [0.3, 0.1, 0]]), turn, False, True)
    barrier = Barrier((bar,), np.array([-0.35, -0.1, -0.1]), np.array([0.35, 0.1, 0.1]), 0.02)
    before = rng.uniform(-2, 2, (60_000, 3))
    now = before + rng.normal(0, 0.1, before.shape)
    longest = float(np.linalg.norm(now - before, axis=1).max())
    start, end = bar.local(before, 0), bar.local(now, 1)
    share = np.linspace(0, 1, 101)[:, None, None]
    way = start + share * (end - start)
    meets = ((way >= barrier.low) & (way <= barrier.high)).all(axis=2).any(axis=0)
    found = barrier.met(now, before, longest, 1)
    assert meets.sum() > 50
    assert found[meets].all()
    assert found.mean() < 0.6
