"""Beats that were true before their interval begins: all frames from 0 are looked at (R156)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, Touch, ball, box, ground, make_candidate, world
from worldagent.verifiers.register.initial import initial_lines
from worldagent.verifiers.story.beats import check
from worldagent.verifiers.story.vacuity import check_vacuity
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.predicates import (
    After,
    And,
    Contact,
    Count,
    Crosses,
    Displacement,
    Eventually,
    Or,
    Reaches,
    RestsOn,
    Speed,
    Topples,
)
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, BoxRegion

FRAMES = 41
LAST = FRAMES - 1
FPS = 24
REGIONS = {"goal": BoxRegion(min=(0.9, -0.5, 0), max=(1.5, 0.5, 3))}
BOUNCES = (7, 16, 25)
"""Frames at which the ball of `bouncing` touches the floor."""


def beat(predicate: Any, frames: tuple[int, int], **more: Any) -> Beat:
    return Beat(text="it happens", owner="rigid", subject=more.pop("subject", "ball"), frames=frames, predicate=predicate, **more)


def moved(tmp_path: Path, beats: dict[str, Beat], x: Any = 0.0, z: Any = 0.0, touches: Any = (), turn: Any = None) -> Candidate:
    """A ball of 0.1 m at (x, 0, 1 + z) [m] over time, a cube that stays on the floor, and contacts as told."""
    entities = {
        "floor": ground(),
        "ball": ball(0.1, motion="dynamic", at=(0, 0, 1)),
        "cube": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 2, 0.1)),
    }
    spec = world(entities, regions=REGIONS, frames=FRAMES, beats=beats)
    along, up = (np.broadcast_to(np.asarray(v, dtype=float), (FRAMES,)) for v in (x, z))
    track = (np.stack([along, 0 * along, 1 + up], axis=1), IDENTITY if turn is None else turn)
    return make_candidate(tmp_path, spec, tracks={"ball": track}, touches=list(touches))


def row(candidate: Candidate, name: str = "b") -> Row:
    return next(r for r in check(candidate) if r.id == f"beat:vacuous:{name}")


def between(*spans: tuple[int, int], inside: float = 1.0, outside: float = 0.0) -> Any:
    """One value in some spans of frames and another elsewhere."""
    value = np.full(FRAMES, outside)
    for first, last in spans:
        value[first : last + 1] = inside
    return value


def bouncing() -> list[Touch]:
    return [Touch(f, "ball", "floor", 0.5) for f in BOUNCES]


FLOOR = Contact(a="ball", b="floor", min_impulse=0.1)


# ---------------------------------------------------------------- events


def test_an_event_before_the_interval_is_refused_with_the_frame_at_which_it_was_first_true(tmp_path: Path) -> None:
    found = row(moved(tmp_path, {"b": beat(FLOOR, (12, 20))}, touches=bouncing()))
    assert (found.status, found.first_failing_entity, found.first_failing_frame) == ("fail", "ball", 7)
    assert "was true at frame 7, before its interval 12..20 begins" in found.evidence["explanation"]
    assert found.corrections[0].patch[0] == {"op": "replace", "path": "/story/beats/b/frames", "value": [7, 20]}
    assert any("beat of its own" in c.action for c in found.corrections)


def test_the_interval_that_begins_there_is_honest(tmp_path: Path) -> None:
    assert row(moved(tmp_path, {"b": beat(FLOOR, (7, 20))}, touches=bouncing())).status == "pass"


@pytest.mark.parametrize("first", [5, 10])
def test_a_repeated_event_is_honest_when_each_earlier_one_has_a_beat_that_it_names(tmp_path: Path, first: int) -> None:
    """The second of three bounces. The owner of the first must have come true at it."""
    beats = {"one": beat(FLOOR, (first, first + 4)), "b": beat(FLOOR, (12, 20), causes=["one"])}
    assert row(moved(tmp_path, beats, touches=bouncing())).status == ("pass" if first == 5 else "fail")
    unnamed = {"one": beat(FLOOR, (5, 9)), "b": beat(FLOOR, (12, 20))}
    assert row(moved(tmp_path / "b", unnamed, touches=bouncing())).status == "fail"


def test_a_third_bounce_needs_two_beats_before_it(tmp_path: Path) -> None:
    two = {"one": beat(FLOOR, (5, 9)), "two": beat(FLOOR, (12, 20), causes=["one"])}
    third = beat(FLOOR, (22, 30), causes=["two"])
    assert row(moved(tmp_path, {**two, "b": third}, touches=bouncing())).status == "pass"
    found = row(moved(tmp_path / "b", {"one": two["one"], "b": beat(FLOOR, (22, 30), causes=["one"])}, touches=bouncing()))
    assert (found.status, found.first_failing_frame) == ("fail", 16)


def test_a_repeated_event_may_say_after_which_beat_it_comes(tmp_path: Path) -> None:
    beats = {"one": beat(FLOOR, (5, 9)), "b": beat(After(beat="one", predicate=FLOOR), (12, 20))}
    assert row(moved(tmp_path, beats, touches=bouncing())).status == "pass"
    late = {**beats, "b": beat(After(beat="one", predicate=FLOOR), (18, 30))}
    found = row(moved(tmp_path / "b", late, touches=bouncing()))
    assert (found.status, found.first_failing_frame) == ("fail", 16)


def test_what_the_first_beat_owns_is_no_second_event_while_it_lasts(tmp_path: Path) -> None:
    lies = [Touch(f, "ball", "floor", 0.5) for f in range(7, FRAMES)]
    beats = {"one": beat(FLOOR, (5, 9)), "b": beat(FLOOR, (12, 20), causes=["one"])}
    assert row(moved(tmp_path, beats, touches=lies)).status == "fail"


def test_what_the_scene_starts_with_is_no_event_that_happened(tmp_path: Path) -> None:
    """It lies on the floor at frame 0, is thrown up and lands again."""
    lies = [Touch(f, "cube", "floor", 0.01) for f in (*range(1, 9), *range(20, FRAMES))]
    thrown = beat(Contact(a="cube", b="floor"), (15, 30), subject="cube")
    assert row(moved(tmp_path, {"b": thrown}, touches=lies)).status == "pass"


@pytest.mark.parametrize(("frames", "impulse"), [((1, 20), 0.0), ((0, 20), 0.0), ((10, 20), 0.0), ((10, 20), 0.05)])
def test_a_touch_that_lasts_from_the_start_is_no_contact_that_happens(
    tmp_path: Path, frames: tuple[int, int], impulse: float
) -> None:
    """No log of contacts tells of frame 0; surfaces do. Weight alone gives 0.01 N s per frame."""
    lies = [Touch(f, "cube", "floor", 0.01) for f in range(1, FRAMES)]
    lands = beat(Contact(a="cube", b="floor", min_impulse=impulse), frames, subject="cube")
    assert row(moved(tmp_path, {"b": lands}, touches=lies)).status == "fail"


def test_a_blow_on_what_touches_all_along_is_new(tmp_path: Path) -> None:
    lies = [Touch(f, "cube", "floor", 0.5 if f == 15 else 0.01) for f in range(1, FRAMES)]
    struck = beat(Contact(a="cube", b="floor", min_impulse=0.4), (10, 20), subject="cube")
    assert row(moved(tmp_path, {"b": struck}, touches=lies)).status == "pass"


@pytest.mark.parametrize(("spans", "status"), [([(25, 30)], "pass"), ([(8, 12), (25, 30)], "fail"), ([(0, 4), (25, 30)], "pass")])
def test_reaching_a_place_counts_when_it_was_not_reached_before(
    tmp_path: Path, spans: list[tuple[int, int]], status: str
) -> None:
    arrives = {"b": beat(Reaches(entity="ball", region="goal"), (20, 35))}
    assert row(moved(tmp_path, arrives, x=between(*spans))).status == status


@pytest.mark.parametrize(("back", "status"), [(40, "fail"), (15, "fail"), (41, "pass")])
def test_a_crossing_is_an_event(tmp_path: Path, back: int, status: str) -> None:
    """It crosses at frame 5 and again at 25, once it came back; or at frame 25 only."""
    x = np.where(np.arange(FRAMES) < 5, -1.0, np.where(np.arange(FRAMES) < back, 1.0, -1.0))
    x[20:25], x[25:] = -1.0, 1.0
    if back > LAST:
        x[:25] = -1.0
    crosses = beat(Crosses(entity="ball", point=(0, 0, 0), normal=(1, 0, 0)), (18, 35))
    found = row(moved(tmp_path, {"b": crosses}, x=x))
    assert (found.status, found.first_failing_frame) == (status, 5 if status == "fail" else None)


# ---------------------------------------------------------------- states


@pytest.mark.parametrize("causes", [[], ["other"]])
def test_what_is_so_from_the_start_may_be_asked_as_a_state_that_needs_no_cause(tmp_path: Path, causes: list[str]) -> None:
    asked = Speed(entity="ball", max=0.1)
    beats = {"b": beat(asked, (0, 20), causes=causes), "other": beat(Speed(entity="ball", max=0.1, when="always"), (0, 20))}
    found = row(moved(tmp_path, beats))
    assert found.status == "fail"
    offered = [c for c in found.corrections if c.patch and c.patch[0]["path"].endswith("/when")]
    assert bool(offered) == (not causes)
    if offered:
        mended = apply_patch(world({"floor": ground(), "ball": ball(0.1, motion="dynamic")}, beats=beats), list(offered[0].patch))
        (tmp_path / "mended").mkdir()
        lasting = moved(tmp_path / "mended", {**beats, "b": mended.story.beats["b"]})
        assert [r for r in check_vacuity(lasting, "b") if r.status != "pass"] == []


@pytest.mark.parametrize(("moves", "status"), [((6, LAST), "fail"), ((2, 3), "pass")])
def test_a_state_that_the_story_starts_with_is_no_cause(tmp_path: Path, moves: tuple[int, int], status: str) -> None:
    """The ball lies still up to frame 5, and goes; or it moved before, so that its rest from frame 4 on came about."""
    still = beat(Displacement(entity="ball", max=0.1, when="always"), (4, 5))
    goes = beat(Displacement(entity="ball", min=0.5), (6, 20), causes=["b"])
    found = row(moved(tmp_path, {"b": still, "goes": goes}, x=between(moves)))
    assert found.status == status
    alone = row(moved(tmp_path / "alone", {"b": still}, x=between(moves)))
    assert (alone.status, alone.evidence.get("initial")) == ("pass", True if status == "fail" else None)
    if status == "fail":
        assert "goes names it as a cause" in found.evidence["explanation"]
        assert (found.first_failing_entity, found.first_failing_frame) == ("ball", 0)


def test_the_register_tells_of_states_that_the_story_starts_with(tmp_path: Path) -> None:
    beats = {
        "b": beat(Displacement(entity="ball", max=0.1, when="always"), (4, 5)),
        "later": beat(Displacement(entity="ball", min=0.5, when="always"), (10, 12)),
    }
    lines = initial_lines(moved(tmp_path, beats, x=between((6, LAST))))
    assert [line["what"] for line in lines] == ["beat 'b' is so from frame 0 on: it happens"]


def test_a_state_that_was_there_before_and_lasts_is_refused(tmp_path: Path) -> None:
    far = {"b": beat(Displacement(entity="ball", min=0.5), (12, 20))}
    found = row(moved(tmp_path, far, x=between((6, LAST))))
    assert (found.status, found.first_failing_frame) == ("fail", 6)
    assert "was true at frames 6..11, before its interval 12..20 begins" in found.evidence["explanation"]
    assert (found.measured, found.bound) == (pytest.approx(1.0), 0.5)


@pytest.mark.parametrize("when", ["eventually", "end"])
def test_a_state_that_ended_and_comes_back_within_the_interval_is_new(tmp_path: Path, when: str) -> None:
    far = {"b": beat(Displacement(entity="ball", min=0.5, when=when), (12, 20))}
    assert row(moved(tmp_path, far, x=between((3, 8), (15, 25)))).status == "pass"
    assert row(moved(tmp_path / "b", far, x=between((3, 25)))).status == "fail"


def test_a_ball_that_rests_is_hit_and_rests_again(tmp_path: Path) -> None:
    z = np.where((np.arange(FRAMES) > 8) & (np.arange(FRAMES) < 20), 0.3, 0.0) - 0.9
    rests = {"b": beat(RestsOn(entity="ball", on="floor"), (18, LAST))}
    assert row(moved(tmp_path, rests, z=z)).status == "pass"
    assert row(moved(tmp_path / "b", rests, z=-0.9)).status == "fail"


def test_a_speed_before_the_interval_is_not_this_one(tmp_path: Path) -> None:
    x = np.interp(np.arange(FRAMES), [0, 5, 14, 20, LAST], [0, 0.5, 0.5, 1.1, 1.1])
    assert row(moved(tmp_path, {"b": beat(Speed(entity="ball", min=1.5), (10, 30))}, x=x)).status == "pass"
    assert row(moved(tmp_path / "b", {"b": beat(Speed(entity="ball", min=1.5), (3, 30))}, x=x)).status == "fail"


def test_what_lay_toppled_before_is_refused(tmp_path: Path) -> None:
    angle = between((10, LAST), inside=1.2)
    turn = np.stack([np.cos(angle / 2), 0 * angle, np.sin(angle / 2), 0 * angle], axis=1)
    assert row(moved(tmp_path, {"b": beat(Topples(entity="ball"), (15, 30))}, turn=turn)).first_failing_frame == 10
    assert row(moved(tmp_path / "b", {"b": beat(Topples(entity="ball"), (8, 30))}, turn=turn)).status == "pass"


# ---------------------------------------------------------------- combinations


def test_combinations_were_true_before_when_their_members_were(tmp_path: Path) -> None:
    far, near = Displacement(entity="ball", min=0.5), Displacement(entity="cube", min=0.5)
    old, new = Reaches(entity="ball", region="goal"), Speed(entity="ball", min=99)
    moved_before = between((6, LAST))
    each = Displacement(entity="each", min=0.5)
    expected = [
        (And(of=[far, old]), "fail"),
        (And(of=[far, near]), "pass"),
        (Or(of=[near, far]), "fail"),
        (Or(of=[near, new]), "pass"),
        (Eventually(predicate=far), "fail"),
        (Count(entities=["ball", "cube"], predicate=each, min=1), "fail"),
        (Count(entities=["ball", "cube"], predicate=each, min=2), "pass"),
    ]
    for k, (predicate, status) in enumerate(expected):
        found = row(moved(tmp_path / str(k), {"b": beat(predicate, (12, 20))}, x=moved_before))
        assert found.status == status, predicate


def test_frames_that_a_probe_does_not_hold_are_no_evidence(tmp_path: Path) -> None:
    candidate = moved(tmp_path, {"b": beat(FLOOR, (45, 50))}, touches=bouncing())
    assert row(candidate).status == "unverified"
