"""Cameras that a call brings along: what they see, and what is said of those that are none."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, ground, make_candidate, world
from worldagent.workflow.own_camera import own_camera
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import InputError


@pytest.fixture(scope="module")
def candidate(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    folder: Path = tmp_path_factory.mktemp("w")
    spec = world({"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(0, 0, 0.1))}, frames=3)
    return make_candidate(folder, spec, tracks={"ball": (np.array([[0, 0, 0.1], [1, 0, 0.1], [2, 0, 0.1]]), IDENTITY)})


def test_six_numbers_and_named_ones_are_the_same_camera(candidate: Candidate) -> None:
    old = own_camera(candidate, [1, -4, 2, 0, 0.5, 0.1], 0, 64, 36)
    new = own_camera(candidate, {"position": [1, -4, 2], "target": [0, 0.5, 0.1]}, 0, 64, 36)
    assert (old.axes == new.axes).all()
    assert (old.position == new.position).all()
    assert old.fov_deg == new.fov_deg == 40
    assert own_camera(candidate, {"position": [1, -4, 2], "target": [0, 0, 0], "fov_deg": 25}, 0, 64, 36).fov_deg == 25


@pytest.mark.parametrize("frame", [0, 2])
def test_a_camera_that_looks_at_an_entity_has_it_in_the_middle_of_the_picture(candidate: Candidate, frame: int) -> None:
    view = own_camera(candidate, {"position": [1, -4, 2], "look_at": "ball"}, frame, 64, 36)
    pixels, _ = view.project(np.array([[float(frame), 0, 0.1]]))
    assert pixels[0] == pytest.approx([32, 18])


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ([0, 0, 1], ["3 items, it needs 6", "look_at"]),
        ([0, 0, 1, 0, 0, "x"], ["camera[5] = 'x' must be a number"]),
        ({"position": [0, 0, 1]}, ["camera.target is missing", "look_at"]),
        ({"look_at": "ball"}, ["camera.position is missing"]),
        ({"position": [0, 0], "look_at": "ball"}, ["camera.position = [0, 0] has 2 items, it needs 3"]),
        ({"position": "0 0 1", "look_at": "ball"}, ["camera.position = '0 0 1' must be a list of 3 numbers"]),
        ({"position": [0, 0, 1], "look_at": [0, 0, 0.5]}, ["takes the id of an entity", "a point is given as target"]),
        ({"position": [0, 0, 1], "look_at": "bal"}, ["'bal' is no entity", "did you mean 'ball'", "floor"]),
        ({"position": [0, 0, 1], "look_at": "ball", "target": [0, 0, 0]}, ["both camera.target and camera.look_at"]),
        ({"position": [0, 0, 1], "lookat": "ball"}, ["camera has no 'lookat'", "did you mean 'look_at'"]),
        ({"position": [0, 0, 1], "target": [0, 0, 0], "fov_deg": 170}, ["camera.fov_deg 170", "below 120"]),
        ({"position": [0, 0, 1], "target": [0, 0, 1]}, ["camera target lies 0.0 m from its position"]),
    ],
)
def test_what_is_no_camera_is_told_by_name(candidate: Candidate, given: Any, words: list[str]) -> None:
    with pytest.raises(InputError) as error:
        own_camera(candidate, given, 0, 64, 36)
    assert all(w in str(error.value) for w in words)
