"""Sides of surfaces: what lies beside a solid is not in it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from worldagent.testing.worlds.liquid_worlds import pool_in_tank
from worldagent.verifiers.categories.liquid.barriers import still_barrier
from worldagent.verifiers.categories.liquid.frames import Liquid


def test_a_point_outside_is_told_from_one_inside_a_part(tmp_path: Path) -> None:
    candidate = pool_in_tank(size=(0.4, 0.3, 0.16), spacing=0.04, wall=0.08, frames=2).candidate(tmp_path)
    liquid = Liquid(candidate, "water", candidate.caches["water"])
    liquid.extent = (np.array([-0.2, -0.2, 0.0]), np.array([0.2, 0.2, 0.16]))
    barrier = still_barrier(liquid)
    assert barrier is not None
    skin = 0.25 * barrier.cube
    found = barrier.deeper(np.array([[0.0, 0.0, -skin], [0.0, 0.0, -3 * skin]]), np.array([[0.0, 0.0, -0.04]] * 2))
    assert found.tolist() == [True, False]  # at the surface; in the solid
    over, under, lower = np.array([0.0, 0.0, 0.001]), np.array([0.0, 0.0, -0.03]), np.array([0.0, 0.0, -0.04])
    found = barrier.deeper(np.array([over, under, under, over]), np.array([under, over, lower, over]))
    assert found.tolist() == [True, False, False, False]


def test_cubes_inside_of_solids_are_not_outer_ones(tmp_path: Path) -> None:
    candidate = pool_in_tank(size=(0.4, 0.3, 0.16), spacing=0.04, wall=0.16, frames=2).candidate(tmp_path)
    liquid = Liquid(candidate, "water", candidate.caches["water"])
    liquid.extent = (np.array([-0.2, -0.2, 0.0]), np.array([0.2, 0.2, 0.16]))
    barrier = still_barrier(liquid)
    assert barrier is not None
    (water, wall), inside = barrier.cells(np.array([[0.0, 0.0, 0.08], [0.0, 0.0, -0.08]]))
    assert inside.all()
    assert [bool(barrier.closed[tuple(c)]) for c in (water, wall)] == [False, False]
    assert [bool(barrier.outer[tuple(c)]) for c in (water, wall)] == [True, False]
