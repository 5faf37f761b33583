"""Pictures without a path tracer: previews, sheets, plots, plans; and video files."""

from __future__ import annotations

import dataclasses
import subprocess
import sys

import cv2
import numpy as np
import pytest
from worldagent.geometry.camera import Camera
from worldagent.rendering import (
    PreviewRenderer,
    contact_sheet,
    encode,
    id_view,
    ledger_series,
    plan_view,
    plot_account,
    plot_ledger,
    preview,
    section_view,
    write_video,
)
from worldagent.rendering.shades import pattern_shade
from worldagent.testing.worlds.small_worlds import box, entity, make_candidate, pose, world
from worldagent.worlds.accounts import Account, Mark
from worldagent.worlds.errors import EvidenceError, InputError
from worldagent.worlds.spec import Appearance, Box, Material, Part


def _noise(height=120, width=160):
    return np.random.default_rng(0).integers(0, 256, (height, width, 3), dtype=np.uint8)


def test_preview_shows_the_red_ball_where_the_camera_projects_it(candidate):
    camera = Camera(np.array([0.2, -4.0, 1.0]), np.array([0.0, 0.0, 0.1]), 30.0, 160, 90)
    renderer = PreviewRenderer(candidate)
    for frame in (0, 4):
        image = preview(candidate, frame, camera=camera, renderer=renderer).astype(int)
        red = (image[..., 0] > image[..., 1] + 60) & (image[..., 0] > image[..., 2] + 60)
        rows, columns = np.nonzero(red)
        expected = camera.project(candidate.center("ball", frame)[None])[0][0]
        assert np.hypot(columns.mean() - expected[0], rows.mean() - expected[1]) < 2.5


def test_preview_shows_the_pattern_of_a_material(candidate):
    """A checker of 0.2 m on the table: as many dark as light squares."""
    looks = candidate.spec.materials
    name = next(part.material for part in candidate.built["table"].parts)
    plain = Camera(np.array([-0.4, -0.01, 2.4]), np.array([-0.4, 0.0, 0.0]), 20.0, 200, 200)
    even = preview(candidate, 0, camera=plain).astype(float)
    checked = looks[name].appearance.model_copy(update={"pattern": "checker", "pattern_scale": 0.2})
    spec = candidate.spec.model_copy(
        update={"materials": {**looks, name: looks[name].model_copy(update={"appearance": checked})}}
    )
    image = preview(dataclasses.replace(candidate, spec=spec), 0, camera=plain).astype(float)
    changed = np.abs(image - even).max(-1) > 20
    assert 0.3 < changed.mean() < 0.6
    lines = np.abs(np.diff(changed.astype(int), axis=1)).sum(1)
    assert np.median(lines) >= 6


def test_pattern_shade_alternates_and_keeps_plain_colours():
    points = np.array([[0.01, 0.01, 0.5], [0.06, 0.01, 0.5], [0.06, 0.06, 0.5], [0.01, 0.01, 0.9]])
    up = np.tile([0.0, 0.0, 1.0], (4, 1))
    shade = pattern_shade("checker", points, up, scale=0.1, extent=np.ones(3))
    assert shade.tolist() == [0.25, 1.0, 0.25, 0.25]
    assert pattern_shade("plain", points, up, scale=0.1, extent=np.ones(3)).tolist() == [1.0] * 4
    wood = pattern_shade("wood", points, up, scale=0.1, extent=np.array([2.0, 1.0, 1.0]))
    assert wood[0] == wood[1]  # along the grain
    assert wood[1] != wood[2]


@pytest.mark.parametrize("size", [(1080, 1920), (3000, 400), (1200, 1000)])
def test_no_picture_is_too_large_for_a_client(size):
    """Noise is the worst that an encoder can get."""
    data, kind = encode(_noise(*size))
    assert len(data) <= 700_000
    shape = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR).shape
    assert max(shape[:2]) <= 1568
    assert shape[0] / shape[1] == pytest.approx(size[0] / size[1], rel=0.01)
    assert kind == "jpeg"


def test_a_contact_sheet_of_noise_is_not_too_large():
    data = contact_sheet([_noise(270, 480)] * 25, ["frame"] * 25)
    assert len(data) <= 700_000
    assert max(cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR).shape[:2]) <= 1568


def test_preview_has_shadows(candidate):
    """The block stands in the sun's way to a patch of the table."""
    renderer = PreviewRenderer(candidate)
    sun = renderer._sun()
    foot = np.array([0.0, 0.25, 0.15]) - sun * (0.15 / sun[2]) * 1.5
    foot[2] = 0.001
    lit = renderer._daylight(0).share(np.array([foot, [0.8, -0.4, 0.001]]))
    assert lit[0] == 0
    assert lit[1] == 1


def test_id_view_gives_every_entity_its_colour(candidate):
    image = id_view(candidate, 0, width=320, height=180)
    assert image.shape == (180, 320, 3)
    assert len(np.unique(image.reshape(-1, 3), axis=0)) > 10


def test_a_sheet_keeps_its_size_limit():
    images = [_noise() for _ in range(9)]
    data = contact_sheet(images, [f"frame {k}" for k in range(9)], columns=3, max_bytes=60_000)
    assert len(data) <= 60_000
    assert data[:2] == b"\xff\xd8"
    free = contact_sheet(images, [""] * 9, columns=3)
    assert cv2.imdecode(np.frombuffer(free, np.uint8), cv2.IMREAD_COLOR).shape[1] == 3 * 166 + 6
    with pytest.raises(InputError, match="1 pictures and 2 labels"):
        contact_sheet(images[:1], ["a", "b"])


def test_encode_prefers_png_and_falls_back_to_jpeg():
    small = np.zeros((20, 20, 3), dtype=np.uint8)
    assert encode(small).format == "png"
    data, kind = encode(_noise(600, 800), max_bytes=100_000)
    assert kind == "jpeg"
    assert len(data) <= 100_000


def test_video_reads_back_with_every_frame(tmp_path):
    frames = []
    for k in range(12):
        path = tmp_path / f"frame_{k:06d}.png"
        cv2.imwrite(str(path), np.full((55, 96, 3), 20 * k, dtype=np.uint8))
        frames.append(path)
    video = write_video(frames, tmp_path / "out.webm", 24)
    assert (video.frames, video.width, video.height) == (12, 96, 54)
    assert video.path.is_file()
    assert video.codec == "VP9" or video.note
    with pytest.raises(InputError, match=r"suffix is '\.gif'"):
        write_video(frames, tmp_path / "out.gif", 24)


def test_plot_shows_curves_beats_and_refuses_unknown_quantities(candidate):
    image = plot_ledger(candidate)
    assert image.shape == (600, 1000, 3)
    assert (image.min(-1) < 200).mean() > 0.005
    tinted = image[70:100, 80:820].reshape(-1, 3)
    assert len(np.unique(tinted, axis=0)) > 3
    assert np.allclose(ledger_series(candidate, "total_energy").values, 1.0)
    assert np.isnan(ledger_series(candidate, "min_gap").values[0])
    assert ledger_series(candidate, "contacts").values.tolist() == [0, 1, 2, 0, 1, 2]
    with pytest.raises(InputError, match="no quantity 'joy'"):
        plot_ledger(candidate, ["joy"])
    with pytest.raises(EvidenceError):
        plot_ledger(candidate, ["mass"])


def test_plan_is_true_to_scale(candidate):
    """The table is 2 m x 1 m: its outline in the plan keeps that ratio, +x right and +y up."""
    image = plan_view(candidate, 0, width=900, height=400)
    paper = np.abs(image.astype(int) - 255).sum(-1) < 30
    across = np.ptp(np.flatnonzero(~paper[60, 70:])) + 1
    upward = np.ptp(np.flatnonzero(~paper[24:376, 150])) + 1
    assert across / upward == pytest.approx(2.0, rel=0.02)


def test_section_fills_what_it_cuts(candidate):
    cut = section_view(candidate, 0, axis="y", at=0.25, width=600, height=400)
    beside = section_view(candidate, 0, axis="y", at=0.45, width=600, height=400)
    assert cut.shape == beside.shape == (400, 600, 3)
    assert (cut.astype(int) != beside.astype(int)).any(-1).sum() > 500
    assert section_view(candidate, 0, axis="x", width=300, height=200).shape == (200, 300, 3)


def test_importing_the_floor_loads_no_engine():
    code = "import sys, worldagent.rendering as r; print([m for m in ('mitsuba', 'cv2', 'warp', 'pyoidn') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "[]"


def test_an_account_is_drawn_with_its_bound_and_what_exceeds_it(candidate):
    """The residual's curve is red and crosses the bound's line exactly when something has no source."""
    times = np.arange(6) / 24
    still, one = np.zeros((6, 2)), np.ones((6, 2))
    account = Account(
        times=times, entities=("ball", "box"), mass=np.array([1.0, 2.0]), kinetic=one * times[:, None], potential=one, elastic=times,
        work=np.zeros(6), momentum=np.repeat(still[:, :, None], 3, axis=2), angular_momentum=np.ones((6, 2, 3)),
        sources={"gravity": np.ones((5, 2, 3))}, contact=np.ones((5, 2)), unexplained=np.full((5, 2), 1e-12), bound=2e-3,
        events=(Mark(0.1, "ball - box"),),
    )  # fmt: skip
    sound = plot_account(candidate, account, width=900, height=900)
    assert sound.shape == (900, 900, 3)
    violet, red = np.array([150, 90, 200]), np.array([200, 30, 30])
    assert (np.abs(sound.astype(int) - violet).sum(-1) < 60).sum() > 300  # the event runs through all panels
    broken = plot_account(candidate, dataclasses.replace(account, unexplained=np.full((5, 2), 0.5)), width=900, height=900)
    reds = [int((np.abs(p.astype(int) - red).sum(-1) < 60).sum()) for p in (sound, broken)]
    assert reds[1] > 1.5 * reds[0] > 0
    small = plot_account(candidate, account, width=64, height=64)
    assert small.shape == (600, 700, 3)


def _jar_before_a_wall(folder, *, transmission):
    """A red cube in a hollow box of a material that lets so much through, before a green wall."""
    looks = {"glass": ((0.96, 0.98, 0.97), transmission), "red": ((0.9, 0.05, 0.05), 0.0), "green": ((0.05, 0.6, 0.05), 0.0)}
    materials = {
        name: Material(
            density=2500.0,
            friction=0.4,
            substance="glass",
            appearance=Appearance(color=color, transmission=share, roughness=0.02),
        )
        for name, (color, share) in looks.items()
    }
    side = Part(shape=Box(size=(0.2, 0.004, 0.2)), pose=pose((0, -0.098, 0.1)))
    back = Part(shape=Box(size=(0.2, 0.004, 0.2)), pose=pose((0, 0.098, 0.1)))
    things = {
        "jar": entity(side, back, material="glass"),
        "cube": box(0.06, 0.06, 0.06, at=(0, 0, 0.1), material="red"),
        "wall": box(2.0, 0.05, 2.0, at=(0, 0.5, 0.0), material="green"),
    }
    return make_candidate(folder, world(things, materials=materials))


FRONT = Camera(np.array([0.0, -1.5, 0.1]), np.array([0.0, 0.0, 0.1]), 14.0, 240, 180)


def test_preview_shows_through_glass_what_is_in_it_and_behind_it(tmp_path):
    clear = preview(_jar_before_a_wall(tmp_path / "a", transmission=1.0), 0, camera=FRONT).astype(int)
    solid = preview(_jar_before_a_wall(tmp_path / "b", transmission=0.0), 0, camera=FRONT).astype(int)
    middle, beside, outside = (slice(86, 94), slice(116, 124)), (slice(60, 70), slice(85, 95)), (slice(60, 70), slice(20, 28))
    inside, behind, bare = (clear[at].reshape(-1, 3).mean(axis=0) for at in (middle, beside, outside))
    assert inside[0] > inside[1] + 60, "the red cube in it"
    assert behind[1] > behind[0] + 40, "the green wall behind it"
    assert behind[1] < bare[1] - 2, "two panes take some of the light"
    assert np.abs(solid[beside].reshape(-1, 3).mean(axis=0) - behind).max() > 60, "what is not clear hides it"


def test_glass_throws_back_the_sky_where_one_looks_along_it(tmp_path):
    candidate = _jar_before_a_wall(tmp_path, transmission=1.0)
    across = preview(candidate, 0, camera=FRONT).astype(int)
    along = Camera(np.array([1.4, -0.22, 0.1]), np.array([0.0, -0.1, 0.1]), 14.0, 240, 180)
    grazing = preview(candidate, 0, camera=along).astype(int)
    mirrored = grazing[60:120, 100:140].reshape(-1, 3).mean(axis=0)
    assert mirrored[2] > across[60:70, 85:95].reshape(-1, 3).mean(axis=0)[2] + 30


def test_tiles_show_joints_on_the_face_one_sees_and_tones_between_them():
    """Points on a floor, 1 mm apart: dark at whole tiles of 0.1 m, along both ways, and even inside."""
    x, y = np.meshgrid(np.arange(0.0005, 0.3, 0.001), np.arange(0.0005, 0.3, 0.001), indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), np.full(x.size, 0.02)], axis=1)
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    shade = pattern_shade("tiles", points, up, scale=0.1, extent=np.ones(3)).reshape(x.shape)
    assert (shade[[0, 100, 199]] < 0.5).all()
    assert (shade[:, [0, 100, 299]] < 0.5).all()
    inside = [shade[10 + 100 * i : 90 + 100 * i, 10 + 100 * j : 90 + 100 * j] for i in range(3) for j in range(3)]
    assert all(np.ptp(cell) == 0 and cell.min() > 0.9 for cell in inside)
    assert len({float(cell[0, 0]) for cell in inside}) == 9


def test_tiles_go_on_from_one_static_wall_to_the_next(tmp_path):
    """A wall of one box looks like the same wall of two boxes that meet off a joint, as two entities."""
    tiled = Material(
        density=2300.0, substance="ceramic", appearance=Appearance(color=(0.8, 0.8, 0.75), pattern="tiles", pattern_scale=0.3)
    )
    camera = Camera(np.array([0.0, -1.4, 0.5]), np.array([0.0, 0.0, 0.5]), 40.0, 320, 240)

    def picture(name, walls):
        candidate = make_candidate(tmp_path / name, world(walls, materials={"wall": tiled}), tracks={})
        return preview(candidate, 0, camera=camera).astype(int)

    whole = picture("one", {"wall": box(1.4, 0.1, 1.0, at=(0, 0.05, 0.5), material="wall")})
    parts = {
        "left": box(0.64, 0.1, 1.0, at=(-0.38, 0.05, 0.5), material="wall"),
        "right": box(0.76, 0.1, 1.0, at=(0.32, 0.05, 0.5), material="wall"),
    }
    assert np.ptp(whole[100:140, 60:260].mean(axis=2)) > 60, "joints are seen"
    off = np.abs(picture("two", parts) - whole).max(axis=2)
    assert (off > 12).mean() < 0.01


def test_bricks_show_courses_and_joints_and_a_single_brick_none():
    """Points on a wall, 1 mm apart: lighter at each course of 75 mm, and at every 225 mm of one, shifted by half of that in the next."""
    x, z = np.meshgrid(np.arange(0.0005, 0.45, 0.001), np.arange(0.0005, 0.15, 0.001), indexing="ij")
    points = np.stack([x.ravel(), np.full(x.size, 0.1), z.ravel()], axis=1)
    front = np.tile([0.0, -1.0, 0.0], (len(points), 1))
    shade = pattern_shade("bricks", points, front, scale=0.225, extent=np.array([3.0, 0.1, 2.0])).reshape(x.shape)
    joint = shade > 1.3
    assert joint[:, [0, 75, 149]].all()
    assert joint[[0, 225, 449], 37].all()
    assert joint[[112, 337], 112].all()
    assert not joint[[112, 337], 37].any()
    assert not joint[[20, 225], 112].any()
    assert len(np.unique(shade[~joint])) == 5  # two bricks of one course, three of the next
    one = pattern_shade("bricks", points, front, scale=0.225, extent=np.array([0.215, 0.1, 0.065]))
    assert np.ptp(one) == 0
