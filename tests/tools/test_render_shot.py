"""Pictures by a call: what stands beside them."""

from __future__ import annotations

import pytest
from worldagent.tests.stories.small_run import BALL, GAP, PROMPT, TOP, small_spec
from worldagent.tools.edit_spec import edit_spec
from worldagent.tools.place_object import place_object
from worldagent.tools.render_shot import render_shot
from worldagent.workflow.context import ToolContext
from worldagent.workflow.taken_pictures import USUAL_SIZE, size_of


@pytest.mark.parametrize("height", [BALL, 0.5])
def test_a_camera_inside_a_body_is_told_beside_its_picture(context: ToolContext, height: float) -> None:
    """The ball is at its place; half a metre higher the air is free."""
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    place_object(context, world="w")
    eye = [-0.2, 0.0, TOP + GAP + height, 0.3, 0.0, TOP]
    reply = render_shot(context, world="w", camera=eye, width=64, height=64)
    told = [w for w in reply.data["warnings"] if "the camera is inside" in w]
    assert told == (["the camera is inside ball at frame 0: move it out"] if height == BALL else [])
    assert reply.pictures


@pytest.mark.parametrize(
    ("asked", "drawn"),
    [
        ((420, None), (420, 236)),
        ((None, 720), (1280, 720)),
        ((None, None), (640, 360)),
        ((100, 300), (100, 300)),
        ((64, None), (64, 64)),
    ],
)
def test_one_side_keeps_the_shape_of_the_picture(asked: tuple[int | None, int | None], drawn: tuple[int, int]) -> None:
    assert size_of(asked, USUAL_SIZE) == drawn
