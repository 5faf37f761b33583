"""Phases found from the run itself (R77, S12)."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, Event, Touch, ball, box, ground, make_candidate, world
from worldagent.verifiers.story.phase_contacts import asks_for_contact
from worldagent.verifiers.story.phases import check, find_phases
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import And, Contact, Displacement, RestsOn
from worldagent.worlds.spec import Beat, Interacts, LiquidPhysics, ReleaseDriver

FPS = 24
G = 9.81


def dropped(
    tmp_path: Path, *, frames: int = 49, release: float = 0.25, damping: float = 10.0, contact: bool = True, **more: Any
) -> Candidate:
    """A ball held until `release` [s] falls 0.5 m, lands on a plank and rolls on, losing speed at `damping` [1/s]."""
    time = np.arange(frames) / FPS
    landing = release + np.sqrt(2 * 0.5 / G)
    height = 0.6 - 0.5 * G * np.clip(time - release, 0, landing - release) ** 2
    roll = (1 - np.exp(-damping * np.clip(time - landing, 0, None))) * 3.0 / damping
    velocity = np.zeros((frames, 2, 3))
    velocity[:, 0, 2] = np.where((time > release) & (time <= landing), -G * (time - release), 0)
    velocity[:, 0, 0] = np.where(time > landing, 3.2 * np.exp(-damping * np.clip(time - landing, 0, None)), 0)
    entities = {
        "floor": ground(4.0),
        "ball": ball(0.1, motion="dynamic", at=(0, 0, 0.6)),
        "plank": box(2, 2, 0.01, motion="dynamic", at=(0, 0, 0.005)),
    }
    drivers = more.pop("drivers") if "drivers" in more else {"hold": ReleaseDriver(entity="ball", time=release)}
    spec = world(entities, frames=frames, drivers=drivers, **more)
    events = [Event(landing, "ball", "plank")] if contact and landing * FPS <= frames - 1 else []
    touches = [Touch(k, "plank", "floor") for k in range(frames)]
    tracks = {"ball": (np.stack([roll, 0 * time, height], axis=1), IDENTITY)}
    channels = {"velocity": velocity, "angular_velocity": np.zeros((frames, 2, 3))}
    return make_candidate(tmp_path, spec, tracks=tracks, events=events, touches=touches, channels=channels)


def test_a_drop_shows_all_five_phases(tmp_path: Path) -> None:
    phases = find_phases(dropped(tmp_path))
    assert phases.missing() == ()
    assert phases.preroll == 0
    assert phases.activation == 6  # released at 0.25 s
    assert phases.first_contact == 14  # 0.25 + 0.319 s = frame 13.66; the plank touched the floor all along
    assert phases.peak_response == 14  # 3.2 m/s right after landing
    assert phases.early_settling == 16  # exp(-20 t) < 0.2 from 80 ms on: 1.9 frames after the peak
    assert phases.entities["first_contact"] == "ball"
    row = check(dropped(tmp_path / "b"))[0]
    assert (row.id, row.status, row.check, row.measured, row.bound) == ("probe:phases", "pass", "beat", 5.0, 5.0)


@pytest.mark.parametrize(("frames", "missing"), [(10, "first_contact"), (15, "peak_response")])
def test_a_probe_that_is_too_short_names_the_phase_and_the_frames(tmp_path: Path, frames: int, missing: str) -> None:
    hits = Beat(text="", owner="rigid", subject="ball", frames=(10, 30), predicate=Contact(a="ball", b="plank"))
    row = check(dropped(tmp_path, frames=frames, beats={"hits": hits}))[0]
    assert row.status == "fail"
    assert row.evidence["missing"][0] == missing
    assert row.evidence["more_frames"] == 30 - (frames - 1)
    assert row.corrections[0].group == "interval"
    assert row.corrections[0].patch[0] == {"op": "replace", "path": "/simulation/frames", "value": 31}


def test_a_response_that_does_not_settle_fails(tmp_path: Path) -> None:
    row = check(dropped(tmp_path, frames=18, damping=0.1))[0]
    assert row.evidence["missing"] == ["early_settling"]
    assert row.evidence["more_frames"] == FPS
    assert "still" in row.evidence["explanation"]


def test_a_slow_but_steady_decline_is_settling(tmp_path: Path) -> None:
    phases = find_phases(dropped(tmp_path, frames=40, damping=0.2))
    assert phases.early_settling == 39


def test_nothing_happens_where_something_should(tmp_path: Path) -> None:
    entities = {"floor": ground(), "cube": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1))}
    hits = Beat(text="", owner="rigid", subject="cube", frames=(1, 20), predicate=Contact(a="cube", b="floor"))
    row = check(make_candidate(tmp_path, world(entities, beats={"hits": hits}), tracks={}))[0]
    assert (row.status, row.evidence["missing"][0]) == ("fail", "activation")
    assert row.corrections[0].group == "drivers"


def test_a_world_that_is_meant_to_rest_has_no_phases_to_cover(tmp_path: Path) -> None:
    entities = {"floor": ground(), "cube": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1))}
    rests = Beat(
        text="", owner="rigid", subject="cube", frames=(0, 20), predicate=RestsOn(entity="cube", on="floor", when="always")
    )
    row = check(make_candidate(tmp_path, world(entities, beats={"rests": rests}), tracks={}))[0]
    assert row.status == "not_applicable"


def swung(tmp_path: Path, predicate: Any, *, course: Any = None, touched: float | None = None, **more: Any) -> Candidate:
    """A ball that is thrown sideways in the air and touches nothing; it slows down, or has the speed of `course` over time.

    At `touched` [s] its log says that it met the floor.
    """
    frames = 49
    time = np.arange(frames) / FPS
    speed = np.exp(-4 * time) if course is None else course(time)
    velocity = np.zeros((frames, 1, 3))
    velocity[:, 0, 0] = speed
    beat = Beat(text="it flies", owner="rigid", subject="ball", frames=(0, 40), predicate=predicate)
    thrown = ball(0.1, motion="dynamic", at=(0, 0, 1))
    thrown = thrown.model_copy(update={"physics": thrown.physics.model_copy(update={"linear_velocity": (1.0, 0.0, 0.0)})})
    spec = world({"floor": ground(4.0), "ball": thrown}, frames=frames, beats={"fly": beat}, **more)
    tracks = {"ball": (np.stack([(1 - speed) / 4, 0 * time, 0 * time + 1], axis=1), IDENTITY)}
    events = [] if touched is None else [Event(touched, "ball", "floor")]
    channels = {"velocity": velocity, "angular_velocity": np.zeros((frames, 1, 3))}
    return make_candidate(tmp_path, spec, tracks=tracks, events=events, channels=channels)


def test_first_contact_does_not_apply_where_nothing_meets_and_nothing_asks_for_it(tmp_path: Path) -> None:
    flight = Displacement(entity="ball", axis=(1, 0, 0), min=0.1)
    phases = find_phases(swung(tmp_path / "a", flight))
    assert phases.touchless
    assert phases.first_contact is None
    assert (phases.peak_response, phases.early_settling) == (0, 5)  # exp(-8 t) < 0.2 from 0.2 s on
    (row,) = check(swung(tmp_path / "b", flight))
    assert (row.status, row.measured, row.bound) == ("pass", 4.0, 4.0)
    assert "no beat, relation or cause asks for one" in row.evidence["explanation"]


def test_first_contact_applies_as_soon_as_anything_asks_for_it(tmp_path: Path) -> None:
    flight = Displacement(entity="ball", axis=(1, 0, 0), min=0.1)
    asked = And(of=[flight, Contact(a="ball", b="floor")])
    landed = RestsOn(entity="ball", on="floor")
    met = {"relations": {"meet": Interacts(a="ball", b="floor")}}
    for name, (predicate, more) in {"a": (asked, {}), "b": (landed, {}), "c": (flight, met)}.items():
        (row,) = check(swung(tmp_path / name, predicate, **more))
        assert (row.status, row.bound) == ("fail", 5.0)
        assert row.evidence["missing"][0] == "first_contact"


def test_what_is_carried_on_evenly_has_reached_its_peak_and_what_still_gains_has_not(tmp_path: Path) -> None:
    """Over the last quarter of a second the energy may vary by 5 %: of a speed that ends at 1.2 m/s, by 0.03 m/s."""
    drift = Displacement(entity="ball", axis=(1, 0, 0), min=0.1)
    phases = find_phases(swung(tmp_path / "a", drift, course=lambda t: 1.2 - 0.2 * np.exp(-2 * t)))
    assert phases.missing() == ()
    assert phases.peak_response in range(12, 43)
    assert "carried on evenly" in phases.notes["peak_response"]
    phases = find_phases(swung(tmp_path / "b", drift, course=lambda t: 1.0 + 0.5 * t))
    assert phases.missing()[0] == "peak_response"


def test_bodies_that_meet_unasked_as_the_run_ends_start_no_response(tmp_path: Path) -> None:
    """Two beams of a stream brushed each other in its last frames: nothing could follow from that, and nothing asked for it."""
    drift = Displacement(entity="ball", axis=(1, 0, 0), min=0.1)
    course = lambda t: 1.2 - 0.2 * np.exp(-2 * t)  # noqa: E731
    phases = find_phases(swung(tmp_path / "a", drift, course=course, touched=47.5 / FPS))
    assert phases.first_contact == 48
    assert phases.missing() == ()
    asked = And(of=[drift, Contact(a="ball", b="floor")])
    assert find_phases(swung(tmp_path / "b", asked, course=course, touched=47.5 / FPS)).missing()[0] == "peak_response"


def test_what_a_liquid_passes_on_needs_no_contact_of_bodies(tmp_path: Path) -> None:
    candidate = swung(tmp_path, Displacement(entity="ball", axis=(1, 0, 0), min=0.1))
    spec, beat = candidate.spec, candidate.spec.story.beats["fly"]
    water = spec.entities["floor"].model_copy(update={"physics": LiquidPhysics(resolution=0.1)})
    for cause, asked in {"water": False, "floor": True}.items():
        beats = {
            "before": beat.model_copy(update={"subject": cause}),
            "fly": beat.model_copy(update={"causes": ["before"]}),
        }
        told = {
            "entities": {**spec.entities, "water": water},
            "story": spec.story.model_copy(update={"beats": beats}),
        }
        assert asks_for_contact(dataclasses.replace(candidate, spec=spec.model_copy(update=told))) is asked


def test_bodies_in_touch_from_the_start_are_no_first_contact(tmp_path: Path) -> None:
    row = check(dropped(tmp_path, contact=False))[0]
    assert row.evidence["missing"][0] == "first_contact"


def test_a_scene_that_moves_unbidden_at_frame_0_has_no_preroll(tmp_path: Path) -> None:
    candidate = dropped(tmp_path, release=-0.2, drivers={})  # it falls already at 2 m/s at frame 0
    row = check(candidate)[0]
    assert (row.status, row.evidence["missing"]) == ("fail", ["preroll"])
    assert row.corrections[0].patch[0]["path"] == "/simulation/preroll"
    plan = candidate.spec.simulation.model_copy(update={"preroll": 0.5})
    settled = dataclasses.replace(candidate, spec=candidate.spec.model_copy(update={"simulation": plan}))
    assert find_phases(settled).preroll == 0


def test_a_throw_that_the_specification_asks_for_needs_no_preroll(tmp_path: Path) -> None:
    candidate = dropped(tmp_path, release=-0.2, drivers={})
    thrown = ball(0.1, motion="dynamic", at=(0, 0, 0.6), velocity=(0, 0, -2))
    spec = candidate.spec.model_copy(update={"entities": {**candidate.spec.entities, "ball": thrown}})
    phases = find_phases(dataclasses.replace(candidate, spec=spec))
    assert (phases.preroll, phases.activation) == (0, 0)


def test_missing_evidence_is_unverified(tmp_path: Path) -> None:
    candidate = dropped(tmp_path)
    assert check(make_candidate(tmp_path / "s", candidate.spec))[0].status == "unverified"
    path = candidate.caches["rigid"].path(3)
    path.unlink()
    assert check(candidate)[0].status == "unverified"
