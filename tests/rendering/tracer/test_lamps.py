"""Lamps of the look: their flux, their colour, and that they move with their bodies."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from worldagent.geometry.camera import Camera
from worldagent.rendering.tracer.lights import DAYLIGHT_EFFICACY, LUMINANCE
from worldagent.rendering.tracer.scene import SceneRenderer

NOISE = 0.05
"""Relative; 256 paths over 64 pixels, and the specular lobe of the floor."""
LUMENS = 800.0


def _lit(candidate_of, *, kelvin=2700.0, without=None, frame=0):
    """Colour of the table beside the ball, lit by the ball alone."""

    def lamp(data):
        data["materials"]["wood"]["appearance"] = {"color": (0.5, 0.5, 0.5), "roughness": 1.0}
        data["entities"]["ball"]["parts"]["body"]["shape"]["radius"] = 0.05
        data["entities"]["ball"]["dimensions"]["size"] = (0.1, 0.1, 0.1)
        data["look"]["lamps"] = {"bulb": {"entity": "ball", "part": "body", "lumens": LUMENS, "kelvin": kelvin}}

    candidate = candidate_of(change=lamp)
    candidate = dataclasses.replace(candidate, built={n: candidate.built[n] for n in ("table", "ball")})
    scene = SceneRenderer(candidate, lights={})
    if frame or without:
        scene.pose(frame, without)
    at = candidate.pose("ball", frame, "body").position
    camera = Camera(np.array([at[0] + 0.15, at[1], 0.5]), np.array([at[0] + 0.15, at[1], 0.0]), 2.0, 8, 8)
    return scene.radiance(camera, 256).mean(axis=(0, 1)), at


@pytest.mark.parametrize("frame", [0, 4])
def test_a_lamp_gives_the_illuminance_of_its_lumens_wherever_its_body_is(make_candidate, frame):
    """Law: a small sphere of flux P lights a plane at distance d, seen under the angle t from above, with P cos t / (4 pi d^2)."""
    color, at = _lit(make_candidate, frame=frame)
    distance = math.hypot(0.15, at[2])
    illuminance = LUMENS / DAYLIGHT_EFFICACY / (4 * math.pi * distance**2) * at[2] / distance
    assert color @ LUMINANCE == pytest.approx(0.5 / math.pi * illuminance, rel=0.25)


def test_a_warm_lamp_is_redder_than_daylight_and_as_bright(make_candidate):
    warm, _ = _lit(make_candidate, kelvin=2700.0)
    cold, _ = _lit(make_candidate, kelvin=6500.0)
    assert warm[0] / warm[2] > 4 * cold[0] / cold[2]
    assert warm @ LUMINANCE == pytest.approx(cold @ LUMINANCE, rel=NOISE)


def test_a_lamp_that_is_left_out_gives_no_light(make_candidate):
    lit, _ = _lit(make_candidate)
    dark, _ = _lit(make_candidate, without="ball")
    assert dark.max() < 1e-4 * lit.max()
