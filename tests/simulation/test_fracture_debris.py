"""Measures that make debris affordable: the order of its bodies, contacts that stay as soft as they were, loads that are not solved for anew."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from worldagent.construction import build_entity
from worldagent.simulation.fracture.clusters import Cluster, clusters_of, elimination
from worldagent.simulation.fracture.pieces import CHANGE, LATEST, Pieces, pieces_of
from worldagent.simulation.rigid.crumbling import EXCESS, HARDENING, STIFFNESS_OF_STEP, Crumbling, Weak
from worldagent.tests.physics import rigid_world
from worldagent.tests.physics.fracture_world import struck_wall
from worldagent.worlds.bonds import WORLD
from worldagent.worlds.built import BuiltEntity

NONE = np.zeros(0, dtype=np.int64)


@pytest.fixture(scope="module")
def pieces() -> Pieces:
    spec = struck_wall(0.0, size=(1.25, 0.8))
    return pieces_of(spec, build_entity(spec, "wall", rigid_world.NO_ASSETS), "wall")


def _fill(built: BuiltEntity, order: list[int]) -> int:
    """Blocks below the diagonal of a factor whose unknowns are single pieces, eliminated in this order."""
    assert built.bonds is not None
    near: dict[int, set[int]] = {k: set() for k in order}
    for a, b in built.bonds.pieces.tolist():
        if b != WORLD:
            near[a].add(b)
            near[b].add(a)
    total = 0
    for piece in order:
        left = near.pop(piece)
        total += len(left)
        for other in left:
            near[other] = (near[other] | left) - {piece, other}
    return total


def test_loose_pieces_are_eliminated_in_an_order_that_keeps_the_factor_sparse(pieces: Pieces) -> None:
    built = pieces.built
    loose = clusters_of(built, np.zeros(len(pieces.whole), dtype=bool))
    order = elimination(built, loose)
    assert sorted(order) == list(range(len(loose)))
    assert _fill(built, order) < 0.9 * _fill(built, sorted(order, reverse=True))


def test_what_the_world_holds_is_not_eliminated(pieces: Pieces) -> None:
    held = clusters_of(pieces.built, np.ones(len(pieces.whole), dtype=bool))
    assert [c.fixed for c in held] == [True]
    assert elimination(pieces.built, held) == []


@pytest.mark.parametrize("shared", [1, 4, 9])
def test_two_parts_have_an_order_however_many_faces_they_share(shared: int) -> None:
    built: Any = SimpleNamespace(bodies=[None, None], bonds=SimpleNamespace(pieces=np.array([[0, 1]] * shared)))
    parts: Any = [SimpleNamespace(fixed=False, pieces=(k,)) for k in range(2)]
    assert sorted(elimination(built, parts)) == [0, 1]


def _weak(points: list[float], pair: list[int]) -> Weak:
    count = len(points)
    place = np.array([[x, 0.0, 0.0] for x in points])
    rows = 3 * np.arange(count, dtype=np.int32)
    tight = np.ones(count, dtype=bool)
    return Weak(rows, np.full(count, 10.0), np.array(pair), place, np.ones(count), np.zeros(count), tight)


def _state(force: list[float]) -> Any:
    rows = 3 * len(force)
    normal = np.zeros(rows)
    normal[::3] = force
    return SimpleNamespace(efc_force=normal, efc_R=np.ones(rows), efc_D=np.ones(rows), nisland=0)


def _crumbling() -> Crumbling:
    return Crumbling(NONE, NONE, NONE, 9, np.zeros(1), np.zeros(1), np.zeros(1), np.zeros(9))


def test_a_contact_that_crumbled_starts_the_next_step_as_soft() -> None:
    kin, weak = _crumbling(), _weak([0.0, 1.0, 1.0], [4, 4, 5])
    kin.remember(_state([10.0 * EXCESS, 30.0, 10.0]), weak)
    # The step after lists them in another order and a little elsewhere; pair 5 has none.
    later, state = _weak([1.1, 0.9, 0.1], [5, 4, 4]), _state([0.0, 0.0, 0.0])
    kin.recall(state, later)
    assert later.soft.tolist() == [1.0, 3.0 * STIFFNESS_OF_STEP, 1.0]
    assert state.efc_R.tolist() == [1.0] * 3 + [3.0 * STIFFNESS_OF_STEP] * 3 + [1.0] * 3
    assert (state.efc_R * state.efc_D).tolist() == pytest.approx([1.0] * 9)
    # It carries nothing any more, and grows hard again step by step.
    kin.remember(state, later)
    again = _weak([0.9], [4])
    kin.recall(_state([0.0]), again)
    assert again.soft[0] == pytest.approx(HARDENING * 3.0 * STIFFNESS_OF_STEP)


def test_a_frame_starts_without_memory_of_what_crumbled() -> None:
    kin, weak = _crumbling(), _weak([0.0], [4])
    assert kin.fresh
    kin.remember(_state([1e3]), weak)
    assert not kin.fresh
    kin.forget()
    kin.recall(_state([0.0]), weak)
    assert kin.fresh
    assert weak.soft[0] == 1.0


def test_loads_are_solved_for_where_they_changed(pieces: Pieces) -> None:
    whole: Cluster = clusters_of(pieces.built, pieces.whole)[0]
    pieces.bind({whole.name: 1})
    assert pieces.changed(0.0) == [whole], "nothing is known yet"
    pieces.load[3, 0] = 1e3
    worst = 0.5
    pieces.keep(whole, pieces.loads()[list(whole.pieces)], worst, 9.81, 0.0)
    assert pieces.changed(0.0) == []
    room = (CHANGE[0] + CHANGE[1] * (1 / worst - 1)) * 1e3
    pieces.load[8, 1] = 0.99 * room
    assert pieces.changed(0.0) == []
    assert pieces.changed(LATEST * pieces.breakable.bond.contact_time) == [whole], "what lasts is looked at in the end"
    pieces.load[8, 1] = 1.01 * room
    assert pieces.changed(0.0) == [whole]
