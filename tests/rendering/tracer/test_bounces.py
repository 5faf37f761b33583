"""Light that bounces: closed rooms keep what their walls give back, panes let through what Fresnel's equations say."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
from worldagent.geometry.camera import Camera
from worldagent.rendering.tracer import scene
from worldagent.rendering.tracer.clear_path import PANE_IOR
from worldagent.tests.physics import rigid_world
from worldagent.tests.physics.fracture_world import simulate
from worldagent.worlds.spec import WorldSpec

HALF = 1.0
"""[m] Half a side of the closed room."""


def _closed_room():
    """A closed cube of six white slabs, with a small light under its ceiling."""
    slabs = {}
    for axis, name in enumerate("xyz"):
        for side in (-1, 1):
            size, at = [2.2 * HALF] * 3, [0.0] * 3
            size[axis], at[axis] = 0.1, side * (HALF + 0.05)
            slabs[f"{name}{'_far' if side > 0 else '_near'}"] = rigid_world.box(*size, at=at, motion="static")
    white = {"m": {"density": 1000.0, "appearance": {"color": (0.85, 0.85, 0.85), "roughness": 1.0}}}
    data = rigid_world.world(slabs, seconds=1 / 24, materials=white).model_dump(mode="json")
    data["look"] = {"lights": {"lamp": {"position": (0, 0, 0.9), "target": (0, 0, 0), "size": 0.1, "power": 100}}}
    return WorldSpec.model_validate(data)


def test_a_white_room_keeps_the_light_that_its_walls_give_back(tmp_path, monkeypatch):
    """Walls that give back 0.85 bring a third of the light by sixth and later bounces; next to none of it may be cut off."""
    candidate = simulate(tmp_path, _closed_room())
    camera = Camera(np.array([0.9, 0.0, -0.9]), np.array([-1.0, 0.0, 0.2]), 60.0, 24, 16)
    found = {}
    for depth in (5, scene.PATH_DEPTH, 200):
        monkeypatch.setattr(scene, "PATH_DEPTH", depth)
        found[depth] = float(np.median(scene.SceneRenderer(candidate).radiance(camera, 256)))
    cut, ours, whole = found.values()
    assert cut < 0.8 * whole
    assert ours == pytest.approx(whole, rel=0.04)


def _let_through(ior: float) -> float:
    """Share of diffuse light that two faces of a plate let through one after the other, as for light without polarisation."""
    angle = (np.arange(4000) + 0.5) / 4000 * np.pi / 2
    cosine, inner = np.cos(angle), np.sqrt(1 - (np.sin(angle) / ior) ** 2)
    across = ((cosine - ior * inner) / (cosine + ior * inner)) ** 2
    along = ((inner - ior * cosine) / (inner + ior * cosine)) ** 2
    through = (1 - 0.5 * (across + along)) ** 2
    return float(2 * (through * cosine * np.sin(angle)).mean() * np.pi / 2)


CHILD = """
import numpy as np
from worldagent.rendering.tracer.clear_path import clear_path
from worldagent.rendering.tracer.variant import load_mitsuba
mi = load_mitsuba()
place = mi.ScalarTransform4f()
matt = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.05}}
floor = mi.load_dict({"type": "rectangle", "to_world": place.scale(50), "bsdf": matt})
pane = {"type": "cube", "to_world": place.translate([0, 0, 0.05]).scale([50, 50, 0.002]), "bsdf": {"type": "dielectric"}}
pane = mi.load_dict(pane)
sky = {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}}
film = {"type": "hdrfilm", "width": 16, "height": 16, "pixel_format": "rgb"}
eye = place.look_at(origin=[0, 0, 0.02], target=[0.005, 0, 0], up=[1, 0, 0])
camera = mi.load_dict({"type": "perspective", "to_world": eye, "film": film, "fov": 20})
world = mi.load_dict({"type": "scene", "sky": sky, "floor": floor, "pane": pane})
seen = mi.render(world, sensor=camera, integrator=clear_path(mi, [], [], [pane], 9), spp=512)
print(float(np.array(seen).mean()) / 0.05)
"""
"""A process of its own: this one has the scalar variant, which crosses no panes straight."""


def test_a_pane_lets_through_the_diffuse_light_that_fresnel_says():
    """0.84 of it at an index of 1.5: a matt floor under a pane below a uniform sky."""
    environment = {k: v for k, v in os.environ.items() if k != "WORLDAGENT_MITSUBA_VARIANT"}
    ask = "from worldagent.rendering.tracer.variant import choose_variant; print(choose_variant().name)"

    def told(text: str) -> str:
        ended = subprocess.run([sys.executable, "-c", text], env=environment, capture_output=True, text=True, check=False)
        assert ended.returncode == 0, ended.stderr[-2000:]
        return ended.stdout.split()[-1]

    if told(ask).startswith("scalar"):
        pytest.skip("no vectorised variant of Mitsuba on this machine")
    assert float(told(CHILD)) == pytest.approx(_let_through(PANE_IOR), rel=0.02)
