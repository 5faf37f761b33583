"""Pins of cloth and of elastic bodies reach what carries them."""

from __future__ import annotations

from pathlib import Path

import pytest
from worldagent.testing.worlds.small_worlds import box, entity, ground, make_candidate, world
from worldagent.verifiers.support import check as support
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import ClothPhysics, ClothPin, Sheet

EDGE = 0.1


def _flag(folder: Path, gap: float) -> Row:
    """A flag 0.6 m long whose left edge is `gap` beside its pole."""
    physics = ClothPhysics(
        area_density=0.2,
        thickness=0.001,
        stretch_stiffness=100,
        bend_stiffness=1e-5,
        pins={"hoist": ClothPin(edge="-x", to="pole")},
    )
    things = {
        "floor": ground(),
        "pole": box(0.06, 0.06, 2.0, at=(0, 0, 1.0)),
        "flag": entity(
            Sheet(size=(0.6, 0.4), resolution=EDGE),
            motion="dynamic",
            at=(0.03 + gap + 0.3, 0, 1.5),
            euler=(1.5708, 0, 0),
            size=(0.6, 0.4, 0.001),
            physics=physics,
        ),
    }
    rows = {r.id: r for r in support.check(make_candidate(folder, world(things, frames=4)))}
    return rows["support:pin:flag:hoist"]


@pytest.mark.parametrize(("gap", "status"), [(0.02, "pass"), (0.3, "fail")])
def test_a_flag_reaches_the_pole_that_it_is_pinned_to(gap: float, status: str, tmp_path: Path) -> None:
    row = _flag(tmp_path, gap)
    assert row.status == status, row.evidence
    assert row.measured == pytest.approx(gap, abs=1e-6)
    assert row.bound == pytest.approx(EDGE)


def test_the_correction_brings_the_flag_to_its_pole(tmp_path: Path) -> None:
    row = _flag(tmp_path, 0.3)
    assert row.corrections[0].patch[0]["value"]["position"][0] == pytest.approx(0.33, abs=1e-6)
