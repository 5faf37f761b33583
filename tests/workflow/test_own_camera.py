"""Cameras that a call brings along: what they see, and what is said of those that are none."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, ground, make_candidate, world
from worldagent.workflow.own_camera import own_camera
from worldagent.workflow.pictures import Kind, View, misplaced
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import InputError
from worldagent.worlds.spec import CameraKey, Shot


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


@pytest.mark.parametrize("kind", ["preview", "still", "ids"])
@pytest.mark.parametrize(("frame", "inside"), [(0, False), (1, True)])
def test_a_camera_in_a_body_is_told(candidate: Candidate, kind: Kind, frame: int, inside: bool) -> None:
    """At frame 1 the ball is where the camera stands."""
    eye = own_camera(candidate, [1, 0.02, 0.1, 3, 0, 0.1], frame, 64, 36)
    told = misplaced(candidate, View(kind, frame, frame, None, eye, (64, 36)))
    assert told == (["the camera is inside ball at frame 1: move it out"] if inside else [])


def test_a_camera_that_cuts_a_body_open_is_told(candidate: Candidate) -> None:
    (told,) = misplaced(
        candidate, View("still", 0, 0, None, own_camera(candidate, [3, 0, 0.0005, 0, 0, 0.1], 0, 64, 36), (64, 36))
    )
    assert "mm of floor, which its near plane cuts open at frame 0" in told


def test_a_sheet_tells_the_first_frame_and_drawings_have_no_camera(candidate: Candidate) -> None:
    eye = own_camera(candidate, [1, 0.02, 0.1, 3, 0, 0.1], 0, 64, 36)
    assert misplaced(candidate, View("contact_sheet", 2, 0, None, eye, (64, 36))) == [
        "the camera is inside ball at frame 1: move it out"
    ]
    assert misplaced(candidate, View("contact_sheet", 2, 0, None, eye, (64, 36), frames=[0, 2])) == []
    assert misplaced(candidate, View("plan", 1, 1, None, eye, (64, 36))) == []


def test_the_camera_of_a_shot_in_a_body_is_told(candidate: Candidate) -> None:
    key = CameraKey(frame=0, position=(1, 0.02, 0.1), target=(3, 0, 0.1), fov_deg=40)
    shots = {"only": Shot(frames=(0, 2), covers=[], intent="the ball", keys={"a": key})}
    seen = dataclasses.replace(candidate, spec=candidate.spec.model_copy(update={"shots": shots}))
    assert misplaced(seen, View("preview", 1, 1, "only", None, (64, 36))) == ["the camera is inside ball at frame 1: move it out"]
    assert misplaced(seen, View("preview", 0, 0, "only", None, (64, 36))) == []
