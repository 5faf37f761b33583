"""Stiffness that follows lost bonds: against one that is factorised anew."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.construction import build_entity
from worldagent.simulation.fracture.network import BondNetwork
from worldagent.simulation.fracture.stiffness import Stiffness
from worldagent.tests.physics import rigid_world
from worldagent.tests.physics.fracture_world import struck_wall
from worldagent.worlds.bonds import components


@pytest.fixture(scope="module")
def network() -> BondNetwork:
    spec = struck_wall(0.0, size=(1.25, 0.8))
    built = build_entity(spec, "wall", rigid_world.NO_ASSETS)
    assert built.bonds is not None
    breakable = spec.entities["wall"].breakable
    assert breakable is not None
    centers = np.array([b.pose.position for b in built.bodies])
    mass, inertia = np.array([b.mass for b in built.bodies]), np.array([b.inertia for b in built.bodies])
    return BondNetwork(built.bonds, centers, breakable.bond, mass, inertia)


@pytest.mark.parametrize("within", [0.0, 1e-4, 1e-3])
def test_a_stiffness_that_lost_bonds_and_pieces_is_that_of_what_is_left(network: BondNetwork, within: float) -> None:
    count = len(network.mass)
    assert count > 40  # the sparse factorisation
    random, whole = np.random.default_rng(1), np.ones(len(network.bonds), dtype=bool)
    near = np.argsort(np.linalg.norm(network.bonds.point - (0.1, 0.0, 0.1), axis=1))
    known = Stiffness(network, np.arange(count), whole, held=True, within=within)
    followed, fewest = 0, count
    for last in range(2, 24, 2):
        whole[near[last - 2 : last]] = False
        labels, _ = components(count, network.bonds, whole)
        pieces = np.flatnonzero(labels == np.bincount(labels).argmax())
        loads = random.normal(size=(len(pieces), 6)) * (1e3, 1e3, 1e3, 10.0, 10.0, 10.0)
        assert known.follow(pieces, whole)
        anew = Stiffness(network, pieces, whole, held=True, within=within)
        assert np.array_equal(known.bonds, anew.bonds)
        wanted = network.carry(anew, loads)
        assert np.abs(network.carry(known, loads) - wanted).max() < 1e-9 * np.abs(wanted).max()
        followed, fewest = followed + 1, min(fewest, len(pieces))
    assert followed == 11
    assert fewest < count  # pieces came off on the way


def test_a_stiffness_without_its_ground_or_after_many_losses_is_made_anew(network: BondNetwork) -> None:
    count, whole = len(network.mass), network.bonds.pieces[:, 1] >= 0
    free = Stiffness(network, np.arange(count), whole, held=False)
    assert not free.follow(np.arange(1, count), whole)
    few = whole.copy()
    few[np.flatnonzero(whole)[:40]] = False
    assert not Stiffness(network, np.arange(count), whole, held=False).follow(np.arange(count), few)
