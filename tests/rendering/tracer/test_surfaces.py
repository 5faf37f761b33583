"""Normals, textures and the choice of variant."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from worldagent.construction.primitives import build_shape
from worldagent.rendering.tracer import variant as variants
from worldagent.rendering.tracer.surfaces import corner_normals, textured_surfaces
from worldagent.rendering.tracer.textures import BOARD_LENGTH, BOARDS, BRICK, board_joint, brick_middle, pattern_tiles
from worldagent.worlds.arrays import RigidPose
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.errors import EngineError
from worldagent.worlds.spec import Box


def _cylinder(segments=24):
    turn = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    vertices = np.concatenate([np.c_[ring, np.full(segments, -1.0)], np.c_[ring, np.full(segments, 1.0)], [[0, 0, 1.0]]])
    faces = []
    for k in range(segments):
        j = (k + 1) % segments
        faces += [[k, j, segments + j], [k, segments + j, segments + k], [segments + k, segments + j, 2 * segments]]
    return TriangleMesh(vertices, np.array(faces, dtype=np.int32))


def test_a_smooth_cylinder_has_round_sides_and_a_sharp_rim():
    mesh = _cylinder()
    normals = corner_normals(mesh, smooth=True)
    lid = (mesh.faces == 48).any(1)
    assert np.allclose(normals[lid], [0, 0, 1], atol=1e-9)
    radial = mesh.vertices[mesh.faces[~lid]] * [1, 1, 0]
    assert np.allclose(normals[~lid], radial, atol=0.02)
    flat = corner_normals(mesh, smooth=False)
    assert (np.ptp(flat, axis=1) == 0).all()


@pytest.mark.parametrize("pattern", ["wood", "concrete", "checker", "tiles", "bricks"])
def test_tiles_keep_the_material_colour_on_average_and_repeat_from_the_same_seed(pattern):
    color = (0.4, 0.3, 0.2)
    tiles = pattern_tiles(pattern, color, seed=3)
    again = pattern_tiles(pattern, color, seed=3)
    for layer, tile in tiles.items():
        assert tile.image.min() >= 0
        assert tile.image.max() <= 1
        assert np.array_equal(tile.image, again[layer].image)
        if pattern != "checker":
            assert np.allclose(tile.image.mean((0, 1)), color, rtol=0.02)
    assert pattern_tiles("plain", color) == {}


def test_concrete_has_no_seam():
    tile = pattern_tiles("concrete", (0.4, 0.4, 0.4))["side"].image
    inner = np.abs(np.diff(tile[..., 0], axis=1)).mean()
    assert np.abs(tile[:, 0, 0] - tile[:, -1, 0]).mean() < 1.5 * inner


def test_boards_start_inside_the_tile():
    joints = [board_joint(k) for k in range(BOARDS)]
    assert 0 <= min(joints) <= max(joints) < BOARD_LENGTH


def test_the_library_version_is_read_from_its_name():
    assert variants._major(Path("/x/libLLVM-15.so.1")) == 15
    assert variants._major(Path("/x/libLLVM.so.19.1")) == 19
    assert variants._major(Path("/x/libfoo.so")) is None


def test_old_libraries_are_never_tried(monkeypatch, tmp_path):
    """LLVM 14 and 15 abort the process that loads them."""
    for name in ("libLLVM-14.so", "libLLVM-15.so.1", "libLLVM-17.so"):
        (tmp_path / name).write_bytes(b"")
    monkeypatch.delenv("DRJIT_LIBLLVM_PATH", raising=False)
    monkeypatch.setattr(variants, "_LIBRARY_FOLDERS", (str(tmp_path),))
    assert [p.name for p in variants._llvm_candidates()] == ["libLLVM-17.so"]


def test_without_a_proof_the_scalar_variant_is_chosen_and_says_why(monkeypatch, tmp_path):
    (tmp_path / "libLLVM-17.so").write_bytes(b"")
    monkeypatch.delenv("DRJIT_LIBLLVM_PATH", raising=False)
    monkeypatch.setattr(variants, "_LIBRARY_FOLDERS", (str(tmp_path),))
    monkeypatch.setattr(variants, "_has_cuda_driver", lambda: False)
    monkeypatch.setattr(variants, "_prove", lambda name, library: False)
    chosen = variants._choose.__wrapped__(None)
    assert (chosen.name, chosen.llvm_path) == ("scalar_rgb", None)
    assert "1 libLLVM found but none worked" in chosen.why
    with pytest.raises(EngineError, match="unset it"):
        variants._choose.__wrapped__("llvm_ad_rgb")


def test_a_failed_proof_is_remembered(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(variants, "_PROOF", "import sys; sys.exit(3)")
    assert variants._prove("llvm_ad_rgb", None) is False
    monkeypatch.setattr(subprocess, "run", lambda *a, **k: pytest.fail("asked again"))
    assert variants._prove("llvm_ad_rgb", None) is False


def test_tiles_have_joints_that_are_darker_and_go_on_over_the_seam():
    tile = pattern_tiles("tiles", (0.6, 0.5, 0.4), seed=1)["side"]
    grey = tile.image.mean(-1)
    side = len(grey) // 6
    assert tile.periods == (6, 6)
    middles = np.array([[grey[i * side + side // 2, j * side + side // 2] for j in range(6)] for i in range(6)])
    assert grey[0].mean() < 0.6 * grey[side // 2].mean(), "a joint runs along the edge"
    assert grey[:, 0].mean() < 0.6 * grey[:, side // 2].mean()
    assert len(np.unique(middles.round(3))) > 20, "no tile is quite like the next"
    dark = float((grey < 0.7 * np.median(grey)).mean())
    assert 0.02 < dark < 0.06, "joints take the share of the surface that two widths of 2 % ask for"


def test_bricks_lie_in_courses_with_joints_of_their_width_and_tones_of_their_own():
    """A brick and its joint are 225 x 75 mm; every second course is shifted by half of that."""
    tile = pattern_tiles("bricks", (0.35, 0.13, 0.08), seed=1)["side"]
    blue = tile.image[..., 2] / tile.image[..., 2].mean()
    high = BRICK // 3
    mortar = blue > 1.4
    assert mortar[:2].mean() > 0.95, "a joint between courses"
    middle = mortar[high // 2]
    shifted = mortar[high + high // 2]
    assert 0.02 < middle.mean() < 0.08, "10 mm of 225"
    assert middle[np.arange(0, len(middle), BRICK)].all()
    assert shifted[np.arange(BRICK // 2, len(middle), BRICK)].all()
    assert not (middle & shifted).any()
    bricks = tile.image[high // 2, BRICK // 2 :: BRICK, 0]
    assert len(np.unique(bricks)) == len(bricks)
    assert np.ptp(bricks) > 0.1 * bricks.mean()


def test_a_wall_shows_level_courses_and_a_single_brick_none():
    """Whichever way is longest; a brick by itself is of one brick's tone."""
    tiles = pattern_tiles("bricks", (0.35, 0.13, 0.08))

    def shown(size):
        mesh = build_shape(Box(size=size), Path()).render
        here = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
        return textured_surfaces(mesh, smooth=False, tiles=tiles, pattern="bricks", scale=0.225, frame=here, key="w")["side"]

    for size in ((3.0, 0.2, 2.0), (2.0, 0.2, 3.0)):
        wall = shown(size)
        front = np.abs(wall.normals[:, 1]) > 0.9
        height = np.ptp(wall.positions[front, 2]) / 0.225
        assert np.ptp(wall.uv[front, 1]) * tiles["side"].periods[1] == pytest.approx(height)
    one = shown((0.215, 0.1025, 0.065))
    assert np.ptp(one.uv, axis=0).max() == 0.0
    rows, columns = tiles["side"].image.shape[:2]
    for random in np.random.default_rng(0).random((20, 2)):
        u, v = brick_middle(random)
        at = tiles["side"].image[int(v * rows) % rows, int(u * columns) % columns]
        assert at[2] / tiles["side"].image[..., 2].mean() < 1.4, "no joint"
