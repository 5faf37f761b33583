"""Energy of impacts against mechanics."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.physics.dust import impact_energy, reduced_mass

WALL = np.array(np.inf)


def test_a_dead_stop_at_a_wall_takes_all_kinetic_energy() -> None:
    mass, speed = np.array(3.0), np.array(4.0)
    found = impact_energy(mass * speed, speed, reduced_mass(mass, WALL))
    assert float(found) == pytest.approx(0.5 * 3.0 * 4.0**2)


def test_of_two_free_bodies_it_takes_the_energy_of_their_reduced_mass() -> None:
    a, b, closing = np.array(2.0), np.array(6.0), np.array(5.0)
    reduced = reduced_mass(a, b)
    assert float(reduced) == pytest.approx(1.5)
    assert float(impact_energy(reduced * closing, closing, reduced)) == pytest.approx(0.5 * 1.5 * 5.0**2)


def test_what_carries_a_body_that_has_landed_gives_no_energy() -> None:
    mass, speed = np.array(3.0), np.array(4.0)
    carried = mass * speed + 3.0 * 9.81 * 0.04
    assert float(impact_energy(carried, speed, mass)) == pytest.approx(0.5 * 3.0 * 4.0**2)


def test_a_corner_that_takes_a_small_impulse_takes_little() -> None:
    assert float(impact_energy(np.array(1.0), np.array(4.0), np.array(3.0))) == pytest.approx(2.0)


def test_bodies_that_part_give_none() -> None:
    assert impact_energy(np.array([2.0, 2.0]), np.array([-1.0, 0.0]), np.array([1.0, 1.0])).tolist() == [0.0, 0.0]
