"""Motion that goes on when a run ends: by physics, or from nowhere (R77, S12)."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, Event, Touch, ball, box, ground, make_candidate, world
from worldagent.verifiers.categories.registry import JUDGES
from worldagent.verifiers.ledgers.exchanged import CHANNEL
from worldagent.verifiers.story.phase_ends import ending
from worldagent.verifiers.story.phases import check
from worldagent.worlds.cache import Cache, CacheIndex, write_container
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Contact, Displacement
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, Coupling, DfsphInstance, ForceDriver, LiquidPhysics, WorldSpec

FPS, FRAMES = 24, 49
LAST = FRAMES - 1
TIME = np.arange(FRAMES) / FPS
G = 9.81


def moving(
    tmp_path: Path, place: Any, velocity: Any, *, spin: float = 0.0, touches: bool = False, meets: int | None = None, **more: Any
) -> Candidate:
    """A thrown ball of 0.1 m over time; beats end at frame 20 unless told, so that none is there to settle it."""
    go = Displacement(entity="ball", min=0.01)
    beats = {"go": Beat(text="", owner="rigid", subject="ball", frames=(0, more.pop("until", 5)), predicate=more.pop("asks", go))}
    thrown = ball(0.1, motion="dynamic", at=tuple(place[0]))
    physics = thrown.physics.model_copy(update={"linear_velocity": (1.0, 0.0, 0.0)})
    entities = {"floor": ground(8.0), "ball": thrown.model_copy(update={"physics": physics})}
    spec = world(entities, frames=FRAMES, beats=beats, **more)
    speeds, spins = (np.zeros((FRAMES, 1, 3)) for _ in range(2))
    speeds[:, 0], spins[:, 0, 2] = velocity, spin
    hits = [] if meets is None else [Event(meets / FPS, "ball", "floor")]
    touched = [Touch(k, "ball", "floor") for k in range(FRAMES)] if touches else []
    channels = {"velocity": speeds, "angular_velocity": spins}
    return make_candidate(tmp_path, spec, tracks={"ball": (place, IDENTITY)}, channels=channels, events=hits, touches=touched)


def along(x: Any, z: Any = 0.1) -> Any:
    return np.stack([x + 0 * TIME, 0 * TIME, z + 0 * TIME], axis=1)


def flying(tmp_path: Path, **more: Any) -> Candidate:
    """It flies over an edge and falls to the end: kinetic energy is largest at the last frame."""
    return moving(tmp_path, along(2 * TIME, 30 - 0.5 * G * TIME**2), along(2.0, -G * TIME), **more)


def sliding(tmp_path: Path, **more: Any) -> Candidate:
    """A puck on ice, whose recorded speed trembles by 0.1 %."""
    return moving(tmp_path, along(2 * TIME), along(2 * (1 + 1e-3 * np.sin(40 * TIME)), 0.0), touches=True, **more)


def row(candidate: Candidate) -> Row:
    (found,) = check(candidate)
    return found


def told(found: Row) -> str:
    return str(found.evidence["notes"]["early_settling"])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (flying, "ball flies on; energy"),
        (sliding, "ball slides or rolls on; energy"),
        (
            lambda path: moving(path, along(0.5 * TIME), along(0.01, 0.0), spin=50.0 + 0.1 * np.sin(9 * TIME), touches=True),
            "ball spins on; energy",
        ),
    ],
    ids=["projectile", "puck", "top"],
)
def test_what_goes_on_by_physics_has_settled_and_the_row_says_which(tmp_path: Path, make: Any, words: str) -> None:
    found = row(make(tmp_path))
    assert (found.status, found.evidence["phases"]["early_settling"]) == ("pass", LAST)
    assert words in told(found)
    assert words in found.evidence["explanation"]


def test_a_swing_that_grows_from_nowhere_fails_though_its_last_beat_has_ended(tmp_path: Path) -> None:
    grow, turn = np.exp(0.8 * TIME), np.sin(6 * TIME)
    x, speed = 0.2 * grow * turn, 0.2 * grow * (6 * np.cos(6 * TIME) + 0.8 * turn)
    for until in (5, LAST):
        found = row(moving(tmp_path / str(until), along(x, 1.0), along(speed, 0.0), until=until))
        assert found.status == "fail"
        assert "no driver feeds it" in str(found.evidence["notes"])
        assert (found.evidence["grows"], found.corrections[0].group) == (1, "step")
    high = 1.0 + 0.5 * 1.44 * turn**2 / G
    rate = 1.44 * turn * 6 * np.cos(6 * TIME) / G
    kept = row(moving(tmp_path / "c", along(0.2 * turn, high), along(1.2 * np.cos(6 * TIME), rate)))
    assert kept.status == "pass"


def test_a_blow_up_at_the_end_fails(tmp_path: Path) -> None:
    speed = 2 + 40 * np.clip(TIME - 1.9, 0, None)
    found = row(moving(tmp_path, along(2 * TIME), along(speed, 0.0), touches=True))
    assert (found.status, found.evidence["missing"][0]) == ("fail", "peak_response")


def test_what_a_lasting_driver_feeds_may_gain(tmp_path: Path) -> None:
    place, speed = along(0.5 * TIME**2), along(1.0 * TIME, 0.0)
    push = ForceDriver(entity="ball", force=(2, 0, 0), start=0.0, end=5.0)
    found = row(moving(tmp_path / "a", place, speed, touches=True, drivers={"push": push}))
    assert found.status == "pass"
    assert "ball is driven on by push" in told(found)
    ended = push.model_copy(update={"end": 0.5})
    assert row(moving(tmp_path / "b", place, speed, touches=True, drivers={"push": ended})).status == "fail"
    assert row(moving(tmp_path / "c", place, speed, touches=True)).status == "fail"


def test_what_is_fed_from_rest_is_told_in_joules_since_a_share_of_nothing_says_nothing(tmp_path: Path) -> None:
    lift = ForceDriver(entity="ball", force=(0, 0, 50), start=0.0, end=5.0)
    lifted = moving(tmp_path, along(0.0, 0.1 + 0.5 * TIME), along(0.0, 0.06), drivers={"lift": lift})
    end = ending(lifted, np.full(FRAMES, 0.01), 0)
    assert end is not None
    assert end.goes_on
    assert " J over the last" in end.text
    assert "%" not in end.text


def test_a_body_that_water_carries_drifts_or_floats(tmp_path: Path) -> None:
    base = moving(tmp_path, along(2 * TIME, 1.0), along(2.0, 0.0))
    water = DfsphInstance(engine="dfsph", members=["sea"], settings={"domain": {"center": (0, 0, 1), "size": (4, 4, 4)}})
    plan = base.spec.simulation
    (solver,) = plan.rigid
    both = Coupling(source="water", target=solver, direction="two_way", variables=["wrench"])
    made = plan.model_copy(update={"solvers": {**plan.solvers, "water": water}, "couplings": {"both": both}})
    coupled = dataclasses.replace(base, spec=base.spec.model_copy(update={"simulation": made}))
    cache = coupled.caches[solver]
    for frame in range(FRAMES):
        push = np.zeros((1, 6))
        push[0, 2] = 1.0
        write_container(cache.path(frame), {**cache.read(frame), CHANNEL: push})
    ways = dict(JUDGES["rigid"].endings(coupled, solver, 12, 1.0))
    assert ways == {"ball": "drifts or floats on"}
    assert dict(JUDGES["rigid"].endings(base, solver, 12, 1.0)) == {"ball": "flies on"}


def test_a_run_that_is_cut_before_its_first_contact_or_a_beat_fails(tmp_path: Path) -> None:
    hits = Contact(a="ball", b="floor")
    found = row(flying(tmp_path / "a", asks=hits))
    assert (found.status, found.evidence["missing"][0]) == ("fail", "first_contact")
    assert row(flying(tmp_path / "b", asks=hits, meets=10)).status == "pass"
    late = row(flying(tmp_path / "c", asks=hits, meets=LAST - 2))
    assert late.status == "fail", "what goes on must be seen to for a quarter of a second"
    assert row(flying(tmp_path / "d", until=LAST + 20)).status == "fail"


@pytest.mark.parametrize(("trend", "status"), [(-0.2, "pass"), (0.0, "pass"), (0.4, "fail")])
def test_water_that_still_splashes_goes_on_when_its_energy_does_not_grow(tmp_path: Path, trend: float, status: str) -> None:
    """Kinetic energy waxes and wanes with the waves; what is potential meanwhile is in the water's own record."""
    wave = np.cos(9 * TIME) ** 2
    whole = 10 * (1 + trend * TIME)
    records = {
        "kinetic_energy": whole * (0.6 + 0.4 * wave),
        "potential_energy": 50 + 0.4 * whole * (1 - wave),
        "max_speed": 1 + 0 * TIME,
    }
    entities = {"floor": ground(4.0), "cube": box(0.2, 0.2, 0.2, at=(0, 0, 0.1))}
    base = make_candidate(tmp_path, world(entities, frames=FRAMES), tracks={})
    index = CacheIndex("water", "dfsph", FPS, FRAMES, ("sea",), (), (), (), "test", {})
    cache = Cache(tmp_path / "cache" / "water")
    cache.write_index(index)
    for k in range(FRAMES):
        write_container(cache.path(k), {f"record/{n}": np.float64(v[k]) for n, v in records.items()})
    sea = box(0.4, 0.4, 0.2, motion="dynamic", at=(0, 0, 0.5), physics=LiquidPhysics(resolution=0.1, currents={}))
    instance = DfsphInstance(engine="dfsph", members=["sea"], settings={"domain": {"center": (0, 0, 1), "size": (4, 4, 4)}})
    flows = Beat(text="", owner="water", subject="sea", frames=(0, 5), predicate=Displacement(entity="sea", min=0.01))
    plan = base.spec.simulation.model_copy(
        update={"solvers": {**base.spec.simulation.solvers, "water": instance}, "preroll": 0.1}
    )
    changed = base.spec.model_copy(
        update={"entities": {**base.spec.entities, "sea": sea}, "simulation": plan}
    )  # fmt: skip
    changed = changed.model_copy(update={"story": changed.story.model_copy(update={"beats": {"flows": flows}})})
    made = dataclasses.replace(base, spec=WorldSpec.model_validate(changed.model_dump(exclude_none=True)))
    vars(made)["caches"] = {**base.caches, "water": cache}
    found = row(made)
    assert found.status == status, found.evidence
    if status == "pass":
        assert "sea flows or splashes on" in told(found)
