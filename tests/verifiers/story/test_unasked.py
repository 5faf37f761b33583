"""Worlds of which no beat names causes: a still one is asked for none, and no event passes for a state."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import ball, box, ground, make_candidate, world
from worldagent.verifiers.rows.findings import Finding
from worldagent.verifiers.story.unasked import without_causes
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Contact, Displacement, Not, Reaches, RestsOn, Speed, StaysIn, Supported
from worldagent.worlds.spec import Beat, BoxRegion, FieldDriver, ForceDriver, Requirement, Story

FPS, N = 24, 25
LAST = N - 1
TIME = np.arange(N) / FPS
LIES = RestsOn(entity="book", on="table", when="always")


def beat(predicate: Any, frames: tuple[int, int] = (0, LAST), subject: str = "book") -> Beat:
    return Beat(text="", owner="rigid", subject=subject, frames=frames, predicate=predicate)


def still(folder: Path, beats: dict[str, Beat] | None = None, *, book: Any = None, ball_at: Any = None, **more: Any) -> Candidate:
    """A book on a table, and a ball beside it; their tracks stay in place unless others are given."""
    entities = {
        "floor": ground(),
        "table": box(1.0, 1.0, 0.5, at=(0, 0, 0.25)),
        "book": box(0.3, 0.2, 0.05, motion="dynamic", at=(0, 0, 0.526)),
        "ball": ball(0.05, motion="dynamic", at=(2, 0, 0.05)),
    }
    regions = {"here": BoxRegion(min=(-0.2, -0.2, 0.4), max=(0.2, 0.2, 0.7)), "there": BoxRegion(min=(0.3, -1, 0), max=(1, 1, 1))}
    story = Story(beats=beats or {"lies": beat(LIES)}, requirements=more.pop("requirements", {}))
    spec = world(entities, story=story, frames=N, regions=regions, **more)
    one = np.tile([1.0, 0, 0, 0], (N, 1))
    tracks = {
        "book": book or (np.tile([0, 0, 0.526], (N, 1)), one),
        "ball": (np.tile([2.0, 0, 0.05], (N, 1)) if ball_at is None else ball_at, one),
    }
    return make_candidate(folder, spec, tracks=tracks, stage="full")


def slid(way: float) -> tuple[Any, Any]:
    """The book slides along x by `way` [m], evenly."""
    positions = np.tile([0, 0, 0.526], (N, 1)) + np.outer(way * TIME / TIME[-1], [1, 0, 0])
    return positions, np.tile([1.0, 0, 0, 0], (N, 1))


def turned(angle: float) -> tuple[Any, Any]:
    """The book turns about the vertical by `angle` [rad], evenly."""
    half = 0.5 * angle * TIME / TIME[-1]
    return np.tile([0, 0, 0.526], (N, 1)), np.stack([np.cos(half), 0 * half, 0 * half, np.sin(half)], axis=1)


def lacks(found: Finding, words: str) -> None:
    """The finding is open, says so, and its corrections name a place and an action."""
    assert found.status == "unverified"
    assert words in found.text, found.text
    assert found.hints
    assert all(h.pointers and h.action for h in found.hints)


def test_a_book_that_lies_on_a_table_is_asked_for_no_cause(tmp_path: Path) -> None:
    requirement = Requirement(text="", predicate=Supported(entity="book"))
    found = without_causes(still(tmp_path, requirements={"held": requirement}))
    assert found.status == "not_applicable"
    assert found.text.startswith("not asked: no beat tells of a change")
    assert found.evidence is not None
    assert found.evidence["states"] == ["/story/beats/lies", "/story/requirements/held"]
    assert found.evidence["farthest"]["m"] == 0.0


@pytest.mark.parametrize(
    "predicate",
    [StaysIn(entity="book", region="here"), Not(predicate=Reaches(entity="book", region="there"))],
    ids=["stays", "never"],
)
def test_what_stays_and_what_never_comes_need_no_cause(tmp_path: Path, predicate: Any) -> None:
    found = without_causes(still(tmp_path, {"so": beat(predicate)}))
    assert found.status == "not_applicable", found.text


def test_a_medium_at_rest_and_a_creep_within_the_limit_change_nothing(tmp_path: Path) -> None:
    air = FieldDriver(field={"kind": "drag", "density": 1.2})  # type: ignore[arg-type]
    assert without_causes(still(tmp_path, drivers={"air": air}, book=slid(0.004))).status == "not_applicable"


def test_a_beat_of_change_still_needs_a_cause(tmp_path: Path) -> None:
    lands = beat(Contact(a="book", b="table"))
    lacks(without_causes(still(tmp_path, {"lies": beat(LIES), "lands": lands})), "/story/beats/lands tells of a change")


def test_a_requirement_of_change_needs_a_cause_too(tmp_path: Path) -> None:
    asked = {"goes": Requirement(text="", predicate=Displacement(entity="book", min=0.1))}
    lacks(without_causes(still(tmp_path, requirements=asked)), "/story/requirements/goes tells of a change")


def test_a_driver_that_acts_is_a_change(tmp_path: Path) -> None:
    held = ForceDriver(entity="book", force=(0, 0, 1), end=1)
    lacks(without_causes(still(tmp_path, drivers={"held": held})), "/simulation/drivers/held tells of a change")


def test_an_event_told_as_a_state_of_late_frames_is_found_by_what_was_before(tmp_path: Path) -> None:
    late = beat(Displacement(entity="book", min=0.1, when="always"), (20, LAST))
    found = without_causes(still(tmp_path, {"gone": late}, book=slid(0.2)))
    lacks(found, "gone does not hold at every frame from 0 to 24")
    assert found.frame == 0


def test_a_motion_that_lasts_is_no_state_of_rest(tmp_path: Path) -> None:
    rolls = beat(Speed(entity="ball", min=0.0, max=9.0, when="always"), subject="ball")
    far = np.tile([2.0, 0, 0.05], (N, 1)) + np.outer(TIME, [0.5, 0, 0])
    found = without_causes(still(tmp_path, {"rolls": rolls}, ball_at=far))
    lacks(found, "ball goes 0.5 m")
    assert (found.entity, found.frame, found.unit) == ("ball", LAST, "m")


@pytest.mark.parametrize(
    ("track", "still_so"), [(slid(0.006), False), (slid(0.0049), True), (turned(0.03), False), (turned(0.01), True)]
)
def test_what_leaves_its_place_is_a_change_that_no_beat_tells(tmp_path: Path, track: Any, still_so: bool) -> None:
    found = without_causes(still(tmp_path, {"there": beat(StaysIn(entity="book", region="here"))}, book=track))
    assert (found.status == "not_applicable") == still_so, found.text
    if not still_so:
        lacks(found, "and no beat tells of it")
        assert "place_object(entity='book'" in found.hints[0].action


def test_motion_that_no_cache_holds_is_no_evidence_of_rest(tmp_path: Path) -> None:
    entities = {"floor": ground(), "book": box(0.3, 0.2, 0.05, motion="dynamic", at=(0, 0, 0.025))}
    asked = {"one": beat(Supported(entity="book"))}
    candidate = make_candidate(tmp_path, world(entities, beats=asked, frames=N), stage="full")
    assert without_causes(candidate).status == "unverified"
