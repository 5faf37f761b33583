"""Impulses and twists on bodies that declare lift against the law: sound flights and landings pass, wrong engines and records are found."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.physics import lift
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.tests.physics.rigid_world import box, floor, world
from worldagent.verifiers.categories.rigid import laws
from worldagent.verifiers.categories.rigid.fields import fields
from worldagent.verifiers.categories.rigid.lifted import lift_lines
from worldagent.verifiers.ledgers.balance import Books, books_of
from worldagent.verifiers.ledgers.origins import Origin, origins_of
from worldagent.verifiers.register.fields import field_lines
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.spec import WorldSpec

STILL = {"air": {"kind": "field", "field": {"kind": "drag", "coefficient": 1.15}}}
WIND = {"wind": {"kind": "field", "field": {"kind": "wind", "velocity": (8, 0, 0), "coefficient": 1.15, "gust": 0.5}}}
STORM = {"wind": {"kind": "field", "field": {"kind": "wind", "velocity": (30, 0, 0), "coefficient": 1.15}}}
EDDIES = {**WIND, "eddies": {"kind": "field", "field": {"kind": "turbulence", "speed": 2.0, "length": 2.0}}}
HINGE = {"h": {"kind": "hinge", "parent": None, "child": "b", "anchor": (0, 0, 1.1), "axis": (0, 1, 0)}}


def card(*size: float, **more: Any) -> dict[str, Any]:
    made = box(*size, **more)
    made["physics"]["lift"] = True
    return made


WORLDS: dict[str, WorldSpec] = {
    "falls": world({"b": card(0.2, 0.2, 0.002, mass=0.01, at=(0, 0, 5), euler=(0, 0.2, 0))}, drivers=STILL, seconds=0.6),
    "spins": world({"b": card(0.2, 0.15, 0.002, mass=0.01, at=(0, 0, 5), euler=(0, 0.2, 0), w=(3, 20, 5))}, drivers=STILL, seconds=0.6),
    "tile": world({"b": card(0.3, 0.25, 0.012, mass=1.0, at=(0, 0, 5), euler=(0, -0.3, 0))}, drivers=STORM, seconds=0.6),
    "leaf": world({"b": card(0.06, 0.04, 0.001, mass=5e-4, at=(0, 0, 2.5), euler=(0, -0.3, 0))}, drivers=EDDIES, seconds=0.6),
    "lands": world({"b": card(0.2, 0.2, 0.002, mass=0.01, at=(0, 0, 0.2), euler=(0.3, 0.5, 0)), "f": floor()}, drivers=WIND, seconds=1.0),
    "hangs": world({"b": card(0.2, 0.2, 0.002, mass=0.05, at=(0, 0, 1), euler=(0, 1.57, 0))}, drivers=WIND, joints=HINGE, seconds=0.8),
}  # fmt: skip


def _books(candidate: Candidate) -> Books:
    (cache,) = candidate.rigid_caches.values()
    return books_of(candidate, cache)


@pytest.mark.parametrize("name", list(WORLDS))
def test_sound_worlds_keep_the_law_and_every_law_of_motion(name: str, tmp_path: Path) -> None:
    books = _books(simulate(tmp_path, WORLDS[name]))
    row = fields(books)
    assert row.status == "pass", row.evidence
    for law in (laws.momentum, laws.motion, laws.spin, laws.turning):
        assert law(books).status in ("pass", "not_applicable"), law(books).evidence


def test_a_free_flight_is_known_within_a_percent(tmp_path: Path) -> None:
    """The judge's own scheme and the engine's differ by the engine's steps alone."""
    for name in ("falls", "spins", "tile"):
        measured = fields(_books(simulate(tmp_path / name, WORLDS[name]))).measured
        assert isinstance(measured, float)
        assert measured < 0.01


WRONG = {"drops": 0.0, "doubles": 2.0, "turns round": -1.0}


@pytest.mark.parametrize("factor", WRONG.values(), ids=list(WRONG))
@pytest.mark.parametrize("name", ["falls", "tile"])
def test_an_engine_with_another_lift_is_found(name: str, factor: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It flies the body as its own law says and records just that: momentum fits, the law does not."""

    def broken(*given: Any) -> lift.Wrench:
        found = lift.wrenches(*given)
        way = found.flow / np.maximum(np.linalg.norm(found.flow, axis=1), 1e-300)[:, None]
        along = (found.force * way).sum(axis=1)[:, None] * way
        return dataclasses.replace(found, force=along + factor * (found.force - along))

    monkeypatch.setattr("worldagent.simulation.rigid.lifting.wrenches", broken)
    books = _books(simulate(tmp_path, WORLDS[name]))
    assert laws.momentum(books).status == "pass"
    assert fields(books).status == "fail"


def test_an_engine_without_torque_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*given: Any) -> lift.Wrench:
        found = lift.wrenches(*given)
        return dataclasses.replace(found, torque=0.0 * found.torque, resistance=0.0 * found.resistance)

    monkeypatch.setattr("worldagent.simulation.rigid.lifting.wrenches", broken)
    assert fields(_books(simulate(tmp_path, WORLDS["falls"]))).status == "fail"


def test_a_wrong_record_of_twists_is_found_by_the_law_and_by_the_spin(tmp_path: Path) -> None:
    base = simulate(tmp_path / "base", WORLDS["spins"])

    def more(k: int, data: dict[str, Any]) -> None:
        data["field/twist"] = 1.3 * data["field/twist"]

    books = _books(edited(base, tmp_path / "forged", "main", more))
    assert fields(books).status == laws.spin(books).status == "fail"


def test_on_the_ground_a_push_that_no_attitude_gives_is_found(tmp_path: Path) -> None:
    base = simulate(tmp_path / "base", WORLDS["lands"])

    def push(k: int, data: dict[str, Any]) -> None:
        data["field/impulse"] = data["field/impulse"] + (np.array([0.0, 0.2, 0.0]) if k == 20 else 0.0)

    assert fields(_books(edited(base, tmp_path / "forged", "main", push))).status == "fail"


def test_a_missing_record_is_no_pass(tmp_path: Path) -> None:
    base = simulate(tmp_path / "base", WORLDS["falls"])

    def without(k: int, data: dict[str, Any]) -> None:
        data.pop("field/twist")

    with pytest.raises(Exception, match="field/twist"):
        fields(_books(edited(base, tmp_path / "cut", "main", without)))


def test_origins_tell_the_work_of_the_wind_and_leave_nothing(tmp_path: Path) -> None:
    candidate = simulate(tmp_path, WORLDS["tile"])
    given = origins_of(candidate, "b")
    wind = given[Origin("fields", "wind")]
    velocity = _books(candidate).velocities[:, 0]
    kinetic = 0.5 * np.diff((velocity**2).sum(axis=1))
    assert sum(g.work for g in given.values()) == pytest.approx(kinetic)
    assert np.abs(given[Origin("unlisted", "")].impulse).max() < 1e-9 * np.abs(wind.impulse).max()
    assert np.abs(wind.impulse[:, 2]).max() > 0.05 * np.abs(wind.impulse[:, 0]).max()


def test_the_register_tells_what_is_left_out() -> None:
    lines = lift_lines(WORLDS["falls"], "main")
    texts = " ".join(line["what"] + line["effect"] for line in lines)
    assert "no stall that lags" in texts
    assert "has no mass, in air about" in texts
    assert "its torque is not taken from a gas" in texts
    assert lift_lines(world({"b": box(0.2, 0.2, 0.002)}, drivers=STILL), "main") == []
    assert any("declares no lift" in line["effect"] for line in field_lines(WORLDS["falls"]))
