"""Sequences: resumable, deterministic, and close to a converged picture."""

from __future__ import annotations

import math

import numpy as np
import pytest
from worldagent.rendering import FrameRenderer, frame_path, meter, render_frame, render_sequence, tonemap
from worldagent.rendering.frames import SAME_LIGHT, exposures
from worldagent.rendering.views import camera_for
from worldagent.worlds.errors import InputError

GOLDEN_PSNR_DB = 28.0
"""Least agreement of a denoised 16-sample picture with 512 samples at 128x72; own choice."""


def _psnr(a, b):
    return 10 * math.log10(255.0**2 / max(float(np.mean((a.astype(float) - b.astype(float)) ** 2)), 1e-9))


def test_denoised_picture_is_close_to_the_converged_one(candidate):
    renderer = FrameRenderer(candidate)
    reference = renderer.render(2, samples=512, denoise=False)
    clean = renderer.render(2, samples=16)
    noisy = renderer.render(2, samples=16, denoise=False)
    assert clean.shape == (72, 128, 3)
    assert clean.dtype == np.uint8
    assert _psnr(clean, reference) > max(GOLDEN_PSNR_DB, _psnr(noisy, reference))


@pytest.mark.parametrize("sky", ["sunsky", "studio", "overcast"])
def test_every_sky_is_exposed_so_that_one_sees_something(make_candidate, sky):
    image = render_frame(make_candidate(sky), 0, width=64, height=36, samples=4)
    assert 60 < image.mean() < 200
    assert (image.max(-1) > 250).mean() < 0.3
    assert (image.max(-1) < 5).mean() < 0.05


def test_exposure_stops_brighten(make_candidate):
    def brighter(data):
        data["look"]["exposure"] = 1.5

    plain = render_frame(make_candidate(), 0, width=48, height=27, samples=2)
    bright = render_frame(make_candidate(change=brighter), 0, width=48, height=27, samples=2)
    assert bright.mean() > plain.mean() + 20


def test_a_resumed_sequence_equals_the_unbroken_one(candidate, tmp_path):
    told: list[tuple[int, int, str]] = []
    whole = render_sequence(candidate, tmp_path / "whole", frames=range(4), progress=lambda *a: told.append(a))
    assert [p.name for p in whole] == [f"frame_{k:06d}.png" for k in range(4)]
    assert told[-1][:2] == (4, 4)

    asked = iter([False, False, True])
    part = render_sequence(candidate, tmp_path / "parts", frames=range(4), cancelled=lambda: next(asked))
    assert len(part) == 2
    kept = frame_path(tmp_path / "parts", 0).stat().st_mtime_ns
    resumed = render_sequence(candidate, tmp_path / "parts", frames=range(4))
    assert [p.read_bytes() for p in resumed] == [p.read_bytes() for p in whole]
    assert frame_path(tmp_path / "parts", 0).stat().st_mtime_ns == kept


def test_a_damaged_or_outdated_frame_is_rendered_again(candidate, tmp_path):
    (path,) = render_sequence(candidate, tmp_path, frames=[1])
    good = path.read_bytes()
    path.write_bytes(good[:-20])
    render_sequence(candidate, tmp_path, frames=[1])
    assert path.read_bytes() == good
    render_sequence(candidate, tmp_path, frames=[1], samples=3)
    assert path.read_bytes() != good


def test_frames_that_do_not_exist_are_refused(candidate):
    with pytest.raises(InputError, match=r"frame 99 is not in 0\.\.5"):
        render_frame(candidate, 99)


def test_tone_curve_is_monotone_and_meter_brings_a_grey_card_to_the_middle():
    ramp = np.geomspace(1e-4, 1e4, 200, dtype=np.float32)[None, :, None].repeat(3, axis=2)
    values = tonemap(ramp)[0, :, 0].astype(int)
    assert (np.diff(values) >= 0).all()
    assert values[0] < 3
    assert values[-1] == 255
    card = np.full((4, 4, 3), 37.0, dtype=np.float32)
    up = np.zeros((4, 4, 3), dtype=np.float32)
    up[..., 2] = 1
    assert 110 < tonemap(card, gain=meter(card, up)).mean() < 160


def test_the_day_before_a_window_does_not_darken_its_room():
    """A tenth of the picture is a pane with a day of a thousand times the room's light behind it."""
    room = np.full((10, 10, 3), 0.5, dtype=np.float32)
    up = np.zeros((10, 10, 3), dtype=np.float32)
    up[..., 2] = 1
    panes = np.zeros((10, 10), dtype=bool)
    panes[0] = True
    seen = np.where(panes[..., None], np.float32(500.0), room)
    assert meter(seen, up, panes) == meter(room, up)
    assert meter(seen, up) < 0.01 * meter(room, up)
    # A tank that takes most of the picture is what one looks at.
    panes[:6] = True
    assert meter(seen, up, panes) == meter(seen, up)


def _two_shots(data):
    """A grey block between a white and a black panel, seen by one shot with each."""
    look = {"roughness": 0.9}
    data["materials"]["white"] = {"density": 600, "appearance": {"color": (0.85, 0.85, 0.85), **look}}
    data["materials"]["black"] = {"density": 600, "appearance": {"color": (0.03, 0.03, 0.03), **look}}
    for name, x in (("white", -1.0), ("black", 1.0)):
        data["entities"][name] = {
            "role": "panel",
            "motion": "static",
            "material": name,
            "dimensions": {"size": (1.8, 0.05, 2.0)},
            "pose": {"position": (x, 0.6, 1.0)},
            "parts": {"body": {"shape": {"kind": "box", "size": (1.8, 0.05, 2.0)}}},
        }
        data["simulation"]["solvers"]["rigid"]["members"].append(name)
    keys = {"a": {"frame": 0, "position": (0.0, -2.0, 0.5), "fov_deg": 40}}
    data["shots"] = {
        name: {"frames": frames, "covers": [], "keys": {"a": {**keys["a"], "frame": frames[0], "target": (x, 0.25, 0.5)}}}
        for name, frames, x in (("left", (0, 2), -0.55), ("right", (3, 5), 0.55))
    }


def _grey_of_block(candidate, picture, frame, shot):
    camera = camera_for(candidate, frame, shot=shot, width=picture.shape[1], height=picture.shape[0])
    column, row = (int(v) for v in camera.project(np.array([[0.0, 0.15, 0.2]]))[0][0])
    return float(picture[row - 1 : row + 2, column - 1 : column + 2].mean())


def test_two_shots_in_one_light_have_one_exposure(make_candidate):
    candidate = make_candidate(change=_two_shots)
    renderer = FrameRenderer(candidate)
    asked = [renderer._metered(renderer._small_view(s, f), f) for s, f in (("left", 0), ("right", 3))]
    assert 0.4 < abs(math.log2(asked[1] / asked[0])) < SAME_LIGHT, "the meters differ by what stands before them"
    greys = [
        _grey_of_block(candidate, renderer.render(f, width=160, height=90, samples=32), f, s)
        for f, s in ((0, "left"), (3, "right"))
    ]
    assert abs(greys[0] - greys[1]) < 6, greys
    # As each meter asks, the same grey would be two greys.
    apart = [tonemap(np.full((1, 1, 3), 0.18 / math.sqrt(asked[0] * asked[1]), dtype=np.float32), gain=g).mean() for g in asked]
    assert abs(apart[0] - apart[1]) > 12


def test_another_camera_in_that_light_is_exposed_alike_and_a_single_shot_as_its_meter_asks(make_candidate):
    candidate = make_candidate(change=_two_shots)
    renderer = FrameRenderer(candidate)
    camera = camera_for(candidate, 3, shot="right", width=96, height=54)
    assert renderer._gain(None, 3, camera) == renderer._gain("left", 0, None) == renderer._gain("right", 3, None)
    assert exposures({"one": 0.7}) == {"one": 0.7}
    assert exposures({}) == {}


def test_a_room_and_the_land_before_it_keep_their_own_exposures():
    found = exposures({"room": 32.0, "window": 20.0, "land": 1.0, "hill": 1.6})
    assert found["room"] == found["window"] == pytest.approx(math.sqrt(640.0))
    assert found["land"] == found["hill"] == pytest.approx(math.sqrt(1.6))
