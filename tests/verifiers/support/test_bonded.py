"""Pins and bonded sides at points of space: something drawn that never moves is there, or the body says why not (R154)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.worlds.small_worlds import box, entity, ground, make_candidate, world
from worldagent.verifiers.register.assemble import approximations
from worldagent.verifiers.support import check as support
from worldagent.worlds.audits.ownership import ownership_problems
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Bond, Breakable, BrickPattern, ClothPhysics, ClothPin, Entity, Sheet

EDGE = 0.1
REASON = "a spell of the tale keeps it there"


def flag(gap: float, **more: Any) -> Entity:
    """A flag 0.6 m long whose left edge is pinned in space, `gap` beside a pole of 6 cm at x = 0."""
    pins = {"hoist": ClothPin(edge="-x")}
    physics = ClothPhysics(area_density=0.2, thickness=0.001, stretch_stiffness=100, bend_stiffness=1e-5, pins=pins)
    at, size = (0.03 + gap + 0.3, 0, 1.5), (0.6, 0.4, 0.001)
    sheet = Sheet(size=(0.6, 0.4), resolution=EDGE)
    return entity(sheet, motion="dynamic", at=at, euler=(1.5708, 0, 0), size=size, physics=physics, **more)


def wall(gap: float, side: str, **more: Any) -> Entity:
    """A wall of bricks on the floor, bonded at one side, `gap` beside a pole of 6 cm at x = 0."""
    pattern = BrickPattern(size=(0.2, 0.3, 0.1), joint=0.0)
    broken = Breakable(pattern=pattern, bond=Bond(tension=1e6, shear=1.5e6), fixed=[side])
    return box(0.6, 0.3, 0.4, motion="dynamic", at=(0.03 + gap + 0.3, 0, 0.2001), breakable=broken, **more)


def rows_of(folder: Path, thing: Entity) -> dict[str, Row]:
    things = {"floor": ground(), "pole": box(0.06, 0.06, 2.0, at=(0, 0, 1.0)), "thing": thing}
    return {r.id: r for r in support.check(make_candidate(folder, world(things, frames=4)))}


@pytest.mark.parametrize(("gap", "status"), [(0.02, "pass"), (0.099, "pass"), (0.11, "fail"), (0.5, "fail")])
def test_a_pin_at_points_of_space_reaches_something_that_never_moves(gap: float, status: str, tmp_path: Path) -> None:
    row = rows_of(tmp_path, flag(gap))["support:pin:thing:hoist"]
    assert row.status == status, row.evidence
    assert row.measured == pytest.approx(gap, abs=1e-6)
    assert row.bound == pytest.approx(EDGE)
    if status == "fail":
        assert row.corrections[1].patch[0]["value"]["position"][0] == pytest.approx(0.33, abs=1e-6)


@pytest.mark.parametrize(
    ("gap", "side", "status"),
    [(1e-4, "x-", "pass"), (0.0039, "x-", "pass"), (0.0041, "x-", "fail"), (0.5, "x+", "fail"), (0.5, "z-", "pass")],
)
def test_a_bonded_side_lies_at_something_that_never_moves(gap: float, side: str, status: str, tmp_path: Path) -> None:
    """The floor meets the lower rim of every upright side, which is none of what they are bonded to."""
    row = rows_of(tmp_path, wall(gap, side))[f"support:bonded:thing:{side}"]
    assert row.status == status, row.evidence
    assert row.bound == pytest.approx(0.004)


def test_what_hangs_on_nothing_says_so_and_is_printed(tmp_path: Path) -> None:
    for k, (thing, row) in enumerate(
        ((flag(0.5, afloat=REASON), "support:pin:thing:hoist"), (wall(0.5, "x-", afloat=REASON), "support:bonded:thing:x-"))
    ):
        assert rows_of(tmp_path / str(k), thing)[row].status == "pass"
        spec = world({"floor": ground(), "thing": thing}, frames=4)
        assert [p for p in ownership_problems(spec) if p.pointer.endswith("/afloat")] == []
        assert any(REASON in line["what"] for line in approximations(make_candidate(tmp_path / f"r{k}", spec)))
    free = world({"floor": ground(), "thing": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 1), afloat=REASON)}, frames=4)
    assert [p.pointer for p in ownership_problems(free)] == ["/entities/thing/afloat"]
