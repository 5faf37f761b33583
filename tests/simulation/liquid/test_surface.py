"""Surfaces of particles: closed, of the right volume, still when the liquid is still, and bound to the particles they show."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree
from worldagent.simulation.liquid import foam, surface_mesh
from worldagent.simulation.liquid.surface import SurfaceSettings, default_settings, mesh_surfaces, surface_frame
from worldagent.simulation.liquid.surround import carried, clumps, crowding, surroundings
from worldagent.worlds.arrays import F64
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.cache import Cache, CacheIndex, write_container
from worldagent.worlds.categories.liquid.surface import LiquidSurface, mesh_of
from worldagent.worlds.channels import QUANTITIES
from worldagent.worlds.errors import EvidenceError, InputError

S = 0.02
"""Spacing of the particles [m]."""


def lattice(*count: int) -> F64:
    axes = [(np.arange(k) + 0.5) * S for k in count]
    return np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)


def jittered(points: F64, amount: float, seed: int = 0) -> F64:
    return points + np.random.default_rng(seed).normal(0, amount * S, points.shape)


def channels(position: F64, velocity: F64 | None = None, fluid: Any = 0, volume: float = S**3) -> dict[str, Any]:
    n = len(position)
    return {
        "origin": np.array([10.0, -4.0, 0.5]),
        "particle/position": position.astype(np.float32),
        "particle/velocity": (np.zeros((n, 3)) if velocity is None else velocity).astype(np.float32),
        "particle/id": np.arange(n, dtype=np.int32),
        "particle/fluid": np.broadcast_to(np.asarray(fluid, dtype=np.int32), n).copy(),
        "particle/volume": np.full(n, volume, dtype=np.float32),
    }


def make_cache(folder: Path, frames: list[dict[str, Any]], engine: str = "dfsph") -> Cache:
    cache = Cache(folder / "water")
    cache.folder.mkdir()
    cache.write_index(CacheIndex("water", engine, 24, len(frames), ("water",), (), (), (), "", {}))
    cache.begin_digests([write_container(cache.path(k), data) for k, data in enumerate(frames)])
    return cache


def volume_ratio(position: F64, **options: float) -> float:
    mesh = surface_mesh.reconstruct(position, 0 * position, 0 * position[:, 0], S, **options)
    return surface_mesh.closed_volume(mesh.vertices, mesh.faces) / (len(position) * S**3)


@pytest.mark.parametrize("disorder", [0.0, 0.05, 0.1])
def test_a_pool_at_rest_has_the_volume_of_its_particles_within_a_percent_and_a_level_face(disorder: float) -> None:
    pool = jittered(lattice(30, 30, 14), disorder)
    mesh = surface_mesh.reconstruct(pool, 0 * pool, 0 * pool[:, 0], S)
    top = mesh.vertices[(np.abs(mesh.vertices[:, :2] - 0.3) < 0.2).all(1) & (mesh.vertices[:, 2] > 0.2), 2]
    assert surface_mesh.closed_volume(mesh.vertices, mesh.faces) == pytest.approx(len(pool) * S**3, rel=0.01)
    assert top.mean() == pytest.approx(14 * S, abs=0.02 * S)
    assert top.std() < 0.6 * disorder * S + 1e-3 * S
    assert trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).is_watertight


def test_a_ragged_face_is_drawn_where_the_volume_has_it_and_lost_volume_is_not_made_up() -> None:
    """Law: volume of rest. A surface offset of 0.15 spacings at most is drawn out, so a pool pressed together by a fifth is drawn smaller, and
    0.5 drawn in, so one that is spread by a fifth is drawn larger."""
    still = lattice(16, 16, 6)
    top = still[:, 2] > 5 * S
    ragged = still - top[:, None] * np.array([0.0, 0.0, 0.2 * S]) * (np.arange(len(still)) // 6 % 2)[:, None]
    low, high = (0.0, 0.0, 0.0), (16 * S, 16 * S, 10 * S)
    walls = SurfaceSettings(
        S, lower=tuple(np.add(low, [10, -4, 0.5])), upper=tuple(np.add(high, [10, -4, 0.5])), closed=(True,) * 5 + (False,)
    )
    ratio = []
    for place in (still, ragged, still * [1, 1, 0.8], still * [1, 1, 1.2]):
        found, _ = surface_frame(channels(place), walls, dt=1 / 24)
        ratio.append(float(found["record/surface_volume"]) / (len(still) * S**3))
    assert ratio[:2] == pytest.approx([1.0, 1.0], abs=2e-3)
    assert ratio[2] < 0.9
    assert ratio[3] > 1.1


def test_water_that_swings_off_the_wall_of_its_vessel_is_drawn_with_no_more_volume_than_it_has() -> None:
    """Law: volume. A glass of water that was knocked over was drawn a tenth too large and shrank as it broke into drops: the row `pop` failed."""
    column = lattice(8, 8, 10)
    corner = np.array([10, -4, 0.5])
    ratio = []
    for gap in (0.0, 0.2):
        walls = SurfaceSettings(
            S,
            lower=tuple(corner),
            upper=tuple(np.add(corner, [(8 + gap) * S, 8 * S, 16 * S])),
            closed=(True,) * 5 + (False,),
        )
        found, _ = surface_frame(channels(column), walls, dt=1 / 24)
        ratio.append(float(found["record/surface_volume"]) / (len(column) * S**3))
    assert ratio == pytest.approx([1.0, 1.0], abs=0.01)


@pytest.mark.parametrize("radius", [4, 6, 10])
def test_a_ball_of_particles_keeps_volume_and_area_of_a_ball_although_it_is_smoothed(radius: int) -> None:
    grid = lattice(24, 24, 24) - 12 * S
    ball = jittered(grid[np.linalg.norm(grid, axis=1) < radius * S], 0.05)
    mesh = surface_mesh.reconstruct(ball, 0 * ball, 0 * ball[:, 0], S)
    true = (3 * len(ball) * S**3 / (4 * np.pi)) ** (1 / 3)
    assert surface_mesh.closed_volume(mesh.vertices, mesh.faces) == pytest.approx(len(ball) * S**3, rel=0.03)
    assert surface_mesh.area(mesh.vertices, mesh.faces) == pytest.approx(4 * np.pi * true**2, rel=0.035)


def test_markers_of_a_grid_make_a_face_without_holes(tmp_path: Path) -> None:
    cell, rng = 2 * S, np.random.default_rng(1)
    corner = np.stack(np.meshgrid(*[np.arange(k) * cell for k in (14, 14, 8)], indexing="ij"), -1).reshape(-1, 1, 3)
    markers = (corner + rng.uniform(0, cell, (len(corner), 8, 3))).reshape(-1, 3)
    cache = make_cache(tmp_path, [channels(markers)], engine="flip")
    settings = default_settings(cache)
    assert settings.spacing == pytest.approx(S)
    found, _ = surface_frame(cache.read(0), settings, dt=1 / 24)
    assert found["record/surface_volume"] + found["record/spray_volume"] == pytest.approx(len(markers) * S**3, rel=0.02)
    assert found["record/surface_components"] == 1


def test_the_surface_of_a_still_pool_stands_still_and_moves_as_far_as_its_particles() -> None:
    """Law: cubes and weights do not depend on where the particles begin, so nothing pops."""
    pool = jittered(lattice(24, 24, 10), 0.05)

    def vertices(points: F64) -> F64:
        return surface_mesh.reconstruct(points, 0 * points, 0 * points[:, 0], S).vertices

    before = vertices(pool)
    mesh = surface_mesh.reconstruct(jittered(pool, 0.01, seed=5), 0 * pool, 0 * pool[:, 0], S)
    near = cKDTree(mesh.vertices).query(before)[1]
    normals = surface_mesh.vertex_normals(mesh.vertices, mesh.faces)[0]
    stirred = np.abs(((before - mesh.vertices[near]) * normals[near]).sum(1))
    assert stirred.mean() < 0.01 * S
    assert np.quantile(stirred, 0.99) < 0.05 * S
    apart = vertices(np.concatenate([pool, [[-0.9, -0.7, 0.9]]]))
    assert cKDTree(apart).query(before)[0].max() < 1e-6 * S
    lifted = vertices(pool + np.array([0, 0, 0.2 * S]))
    top = [v[(v[:, 2] > 8 * S) & (np.abs(v[:, :2] - 12 * S) < 8 * S).all(1), 2].mean() for v in (before, lifted)]
    assert top[1] - top[0] == pytest.approx(0.2 * S, abs=0.02 * S)


def test_the_same_particles_give_the_same_bytes(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    pool = jittered(lattice(40, 30, 14), 0.1)
    data = channels(pool, rng.normal(0, 2, pool.shape))
    digests = set()
    for name in ("a", "b", "c"):
        (tmp_path / name).mkdir()
        digests.add(mesh_surfaces(make_cache(tmp_path / name, [data, data])).digest())
    assert len(digests) == 1


def test_values_at_a_surface_are_kernel_means_of_the_particles_near_and_crowding_counts_neighbours_up_to_enough() -> None:
    """Against sums over all pairs, with the cubic spline's values at 0, 1/2 and 1 of its support (1, 1/4, 0)."""
    rng = np.random.default_rng(2)
    place, points = rng.uniform(0, 8 * S, (300, 3)), np.concatenate([rng.uniform(-S, 9 * S, (200, 3)), [[1.0, 1.0, 1.0]]])
    values, support = rng.normal(0, 1, (300, 2)), 2 * S
    q = np.linalg.norm(points[:, None] - place, axis=2) / support
    weight = np.where(q < 0.5, 1 - 6 * q**2 + 6 * q**3, np.where(q < 1, 2 * np.clip(1 - q, 0, 1) ** 3, 0.0))
    total = weight.sum(1)
    means = (weight @ values) / np.where(total > 0, total, 1)[:, None]
    assert (total[:-1] > 0).mean() > 0.9
    assert carried(points, place, values, support) == pytest.approx(np.where(total[:, None] > 0, means, 0.0), abs=1e-12)
    apart = np.linalg.norm(place[:, None] - place, axis=2) / support
    number = np.clip(1 - apart**2, 0, None).sum(1) - 1
    assert crowding(place, support, 1e9) == pytest.approx(number, abs=1e-9)
    some = float(np.median(number))
    assert crowding(place, support, some) == pytest.approx(np.minimum(number, some), abs=1e-9)


def test_sheets_and_strands_are_liquid_while_drops_and_lone_particles_are_spray() -> None:
    sheet, pool = lattice(20, 20, 1) + np.array([0, 0, 1.0]), lattice(12, 12, 6)
    drop, lone = lattice(2, 2, 2) + np.array([1.0, 0, 0]), np.array([[2.0, 2.0, 2.0], [2.0, 2.5, 2.0]])
    points = np.concatenate([sheet, pool, drop, lone])
    around = surroundings(points, 0 * points, S)
    spray = foam.spray_of(around.count, clumps(points, S), np.zeros(len(points), dtype=bool))
    corner = np.argsort(around.count[: len(sheet)], kind="stable")[:4]
    assert not np.delete(spray[: len(sheet) + len(pool)], corner).any()
    assert spray[len(sheet) + len(pool) :].all()


def test_spray_does_not_flicker_at_the_limit() -> None:
    count, clump, was = np.full(2, foam.ALONE + 1, np.int32), np.full(2, 1000), np.array([True, False])
    assert foam.spray_of(count, clump, was).tolist() == [True, False]


def test_breaking_water_foams_calm_and_evenly_moving_water_does_not() -> None:
    pool = jittered(lattice(16, 16, 8), 0.05)
    identity, liquid = np.arange(len(pool), dtype=np.int32), np.ones(len(pool), dtype=bool)

    def foaming(velocity: F64) -> float:
        around = surroundings(pool, velocity, S)
        return float(foam.grow_foam(identity, velocity, around, liquid, None, 1 / 24)[1].sum())

    assert foaming(0 * pool) == 0
    assert foaming(np.broadcast_to([3.0, 0, 0], pool.shape).copy()) == 0
    beaten = np.random.default_rng(0).normal(0, 2.0, pool.shape)
    assert foaming(beaten) > 10
    around = surroundings(pool, beaten, S)
    state, _ = foam.grow_foam(identity, beaten, around, liquid, None, 1 / 24)
    later = state
    for _ in range(120):
        later, _ = foam.grow_foam(identity, 0 * pool, surroundings(pool, 0 * pool, S), liquid, later, 1 / 24)
    assert len(state.identity) > 0
    assert len(later.identity) == 0


def box(low: list[float], high: list[float]) -> TriangleMesh:
    mesh = trimesh.creation.box(bounds=[low, high])
    return TriangleMesh(np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces, dtype=np.int32))


def test_water_in_a_tank_lies_against_its_walls(tmp_path: Path) -> None:
    """No air between water and glass: the surface reaches into the wall by less than a tenth of a spacing."""
    data = channels(jittered(lattice(20, 16, 10), 0.05))
    x, y, t = 20 * S, 16 * S, 0.01
    local = [
        box([-t, -t, -t], [x + t, y + t, 0]),
        box([-t, 0, 0], [0, y, 0.4]),
        box([x, 0, 0], [x + t, y, 0.4]),
        box([-t, -t, 0], [x + t, 0, 0.4]),
        box([-t, y, 0], [x + t, y + t, 0.4]),
    ]
    walls = [TriangleMesh(w.vertices + data["origin"], w.faces) for w in local]
    settings = SurfaceSettings(S)
    found, _ = surface_frame(data, settings, dt=1 / 24, walls=walls)
    vertices = found["surface/vertices"].astype(np.float64)
    inner = vertices[(vertices[:, 2] < 8 * S) & (vertices[:, 2] > 2 * S)]
    gap = np.minimum(np.minimum(inner[:, 0], x - inner[:, 0]), np.minimum(inner[:, 1], y - inner[:, 1]))
    assert gap.max() < 0.5 * S
    assert gap.min() > -0.1 * S
    assert np.median(gap) == pytest.approx(-0.02 * S, abs=0.01 * S)
    side = SurfaceSettings(S, lower=tuple(data["origin"]), upper=tuple(data["origin"] + [x, y, 1]), closed=(True,) * 5 + (False,))
    other, _ = surface_frame(data, side, dt=1 / 24)
    for each in (found, other):
        assert each["record/surface_volume"] == pytest.approx(20 * 16 * 10 * S**3, rel=0.01)
        assert trimesh.Trimesh(each["surface/vertices"], each["surface/faces"], process=False).is_watertight


def test_two_liquids_get_a_mesh_each_and_cavities_below_resolution_are_filled() -> None:
    block = lattice(10, 10, 10)
    hollow = block[np.linalg.norm(block - 5 * S, axis=1) > 1.2 * S]
    data = channels(np.concatenate([hollow, block + np.array([0.5, 0, 0])]), fluid=np.repeat([0, 1], [len(hollow), len(block)]))
    found, _ = surface_frame(data, SurfaceSettings(S), dt=1 / 24)
    assert found["record/surface_components"] == 2
    assert set(found["surface/fluid"]) == {0, 1}
    low = mesh_of(found, 0)[0]
    assert low[:, 0].max() < 10.25
    assert surface_mesh.closed_volume(*mesh_of(found, 0)) == pytest.approx(1000 * S**3, rel=0.01)


def pool_frames(count: int) -> list[dict[str, Any]]:
    pool = lattice(10, 10, 6)
    return [channels(jittered(pool, 0.05, seed=k), np.random.default_rng(k).normal(0, 2, pool.shape)) for k in range(count)]


def test_surfaces_resume_where_they_were_stopped_and_end_equal(tmp_path: Path) -> None:
    cache = make_cache(tmp_path, pool_frames(4))
    whole = mesh_surfaces(cache).digest()
    shutil.rmtree(cache.folder / "surface")

    def stop_after(done: int, total: int, text: str) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        mesh_surfaces(cache, progress=stop_after)
    assert LiquidSurface(cache).count() == 2
    told: list[int] = []
    again = mesh_surfaces(cache, progress=lambda done, total, text: told.append(done))
    assert told == [3, 4]
    assert again.digest() == whole
    assert mesh_surfaces(cache, progress=lambda done, total, text: told.append(done)).digest() == whole
    assert told == [3, 4]


def test_an_altered_surface_and_one_of_other_particles_are_noticed(tmp_path: Path) -> None:
    frames = pool_frames(2)
    cache = make_cache(tmp_path, frames)
    surface = mesh_surfaces(cache)
    found = dict(surface.read(1))
    found["surface/vertices"] = found["surface/vertices"] * np.float32(1.01)
    write_container(surface.files.path(1), found)
    with pytest.raises(EvidenceError, match="altered"):
        LiquidSurface(cache).read(1)
    other = channels(frames[0]["particle/position"] + np.float32(0.001))
    cache.begin_digests([write_container(cache.path(0), other), cache.digests()[1]])
    with pytest.raises(EvidenceError, match="other particles"):
        LiquidSurface(cache).read(0)
    mended = mesh_surfaces(cache)
    assert mended.records(0)["surface_volume"] > 0
    assert mended.records(1)["surface_volume"] > 0


def test_a_liquid_without_any_particle_is_refused_and_an_empty_frame_is_not(tmp_path: Path) -> None:
    empty = channels(np.empty((0, 3)))
    (tmp_path / "none").mkdir()
    with pytest.raises(InputError, match="no particle"):
        mesh_surfaces(make_cache(tmp_path / "none", [empty]))
    cache = make_cache(tmp_path, [empty, pool_frames(1)[0]])
    surface = mesh_surfaces(cache)
    assert surface.records(0) == {"surface_volume": 0, "surface_area": 0, "surface_components": 0, "spray_volume": 0}
    assert surface.records(1)["surface_components"] == 1


def test_what_is_recorded_of_surfaces_is_registered_and_readable_as_series(tmp_path: Path) -> None:
    surface = mesh_surfaces(make_cache(tmp_path, pool_frames(2)))
    assert set(surface.records(1)) == {n for n, q in QUANTITIES.items() if "surface" in q.of}
    assert surface.files.series("record/surface_volume") == pytest.approx(600 * S**3, rel=0.02)


def test_foam_lies_on_the_free_surface_and_not_against_walls() -> None:
    pool = jittered(lattice(16, 16, 10), 0.05)
    data = channels(pool, np.random.default_rng(0).normal(0, 2.0, pool.shape))
    low, high = data["origin"], data["origin"] + 16 * S
    closed = (True, True, True, True, True, False)
    bare, _ = surface_frame(data, SurfaceSettings(S), dt=1 / 24)
    held, _ = surface_frame(data, SurfaceSettings(S, lower=tuple(low), upper=tuple(high), closed=closed), dt=1 / 24)
    walls = [box([-0.02, -0.02, -0.02], [16 * S + 0.02, 16 * S + 0.02, 0])]
    floored, _ = surface_frame(
        data, SurfaceSettings(S), dt=1 / 24, walls=[TriangleMesh(w.vertices + low, w.faces) for w in walls]
    )
    heights = [found["foam/position"][:, 2] for found in (bare, held, floored)]
    assert (heights[0] < 0.3 * S).sum() > 20
    assert heights[2].min() > 0.3 * S
    sides = held["foam/position"][:, :2]
    assert np.minimum(sides, 16 * S - sides).min() > 0.3 * S
    assert 20 < len(heights[1]) < len(heights[2]) < len(heights[0])
