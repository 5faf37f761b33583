"""Grains on height fields: what rolls down a slope of many triangles rolls as on a plane, and an avalanche comes to rest with all its grains."""

import math

import numpy as np
import pytest
from worldagent.geometry.heightfields import ground_solid
from worldagent.simulation.boundaries import Boundary
from worldagent.tests.physics.grains import G, grains, still
from worldagent.worlds.built import TriangleMesh

R = 0.02


def ground(height, samples, half=1.0, friction=0.5):
    """A height field `height(x, y)` [m] over a square, as the closed solid that grains get of built terrain."""
    axis = np.linspace(-half, half, samples)
    solid = ground_solid(height(*np.meshgrid(axis, axis)), (2 * half, 2 * half), 0.2)
    return Boundary("ground/body", TriangleMesh(solid.vertices, solid.faces), "static", True, friction)


def test_a_ball_rolls_over_the_seams_of_a_height_field_as_down_a_plane():
    slope = 0.25
    field = ground(lambda x, y: 0.5 + slope * x, 97)
    angle = math.atan(slope)
    start = np.array([0.6, 0.013, 0.5 + 0.6 * slope]) + R * np.array([-math.sin(angle), 0, math.cos(angle)])
    engine = grains([start], R, gravity=(0, 0, -G), walls=(field,), young=1e7, friction=0.5)
    before = engine.columns()
    seconds, heights = 0.6, []
    for _ in range(30):
        engine.step(seconds / 30, still(1))
        place = engine.columns()["position"][0]
        heights.append((place[2] - 0.5 - slope * place[0]) * math.cos(angle) / R)
    c = engine.columns()
    speed = float(np.linalg.norm(c["velocity"][0]))
    assert speed == pytest.approx(5 / 7 * G * math.sin(angle) * seconds, rel=0.01)
    assert abs(c["velocity"][0, 1]) < 2e-3 * speed
    assert abs(c["spin"][0, 1]) * R == pytest.approx(speed, rel=0.01)
    assert max(heights) < 1.001, "it never leaves the ground at a seam"
    assert min(heights) > 0.99
    went = float(np.linalg.norm(c["position"][0] - before["position"][0]))
    assert went == pytest.approx(5 / 14 * G * math.sin(angle) * seconds**2, rel=0.01)


def slope_and_flat(x, y):
    """A slope of 35 degrees that runs out into a plain, with bumps half a grain high."""
    bumps = 0.25 * R * np.sin(2.2 * x / R) * np.sin(1.9 * y / R)
    return 0.2 + np.maximum(0.0, x) * math.tan(math.radians(35)) + bumps


@pytest.mark.slow
def test_an_avalanche_on_a_built_slope_settles_on_the_plain_and_loses_no_grain():
    field = ground(slope_and_flat, 257)
    rng = np.random.default_rng(4)
    cells = np.stack(np.meshgrid(np.arange(8), np.arange(8), np.arange(4), indexing="ij"), axis=-1).reshape(-1, 3)
    place = (0.4, -0.17, 0.0) + cells * 2.15 * R * np.array([0.9, 1.0, 1.0]) + rng.uniform(-1, 1, (256, 3)) * 0.05 * R
    place[:, 2] += slope_and_flat(place[:, 0], place[:, 1]) + 2.5 * R
    engine = grains(place, R * rng.uniform(0.8, 1.0, 256), gravity=(0, 0, -G), walls=(field,), rolling=0.2, restitution=0.2)
    energy = []
    for _ in range(60):
        engine.step(0.05, still(1))
        c = engine.columns()
        spin = 0.2 * (c["mass"] * c["radius"] ** 2) @ (c["spin"] ** 2).sum(axis=1)
        energy.append(float(0.5 * c["mass"] @ (c["velocity"] ** 2).sum(axis=1) + spin + G * c["mass"] @ c["position"][:, 2]))
    assert engine.count == 256
    assert np.diff(energy).max() < 1e-4 * (energy[0] - energy[-1])
    above = c["position"][:, 2] - slope_and_flat(c["position"][:, 0], c["position"][:, 1])
    assert above.min() > 0.3 * R
    assert np.median(c["position"][:, 0]) < 0.1, "it ran down to the plain"
    assert float(np.linalg.norm(c["velocity"], axis=1).mean()) < 0.01
