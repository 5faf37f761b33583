"""Frame 0 is what was declared: nothing is pushed from its place, and what settles before it is told."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.defects._starts import embedded
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.testing.worlds.small_worlds import box, ground, world
from worldagent.verifiers.categories import check as category
from worldagent.verifiers.register.assemble import approximations
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import EngineError
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Limits, RigidPhysics, Supports

SKIN = 5e-4
"""[m] Default."""


def rows_of(candidate: Candidate) -> dict[str, Row]:
    return {r.id.split(":")[1]: r for r in category.check_numerical(candidate) if r.id.endswith(":rigid")}


@pytest.mark.parametrize("depth", [0.01, 0.091])
def test_an_overlap_that_is_declared_is_never_pushed_apart_before_frame_0(tmp_path: Path, depth: float) -> None:
    """Once this moved a crate by its depth, and every check passed. The refusal names the pair, the overlap and what to do."""
    with pytest.raises(EngineError, match=r"'crate' and 'base' .* overlap by .* m, and nothing holds them together") as told:
        simulate(tmp_path, embedded(welded=False, depth=depth))
    assert "weld" in str(told.value)
    assert f"{depth:.4g} m" in str(told.value)


def test_an_overlap_of_what_is_welded_keeps_its_place(tmp_path: Path) -> None:
    candidate = simulate(tmp_path, embedded(welded=True, frames=6), stage="full")
    assert np.abs(candidate.caches["rigid"].series("position")[:, 0] - [0, 0, 0.5]).max() < 1e-9
    row = rows_of(candidate)["placed"]
    assert (row.status, row.unit) == ("pass", "m")
    assert row.measured < 1e-9


def stack(count: int) -> dict[str, Any]:
    crates = {f"c{k}": box(0.2, 0.2, 0.2, at=(0, 0, 0.1 + 0.2 * k), motion="dynamic") for k in range(count)}
    return {"floor": ground(), **crates}


def test_skins_of_a_stack_open_by_one_per_contact_and_the_row_says_how_far(tmp_path: Path) -> None:
    candidate = simulate(tmp_path, world(stack(4), frames=2), stage="full")
    row = rows_of(candidate)["placed"]
    moved = row.evidence["moved_m"]
    assert row.status == "pass"
    assert moved["c3"] == pytest.approx(4 * 2 * SKIN, rel=0.05)
    assert row.bound >= moved["c3"]
    (line,) = [a for a in approximations(candidate) if "were opened before frame 0" in a["what"]]
    assert "4 of its members" in line["effect"]
    assert f"{moved['c3']:.3g} m" in line["effect"]


def test_a_body_alone_may_be_moved_by_two_summed_skins_and_no_farther(tmp_path: Path) -> None:
    base = simulate(tmp_path, world(stack(1), frames=2), stage="full")
    bound = rows_of(base)["placed"].bound
    assert bound == pytest.approx(2 * 2 * SKIN, abs=1e-5)

    def lifted(frame: int, data: dict[str, Any]) -> None:
        data["position"][0, 2] += 1.1 * bound

    row = rows_of(edited(base, tmp_path / "b", "rigid", lifted))["placed"]
    assert (row.status, row.first_failing_entity, row.first_failing_frame) == ("fail", "c0", 0)
    assert row.corrections


def test_velocities_at_frame_0_are_the_declared_ones(tmp_path: Path) -> None:
    crate = box(0.2, 0.3, 0.1, at=(0, 0, 2), motion="dynamic")
    physics = RigidPhysics(linear_velocity=(3.0, 0.5, 1.0), angular_velocity=(2.0, -1.0, 4.0))
    spec = world({"crate": crate.model_copy(update={"physics": physics})}, frames=2, limits=Limits(max_speed=50), preroll=0.2)
    base = simulate(tmp_path, spec, stage="full")
    rows = rows_of(base)
    assert (rows["placed"].status, rows["started"].status) == ("pass", "pass")
    assert rows["started"].measured < rows["started"].bound

    def spun(frame: int, data: dict[str, Any]) -> None:
        data["angular_velocity"][0] += [0.0, 0.0, 0.1 if frame == 0 else 0.0]

    row = rows_of(edited(base, tmp_path / "b", "rigid", spun))["started"]
    assert (row.status, row.first_failing_entity) == ("fail", "crate")


def test_a_preroll_that_moves_a_body_is_told_and_one_that_drops_what_is_said_to_rest_is_refused(tmp_path: Path) -> None:
    things = {"floor": ground(), "crate": box(0.2, 0.2, 0.2, at=(0, 0, 0.6), motion="dynamic")}
    free = rows_of(simulate(tmp_path / "a", world(things, frames=2, preroll=0.6), stage="full"))["placed"]
    assert free.status == "pass"
    assert free.evidence["moved_m"]["crate"] == pytest.approx(0.5, abs=0.01)
    assert free.evidence["settled_in_preroll"] == ["crate"]
    told = [a["effect"] for a in approximations(simulate(tmp_path / "c", world(things, frames=2, preroll=0.6), stage="full"))]
    assert any("'crate' farthest, by 0.5" in effect or "'crate' farthest, by 0.49" in effect for effect in told)
    resting = {"s": Supports(a="floor", b="crate")}
    row = rows_of(simulate(tmp_path / "b", world(things, frames=2, preroll=0.6, relations=resting), stage="full"))["placed"]
    assert (row.status, row.first_failing_entity) == ("fail", "crate")
    assert row.measured == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize(("shift", "status"), [(0.0, "pass"), (0.13, "fail")])
def test_a_tower_that_falls_in_the_preroll_is_no_tower(shift: float, status: str, tmp_path: Path) -> None:
    """Two bricks, the upper one over the edge of the lower or not; no relation says that it rests."""
    things = {
        "floor": ground(),
        "lower": box(0.2, 0.2, 0.2, at=(0, 0, 0.1001), motion="dynamic"),
        "upper": box(0.2, 0.2, 0.2, at=(shift, 0, 0.3002), motion="dynamic"),
    }
    row = rows_of(simulate(tmp_path, world(things, frames=2, preroll=1.0), stage="full"))["placed"]
    assert row.status == status
    assert status == "pass" or row.first_failing_entity == "upper"
