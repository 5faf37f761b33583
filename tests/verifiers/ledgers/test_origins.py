"""The ledger by origin: impulses and works of worlds that the engine ran, against the laws that they must follow."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.defects import _scenes as scenes
from worldagent.testing.defects._films import film_of
from worldagent.testing.worlds.small_worlds import ball, box, ground, world
from worldagent.verifiers.ledgers.balance import books_of
from worldagent.verifiers.ledgers.origins import Given, Origin, origins_of
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.spec import ForceDriver, Material, RigidSettings, SpringJoint

EVEN = {"wood": Material(density=600.0, friction=0.3, restitution=0.0, substance="wood")}


def ran(folder: Path, entities: dict, **more: Any) -> Candidate:
    spec = world(entities, materials=EVEN, settings=RigidSettings(step=5e-4), **more)
    return film_of(spec).candidate(folder)


def total(given: dict[Origin, Given], kind: str) -> float:
    return float(sum(one.work.sum() for origin, one in given.items() if origin.kind == kind))


@pytest.mark.parametrize("name", ["flight", "bounce", "slide", "pendulum", "welded", "sprung", "pushed", "cradle"])
def test_works_of_all_origins_are_the_change_of_kinetic_energy(name: str, tmp_path: Path) -> None:
    candidate = getattr(scenes, name)(2).candidate(tmp_path)
    books = books_of(candidate, candidate.rigid_caches["rigid"])
    free = [(entity, row) for entity, row in books.row.items() if not books.kinematic[row]]
    assert free
    for entity, row in free:
        energy = 0.5 * books.mass[row] * np.sum(books.velocities[:, row] ** 2, axis=1)
        works = sum(given.work for given in origins_of(candidate, entity).values())
        assert works == pytest.approx(np.diff(energy), abs=1e-9 * max(1.0, energy.max())), entity


def test_a_sliding_block_loses_to_the_floor_what_friction_takes(tmp_path: Path) -> None:
    """Coulomb: friction takes mu m g per metre of the way."""
    block = box(0.3, 0.2, 0.1, motion="dynamic", at=(0, 0, 0.05), velocity=(2.0, 0, 0))
    candidate = ran(tmp_path, {"floor": ground(9), "block": block}, frames=24)
    books = books_of(candidate, candidate.rigid_caches["rigid"])
    way = float(np.linalg.norm(books.centers[-1, 0] - books.centers[0, 0]))
    given = origins_of(candidate, "block")
    assert way > 0.5
    assert given[Origin("contact", "floor")].work.sum() == pytest.approx(-0.3 * float(books.mass[0]) * 9.81 * way, rel=0.01)
    awake = ~books.dozing[:, 0]
    assert awake.sum() > 12
    assert np.abs(given[Origin("unlisted", "")].impulse[awake]).max() < 1e-6 * books.mass[0]


def test_two_bodies_give_each_other_opposite_impulses(tmp_path: Path) -> None:
    entities = {
        "hitter": ball(0.1, motion="dynamic", at=(0, 0, 1), velocity=(3.0, 0, 0)),
        "target": ball(0.1, motion="dynamic", at=(0.4, 0, 1)),
    }
    candidate = ran(tmp_path, entities, frames=12, gravity=(0, 0, 0))
    one, other = (origins_of(candidate, n) for n in ("hitter", "target"))
    on_target, on_hitter = other[Origin("contact", "hitter")], one[Origin("contact", "target")]
    assert np.abs(on_target.impulse + on_hitter.impulse).max() < 1e-12
    mass = 600.0 * 4 / 3 * np.pi * 0.1**3
    # Equal masses, no restitution: both go on with half the speed, and a quarter of the energy has passed over.
    assert on_target.work.sum() == pytest.approx(0.5 * mass * 1.5**2, rel=0.02)
    assert on_hitter.work.sum() == pytest.approx(0.5 * mass * (1.5**2 - 3.0**2), rel=0.02)
    assert set(other) == {Origin("contact", "hitter"), Origin("unlisted", "")}


def test_a_force_a_spring_and_gravity_are_told_apart_by_name(tmp_path: Path) -> None:
    """Work of a constant force is F times the way; of a spring, the energy that it loses; of gravity, m g h."""
    entities = {"block": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 5)), "free": ball(0.1, motion="dynamic", at=(3, 0, 5))}
    joints = {"k": SpringJoint(child="block", child_point=(0, 0, 5), parent_point=(1.0, 0, 5), stiffness=8.0, rest_length=0.5)}
    drivers = {"f": ForceDriver(entity="free", force=(2.0, 0, 0), start=0.0, end=10.0)}
    candidate = ran(tmp_path, entities, frames=12, joints=joints, drivers=drivers)
    books = books_of(candidate, candidate.rigid_caches["rigid"])
    move = books.centers[-1] - books.centers[0]
    free, block = (origins_of(candidate, n) for n in ("free", "block"))
    assert total(free, "driver") == pytest.approx(2.0 * move[books.row["free"], 0], rel=0.01)
    assert total(free, "gravity") == pytest.approx(-books.mass[books.row["free"]] * 9.81 * move[books.row["free"], 2], rel=0.01)
    assert total(block, "spring") == pytest.approx(float(books.elastic[0] - books.elastic[-1]), rel=0.03)
    assert (Origin("driver", "f") in free, Origin("spring", "k") in block, Origin("spring", "k") in free) == (True, True, False)


def test_the_doubt_bounds_how_a_hit_shares_in_its_interval(tmp_path: Path) -> None:
    """Whatever the order of impulses within an interval, the work differs by no more than what is told."""
    candidate = scenes.bounce(3).candidate(tmp_path)
    given = origins_of(candidate, "ball")
    fall = given[Origin("gravity", "")]
    books = books_of(candidate, candidate.rigid_caches["rigid"])
    row = books.row["ball"]
    exact = -books.mass[row] * 9.81 * np.diff(books.centers[:, row, 2])
    assert (np.abs(fall.work - exact) <= fall.doubt + 1e-9).all()
    assert np.abs(fall.work - exact).max() > 1e-6  # a bounce within an interval is one that the trapezoid does not see


def test_what_no_rigid_instance_moves_has_no_ledger(tmp_path: Path) -> None:
    candidate = scenes.bounce(1).candidate(tmp_path)
    assert origins_of(candidate, "floor") == {}
