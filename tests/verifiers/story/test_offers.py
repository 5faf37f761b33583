"""Corrections of causal rows can be followed: their patches apply, say where they weaken, and make the row pass."""

from __future__ import annotations

from pathlib import Path

from worldagent.testing.worlds.simulated_worlds import beat, simulate
from worldagent.tests.verifiers.pushed_blocks import only, pushed
from worldagent.verifiers.rows.corrections import WEAKER
from worldagent.verifiers.story import causal
from worldagent.verifiers.story.offers import earlier, offered
from worldagent.worlds.patch import apply_patch, weakenings
from worldagent.worlds.predicates import Contact, Displacement
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import ForceDriver, WorldSpec

WIND = ForceDriver(entity="b", force=(3, 0, 0), start=0.3, end=1.0)


def check_patches(spec: WorldSpec, row: Row) -> None:
    """Every patch validates, and says so where it weakens."""
    for found in row.corrections:
        if found.patch:
            after = apply_patch(spec, found.patch)
            assert not weakenings(spec, after) or "weakening" in found.action, found


def test_the_driver_that_brings_the_effect_anyway_is_named_and_taken_away(tmp_path: Path) -> None:
    spec = pushed(drivers={"wind": WIND})
    row = only(simulate(tmp_path / "a", spec))
    check_patches(spec, row)
    away = row.corrections[0]
    assert away.patch == ({"op": "remove", "path": "/simulation/drivers/wind"},)
    assert "take wind away" in away.action
    assert only(simulate(tmp_path / "b", apply_patch(spec, away.patch))).status == "pass"


def test_a_cause_that_only_hastens_is_given_the_margin_that_was_measured(tmp_path: Path) -> None:
    spec = pushed(drivers={"wind": WIND})
    row = only(simulate(tmp_path / "a", spec))
    hastened = next(c for c in row.corrections if c.pointers == ("/story/beats/slide/margins",))
    assert hastened.action.endswith(WEAKER)
    assert only(simulate(tmp_path / "b", apply_patch(spec, hastened.patch))).status == "pass"


def test_a_driver_that_owns_a_beat_is_named_by_it_in_place_of_the_cause(tmp_path: Path) -> None:
    beats = {**pushed().story.beats, "blown": beat("b", Displacement(entity="b", min=0.01), frames=(1, 24), owner="wind")}
    spec = pushed(drivers={"wind": WIND.model_copy(update={"start": 0.0})}, beats=beats)
    row = only(simulate(tmp_path, spec))
    check_patches(spec, row)
    named = row.corrections[0]
    assert "name blown, which driver wind owns" in named.action
    assert named.action.endswith(WEAKER)
    assert apply_patch(spec, named.patch).story.beats["slide"].causes == ["blown"]


def test_a_row_behind_a_beat_that_never_came_points_at_the_first_that_did_not(tmp_path: Path) -> None:
    beats = {
        "hit": beat("b", Contact(a="a", b="b", min_impulse=1e6), frames=(1, 20)),
        "slide": beat("b", Displacement(entity="b", min=9.0), frames=(1, 24), causes=["hit"]),
        "far": beat("b", Displacement(entity="b", min=9.5), frames=(1, 24), causes=["slide"]),
    }
    spec = pushed(beats=beats)
    row = next(r for r in causal.check(simulate(tmp_path, spec)) if r.id == "causal:slide:far")
    check_patches(spec, row)
    assert (row.status, row.evidence["follows"]) == ("fail", "beat:hit")
    assert "this row follows from beat:hit, the first that leads to it" in row.evidence["explanation"]
    assert "impulse is needed" in row.corrections[0].action


def test_a_patch_that_does_not_apply_is_left_out_and_a_driver_acts_no_earlier_than_frame_0() -> None:
    spec = pushed(drivers={"wind": WIND})
    gone = ({"op": "remove", "path": "/simulation/drivers/nobody"},)
    assert offered(spec, "c", "drivers", "a", pointers=(), patch=gone).patch == ()
    assert [op["value"] for op in earlier(spec, "wind", 0.1)] == [0.2, 0.9]
    assert earlier(spec, "wind", 0.5) == ()
    assert apply_patch(spec, earlier(spec, "wind", 0.1)).simulation.drivers["wind"].begins == 0.2
