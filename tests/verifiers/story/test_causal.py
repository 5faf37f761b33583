"""Causal checks: order, impulse chains, and coincidences that must not pass for causes (R96, R97)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import Event, Touch, ball, box, ground, make_candidate, world
from worldagent.verifiers.story.causal import check
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import And, Contact, Displacement, Reaches, Speed, Topples
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, BoxRegion, DetachDriver, ForceDriver, PathDriver, ReleaseDriver, SpringJoint, WeldJoint

FPS, N = 24, 49
TIME = np.arange(N) / FPS


def toppling(start: float, x: float, *, end: float = 1.4, rate: float = 3.0) -> tuple[Any, Any]:
    """A domino at x that turns about +y from `start` [s]; it is past 0.6 rad 0.2 s later."""
    angles = np.clip(rate * (TIME - start), 0, end)
    quaternions = np.stack([np.cos(angles / 2), 0 * angles, np.sin(angles / 2), 0 * angles], axis=1)
    positions = np.stack([x + 0.05 * np.sin(angles), 0 * angles, 0.1 * np.cos(angles)], axis=1)
    return positions, quaternions


def beat(subject: str, predicate: Any = None, *, causes: list[str] | None = None, **more: Any) -> Beat:
    return Beat(
        text="",
        owner=more.pop("owner", "rigid"),
        subject=subject,
        frames=more.pop("frames", (0, N - 1)),
        predicate=predicate or Topples(entity=subject),
        causes=causes or [],
    )


def dominoes(
    tmp_path: Path,
    starts: list[float],
    *,
    contacts: list[tuple[float, str, str, float]],
    beats: dict[str, Beat] | None = None,
    **more: Any,
) -> Candidate:
    """Dominoes d0, d1, ... on a floor that all of them touch; `contacts` are (time, a, b, impulse)."""
    entities = {"floor": ground()}
    entities |= {f"d{i}": box(0.02, 0.1, 0.2, motion="dynamic", at=(0.1 * i, 0, 0.1)) for i in range(len(starts))}
    last = f"d{len(starts) - 1}"
    beats = beats or {"first": beat("d0"), "last": beat(last, causes=["first"])}
    spec = world(entities, beats=beats, frames=N, drivers=more.pop("drivers", None), joints=more.pop("joints", None))
    frames_of = [(int(np.ceil(t * FPS - 1e-9)), a, b, j) for t, a, b, j in contacts]
    touches = [Touch(k, a, b, j) for k, a, b, j in frames_of]
    touches += [Touch(k, "floor", f"d{i}", 1.0) for k in range(1, N) for i in range(len(starts))]
    events = [Event(t, a, b, impulse=j) for t, a, b, j in contacts]
    tracks = {f"d{i}": toppling(s, 0.1 * i) for i, s in enumerate(starts)}
    return make_candidate(tmp_path, spec, tracks=tracks, touches=touches, events=events, **more)


def only(candidate: Candidate) -> Row:
    rows = check(candidate)
    assert len(rows) == 1
    return rows[0]


def test_a_chain_of_contacts_is_a_cause(tmp_path: Path) -> None:
    contacts = [(0.13, "d0", "d1", 0.05), (0.33, "d1", "d2", 0.05)]
    row = only(dominoes(tmp_path, [0.0, 0.13, 0.33], contacts=contacts))
    assert (row.id, row.status, row.check, row.group) == ("causal:first:last", "pass", "causal", "temporal")
    assert (row.measured, row.unit) == (2.0, "hops")
    assert [(h["source"], h["target"]) for h in row.evidence["chain"]] == [("d0", "d1"), ("d1", "d2")]
    assert [h["time"] for h in row.evidence["chain"]] == pytest.approx([0.13, 0.33])
    assert row.evidence["order_frames"] == 8  # 0.2 s after 0.0 and 0.33: frames 5 and 13


def test_two_coincident_events_without_contact_are_no_cause(tmp_path: Path) -> None:
    """R97: simultaneous glass break and leak must fail. The shared floor connects nothing."""
    row = only(dominoes(tmp_path, [0.0, 0.1, 0.1], contacts=[]))
    assert (row.status, row.measured, row.bound) == ("fail", 0.0, 1.0)
    assert row.first_failing_entity == "d1"  # next to d0, and the first that received nothing
    assert row.corrections[0].group == "placement"


def test_a_gap_names_the_first_entity_that_never_received_the_chain(tmp_path: Path) -> None:
    row = only(dominoes(tmp_path, [0.0, 0.1, 0.2, 0.3], contacts=[(0.1, "d0", "d1", 0.05), (0.3, "d2", "d3", 0.05)]))
    assert (row.status, row.first_failing_entity, row.evidence["tip"]) == ("fail", "d2", "d1")
    assert row.evidence["gap_between_centers"] == pytest.approx(0.1, abs=0.06)


def test_contacts_in_the_wrong_order_carry_nothing(tmp_path: Path) -> None:
    contacts = [(0.10, "d1", "d2", 0.05), (0.30, "d0", "d1", 0.05)]
    row = only(dominoes(tmp_path, [0.0, 0.05, 0.33], contacts=contacts))
    assert (row.status, row.first_failing_entity) == ("fail", "d2")


def test_a_feather_touch_carries_nothing(tmp_path: Path) -> None:
    mass = 600.0 * 0.02 * 0.1 * 0.2
    for name, impulse, status in (("weak", 0.001 * mass, "fail"), ("strong", 0.02 * mass, "pass")):
        row = only(dominoes(tmp_path / name, [0.0, 0.1], contacts=[(0.15, "d0", "d1", impulse)]))
        assert row.status == status  # d1's centre moves at about 0.3 m/s then: 1 % of it is 0.003 m/s


def test_an_effect_before_its_cause_fails_the_order(tmp_path: Path) -> None:
    row = only(dominoes(tmp_path, [1.0, 0.1], contacts=[(0.1, "d0", "d1", 0.05)]))
    assert (row.status, row.unit) == ("fail", "frame")
    assert row.measured == 8 - 29  # 0.1 + 0.2 s is frame 8, 1.0 + 0.2 s frame 29
    assert row.first_failing_entity == "d1"


def test_contacts_in_one_frame_are_ordered_by_their_event_times(tmp_path: Path) -> None:
    hit = {
        "a": beat("d0", Contact(a="d0", b="d1")),
        "b": beat("d1", Contact(a="d1", b="d2"), causes=["a"]),
    }
    good = [(0.490, "d0", "d1", 0.05), (0.495, "d1", "d2", 0.05)]
    assert only(dominoes(tmp_path / "g", [0.0, 0.4, 0.4], contacts=good, beats=hit)).status == "pass"
    swapped = [(0.495, "d0", "d1", 0.05), (0.490, "d1", "d2", 0.05)]
    row = only(dominoes(tmp_path / "b", [0.0, 0.4, 0.4], contacts=swapped, beats=hit))
    assert row.status == "fail"
    assert row.evidence["event_times"] == pytest.approx([0.495, 0.490])


def test_joints_carry_the_chain_until_they_are_opened(tmp_path: Path) -> None:
    weld = {"w": WeldJoint(parent="d1", child="d2", anchor=(0.15, 0, 0.1))}
    contacts = [(0.5, "d0", "d1", 0.05)]
    starts = [0.4, 0.5, 0.5]
    row = only(dominoes(tmp_path / "a", starts, contacts=contacts, joints=weld))
    assert row.status == "pass"
    assert row.evidence["chain"][1]["impulse"] is None
    opened = {"o": DetachDriver(joint="w", time=0.3)}
    assert only(dominoes(tmp_path / "b", starts, contacts=contacts, joints=weld, drivers=opened)).status == "fail"
    spring = {"s": SpringJoint(parent="d1", child="d2", parent_point=(0.1, 0, 0.1), child_point=(0.2, 0, 0.1), stiffness=10)}
    assert only(dominoes(tmp_path / "c", starts, contacts=contacts, joints=spring)).status == "pass"


def test_one_subject_links_itself_while_it_moves(tmp_path: Path) -> None:
    regions = {"mid": BoxRegion(min=(0.4, -1, 0), max=(0.6, 1, 1)), "end": BoxRegion(min=(0.9, -1, 0), max=(1.1, 1, 1))}
    beats = {
        "passes": beat("ball", Reaches(entity="ball", region="mid")),
        "arrives": beat("ball", Reaches(entity="ball", region="end"), causes=["passes"]),
    }
    spec = world({"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(0, 0, 0.1))}, regions=regions, beats=beats, frames=N)
    smooth = np.minimum(TIME, 1.0)
    stop = np.where(TIME < 0.55, TIME, np.where(TIME < 1.2, 0.55, np.minimum(TIME - 0.65, 1.0)))
    for name, x, status in (("smooth", smooth, "pass"), ("stop", stop, "fail")):
        tracks = {"ball": (np.stack([x, 0 * x, 0 * x + 0.1], axis=1), (1.0, 0, 0, 0))}
        row = only(make_candidate(tmp_path / name, spec, tracks=tracks))
        assert row.status == status
    assert row.first_failing_entity == "ball"
    assert row.first_failing_frame in range(13, 17)  # it stops at 0.55 s


def test_a_driver_causes_from_its_moment_on(tmp_path: Path) -> None:
    drivers = {"go": ReleaseDriver(entity="d0", time=0.25)}
    beats = {"go": beat("d0", owner="go", predicate=Displacement(entity="d0", min=0.001)), "end": beat("d1", causes=["go"])}
    row = only(dominoes(tmp_path / "a", [0.25, 0.45], contacts=[(0.45, "d0", "d1", 0.05)], beats=beats, drivers=drivers))
    assert row.status == "pass"
    assert row.evidence["cause_frame"] == pytest.approx(6.0)
    early = only(dominoes(tmp_path / "b", [0.25, 0.0], contacts=[(0.0, "d0", "d1", 0.05)], beats=beats, drivers=drivers))
    assert (early.status, early.unit) == ("fail", "frame")


def test_beats_that_never_happen_fail_and_tell_how_far_the_chain_came(tmp_path: Path) -> None:
    still = 99.0
    row = only(dominoes(tmp_path / "a", [0.0, 0.1, still], contacts=[(0.1, "d0", "d1", 0.05)]))
    assert (row.status, row.first_failing_entity, row.evidence["tip"]) == ("fail", "d2", "d1")
    row = only(dominoes(tmp_path / "b", [still, 0.1, 0.2], contacts=[(0.1, "d1", "d2", 0.05)]))
    assert (row.status, row.evidence["absent"]) == ("fail", "first")


@pytest.mark.parametrize("channel", ["event/time", "contact/impulse", "velocity"])
def test_a_missing_log_is_unverified(tmp_path: Path, channel: str) -> None:
    candidate = dominoes(tmp_path, [0.0, 0.1], contacts=[(0.1, "d0", "d1", 0.05)], without=[channel])
    assert only(candidate).status == "unverified"


def test_nothing_is_claimed_before_a_simulation(tmp_path: Path) -> None:
    candidate = dominoes(tmp_path, [0.0, 0.1], contacts=[])
    assert only(make_candidate(tmp_path / "s", candidate.spec)).status == "unverified"


def test_a_long_row_is_followed_quickly(tmp_path: Path) -> None:
    """40 dominoes, 39 hops."""
    starts = [0.03 * i for i in range(40)]
    contacts = [(0.03 * i + 0.02, f"d{i}", f"d{i + 1}", 0.05) for i in range(39)]
    assert only(dominoes(tmp_path, starts, contacts=contacts)).measured == 39.0


# ---------------------------------------------------------------- what links nothing, and what does all the same


def test_a_contact_before_the_cause_within_the_same_frame_carries_nothing(tmp_path: Path) -> None:
    beats = {"hit": beat("d1", Contact(a="d0", b="d1")), "end": beat("d2", causes=["hit"])}
    starts = [0.2, 0.4, 0.5]
    good = [(0.490, "d0", "d1", 0.05), (0.495, "d1", "d2", 0.05)]
    assert only(dominoes(tmp_path / "g", starts, contacts=good, beats=beats)).status == "pass"
    bad = [(0.495, "d0", "d1", 0.05), (0.490, "d1", "d2", 0.05)]
    assert only(dominoes(tmp_path / "b", starts, contacts=bad, beats=beats)).status == "fail"


def scene(
    tmp_path: Path, tracks: dict[str, Any], touches: list[Touch], events: list[Event], beats: dict[str, Beat], **plan: Any
) -> Row:
    """Balls of 10 cm along x; a track is x over the frames."""
    kinematic = plan.pop("kinematic", ())
    entities = {"floor": ground()} | {
        n: ball(0.05, motion="kinematic" if n in kinematic else "dynamic", at=(float(np.ravel(x)[0]), 0, 0.05))
        for n, x in tracks.items()
    }
    own = {
        n: (np.stack([np.broadcast_to(x, N), np.zeros(N), np.full(N, 0.05)], axis=1), (1.0, 0, 0, 0)) for n, x in tracks.items()
    }
    spec = world(entities, beats=beats, frames=N, **plan)
    return only(make_candidate(tmp_path, spec, tracks=own, touches=touches, events=events))


def moves(name: str, least: float, *, causes: list[str] | None = None) -> Beat:
    return beat(name, Displacement(entity=name, min=least), causes=causes)


RESTING = 0.02
"""[N s] per frame."""


@pytest.mark.parametrize(("pressed", "status"), [(1.0, "fail"), (1.05, "fail"), (1.5, "pass")])
def test_a_body_at_rest_passes_on_only_what_presses_it_harder_than_its_rest(tmp_path: Path, pressed: float, status: str) -> None:
    """`a` moves while it touches a still `m`, which touches `b`; `b` leaves at 1 s."""
    tracks = {"a": 0.1 * np.clip(TIME - 0.5, 0, 0.5), "m": 0.1, "b": 0.2 + np.clip(TIME - 1.0, 0, None)}
    touches = [
        Touch(k, *pair, RESTING * (pressed if k >= 24 else 1.0)) for k in range(1, 26) for pair in (("a", "m"), ("m", "b"))
    ]
    beats = {"first": moves("a", 0.01), "last": moves("b", 0.05, causes=["first"])}
    assert scene(tmp_path, tracks, touches, [], beats).status == status


def test_what_has_come_to_rest_is_told_to_bear_what_comes_to_it(tmp_path: Path) -> None:
    """`a` stops at 0.5 s; `b` falls onto it long after."""
    tracks = {"a": np.clip(TIME - 0.3, 0, 0.2), "b": 0.5 + np.clip(TIME - 0.9, 0, None)}
    beats = {"first": moves("a", 0.1), "last": moves("b", 0.05, causes=["first"])}
    row = scene(tmp_path, tracks, [Touch(24, "a", "b", RESTING)], [Event(0.99, "a", "b", impulse=RESTING)], beats)
    assert row.status == "fail"
    assert "got as far as a, and b," in row.evidence["explanation"]
    assert "a came to rest at frame 13" in row.evidence["explanation"]
    assert "name what still moves when it meets b" in row.corrections[0].action


def test_what_set_the_cause_going_does_not_link_it_with_what_it_strikes_next(tmp_path: Path) -> None:
    """A hammer strikes `a` and then `b`: `a` is no cause of `b`. It is one if `a` itself strikes `b`."""
    tracks = {
        "hammer": TIME - 0.6,
        "a": np.clip(TIME - 0.5, 0, None) * 0.2,
        "b": 0.5 + np.clip(TIME - 1.0, 0, None) * 0.5,
    }
    beats = {"one": moves("a", 0.05), "two": moves("b", 0.1, causes=["one"])}
    for striker, status in (("hammer", "fail"), ("a", "pass")):
        events = [Event(0.51, "hammer", "a"), Event(1.01, striker, "b")]
        touches = [Touch(13, "hammer", "a"), Touch(25, striker, "b")]
        assert scene(tmp_path / striker, tracks, touches, events, beats).status == status


def _struck(tmp_path: Path, held_from: int) -> Row:
    """A wall stands still, bears a load that slops from frame `held_from` on, and is struck at 0.5 s: both move."""
    slop = 0.3 + 0.004 * np.sin(40.0 * TIME)
    tracks: dict[str, Any] = {
        "ram": TIME - 0.6,
        "wall": np.clip(TIME - 0.5, 0, None) * 0.2,
        "load": slop + np.clip(TIME - 0.5, 0, None) * 0.2,
        "aside": 2.0,
    }
    entities = {"floor": ground()} | {
        n: ball(0.05, motion="dynamic", at=(float(np.ravel(x)[0]), 0, 0.05)) for n, x in tracks.items()
    }
    own = {
        n: (np.stack([np.broadcast_to(x, N), np.zeros(N), np.full(N, 0.05)], axis=1), (1.0, 0, 0, 0)) for n, x in tracks.items()
    }
    both = And(of=[Displacement(entity="load", min=0.05), Speed(entity="load", min=0.05)])
    beats = {"breaks": moves("wall", 0.02), "runs": beat("load", both, causes=["breaks"])}
    touches = [Touch(13, "ram", "wall", 0.5), *(Touch(k, "wall", "load", 0.1) for k in range(held_from, N))]
    spec = world(entities, beats=beats, frames=N)
    return only(make_candidate(tmp_path, spec, tracks=own, touches=touches, events=[Event(0.51, "ram", "wall", impulse=0.5)]))


def test_what_a_struck_wall_bore_until_then_did_not_strike_it(tmp_path: Path) -> None:
    """Water in a vase slops while a ball comes: the vase that breaks lets it go. What came with the ball struck the wall itself."""
    held = _struck(tmp_path / "held", 1)
    assert held.status == "pass", held.evidence["explanation"]
    came = _struck(tmp_path / "came", 13)
    assert came.status == "fail", came.evidence["explanation"]
    assert "tells of load too" in came.evidence["explanation"]


@pytest.mark.parametrize(("blow", "status"), [(90.0, "pass"), (110.0, "fail")])
def test_a_chain_that_gives_next_to_nothing_beside_others_is_no_cause(tmp_path: Path, blow: float, status: str) -> None:
    """S8: 1 % of what others that were moving already give meanwhile."""
    touch = 1e-3
    tracks = {"a": np.minimum(TIME - 0.5, 0), "b": 0.1 + np.clip(TIME - 0.625, 0, None), "fist": TIME - 0.7}
    events = [Event(0.51, "a", "b", impulse=touch), Event(0.63, "fist", "b", impulse=blow * touch)]
    touches = [Touch(13, "a", "b", touch), Touch(16, "fist", "b", blow * touch)]
    row = scene(tmp_path, tracks, touches, events, {"first": moves("a", 0.1), "last": moves("b", 0.2, causes=["first"])})
    assert row.status == status
    if status == "fail":
        assert (row.unit, row.measured, row.bound) == ("N s", pytest.approx(touch), pytest.approx(0.01 * blow * touch))
        assert row.evidence["others"] == pytest.approx({"fist": blow * touch})


def test_a_force_driver_counts_among_the_others(tmp_path: Path) -> None:
    tracks = {"a": np.minimum(TIME - 0.5, 0), "b": 0.1 + np.clip(TIME - 0.5, 0, None)}
    beats = {"first": moves("a", 0.1), "last": moves("b", 0.2, causes=["first"])}
    for force, status in ((0.01, "pass"), (100.0, "fail")):
        driver = {"push": ForceDriver(entity="b", force=(force, 0, 0), start=0.5, end=1.0)}
        events, touches = [Event(0.51, "a", "b", impulse=0.1)], [Touch(13, "a", "b", 0.1)]
        assert scene(tmp_path / status, tracks, touches, events, beats, drivers=driver).status == status


def test_a_held_body_receives_nothing_before_its_release(tmp_path: Path) -> None:
    tracks = {"a": np.minimum(TIME - 0.5, 0), "b": 0.1 + np.clip(TIME - 0.75, 0, None)}
    beats = {"first": moves("a", 0.1), "last": moves("b", 0.2, causes=["first"])}
    events, touches = [Event(0.51, "a", "b")], [Touch(13, "a", "b")]
    for time, status in ((0.25, "pass"), (0.75, "fail")):
        b = 0.1 + np.clip(TIME - (0.5 if status == "pass" else 0.75), 0, None)
        driver = {"let": ReleaseDriver(entity="b", time=time)}
        assert scene(tmp_path / status, {**tracks, "b": b}, touches, events, beats, drivers=driver).status == status


def test_what_a_path_moves_is_no_effect_of_its_own_earlier_motion(tmp_path: Path) -> None:
    keys = {"s": {"time": 0, "pose": {"position": (0, 0, 0.05)}}, "e": {"time": 2, "pose": {"position": (2, 0, 0.05)}}}
    path = {"go": PathDriver(entity="a", keys=keys)}  # type: ignore[arg-type]
    beats = {"starts": moves("a", 0.1), "arrives": moves("a", 1.0, causes=["starts"])}
    row = scene(tmp_path, {"a": TIME}, [], [], beats, drivers=path, kinematic=("a",))
    assert row.status == "fail"
    assert "authored path" in row.evidence["explanation"]


def test_a_slow_creep_is_a_motion(tmp_path: Path) -> None:
    """2 mm/s."""
    tracks = {"a": 0.002 * TIME, "b": 0.1 + 0.002 * np.clip(TIME - 0.5, 0, None)}
    touches = [Touch(k, "a", "b", 0.05) for k in range(13, N)]
    beats = {"first": moves("a", 0.0002), "last": moves("b", 0.0015, causes=["first"])}
    assert scene(tmp_path, tracks, touches, [Event(0.51, "a", "b")], beats).status == "pass"


def test_waves_act_from_their_start_or_from_frame_0() -> None:
    from worldagent.testing.worlds.small_liquids import sea_spec
    from worldagent.worlds.drivers import acts_from
    from worldagent.worlds.patch import parse_spec

    for start, wanted in ((0.5, 0.5), (-1.0, 0.0)):
        spec = parse_spec({**sea_spec(start=start), "prompt": "A crate bobs in the waves of the sea."})
        assert acts_from(spec, "sea") == (wanted, ("water",))
