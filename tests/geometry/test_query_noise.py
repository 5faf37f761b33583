"""The query's own noise (S1): how far flush and near-touching configurations come out from the truth."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.geometry import query_noise, signed_clearance
from worldagent.worlds.arrays import RigidPose, compose

from .meshes import at, ball, box, random_pose, ring


@pytest.mark.parametrize("size", [0.01, 1.0, 30.0])
def test_noise_of_flush_contacts_stays_a_thousandfold_below_eps(size):
    """Law of the construction: the gap is known exactly; the common motion only adds rounding.

    Bodies stand up to 100 sizes from the origin. Measured: 1.3e-15 of the size at the origin, 2.3e-14 at 100
    sizes, where the poses themselves round.
    """
    rng = np.random.default_rng(7)
    worst = 0.0
    for _ in range(60):
        half = size * rng.uniform(0.05, 0.5, (2, 3))
        a, b = box(*(2 * half[0])), box(*(2 * half[1]))
        axis, gap = rng.integers(3), rng.choice([0.0, 1e-9, 1e-6]) * size
        shift = rng.uniform(-1, 1, 3) * (half[0] + half[1]) * rng.choice([0.0, 0.5, 1.0], 3)
        shift[axis] = half[0, axis] + half[1, axis] + gap
        world = random_pose(rng, 30.0 * size)
        found = signed_clearance(a, compose(world, at(*shift)), b, world).distance
        worst = max(worst, abs(found - gap))
    assert worst < 1e-3 * query_noise(size)


def test_noise_of_meshes_of_other_shapes_stays_below_eps():
    """Rings and faceted balls set down flush, turned and carried about."""
    rng = np.random.default_rng(11)
    table = box(3, 3, 0.2)
    round_thing = ball(0.3, 1)
    lowest = -round_thing.vertices[:, 2].min()
    for _ in range(8):
        world = random_pose(rng, 30.0)
        spin = rng.uniform(0, np.pi)
        turn = np.array([np.cos(spin), 0, 0, np.sin(spin)])
        for thing, height in ((ring(), 0.15), (round_thing, lowest)):
            pose = RigidPose(np.array([*rng.uniform(-0.5, 0.5, 2), 0.1 + height]), turn)
            found = signed_clearance(thing, compose(world, pose), table, world).distance
            assert abs(found) < query_noise(1.0)
