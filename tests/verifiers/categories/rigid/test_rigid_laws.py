"""Laws of motion on ledgers: free flight, contacts, joints and drivers of worlds that the engine really ran."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.defects import _scenes as scenes
from worldagent.testing.defects._films import Film, film_of
from worldagent.testing.worlds.small_worlds import ball, box, ground, world
from worldagent.verifiers.categories.check import check
from worldagent.verifiers.ledgers.accounts import account_of
from worldagent.verifiers.ledgers.balance import Books
from worldagent.verifiers.ledgers.tumbling import tumble
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import ForceDriver, HingeJoint, RigidSettings


def rows_of(film: Film, folder: Path) -> dict[str, Row]:
    return {r.id.split(":")[2]: r for r in check(film.candidate(folder))}


def books(film: Film, folder: Path) -> Books:
    candidate = film.candidate(folder)
    return Books(candidate, candidate.caches["rigid"])


@pytest.mark.parametrize(
    "name", ["flight", "bounce", "slide", "gripped", "pendulum", "welded", "roped", "sprung", "pushed", "stack", "cradle"]
)
def test_what_the_engine_runs_keeps_every_law(name: str, tmp_path: Path) -> None:
    rows = rows_of(getattr(scenes, name)(1), tmp_path)
    assert {n: r.status for n, r in rows.items() if r.status not in ("pass", "not_applicable")} == {}


def test_the_ledger_closes_to_rounding_in_flight_and_in_contact(tmp_path: Path) -> None:
    """Laws: change of momentum = gravity + contacts, and contacts give at most sqrt(1 + mu^2) of their normal impulse."""
    flown = books(scenes.flight(0), tmp_path / "a")
    assert np.abs(flown.residual / flown.mass[:, None]).max() < 1e-12
    hit = books(scenes.bounce(4), tmp_path / "b")
    given = np.linalg.norm(hit.residual, axis=2)
    assert given.max() > 1.0  # the bounce itself
    assert (given <= hit.contact_budget * (1 + 1e-9) + 1e-12)[~hit.dozing].all()
    assert np.abs(hit.residual - hit.contact_given)[~hit.dozing].max() < 1e-12


def test_forces_of_a_step_in_which_a_body_falls_asleep_are_logged(tmp_path: Path) -> None:
    """A ball hits the floor in the very steps in which neighbours fall asleep; every impulse is in the log."""
    entities = {"floor": ground()}
    for k in range(12):
        entities[f"rest{k}"] = box(0.1, 0.1, 0.1, motion="dynamic", at=(0.3 * k - 2, 1, 0.05 + 0.0004 * k))
        entities[f"drop{k}"] = ball(0.05, motion="dynamic", at=(0.3 * k - 2, -1, 0.06 + 0.004 * k))
    film = film_of(world(entities, frames=8, settings=RigidSettings(step=1e-3)))
    slept = film.series("asleep").sum(axis=1)
    assert (np.diff(slept) > 0).any()
    row = rows_of(film, tmp_path)["momentum"]
    assert (row.status, row.measured) == ("pass", pytest.approx(0.0, abs=1e-9))


@pytest.mark.parametrize(("share", "status"), [(0.4, "pass"), (0.05, "fail")])
def test_what_joints_hold_together_sleeps_and_wakes_within_a_frame_as_one(share: float, status: str, tmp_path: Path) -> None:
    """The upper box touches nothing: the engine lists for a part of the frame what the lower one gives, and that bears both."""
    entities = {
        "floor": ground(),
        "lower": box(0.2, 0.2, 0.1, motion="dynamic", at=(0, 0, 0.05)),
        "upper": box(0.2, 0.2, 0.1, motion="dynamic", at=(0, 0, 0.2)),
    }
    joints = {"hinge": HingeJoint(parent="lower", child="upper", anchor=(0, 0, 0.125), axis=(0, 0, 1))}
    film = film_of(world(entities, joints=joints, frames=8, settings=RigidSettings(step=1e-3, sleep=False)))
    film.spec, k = world(entities, joints=joints, frames=8, settings=RigidSettings(step=1e-3)), 3
    for channel in ("contact/impulse", "contact/vector"):
        film.frames[k][channel] = share * film.frames[k][channel]
    row = rows_of(film, tmp_path)["momentum"]
    assert (row.status, row.first_failing_frame) == (status, None if status == "pass" else k)


def test_what_sleeps_and_is_lifted_within_a_frame_has_a_source(tmp_path: Path) -> None:
    """The force starts at 0.2 s, amid frame 5: until then the floor bears the sleeper, whose contacts are in no log."""
    entities = {"floor": ground(), "block": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.051))}
    lift = ForceDriver(entity="block", force=(0.0, 0.0, 30.0), start=0.2, end=0.4)
    film = film_of(world(entities, drivers={"lift": lift}, frames=8, settings=RigidSettings(step=5e-4)))
    assert film.series("asleep")[4].all()
    assert rows_of(film, tmp_path)["momentum"].status == "pass"
    film.push("block", 7, np.array([0.0, 0.0, 0.01]))
    film.settle_records()
    assert rows_of(film, tmp_path / "pushed")["momentum"].status == "fail"


def test_energies_and_momentum_are_those_of_the_records(tmp_path: Path) -> None:
    """Ledger and solver come to the same numbers by different ways, springs and ropes included."""
    for name in ("sprung", "roped", "pushed"):
        row = rows_of(getattr(scenes, name)(0), tmp_path / name)["records"]
        assert row.measured is not None
        assert row.measured < 1e-6, name


def test_a_push_without_a_cause_names_body_and_frame(tmp_path: Path) -> None:
    film = scenes.flight(0)
    film.push("small", 6, np.array([0.0, 0.01, 0.0]))
    film.settle_records()
    row = rows_of(film, tmp_path)["momentum"]
    assert (row.status, row.first_failing_entity, row.first_failing_frame) == ("fail", "small", 6)
    assert row.measured == pytest.approx(0.01, rel=1e-6)
    assert (row.bound, row.unit) == (2e-3, "m/s")


def test_an_impulse_that_is_turned_or_raised_with_all_that_is_said_of_it_is_found(tmp_path: Path) -> None:
    """Impulse, force and event agree with each other; the bodies did not take what they tell."""
    for name, factor in (("turned", -1.0), ("raised", 1.2)):
        film = scenes.thrown_pair(0)
        k = next(k for k, f in enumerate(film.frames) if len(f["event/impulse"]) and f["contact/impulse"].max() > 0.01)
        log = film.frames[k]
        log["contact/vector"] = factor * log["contact/vector"]
        for channel in ("contact/impulse", "contact/max_force", "event/impulse"):
            log[channel] = abs(factor) * log[channel]
        row = rows_of(film, tmp_path / name)["momentum"]
        assert (row.status, row.first_failing_frame) == ("fail", k), name


def test_a_touch_in_the_air_that_gave_nothing_cannot_be_invented(tmp_path: Path) -> None:
    film = scenes.thrown_pair(0)
    k = next(k for k in range(1, film.count) if not len(film.frames[k]["contact/pair"]))
    film.touch(k, "left", "right", np.array([0.5, 0.0, 0.0]))
    row = rows_of(film, tmp_path)["momentum"]
    assert (row.status, row.first_failing_frame) == ("fail", k)


def test_a_missing_contact_log_is_unverified_and_not_a_pass(tmp_path: Path) -> None:
    film = scenes.bounce(1)
    for frame in film.frames:
        del frame["contact/impulse"]
    rows = rows_of(film, tmp_path)
    assert {rows[n].status for n in ("momentum", "spin", "contacts", "friction")} == {"unverified"}


def test_without_the_log_a_bounce_has_no_cause(tmp_path: Path) -> None:
    film = scenes.bounce(4)
    film.drop_contacts()
    row = rows_of(film, tmp_path)["momentum"]
    assert (row.status, row.first_failing_entity) == ("fail", "ball")


def test_a_static_body_in_the_cache_fails(tmp_path: Path) -> None:
    film = scenes.flight(0)
    film.index = dataclasses.replace(film.index, bodies=(*film.index.bodies[:-1], "floor/body"))
    row = rows_of(film, tmp_path)["bodies"]
    assert (row.status, row.first_failing_entity) == ("fail", "floor")


def test_tumbling_keeps_angular_momentum_and_energy() -> None:
    """Law, and an exact case: a symmetric top precesses at L / I about its angular momentum."""
    inertia = np.diag([1.0, 1.0, 3.0])[None]
    spin = np.array([[2.0, 0.0, 5.0]])
    turned, after = tumble(np.eye(3)[None], spin, inertia, np.zeros((1, 3)), 1.3)
    before = inertia[0] @ spin[0]
    local = turned[0].T @ after[0]
    assert turned[0] @ inertia[0] @ local == pytest.approx(before, abs=1e-5)
    assert local @ inertia[0] @ local == pytest.approx(spin[0] @ before, rel=1e-6)
    rate = np.linalg.norm(before) / 1.0
    axis = before / np.linalg.norm(before)
    top = np.array([0.0, 0.0, 1.0])
    angle = rate * 1.3
    turned_top = top * np.cos(angle) + np.cross(axis, top) * np.sin(angle) + axis * (axis @ top) * (1 - np.cos(angle))
    assert turned[0] @ top == pytest.approx(turned_top, abs=1e-5)


def test_the_account_balances_frame_by_frame(tmp_path: Path) -> None:
    """Change of momentum of every free entity is the sum of its sources; bodies on paths are not in it."""
    candidate = scenes.pushed(1).candidate(tmp_path)
    account = account_of(candidate)
    assert "pusher" not in account.entities
    total = sum(account.sources.values(), start=np.zeros_like(account.momentum[1:]))
    held = account.entities.index("late")
    balance = np.diff(account.momentum, axis=0) - total
    assert np.abs(np.delete(balance, held, axis=1)).max() < 1e-9
    energy = account.kinetic.sum(axis=1) + account.potential.sum(axis=1) + account.elastic
    recorded = candidate.caches["rigid"].series("record/kinetic_energy") + candidate.caches["rigid"].series(
        "record/potential_energy"
    )
    assert energy == pytest.approx(recorded, rel=1e-9)
    assert next(m.name for m in account.events) == "pusher - cart"
    assert np.nanmax(account.unexplained) < account.bound
