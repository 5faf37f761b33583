"""Category checks of rigid instances: mass, count, joints, energy, escape."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, box, ground, make_candidate, world
from worldagent.verifiers.categories.check import check
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Displacement
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, HingeJoint, Limits, LiquidPhysics

FPS, N = 24, 25
TIME = np.arange(N) / FPS
MASS = 600.0 * 0.2**3
G = 9.81


def falling(tmp_path: Path, *, records: dict[str, Any] | None = None, track: Any = None, **more: Any) -> Candidate:
    """A wooden cube in free fall from 6 m: kinetic energy m g^2 t^2 / 2, potential m g h."""
    entities = {"floor": ground(4.0), "cube": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 6.0))}
    entities |= more.pop("entities", {})
    without = more.pop("without", ())
    spec = world(entities, frames=N, **more)
    height = 6.0 - 0.5 * G * TIME**2
    tracks = {"cube": (np.stack([0 * TIME, 0 * TIME, height], axis=1), IDENTITY)} if track is None else {"cube": track}
    energies = {
        "kinetic_energy": 0.5 * MASS * (G * TIME) ** 2,
        "potential_energy": MASS * G * height,
        "driver_work": 0.0,
        "mass": MASS * (len(entities) - 1),
        "body_count": len(entities) - 1,
        "joint_error": 0.0,
    }
    return make_candidate(tmp_path, spec, tracks=tracks, records=energies | (records or {}), without=without)


def rows_of(candidate: Candidate) -> dict[str, Row]:
    return {r.id.removeprefix("category:rigid:").removesuffix(":rigid"): r for r in check(candidate)}


def test_free_fall_passes_everything(tmp_path: Path) -> None:
    """Law: mechanical energy of a free fall is constant."""
    rows = rows_of(falling(tmp_path))
    assert {n: rows[n].status for n in ("bodies", "mass", "joints", "energy", "escape")} == {
        "bodies": "pass",
        "mass": "pass",
        "joints": "not_applicable",
        "energy": "pass",
        "escape": "pass",
    }
    assert rows["energy"].measured == pytest.approx(0, abs=1e-9)
    assert rows["energy"].evidence["scale_J"] == pytest.approx(2 * 0.5 * MASS * G**2)  # largest kinetic + range of potential


def test_energy_that_grows_without_a_source_fails_at_its_first_frame(tmp_path: Path) -> None:
    gain = np.where(TIME >= 0.5, 0.05 * MASS * G**2, 0.0)  # 5 % of the energy in play, from frame 12 on
    row = rows_of(falling(tmp_path, records={"potential_energy": MASS * G * (6.0 - 0.5 * G * TIME**2) + gain}))["energy"]
    assert (row.status, row.first_failing_frame, row.first_failing_entity) == ("fail", 12, "cube")
    scale = 0.5 * MASS * G**2 + (0.5 * MASS * G**2 - 0.05 * MASS * G**2)
    assert row.measured == pytest.approx(0.05 * MASS * G**2 / scale, rel=1e-6)
    assert row.corrections[0].group == "step"
    assert row.corrections[0].patch[0]["value"] == pytest.approx(2.5e-4)


def test_energy_given_by_a_driver_has_a_source(tmp_path: Path) -> None:
    gain = np.where(TIME >= 0.5, 0.05 * MASS * G**2, 0.0)
    potential = MASS * G * (6.0 - 0.5 * G * TIME**2) + gain
    assert rows_of(falling(tmp_path, records={"potential_energy": potential, "driver_work": gain}))["energy"].status == "pass"


def test_losses_do_not_hide_a_later_growth(tmp_path: Path) -> None:
    """Own choice: growth counts from the lowest energy so far, not from the start."""
    energy = np.full(N, 100.0)
    energy[5:10], energy[10:] = 50.0, 60.0
    records = {"kinetic_energy": energy, "potential_energy": 0.0}
    row = rows_of(falling(tmp_path, records=records))["energy"]
    assert (row.status, row.first_failing_frame, row.measured) == ("fail", 10, pytest.approx(0.1))
    assert row.evidence["interval"] == [5, 10]
    assert rows_of(falling(tmp_path / "b", records=records, limits=Limits(energy_growth=0.15)))["energy"].status == "pass"


def test_a_scene_at_rest_is_not_failed_by_noise(tmp_path: Path) -> None:
    noise = 1e-5 * MASS * G * np.sin(np.arange(N))
    still = (np.array([0, 0, 6.0]), IDENTITY)
    records = {"kinetic_energy": 0.0, "potential_energy": MASS * G * 6 + noise}
    assert rows_of(falling(tmp_path, records=records, track=still))["energy"].status == "pass"


def test_lost_mass_and_bodies_fail_at_their_frame(tmp_path: Path) -> None:
    lost = np.where(np.arange(N) >= 7, 0.9 * MASS, MASS)
    rows = rows_of(falling(tmp_path, records={"mass": lost, "body_count": np.where(np.arange(N) >= 9, 0, 1)}))
    assert (rows["mass"].status, rows["mass"].first_failing_frame) == ("fail", 7)
    assert rows["mass"].measured == pytest.approx(0.1 * MASS)
    assert (rows["bodies"].status, rows["bodies"].first_failing_frame) == ("fail", 9)


def test_mass_is_compared_with_what_was_built(tmp_path: Path) -> None:
    assert rows_of(falling(tmp_path, records={"mass": 2 * MASS}))["mass"].first_failing_frame == 0


@pytest.mark.parametrize(("error", "status"), [(9e-4, "pass"), (3e-3, "pass"), (4e-3, "fail")])
def test_joints_may_gape_by_a_share_of_their_body(tmp_path: Path, error: float, status: str) -> None:
    """1 % of the cube's diagonal is 3.46 mm."""
    joints = {"h": HingeJoint(child="cube", anchor=(0, 0, 6.1), axis=(0, 1, 0))}
    gaps = np.where(np.arange(N) >= 4, error, 0.0)
    still = (np.array([0, 0, 6.0]), IDENTITY)
    row = rows_of(falling(tmp_path, joints=joints, track=still, records={"joint_error": gaps}))["joints"]
    assert row.status == status
    assert row.bound == pytest.approx(0.01 * 0.2 * 3**0.5)
    assert row.first_failing_frame == (4 if status == "fail" else None)


def test_a_body_that_flies_off_fails(tmp_path: Path) -> None:
    """The scene is 6.1 + 0.2 m large: ten sizes reach 31.5 m from its middle."""
    x = np.where(TIME > 0.5, (TIME - 0.5) * 100, 0.0)
    track = (np.stack([x, 0 * x, 0 * x + 6.0], axis=1), IDENTITY)
    row = rows_of(falling(tmp_path, track=track))["escape"]
    assert (row.status, row.first_failing_entity) == ("fail", "cube")
    assert row.bound == pytest.approx(31.5)
    assert row.first_failing_frame == 20  # 100 (k / 24 - 0.5) > 31.5
    sent = Beat(text="", owner="rigid", subject="cube", frames=(0, 24), predicate=Displacement(entity="cube", min=40))
    assert rows_of(falling(tmp_path / "b", track=track, beats={"away": sent}))["escape"].status == "pass"


def test_not_a_number_fails(tmp_path: Path) -> None:
    bad = np.where(np.arange(N) == 3, np.nan, 1.0)
    rows = rows_of(falling(tmp_path, records={"kinetic_energy": bad, "mass": bad * MASS, "body_count": bad}))
    assert {n: (rows[n].status, rows[n].first_failing_frame) for n in ("energy", "mass", "bodies")} == dict.fromkeys(
        ("energy", "mass", "bodies"), ("fail", 3)
    )


def test_missing_records_and_missing_caches_are_unverified(tmp_path: Path) -> None:
    rows = rows_of(falling(tmp_path, without=["record/driver_work", "record/mass"]))
    assert (rows["energy"].status, rows["mass"].status, rows["bodies"].status) == ("unverified", "unverified", "pass")
    static = make_candidate(tmp_path / "s", falling(tmp_path / "x").spec)
    assert {r.status for r in check(static)} == {"unverified"}


def test_other_categories_are_unverified(tmp_path: Path) -> None:
    water = box(0.2, 0.2, 0.2, motion="dynamic", at=(1, 0, 1)).model_copy(update={"physics": LiquidPhysics(resolution=0.01)})
    rows = check(falling(tmp_path, entities={"water": water}))
    row = next(r for r in rows if r.id == "category:water")
    assert row.status == "unverified"
    assert "no instance simulates it" in row.evidence["explanation"]
