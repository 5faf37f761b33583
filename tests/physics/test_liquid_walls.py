"""Particles that fly at rigid bodies alone: what keeps them out takes their velocity and gives it to the body."""

import numpy as np
import pytest
import trimesh
from worldagent.simulation.boundaries import Boundary
from worldagent.simulation.liquid.dfsph import Dfsph, DfsphSettings
from worldagent.tests.physics.liquid_column import bodies, liquid, momentum
from worldagent.worlds.built import TriangleMesh


@pytest.mark.parametrize("speed", [2.0, 10.0])
def test_a_drop_that_hits_a_plate_leaves_its_momentum_there(speed):
    """Law: what comes to rest at a heavy plate gave it all its momentum across it; along it, it slides on."""
    made = trimesh.creation.box((0.1, 0.6, 0.6))
    middle = np.array([0.75, 0.5, 0.5])
    plate = Boundary("plate/body", TriangleMesh(np.array(made.vertices), np.array(made.faces, dtype=np.int32)), "dynamic")
    setup = liquid(
        0.04, (0.04, 0.04, 0.04), (1, 1, 1), gravity=0.0, sides=("open",) * 6, boundaries=(plate,),
        velocity=lambda x: np.tile([speed, 0.3, 0.0], (len(x), 1)),
    )  # fmt: skip
    setup.position[:] = [0.5, 0.5, 0.5]
    state = bodies((middle, (0, 0, 0), 1e-6, np.zeros((3, 3)), (0, 0, 0)))
    engine, given = Dfsph(setup, DfsphSettings(max_step=5e-3)), np.zeros(3)
    before = momentum(engine)[0]
    while engine.time < 0.4:
        given += engine.step(1.0, state).impulse[0, :3]
    after = momentum(engine)[0]
    assert after + given == pytest.approx(before, abs=1e-5 * speed)
    assert abs(after[0]) < 0.02 * before[0]
    assert given[0] > 0.98 * before[0]
    assert after[1] == pytest.approx(before[1], rel=0.05)
