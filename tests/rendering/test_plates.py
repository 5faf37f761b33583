"""Plates: the same picture with and without one entity, from two seeds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.geometry.camera import Camera
from worldagent.rendering import FrameRenderer
from worldagent.rendering.tracer.scene import SceneRenderer
from worldagent.testing.worlds.by_category import SMALL_WORLDS
from worldagent.tests.rendering.categories.test_layers import candidate_of
from worldagent.worlds.errors import InputError
from worldagent.worlds.plates import SEEDS, View

SIZE = (96, 54)


@pytest.mark.parametrize("subject", ["ball", "block"])
def test_only_the_subject_is_missing_from_the_picture_without_it(candidate: Any, subject: str) -> None:
    """One of them moves, the other stands still."""
    renderer = FrameRenderer(candidate)
    plate = renderer.plate(View(subject, "all", 2), size=SIZE, samples=16)
    assert plate.shown.shape == plate.bare.shape == (SEEDS, SIZE[1], SIZE[0], 3)
    assert plate.shown.dtype == np.uint8
    shown, bare = (p.astype(float).mean(0) for p in plate)
    apart = np.abs(shown - bare).max(-1)
    seeds = np.abs(plate.shown[0].astype(float) - plate.shown[1]).max(-1)
    assert 0.0 < seeds.mean() < 10.0
    assert 30 < (apart > 10).sum() < 0.2 * apart.size
    again = renderer.plate(View(subject, "all", 2), size=SIZE, samples=16)
    assert np.array_equal(plate.shown, again.shown), "what was left out is back"
    assert np.array_equal(plate.bare, again.bare)


@pytest.mark.parametrize(("subject", "reused"), [("ball", True), ("block", False)])
def test_the_bare_picture_serves_other_frames_only_where_the_subject_alone_moves(
    candidate: Any, monkeypatch: pytest.MonkeyPatch, subject: str, reused: bool
) -> None:
    """The ball moves and the block stands still."""
    renderer, taken = FrameRenderer(candidate), list[int]()
    first = renderer.plate(View(subject, "all", 1), size=SIZE, samples=4)
    radiance = SceneRenderer.radiance
    monkeypatch.setattr(SceneRenderer, "radiance", lambda *a, **k: (taken.append(k["seed"]), radiance(*a, **k))[1])
    second = renderer.plate(View(subject, "all", 2), size=SIZE, samples=4)
    assert len(taken) == SEEDS * (1 if reused else 2)
    assert np.array_equal(first.bare, second.bare) == reused
    fresh = FrameRenderer(candidate).plate(View(subject, "all", 2), size=SIZE, samples=4)
    assert np.array_equal(second.bare, fresh.bare)
    assert np.array_equal(second.shown, fresh.shown)


def test_a_plate_is_exposed_like_the_film(candidate: Any) -> None:
    renderer = FrameRenderer(candidate)
    film = renderer.render(2, width=SIZE[0], height=SIZE[1], samples=16)
    plate = FrameRenderer(candidate).plate(View("ball", "all", 2), size=SIZE, samples=16)
    assert np.array_equal(plate.shown[0], film)


def test_a_frame_or_shot_that_is_not_there_is_refused(candidate: Any) -> None:
    renderer = FrameRenderer(candidate)
    with pytest.raises(InputError, match="frame 99"):
        renderer.plate(View("ball", "all", 99), size=SIZE, samples=1)
    with pytest.raises(InputError, match="no shot"):
        renderer.plate(View("ball", "none", 0), size=SIZE, samples=1)
    with pytest.raises(InputError, match="landscape"):
        renderer.plate(View("nobody", "all", 0), size=SIZE, samples=1)


@pytest.mark.parametrize("name", SMALL_WORLDS)
def test_an_entity_of_every_category_can_be_left_out(name: str, tmp_path: Path) -> None:
    entity, make = SMALL_WORLDS[name]
    candidate = candidate_of(tmp_path, make())
    scene = SceneRenderer(candidate)
    assert scene.draws(entity)
    middle = candidate.vertices(entity, 0).mean(0)
    near = Camera(middle + np.array([0.3, -0.5, 1.0]), middle, 40.0, *SIZE)

    def seen() -> np.ndarray:
        """Depth, albedo and normals: gas has no first hit, but dims what is behind it."""
        return np.concatenate([scene.depth(near)[..., None], *scene.features(near)], axis=-1)

    there = seen()
    scene.pose(0, entity)
    gone = seen()
    scene.pose(0)
    assert (np.abs(gone - there).max(-1) > 1e-3).sum() > 10
    assert np.array_equal(there, seen())
