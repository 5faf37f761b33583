"""`beat:driven`: helpers that the story is silent about, in worlds that the engine ran, and their twins that are told or do no work."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.defects._helpers import guided_block, pushed_row, sprung_block
from worldagent.testing.worlds.simulated_worlds import SLICK, beat, simulate
from worldagent.testing.worlds.small_worlds import ball, box, ground, world
from worldagent.verifiers.story.beats import check
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Displacement, PairEvent, Speed
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import ForceDriver, RigidSettings, WeldJoint


def driven(candidate: Candidate, beat: str) -> Row:
    return next(r for r in check(candidate) if r.id == f"beat:driven:{beat}")


def test_a_loaded_spring_of_no_beat_is_found_with_its_work(tmp_path: Path) -> None:
    row = driven(sprung_block(tmp_path, load=0.6), "goes")
    said = str(row.evidence["explanation"])
    assert (row.status, row.evidence["trigger"]) == ("fail", "helped")
    assert all(word in said for word in ("spring 'k'", "'block'", "goes"))
    assert row.corrections[0].pointers == ("/simulation/joints/k",)


@pytest.mark.parametrize(
    "more",
    [{"load": 0.0}, {"load": 0.6, "told": "release"}, {"load": 0.6, "told": "first"}],
    ids=["unloaded", "let go by a release of a beat", "part of an initial state"],
)
def test_a_spring_that_is_told_or_not_loaded_is_not(tmp_path: Path, more: dict[str, Any]) -> None:
    row = driven(sprung_block(tmp_path, **more), "goes")
    assert row.status == "pass", row.evidence["explanation"]


@pytest.mark.parametrize("between", [0, 1, 2])
def test_a_body_on_a_path_is_found_through_others(tmp_path: Path, between: int) -> None:
    row = driven(pushed_row(tmp_path, between=between, told=False), "moves")
    assert row.status == "fail"
    help_ = row.evidence["helper"]
    assert (help_["pointer"], help_["body"], len(help_["through"])) == ("/simulation/drivers/p", "last", between + 1)
    assert row.corrections[0].pointers == ("/simulation/drivers/p",)


def _bystander(folder: Path, *, told: bool, cause: str = "strike") -> Candidate:
    """A sphere taps a block, and another one that comes from the side sends it on."""
    entities = {
        "ground": ground(),
        "tapper": ball(0.05, motion="dynamic", at=(-0.3, 0, 0.051), velocity=(0.6, 0, 0)),
        "other": ball(0.1, motion="dynamic", at=(0.0, -0.6, 0.101), velocity=(0, 2.5, 0)),
        "block": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.051)),
    }
    hit = PairEvent(kind="hits", entity="tapper", other="block")
    moves = Displacement(entity="block", min=0.08, when="eventually")
    beats = {"strike": beat("block", hit, frames=(0, 20)), "moves": beat("block", moves, frames=(2, 23), causes=("strike",))}
    if told:
        beats["comes"] = beat("other", Speed(entity="other", min=1.0), frames=(0, 6))
        beats["moves"] = beat("block", moves, frames=(2, 23), causes=("strike", "comes"))
    return simulate(folder, world(entities, beats=beats, frames=24, settings=RigidSettings(step=1e-3)))


def test_a_body_with_a_start_of_its_own_helps_and_is_told_or_found(tmp_path: Path) -> None:
    row = driven(_bystander(tmp_path / "a", told=False), "moves")
    assert (row.status, row.evidence["helper"]["body"]) == ("fail", "block")
    assert "'other', which starts with a velocity" in str(row.evidence["explanation"])
    assert row.corrections[0].pointers[0] == "/story/beats"
    assert driven(_bystander(tmp_path / "b", told=True), "moves").status == "pass"


@pytest.mark.parametrize("between", [0, 2])
def test_a_path_that_a_beat_owns_is_told(tmp_path: Path, between: int) -> None:
    row = driven(pushed_row(tmp_path, between=between, told=True), "moves")
    assert row.status == "pass", row.evidence["explanation"]


def test_a_body_on_a_path_that_touches_others_alone_helps_nobody_else(tmp_path: Path) -> None:
    row = driven(pushed_row(tmp_path, between=0, told=False, aside=True), "moves")
    assert row.status == "pass", row.evidence["explanation"]


def test_a_force_on_a_body_that_pushes_the_outcome_is_found(tmp_path: Path) -> None:
    row = driven(pushed_row(tmp_path, between=1, told=False, force=60.0), "moves")
    assert (row.status, row.evidence["helper"]["pointer"]) == ("fail", "/simulation/drivers/f")
    assert row.evidence["helper"]["through"] == ["b0", "last"]


def test_a_torque_on_a_body_that_pushes_the_outcome_is_found_with_its_work_on_the_turning(tmp_path: Path) -> None:
    """A wheel that a torque spins drives a block before it: of the torque the momentum of the wheel tells nothing."""
    entities = {
        "floor": ground(20),
        "wheel": ball(0.1, motion="dynamic", at=(0, 0, 0.101)),
        "last": box(0.2, 0.2, 0.2, motion="dynamic", at=(0.22, 0, 0.1)),
    }
    beats = {
        "starts": beat("last", Speed(entity="last", min=0.02), frames=(0, 24)),
        "moves": beat("last", Displacement(entity="last", min=0.03), frames=(1, 24), causes=("starts",)),
    }
    twist = ForceDriver(entity="wheel", torque=(0, 3.0, 0), start=0.0, end=1.0)
    spec = world(entities, beats=beats, drivers={"t": twist}, frames=25, settings=RigidSettings(step=1e-3))
    row = driven(simulate(tmp_path, spec), "moves")
    help_ = row.evidence["helper"]
    assert (row.status, help_["pointer"], help_["through"]) == ("fail", "/simulation/drivers/t", ["wheel", "last"])
    assert help_["work"] > 0.0


def test_a_force_is_found_through_a_joint(tmp_path: Path) -> None:
    """It pulls one of two blocks that are welded together, the other one pushes the third."""
    entities = {
        "floor": ground(20),
        **{
            n: box(0.2, 0.2, 0.2, motion="dynamic", at=(x, 0, 0.101)) for n, x in (("pulled", 0.0), ("tied", 0.25), ("last", 0.5))
        },
    }
    weld = WeldJoint(parent="pulled", child="tied", anchor=(0.1, 0, 0.101))
    beats = {
        "starts": beat("last", Speed(entity="last", min=0.02), frames=(0, 24)),
        "moves": beat("last", Displacement(entity="last", min=0.05), frames=(1, 24), causes=("starts",)),
    }
    pull = ForceDriver(entity="pulled", force=(60.0, 0, 0), end=1.0)
    spec = world(
        entities,
        beats=beats,
        drivers={"f": pull},
        joints={"w": weld},
        frames=25,
        materials=SLICK,
        settings=RigidSettings(step=1e-3),
    )
    row = driven(simulate(tmp_path, spec), "moves")
    assert row.status == "fail", row.evidence["explanation"]
    assert row.evidence["helper"]["through"] == ["pulled", "tied", "last"]


def test_a_slide_that_spares_a_body_the_friction_of_its_surface_is_found(tmp_path: Path) -> None:
    row = driven(guided_block(tmp_path, speed=2.0, friction=0.0), "goes")
    help_ = row.evidence["helper"]
    assert (row.status, help_["pointer"]) == ("fail", "/simulation/joints/rail")
    # Coulomb: mu m g over the way; 600 kg/m^3, 0.2 m cubed, friction 0.1.
    assert help_["friction"] == pytest.approx(0.1 * 600 * 0.2**3 * 9.81, rel=0.05)
    (patch,) = row.corrections[0].patch
    assert (patch["path"], patch["value"]) == ("/simulation/joints/rail/friction", pytest.approx(help_["friction"], rel=1e-3))
    assert {c.group for c in row.corrections} == {"joints"}, "no beat can own a slide: it rubs, or it goes"


@pytest.mark.parametrize("friction", [1.0, 3.0])
def test_a_slide_that_rubs_as_its_surfaces_do_is_not(tmp_path: Path, friction: float) -> None:
    row = driven(guided_block(tmp_path, speed=3.0, friction=friction), "hit")
    assert row.status == "pass", row.evidence["explanation"]
