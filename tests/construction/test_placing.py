"""Places of many by their outlines, sides of other things, slopes: measured on the surfaces themselves."""

import numpy as np
import pytest
from worldagent.construction.leaning import laid, tilted
from worldagent.construction.placing import approach, side_direction
from worldagent.construction.primitives import build_shape
from worldagent.construction.scatters import Scatter, circle, grid, scatter
from worldagent.construction.scenes import Body, clearance
from worldagent.geometry import Solid, ground_solid
from worldagent.worlds.arrays import RigidPose, euler_to_quaternion, rotation_matrix
from worldagent.worlds.errors import InputError, RefusedError
from worldagent.worlds.shapes import Box, Sphere

UP = np.array([1.0, 0.0, 0.0, 0.0])
ORIGIN = RigidPose(np.zeros(3), UP)


def body_of(shape, tmp_path):
    return Body(((ORIGIN, Solid.from_mesh(build_shape(shape, tmp_path).render, closed=True)),))


@pytest.fixture
def brick(tmp_path):
    return body_of(Box(size=(0.4, 0.2, 0.1)), tmp_path)


def at(x, y, z, yaw=0.0):
    return RigidPose(np.array([x, y, z]), euler_to_quaternion((0.0, 0.0, yaw)))


def settle(pose, body):
    return RigidPose(pose.position - [0, 0, body.box(pose)[0][2]], pose.quaternion)


def asked(**changes):
    numbers = {"count": 30, "polygon": np.array([[0, 0], [6, 0], [6, 2], [2, 2], [2, 6], [0, 6.0]]), "gap": 0.05}
    numbers |= {"sizes": (0.5, 1.5), "random_yaw": True, "seed": 7}
    return Scatter(**{**numbers, **changes})


def test_a_body_comes_to_exactly_the_gap_and_may_pass_by(brick, tmp_path):
    ball = body_of(Sphere(radius=0.3), tmp_path)
    direction = np.array([-1.0, 0.0, 0.0])
    found = approach(brick, at(9, 0.1, 0, yaw=0.3), ball, ORIGIN, direction, 0.07)
    assert found is not None
    assert clearance(brick, found, ball, ORIGIN) == pytest.approx(0.07, abs=2e-6)
    assert found.position[1:].tolist() == [0.1, 0.0]
    assert approach(brick, at(9, 0.1, 2.0), ball, ORIGIN, direction, 0.07) is None


def test_sides_are_those_of_the_world_or_of_the_other_entity():
    turned = at(5, 5, 0, yaw=np.pi / 2)
    assert side_direction("-y", turned) == pytest.approx([0, -1, 0])
    assert side_direction("front", turned) == pytest.approx([0, 1, 0])
    assert side_direction("left", turned) == pytest.approx([-1, 0, 0])
    on_its_nose = RigidPose(np.zeros(3), euler_to_quaternion((0.0, np.pi / 2, 0.0)))
    with pytest.raises(InputError, match="side of the world"):
        side_direction("back", on_its_nose)


def test_a_tilted_body_stands_along_the_normal_of_the_slope(brick):
    x = np.linspace(-5, 5, 21)
    slope = Body(((ORIGIN, Solid.from_mesh(ground_solid(0.3 * x[None] + 0.1 * x[:, None], (10.0, 10.0), 0.5), closed=True)),))
    found = tilted(brick, at(1.0, 2.0, 3.0, yaw=0.7), slope, ORIGIN)
    normal = np.array([-0.3, -0.1, 1.0]) / np.linalg.norm([0.3, 0.1, 1.0])
    assert rotation_matrix(found.quaternion)[:, 2] == pytest.approx(normal, abs=1e-9)
    with pytest.raises(InputError, match="nothing to tilt to"):
        tilted(brick, at(9.0, 2.0, 3.0), slope, ORIGIN)


def test_a_body_is_laid_on_the_nearest_side_on_which_it_stays(brick):
    tipped = RigidPose(np.zeros(3), euler_to_quaternion((0.5, 0.2, 0.0)))
    found = rotation_matrix(laid(brick, tipped, np.zeros(3)).quaternion)
    assert np.abs(found[:, 2]) == pytest.approx([0, 0, 1], abs=1e-9)
    top_heavy = laid(brick, tipped, np.array([0.19, 0.0, 0.0]))
    assert abs(rotation_matrix(top_heavy.quaternion)[2, 0]) == pytest.approx(1, abs=1e-9), "on its heavy end"


def test_a_scatter_lies_in_its_polygon_apart_and_equal_for_equal_seeds(brick):
    places = scatter(asked(), brick, UP, settle, lambda pose, body: True)
    again = scatter(asked(), brick, UP, settle, lambda pose, body: True)
    assert all((a.pose.position == b.pose.position).all() and a.size == b.size for a, b in zip(places, again, strict=True))
    other = scatter(asked(seed=8), brick, UP, settle, lambda pose, body: True)
    assert any((a.pose.position != b.pose.position).any() for a, b in zip(places, other, strict=True))
    bodies = [brick.scaled(p.size) for p in places]
    corners = np.concatenate([b.points(p.pose) for b, p in zip(bodies, places, strict=True)])
    assert ((corners[:, :2] > 0) & (corners[:, :2] < 6)).all()
    assert (corners[:, :2].min(1) < 2).all(), "none in the notch"
    pairs = [(i, j) for i in range(30) for j in range(i)]
    assert min(clearance(bodies[i], places[i].pose, bodies[j], places[j].pose) for i, j in pairs) >= 0.05
    assert places[0].size == 1.0
    assert 0.5 < min(p.size for p in places[1:]) < 0.8 < 1.2 < max(p.size for p in places) < 1.5
    assert [b.box(p.pose)[0][2] for b, p in zip(bodies, places, strict=True)] == pytest.approx([0] * 30, abs=1e-12)


def test_a_scatter_keeps_off_what_is_there_and_says_when_no_more_fit(brick):
    places = scatter(asked(count=8), brick, UP, settle, lambda pose, body: bool(pose.position[0] > 3))
    assert min(p.pose.position[0] for p in places) > 3
    with pytest.raises(RefusedError, match=r"\d+ of 400 find a place"):
        scatter(asked(count=400), brick, UP, settle, lambda pose, body: True)
    with pytest.raises(InputError, match="no area"):
        scatter(asked(polygon=np.array([[0, 0], [1, 1], [2, 2.0]])), brick, UP, settle, lambda pose, body: True)


def test_grids_and_circles_begin_at_the_original():
    places = list(grid(at(1, 2, 3, yaw=0.4), (3, 2), (0.5, 2.0)))
    assert [p.pose.position.tolist() for p in places] == [[1 + 0.5 * i, 2 + 2 * j, 3] for j in (0, 1) for i in (0, 1, 2)]
    ring = list(circle(at(2, 0, 1), 4, (0.0, 0.0), 2 * np.pi, along=True))
    assert np.array([p.pose.position for p in ring]) == pytest.approx(np.array([[2, 0, 1], [0, 2, 1], [-2, 0, 1], [0, -2, 1]]))
    assert [rotation_matrix(p.pose.quaternion)[:2, 0] @ p.pose.position[:2] / 2 for p in ring] == pytest.approx([1] * 4)
    half = list(circle(at(2, 0, 1), 3, (0.0, 0.0), np.pi, along=False))
    assert half[-1].pose.position == pytest.approx([-2, 0, 1])
    assert (half[-1].pose.quaternion == half[0].pose.quaternion).all()
    with pytest.raises(InputError, match="radius"):
        list(circle(at(0, 0, 1), 3, (0.0, 0.0), np.pi, along=False))
