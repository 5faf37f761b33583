"""Rigid bodies in force fields: terminal velocity, drag law, attraction, and impulses that the ledger counts."""

import numpy as np
import pytest
from worldagent.tests.physics.rigid_world import G, Run, ball, box, floor, world

FACETS = 0.015
"""Relative: a ball's hull shows less area than its sphere."""


def _field(law, **more):
    return {"f": {"kind": "field", "field": law, **more}}


def test_a_ball_falls_at_its_terminal_velocity():
    run = Run(world({"b": ball(0.1, mass=0.05)}, seconds=4.0, drivers=_field({"kind": "drag", "coefficient": 0.47})))
    terminal = np.sqrt(2 * 0.05 * G / (1.204 * 0.47 * np.pi * 0.01))
    assert run.of("b", "velocity")[-1, 2] == pytest.approx(-terminal, rel=FACETS)


def test_wind_speeds_a_box_up_by_the_square_law_from_its_start_on():
    law = {"kind": "wind", "velocity": (10, 0, 0)}
    run = Run(world({"b": box(0.2, 0.2, 0.2, mass=0.5)}, seconds=2.0, gravity=(0, 0, 0), drivers=_field(law, start=0.5)))
    rate = 0.5 * 1.204 * 0.04 / 0.5
    assert run.of("b", "velocity")[-1] == pytest.approx([10 - 10 / (1 + rate * 10 * 1.5), 0, 0], rel=1e-4, abs=1e-12)
    assert run.series("driver/active")[:, 0].tolist() == [*[0] * 13, *[1] * 36]
    given = np.cumsum(run.series("field/impulse")[:, 0], axis=0)
    assert 0.5 * run.of("b", "velocity") == pytest.approx(given, abs=1e-9)


def test_attraction_keeps_a_circling_body_on_its_circle():
    law = {"kind": "attraction", "center": (0, 0, 0), "acceleration": 8.0, "distance": 2.0}
    run = Run(world({"b": ball(0.1, at=(2, 0, 0), v=(0, 4, 0), mass=3.0)}, seconds=3.0, gravity=(0, 0, 0), drivers=_field(law)))
    assert np.linalg.norm(run.of("b"), axis=1) == pytest.approx(2.0, rel=2e-3)


def test_a_body_at_rest_feels_the_wind_that_begins_and_a_held_one_does_not():
    drivers = {
        **_field({"kind": "wind", "velocity": (30, 0, 0)}, start=1.0),
        "hold": {"kind": "release", "entity": "held", "time": 1.5},
    }
    entities = {
        "ground": floor(),
        "b": box(0.3, 0.3, 0.3, at=(0, 0, 0.151), mass=2.0),
        "held": box(0.3, 0.3, 0.3, at=(0, 2, 1.0), mass=2.0),
    }
    run = Run(world(entities, seconds=2.0, drivers=drivers))
    assert run.series("asleep")[23, run.index.bodies.index("b/body")] == 1
    assert run.of("b")[-1, 0] > 0.5
    impulse = run.series("field/impulse")
    assert (impulse[:37, run.index.bodies.index("held/body")] == 0).all()
    assert (impulse[37:, run.index.bodies.index("held/body"), 0] > 0).all()


def test_a_field_names_whom_it_moves():
    law = {"kind": "attraction", "center": (5, 0, 0), "acceleration": 2.0, "distance": 1.0, "exponent": 0.0}
    entities = {"a": ball(0.1), "b": ball(0.1, at=(0, 1, 0))}
    run = Run(world(entities, seconds=0.5, gravity=(0, 0, 0), drivers=_field(law, entities=["a"])))
    assert run.of("a", "velocity")[-1, 0] == pytest.approx(1.0, rel=1e-6)
    assert (run.of("b") == run.of("b")[0]).all()
