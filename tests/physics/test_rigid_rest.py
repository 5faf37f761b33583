"""Rest, containers and extreme scales."""

import numpy as np
import pytest
from worldagent.tests.physics.rigid_world import G, Run, ball, box, entity, floor, world, worst_clearance

DRIFT = 1e-3
"""[m] Gate of the table for a stack of ten over ten seconds."""
BOWL = [(0.0, 0.0), (0.15, 0.0), (0.3, 0.15), (0.28, 0.15), (0.14, 0.02), (0.0, 0.02)]


@pytest.mark.parametrize("sleep", [True, False])
def test_a_stack_of_ten_boxes_stands_for_ten_seconds(sleep):
    stack = {f"b{k}": box(0.1, 0.1, 0.1, at=(0, 0, 0.05 + 0.1 * k)) for k in range(10)}
    run = Run(world({"ground": floor(), **stack}, seconds=10.0 if sleep else 3.0, fps=12, settings={"sleep": sleep}))
    assert max(np.abs(run.of(n) - run.of(n)[0]).max() for n in stack) < DRIFT
    assert run.events() == []
    assert worst_clearance(run)[0] >= 0


def test_a_heavy_box_rests_on_a_light_one():
    stack = {"light": box(0.2, 0.2, 0.1, at=(0, 0, 0.05), mass=0.01), "heavy": box(0.2, 0.2, 0.2, at=(0, 0, 0.2), mass=100.0)}
    run = Run(world({"ground": floor(), **stack}, seconds=2.0))
    assert worst_clearance(run)[0] >= 0
    assert max(np.abs(run.of(n) - run.of(n)[0]).max() for n in stack) < DRIFT


@pytest.mark.parametrize("shape", ["ball", "cube"])
def test_what_falls_into_a_bowl_stays_there(shape):
    bowl = entity({"kind": "revolution", "profile": BOWL, "segments": 24}, motion="static")
    thing = (
        ball(0.04, at=(0.12, 0.02, 0.3), v=(0.3, 0.2, 0))
        if shape == "ball"
        else box(0.06, 0.06, 0.06, at=(0.1, 0, 0.25), w=(3, 5, 1))
    )
    run = Run(world({"bowl": bowl, "thing": thing}, seconds=2.0, restitution=0.2))
    end = run.of("thing")[-1]
    assert np.hypot(end[0], end[1]) < 0.2
    assert 0.02 < end[2] < 0.12
    assert worst_clearance(run)[0] >= 0


def test_a_ball_comes_to_rest_in_the_valley_of_a_height_field():
    x = np.linspace(-1, 1, 33)
    heights = 0.3 * (x[None, :] ** 2 + x[:, None] ** 2) + 0.02 * np.sin(9 * x)[None, :]
    ground = entity({"kind": "heightfield", "size": (2, 2), "heights": heights.tolist()}, motion="static")
    run = Run(
        world(
            {"ground": ground, "s": ball(0.12, at=(0.4, 0.3, 0.5), material="felt")},
            seconds=6.0,
            materials={"felt": {"density": 500.0, "friction": 0.8, "rolling_friction": 0.01}},
        )
    )
    assert np.linalg.norm(run.of("s", "velocity")[-1]) < 0.02
    assert np.hypot(*run.of("s")[-1, :2]) < 0.35
    assert worst_clearance(run)[0] >= 0


def _u_mesh():
    """A U of 0.5 x 0.2 x 0.3 with walls of 0.05, as a triangle mesh."""
    from worldagent.construction.primitives import build_shape
    from worldagent.tests.physics.rigid_world import NO_ASSETS
    from worldagent.worlds.spec import Extrusion

    polygon = [(-0.25, 0), (0.25, 0), (0.25, 0.3), (0.2, 0.3), (0.2, 0.05), (-0.2, 0.05), (-0.2, 0.3), (-0.25, 0.3)]
    return build_shape(Extrusion(polygon=polygon, height=0.2), NO_ASSETS).render


def test_a_ball_dropped_into_a_concave_mesh_stays_in_it():
    mesh = _u_mesh()
    shape = {"kind": "mesh", "vertices": mesh.vertices.tolist(), "faces": mesh.faces.tolist()}
    cup = entity(shape, motion="static", euler=(np.pi / 2, 0, 0))
    run = Run(world({"cup": cup, "s": ball(0.08, at=(0.05, 0, 0.4))}, seconds=2.0, restitution=0.2))
    end = run.of("s")[-1]
    assert end[2] == pytest.approx(0.05 + 0.08, abs=0.01)
    assert abs(end[0]) < 0.13
    assert worst_clearance(run)[0] >= 0


@pytest.mark.parametrize(("size", "step"), [(0.001, 2e-5), (100.0, 5e-4)])
def test_very_small_and_very_large_bodies_fall_and_rest(size, step):
    skin = min(5e-4, 0.02 * size)
    drop = box(size, size, size, at=(0, 0, 0.6 * size))
    ground = box(5 * size, 5 * size, size, at=(0, 0, -0.5 * size), motion="static")
    seconds = 0.05 if size < 1 else 3.0
    run = Run(world({"ground": ground, "b": drop}, seconds=seconds, fps=120, settings={"skin": skin, "step": step}))
    fall = np.sqrt(2 * 0.1 * size / G)
    before = run.time < 0.8 * fall
    assert run.of("b")[before, 2] == pytest.approx(0.6 * size - 0.5 * G * run.time[before] ** 2, abs=0.01 * size)
    after = run.time > 1.3 * fall
    assert run.of("b")[after][-1, 2] == pytest.approx(0.5 * size + 2 * skin, abs=max(1e-3 * size, 2e-6))
    assert worst_clearance(run, skip_above=size)[0] >= 0
