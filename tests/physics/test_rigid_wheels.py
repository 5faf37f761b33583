"""A spoked wheel of the generators rolls: on the flat it keeps going, and on a gentle slope it starts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from worldagent.construction.assets.documents import asset_documents
from worldagent.construction.assets.registry import make
from worldagent.construction.assets.wheels import facets
from worldagent.tests.physics.rigid_world import G, Run, box, world
from worldagent.worlds.arrays import RigidPose

RADIUS = 0.3
DENSITIES = {"steel": 7850.0, "iron": 7200.0}


def _wheel(**physics: Any) -> dict[str, Any]:
    """The front left wheel of a cart, by itself at the origin."""
    parameters = {"wheels": "four", "wheel": RADIUS}
    record = {"generator": "cart", "parameters": parameters, "seed": 1, "positions": {}}
    pose = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    wheel = asset_documents("cart", record, make("cart", parameters, 1), pose, motion="dynamic").entities["cart_wheel_front_left"]
    return {**wheel, "physics": {"category": "rigid", **physics}, "pose": {"position": [0, 0, 0.002]}}


def _run(slope: float, seconds: float, **physics: Any) -> Run:
    wheel = _wheel(**physics)
    used = {wheel["material"], *(p.get("material") or wheel["material"] for p in wheel["parts"].values())}
    materials = {n: {"density": next((d for k, d in DENSITIES.items() if k in n), 700.0), "friction": 0.6} for n in used}
    ground = box(30, 30, 1, at=(0, 0, -0.5), motion="static")
    pull = (0.0, G * math.sin(slope), -G * math.cos(slope))
    settings = {"step": 5e-4, "skin": 1e-3}
    plan: dict[str, Any] = {"materials": materials, "friction": 0.6, "settings": settings, "gravity": pull}
    return Run(world({"ground": ground, "wheel": wheel}, seconds=seconds, **plan))


def test_a_wheel_rolls_on_with_the_resistance_of_a_cart_on_a_road() -> None:
    """Its flat sides cost less than 0.02 of its weight, as an iron tyre on a paved road does (0.01 to 0.02); 20 sides cost 0.04."""
    speed = 1.5
    run = _run(0.0, 2.0, linear_velocity=(0, speed, 0), angular_velocity=(-speed / RADIUS, 0, 0))
    lost = speed - run.of("wheel", "velocity")[-1, 1]
    assert 0.0 < lost / (2.0 * G) < 0.02


@pytest.mark.parametrize("spokes", [6, 7, 10, 12])
def test_a_flat_side_holds_no_wheel_on_a_slope_of_five_degrees(spokes: int) -> None:
    assert math.degrees(math.pi / facets(spokes)) <= 5.0


def test_a_wheel_starts_to_roll_down_six_degrees_by_itself() -> None:
    run = _run(math.radians(6.0), 2.0)
    assert run.of("wheel", "velocity")[-1, 1] > 0.4
