"""First contact of grains and cloth, seen from their own records: what was promised counts, what happens beside it does not (R77)."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, box, ground, make_candidate, world
from worldagent.verifiers.story.phases import check, find_phases
from worldagent.worlds.cache import Cache, CacheIndex, write_container
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.channels import CHANNELS
from worldagent.worlds.predicates import Contact, Displacement, Speed
from worldagent.worlds.spec import (
    Beat,
    ClothInstance,
    ClothPhysics,
    ClothPin,
    Coupling,
    DemInstance,
    Interacts,
    ParticlePhysics,
    ReleaseDriver,
    WorldSpec,
)

FPS, FRAMES = 24, 60
LANDS = 30
"""Frame in which the ball meets what lies below it."""
DROP = {"drop": ReleaseDriver(entity="ball", time=20 / FPS)}
SAND = DemInstance(engine="dem", members=["sand"], settings={"domain": {"center": (0, 0, 1), "size": (4, 4, 4)}})
RUNS = Beat(text="", owner="grains", subject="sand", frames=(1, 20), predicate=Speed(entity="sand", min=0.1))


def bump(first: int, last: int, frames: int = FRAMES) -> np.ndarray:
    """1 over some frames, 0 elsewhere."""
    k = np.arange(frames)
    return ((k >= first) & (k <= last)).astype(float)


def write(folder: Path, index: CacheIndex, channels: dict[str, Any]) -> Cache:
    cache = Cache(folder)
    cache.write_index(index)
    for k in range(index.frames):
        write_container(cache.path(k), {n: np.asarray(v[k], dtype=CHANNELS[n].type) for n, v in channels.items()})
    return cache


def beside(candidate: Candidate, solver: str, entity: str, instance: Any, cache: Cache, physics: Any, **more: Any) -> Candidate:
    """The candidate with an entity that an instance of its own moves; `more` changes the plan."""
    spec = candidate.spec
    plan = spec.simulation.model_copy(update={"solvers": {**spec.simulation.solvers, solver: instance}, **more})
    matter = box(0.4, 0.4, 0.2, motion="dynamic", at=(0, 0, 0.1), physics=physics)
    changed = spec.model_copy(update={"entities": {**spec.entities, entity: matter}, "simulation": plan})
    made = dataclasses.replace(candidate, spec=WorldSpec.model_validate(changed.model_dump(exclude_none=True)))
    vars(made)["caches"] = {**candidate.caches, solver: cache}
    return made


def falling(tmp_path: Path, frames: int, *, drops: bool = True, **more: Any) -> Candidate:
    """A ball that is let go at frame 20 and stops at `LANDS`, over ground and hopper; nothing rigid meets."""
    time = np.clip((np.arange(frames) - 20) / FPS, 0, (LANDS - 20) / FPS) * drops
    velocity = np.zeros((frames, 1, 3))
    velocity[:, 0, 2] = -9.81 * time * (np.arange(frames) <= LANDS)
    entities = {
        "floor": ground(4.0),
        "hopper": box(0.1, 0.1, 1.0, at=(0.5, 0, 0.5)),
        "ball": ball(0.1, motion="dynamic", at=(0, 0, 2)),
    }
    track = np.stack([0 * time, 0 * time, 2 - 0.5 * 9.81 * time**2], axis=1)
    spec = world(entities, frames=frames, drivers=DROP if drops else {}, **more)
    channels = {"velocity": velocity, "angular_velocity": np.zeros((frames, 1, 3)), "exchange/impulse": np.zeros((frames, 1, 6))}
    return make_candidate(tmp_path, spec, tracks={"ball": (track, IDENTITY)}, channels=channels)


def poured(tmp_path: Path, frames: int = FRAMES, *, drops: bool = True, **more: Any) -> Candidate:
    """Sand presses the hopper from the start, runs onto the floor from frame 8 on and presses the ball from `LANDS` on."""
    push = np.zeros((frames, 3, 6))
    for row, first in enumerate((1, 8, LANDS)):
        push[:, row, 2] = bump(first, frames if drops or row < 2 else 0, frames)
    energy = np.minimum(np.arange(frames), 8) * (np.arange(frames) < 12)  # [J] largest at frame 8
    records = {"max_speed": bump(1, 25, frames), "kinetic_energy": energy}
    index = CacheIndex("grains", "dem", FPS, frames, ("sand",), ("hopper/body", "floor/body", "ball/body"), (), (), "test", {})
    data = {"exchange/impulse": push, **{f"record/{n}": v for n, v in records.items()}}
    base = falling(tmp_path, frames, drops=drops, **more)
    cache = write(tmp_path / "cache" / "grains", index, data)
    return beside(base, "grains", "sand", SAND, cache, ParticlePhysics(radius=0.01))


def hit(predicate: Any, **more: Any) -> Beat:
    return Beat(text="", owner="rigid", subject="ball", frames=(20, 40), predicate=predicate, **more)


def test_a_ball_that_lands_on_sand_has_met_it(tmp_path: Path) -> None:
    beats = {"runs": RUNS, "lands": hit(Contact(a="ball", b="sand"), causes=["runs"])}
    phases = find_phases(poured(tmp_path, beats=beats))
    assert (phases.activation, phases.first_contact) == (1, LANDS)  # sand on the floor at frame 8 was not promised
    assert phases.entities["first_contact"] == "ball"
    assert phases.missing() == ()


def test_a_probe_that_ends_before_the_promised_contact_fails(tmp_path: Path) -> None:
    beats = {"runs": RUNS, "lands": hit(Contact(a="ball", b="sand"), causes=["runs"])}
    (row,) = check(poured(tmp_path, LANDS, beats=beats))
    assert (row.status, row.evidence["missing"][0]) == ("fail", "first_contact")
    assert "no new contact between ball and sand after frame 1" in row.evidence["explanation"]
    assert row.corrections[0].group == "interval"
    assert row.evidence["more_frames"] == 40 - (LANDS - 1)


def test_the_story_may_promise_another_contact_than_that_with_sand(tmp_path: Path) -> None:
    for name, beats in {
        "a": {"lands": hit(Contact(a="ball", b="floor"))},
        "b": {"runs": RUNS, "lands": hit(Contact(a="sand", b="hopper"), causes=["runs"])},  # which it touches from the start
    }.items():
        (row,) = check(poured(tmp_path / name, beats=beats))
        assert (row.status, row.evidence["missing"][0]) == ("fail", "first_contact")


def test_sand_that_runs_beside_a_body_at_rest_shows_all_phases(tmp_path: Path) -> None:
    phases = find_phases(poured(tmp_path / "a", drops=False, beats={"runs": RUNS}))
    assert (phases.activation, phases.first_contact, phases.peak_response, phases.early_settling) == (1, 8, 8, 12)
    assert phases.missing() == ()
    (row,) = check(poured(tmp_path / "b", 8, drops=False, beats={"runs": RUNS}))
    assert (row.status, row.evidence["missing"]) == ("fail", ["peak_response", "early_settling"])


def hung(
    tmp_path: Path, frames: int = FRAMES, *, brushes: int | None = None, caught: bool = False, to: str = "hopper", **more: Any
) -> Candidate:
    """A sheet that swings from frame 5 on, with less and less energy; it brushes a solid at a frame, or the ball falls into it."""
    swing = np.where(np.arange(frames) >= 5, np.exp(-0.2 * (np.arange(frames) - 5)), 0.0)
    records = {f"solid_impulse_{a}": np.zeros(frames) for a in "xyz"} | {"max_speed": swing, "kinetic_energy": swing**2}
    if brushes is not None:
        records["solid_impulse_x"] = 0.2 * (np.arange(frames) >= brushes)
    base = falling(tmp_path, frames, drops=caught, **more)
    plan: dict[str, Any] = {}
    if caught:
        felt = np.zeros((frames, 1, 6))
        felt[:, 0, 2] = bump(LANDS, frames, frames)
        for k in range(frames):
            path = base.caches["rigid"].path(k)
            write_container(path, {**base.caches["rigid"].read(k), "exchange/impulse": felt[k]})
        both = Coupling(source="rigid", target="cloth", direction="two_way", variables=["motion", "wrench"])
        plan["couplings"] = {"both": both}
    index = CacheIndex("cloth", "shell", FPS, frames, (), (), (), (), "test", {})
    cache = write(tmp_path / "cache" / "cloth", index, {f"record/{n}": v for n, v in records.items()})
    physics = ClothPhysics(
        area_density=0.2, thickness=0.001, stretch_stiffness=100, bend_stiffness=1e-5, pins={"top": ClothPin(edge="+y", to=to)}
    )
    return beside(base, "cloth", "sheet", ClothInstance(members=["sheet"]), cache, physics, **plan)


SWINGS = Beat(text="", owner="cloth", subject="sheet", frames=(4, 20), predicate=Displacement(entity="sheet", min=0.1))


def test_a_sheet_that_hangs_and_swings_is_asked_for_no_contact(tmp_path: Path) -> None:
    (row,) = check(hung(tmp_path / "a", beats={"swings": SWINGS}))
    assert (row.status, row.bound) == ("pass", 4.0)
    # What it is pinned to moves it without a contact.
    pushed = Beat(text="", owner="rigid", subject="hopper", frames=(1, 9), predicate=Displacement(entity="hopper", min=0.1))
    beats = {"pushed": pushed, "swings": SWINGS.model_copy(update={"causes": ["pushed"]})}
    assert check(hung(tmp_path / "b", beats=beats))[0].status == "pass"
    (row,) = check(hung(tmp_path / "c", beats=beats, to="floor"))
    assert (row.status, row.evidence["missing"][0]) == ("fail", "first_contact")


def test_a_sheet_that_meets_a_solid_has_its_first_contact(tmp_path: Path) -> None:
    met = {"relations": {"meet": Interacts(a="sheet", b="hopper")}, "beats": {"swings": SWINGS}}
    phases = find_phases(hung(tmp_path / "a", brushes=12, **met))
    assert (phases.activation, phases.first_contact) == (5, 12)
    for name, at in {"never": None, "from the start": 1, "after the probe": 40}.items():
        (row,) = check(hung(tmp_path / name, 30, brushes=at, **met))
        assert (row.status, row.evidence["missing"][0]) == ("fail", "first_contact")


@pytest.mark.parametrize(("frames", "first"), [(FRAMES, LANDS), (LANDS, None)])
def test_a_ball_in_a_sheet_is_known_by_what_it_felt(tmp_path: Path, frames: int, first: int | None) -> None:
    """That the sheet brushes the hopper on the way is not what the story promises."""
    sags = Beat(text="", owner="cloth", subject="sheet", frames=(25, 40), predicate=Displacement(entity="sheet", min=0.1))
    beats = {"drops": hit(Displacement(entity="ball", min=0.1)), "sags": sags.model_copy(update={"causes": ["drops"]})}
    phases = find_phases(hung(tmp_path, frames, brushes=12, caught=True, beats=beats))
    assert phases.first_contact == first
    assert phases.missing()[:1] == (() if first else ("first_contact",))
