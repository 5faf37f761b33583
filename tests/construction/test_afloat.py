"""Float lines against Archimedes: solids by their density, open hulls by the air in them."""

import numpy as np
import pytest
from worldagent.construction.afloat import float_line, submerged
from worldagent.construction.primitives import build_shape
from worldagent.construction.scenes import Body
from worldagent.geometry import Solid
from worldagent.worlds.arrays import RigidPose, euler_to_quaternion
from worldagent.worlds.errors import InputError
from worldagent.worlds.shapes import Box, Revolution, Sphere

UP = np.array([1.0, 0.0, 0.0, 0.0])
LEVEL = 2.0


def body_of(tmp_path, *placed):
    """Shapes at places, as one body."""
    return Body(
        tuple(
            (RigidPose(np.array(place, dtype=float), UP), Solid.from_mesh(build_shape(shape, tmp_path).render, closed=True))
            for shape, place in placed
        )
    )


def tub(tmp_path, *, hole=False):
    """Open box of planks 1 cm thick, 2 x 1 x 0.5 m outside; with a hole the long side of one half is missing."""
    t = 0.01
    planks: list[tuple[Box, tuple[float, float, float]]] = [
        (Box(size=(2, 1, t)), (0, 0, t / 2)),
        (Box(size=(2, t, 0.5 - t)), (0, 0.5 - t / 2, 0.25 + t / 2)),
    ]
    planks += [(Box(size=(t, 1 - 2 * t, 0.5 - t)), (s * (1 - t / 2), 0, 0.25 + t / 2)) for s in (-1, 1)]
    planks += [(Box(size=(1.0 if hole else 2, t, 0.5 - t)), (0.5 if hole else 0, -0.5 + t / 2, 0.25 + t / 2))]
    return body_of(tmp_path, *planks)


@pytest.mark.parametrize("euler", [(0.0, 0.0, 0.0), (0.4, -0.3, 0.9)])
def test_the_volume_under_a_plane_is_exact(tmp_path, euler):
    """A cube cut through its centre loses half, wherever it is and however it is turned; below and above it is all and nothing."""
    solid = body_of(tmp_path, (Box(size=(1, 2, 3)), (0, 0, 0))).solids[0][1]
    pose = RigidPose(np.array([5.0, -3.0, 1.0]), euler_to_quaternion(euler))
    triangles = pose.apply(solid.triangles.reshape(-1, 3)).reshape(-1, 3, 3)
    assert submerged(triangles, 1.0)[0] == pytest.approx(3.0, rel=1e-12)
    whole, middle = submerged(triangles, 9.0)
    assert whole == pytest.approx(6.0, rel=1e-12)
    assert middle / whole == pytest.approx([5.0, -3.0], rel=1e-12)
    assert submerged(triangles, -9.0)[0] == 0.0


@pytest.mark.parametrize("density", [250.0, 700.0, 990.0])
def test_a_block_lies_as_deep_as_its_density_says(tmp_path, density):
    block = body_of(tmp_path, (Box(size=(2, 1, 0.5)), (0, 0, 0)))
    found = float_line(block, RigidPose(np.array([4.0, 1, 77]), UP), density, np.zeros(3), density=1000.0, level=LEVEL)
    assert found.draught == pytest.approx(0.5 * density / 1000, rel=1e-7)
    assert found.pose.position == pytest.approx([4, 1, LEVEL + 0.25 - found.draught], abs=1e-7)
    assert found.freeboard == pytest.approx(0.5 - found.draught)
    assert found.lever == pytest.approx(0.0, abs=1e-9)


def test_a_ball_of_half_the_density_floats_at_its_middle(tmp_path):
    ball = body_of(tmp_path, (Sphere(radius=0.3), (0, 0, 0)))
    found = float_line(
        ball, RigidPose(np.zeros(3), UP), 0.5 * 1025 * ball.solids[0][1].volume, np.zeros(3), density=1025.0, level=LEVEL
    )
    assert found.pose.position[2] == pytest.approx(LEVEL, abs=1e-6)


def test_an_open_hull_displaces_its_air_up_to_the_rim(tmp_path):
    """200 kg in a tub of 2 m^2: 0.1 m, whatever its planks displace by themselves."""
    found = float_line(tub(tmp_path), RigidPose(np.zeros(3), UP), 200.0, np.array([0.1, 0, 0.2]), density=1000.0, level=LEVEL)
    assert found.draught == pytest.approx(0.1, rel=0.01)
    assert found.displaced == pytest.approx(0.2, rel=1e-6)
    assert found.lever == pytest.approx(0.1, rel=0.02)


def test_a_bowl_of_one_solid_floats_on_its_air(tmp_path):
    profile = [(0, 0), (0.5, 0), (0.5, 0.4), (0.49, 0.4), (0.49, 0.01), (0, 0.01)]
    bowl = body_of(tmp_path, (Revolution(profile=profile, segments=128), (0, 0, 0)))
    found = float_line(bowl, RigidPose(np.zeros(3), UP), 157.0, np.zeros(3), density=1000.0, level=LEVEL)
    assert found.draught == pytest.approx(157 / 1000 / (np.pi * 0.25), rel=0.01)


def test_what_is_too_heavy_or_leaks_sinks(tmp_path):
    pose = RigidPose(np.zeros(3), UP)
    with pytest.raises(InputError, match="sinks: of 1100 kg"):
        float_line(tub(tmp_path), pose, 1100.0, np.zeros(3), density=1000.0, level=LEVEL)
    with pytest.raises(InputError, match="sinks"):
        float_line(tub(tmp_path, hole=True), pose, 200.0, np.zeros(3), density=1000.0, level=LEVEL)
