"""Camera and id caster."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from worldagent.geometry import Camera, IdCaster, camera_at, idcast
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.errors import InputError
from worldagent.worlds.spec import Shot

from .meshes import at, mesh_of, random_pose


def camera(position=(0.0, -5.0, 0.0), target=(0.0, 0.0, 0.0), fov=40.0, size=(160, 90)) -> Camera:
    return Camera(np.array(position), np.array(target), fov, *size)


def test_the_picture_is_right_handed_with_z_up():
    """Looking along +y: +x is to the right, +z is up, pixel rows run down."""
    pixels, depth = camera().project(np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -6.0, 0]]))
    assert pixels[0, 0] > 80
    assert pixels[1, 1] < 45
    assert depth == pytest.approx([5.0, 5.0, -1.0])
    assert np.isnan(pixels[2]).all()
    assert camera().in_frame(np.array([[0.0, 0, 0], [0, -6.0, 0], [9.0, 0, 0]])).tolist() == [True, False, False]


def test_straight_down_has_y_up():
    view = camera((0, 0, 5.0))
    assert view.axes == pytest.approx(np.eye(3))


def test_rays_project_back_to_their_pixels():
    view = camera((3.0, -4.0, 2.0), (0.2, 0.1, 0.5), 55.0)
    origin, directions = view.rays()
    pixels, _ = view.project(origin + 3.7 * directions.reshape(-1, 3))
    x, y = np.meshgrid(np.arange(160) + 0.5, np.arange(90) + 0.5)
    assert pixels == pytest.approx(np.stack([x, y], axis=-1).reshape(-1, 2), abs=1e-9)


def test_an_impossible_camera_is_refused():
    with pytest.raises(InputError, match="target"):
        camera((0, 0, 0))


def shot(*keys: dict) -> Shot:
    return Shot.model_validate({"frames": [0, 40], "keys": {f"k{i}": k for i, k in enumerate(keys)}})


def test_shots_pass_their_keys_and_stand_still_outside():
    plan = shot(
        {"frame": 10, "position": (0, 0, 1), "target": (0, 1, 1), "fov_deg": 30},
        {"frame": 20, "position": (1, 0, 1), "target": (0, 2, 1), "fov_deg": 50},
        {"frame": 40, "position": (5, 0, 1), "target": (0, 2, 1), "fov_deg": 50},
    )
    views = [camera_at(plan, f, 64, 36, None) for f in range(50)]
    for frame, x in ((0, 0.0), (10, 0.0), (20, 1.0), (40, 5.0), (49, 5.0)):
        assert views[frame].position[0] == pytest.approx(x)
    path = np.array([v.position[0] for v in views])
    assert (np.diff(path) >= -1e-12).all()
    assert views[15].fov_deg == pytest.approx(40.0)
    assert path[11] < 0.1, "eases in"
    assert all(v.target[1] <= 2.0 + 1e-12 for v in views), "no overshoot at a key that holds"


def test_a_follow_shot_moves_the_target_only():
    plan = shot({"frame": 0, "position": (0, 0, 1), "target": (0, 1, 1)})
    view = camera_at(plan, 5, 64, 36, np.array([0.5, 0, 0]))
    assert view.target == pytest.approx([0.5, 1, 1])
    assert view.position == pytest.approx([0, 0, 1])


def test_visible_areas_are_those_of_the_pinhole():
    """Analytic: a square of 1 m at 4.5 m depth and a sphere, within the pixels of their outlines."""
    view = camera(size=(640, 360))
    caster = IdCaster([mesh_of(trimesh.creation.box((1, 1, 1))), mesh_of(trimesh.creation.icosphere(4, 0.3))])
    image = caster.cast(view, [at(), at(0, -3, 0)])
    side = view.focal / 4.5
    radius = view.focal * 0.3 / math.sqrt(2.0**2 - 0.3**2)
    crate, sphere = np.bincount(image.ids[image.ids >= 0])
    assert sphere == pytest.approx(math.pi * radius**2, rel=0.01)
    assert crate + sphere == pytest.approx(max(side**2, math.pi * radius**2), rel=0.03)
    alone = caster.cast(view, [at(), at(0, -3, 0)], only=[0])
    assert np.bincount(alone.ids[alone.ids >= 0]) == pytest.approx([side**2], rel=0.01)
    assert alone.depth[180, 320] == pytest.approx(4.5, rel=1e-6)
    assert alone.normals[180, 320] == pytest.approx([0, -1, 0], abs=1e-6)
    assert np.isinf(alone.depth[0, 0])
    assert alone.ids[0, 0] == -1


def test_hits_project_to_the_pixel_they_were_seen_in():
    """Round trip, and every pixel against a ray-triangle loop of its own."""
    rng = np.random.default_rng(6)
    meshes = [mesh_of(trimesh.creation.box(rng.uniform(0.3, 1.2, 3))) for _ in range(6)]
    poses = [random_pose(rng, 1.0) for _ in meshes]
    view = camera(size=(48, 27))
    image = IdCaster(meshes).cast(view, poses)
    origin, directions = view.rays()
    nearest = np.full((27, 48), np.inf)
    ids = np.full((27, 48), -1)
    for k, (mesh, pose) in enumerate(zip(meshes, poses, strict=True)):
        for a, b, c in pose.apply(mesh.vertices)[mesh.faces]:
            matrix = np.stack(np.broadcast_arrays(-directions, b - a, c - a), axis=-1)
            s = np.linalg.solve(matrix, np.broadcast_to((origin - a)[..., None], (27, 48, 3, 1)))[..., 0]
            hit = (s[..., 0] > 0) & (s[..., 1] >= 0) & (s[..., 2] >= 0) & (s[..., 1] + s[..., 2] <= 1) & (s[..., 0] < nearest)
            nearest[hit], ids[hit] = s[..., 0][hit], k
    assert (image.ids == ids).all()
    seen = ids >= 0
    assert seen.sum() > 100
    pixels, depth = view.project(origin + nearest[seen, None] * directions[seen])
    assert image.depth[seen] == pytest.approx(depth, rel=1e-6)
    rows, columns = np.nonzero(seen)
    assert pixels == pytest.approx(np.stack([columns, rows], axis=1) + 0.5, abs=1e-9)


def test_a_floor_that_passes_below_the_eye_needs_no_clipping():
    """Analytic: a plane through the eye plane fills exactly the lower half of the picture."""
    floor = TriangleMesh(np.array([[-1e3, -1e3, 0], [1e3, -1e3, 0], [0, 1e4, 0.0]]), np.array([[0, 1, 2]], dtype=np.int32))
    image = IdCaster([floor]).cast(camera((0, 0, 1.0), (0, 1.0, 1.0), size=(64, 36)), [at()])
    assert (image.ids[:18] == -1).all()
    assert (image.ids[18:] == 0).all()


def test_no_ray_slips_through_a_seam():
    """A finely triangulated wall seen along its grid has no holes."""
    wall = trimesh.creation.box((2, 2, 2)).subdivide().subdivide()
    image = IdCaster([mesh_of(wall)]).cast(camera((0, -2.0, 0), size=(65, 65), fov=60.0), [at()])
    assert (image.ids == 0).all()


def test_a_window_shows_what_the_whole_picture_shows_there() -> None:
    caster = IdCaster([mesh_of(trimesh.creation.box((1, 1, 1))), mesh_of(trimesh.creation.icosphere(4, 0.3))])
    view, poses = camera((2.0, -3.0, 1.0)), [at(), at(0.2, -1, 0.1)]
    whole = caster.cast(view, poses)
    part = caster.cast(view, poses, window=(10, view.width - 7, 5, view.height - 3))
    for a, b in zip(whole, part, strict=True):
        np.testing.assert_array_equal(a[5:-3, 10:-7], b)
    with pytest.raises(InputError, match="window"):
        caster.cast(view, poses, window=(5, 5, 0, 1))


def test_a_picture_without_normals_shows_the_same() -> None:
    caster = IdCaster([mesh_of(trimesh.creation.box((1, 1, 1))), mesh_of(trimesh.creation.icosphere(4, 0.3))])
    view, poses = camera((2.0, -3.0, 1.0)), [at(), at(0.2, -1, 0.1)]
    whole, bare = caster.cast(view, poses), caster.cast(view, poses, normals=False)
    np.testing.assert_array_equal(whole.ids, bare.ids)
    np.testing.assert_array_equal(whole.depth, bare.depth)
    assert np.abs(whole.normals).max() > 0.5
    assert not bare.normals.any()


def test_a_turned_camera_shows_the_same_turned() -> None:
    """A quarter turn: right becomes up."""
    view = camera((0, -4.0, 0), size=(64, 64))
    turned = replace(view, roll=math.pi / 2)
    points = np.array([[0.3, 0, 0.1], [0, 0, 0.5]])
    one, two = view.project(points)[0] - 32, turned.project(points)[0] - 32
    np.testing.assert_allclose(two, np.column_stack([-one[:, 1], one[:, 0]]), atol=1e-9)


def sheets(rng, count: int) -> TriangleMesh:
    """Large triangles all about a camera at the origin: before it, behind it, and through the plane of its eye."""
    corners = rng.normal(size=(count, 3, 3)) * 10.0 ** rng.uniform(-1.0, 2.0, size=(count, 1, 1))
    return TriangleMesh(corners.reshape(-1, 3), np.arange(3 * count, dtype=np.int32).reshape(-1, 3))


@pytest.mark.parametrize("seed", range(5))
def test_leaving_out_what_reaches_no_pixel_changes_no_picture(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    caster, poses = IdCaster([sheets(rng, 60) for _ in range(3)]), [at()] * 3
    drawn, saved = [], 0
    draw = idcast._Buffer._draw_large
    monkeypatch.setattr(idcast._Buffer, "_draw_large", lambda *told: (drawn.extend(told[2].tolist()), draw(*told)))
    for _ in range(4):
        view = camera((0.0, 0.0, 0.0), tuple(rng.normal(size=3)), float(rng.uniform(20, 100)), (320, 180))
        x, y = np.sort(rng.integers(0, 320, 2)), np.sort(rng.integers(0, 180, 2))
        window = (int(x[0]), int(x[1]) + 1, int(y[0]), int(y[1]) + 1)
        few, left = caster.cast(view, poses, window=window), len(drawn)
        with monkeypatch.context() as patch:
            patch.setattr(idcast, "_reaching", lambda edge, rectangle: np.ones(len(edge), dtype=bool))
            whole = caster.cast(view, poses, window=window)
        saved += len(drawn) - 2 * left
        for one, other in zip(few, whole, strict=True):
            assert np.array_equal(one, other)
        drawn.clear()
    assert saved > 0


def drawn_by_numpy(buffer, edge, index, rectangle, chunk=None):
    """Triangles of a buffer, all pixels of a triangle at once; of equals the first wins, of small ones over those of earlier chunks."""
    for n in range(len(index)):
        x0, x1, y0, y1 = (int(v) for v in rectangle[n])
        column, row = np.arange(x0, x1), np.arange(y0, y1)[:, None]
        a, b, c = (edge[n, :, k, None, None] for k in range(3))
        value = (a * column + c) + b * row if chunk is None else a * column + b * row + c
        inverse = value[0] + value[1] + value[2]
        with np.errstate(divide="ignore"):
            hit = np.where((value.min(axis=0) >= -idcast.SEAM * inverse) & (inverse > 0.0), 1.0 / inverse, np.nan)
        part = (slice(y0 - buffer.top, y1 - buffer.top), slice(x0 - buffer.left, x1 - buffer.left))
        depth, face = (values.reshape(buffer.height, buffer.width)[part] for values in (buffer.depth, buffer.face))
        closer = (hit < depth) & (hit >= idcast.NEAR)
        level = np.zeros_like(closer)
        if chunk is not None:
            place = np.minimum(np.searchsorted(index, face), len(index) - 1)
            level = (hit == depth) & ((index[place] != face) | (chunk[place] != chunk[n]))
        depth[closer] = hit[closer]
        face[closer | level] = index[n]


@pytest.mark.parametrize("chunk", [1, 400, 10**6])
def test_compiled_pictures_are_those_of_numpy(chunk, monkeypatch):
    """Sheets through each other, each of them twice, so that depths are equal; from near and far, so that they fill few and many pixels."""
    monkeypatch.setattr(idcast, "CHUNK", chunk)
    rng = np.random.default_rng(11)
    once = sheets(rng, 60)
    twice = TriangleMesh(once.vertices, np.concatenate([once.faces, once.faces]))
    for size in ((320, 180), (48, 27)):
        view = camera((0.0, 0.0, 0.0), tuple(rng.normal(size=3)), 60.0, size)
        found = IdCaster([twice, once]).cast(view, [at()] * 2)
        with monkeypatch.context() as patch:
            patch.setattr(idcast._Buffer, "_draw_large", drawn_by_numpy)
            patch.setattr(idcast._Buffer, "_draw_small", drawn_by_numpy)
            plain = IdCaster([twice, once]).cast(view, [at()] * 2)
        assert len(np.unique(found.depth)) > 100
        for one, other in zip(found, plain, strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("seed", range(5))
def test_a_look_up_to_a_depth_is_the_whole_one_up_to_there(seed):
    rng = np.random.default_rng(seed)
    caster = IdCaster([sheets(rng, 200)])
    view = camera((0.0, 0.0, 0.0), tuple(rng.normal(size=3)), 60.0)
    whole = caster.cast(view, [at()])
    until = float(np.median(whole.depth[np.isfinite(whole.depth)]))
    found = caster.cast(view, [at()], until=until)
    near = whole.depth < until * (1 - 1e-6)
    assert near.any()
    assert np.array_equal(found.ids[near], whole.ids[near])
    assert np.array_equal(found.depth[near], whole.depth[near])
    assert (found.depth[~near] >= whole.depth[~near]).all()
