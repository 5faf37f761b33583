"""Numerical checks: each broken on purpose by one number."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.defects import _scenes as scenes
from worldagent.testing.defects._films import film_of
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.testing.worlds.small_worlds import IDENTITY, Touch, ball, box, entity, ground, make_candidate, pose, world
from worldagent.verifiers.categories.check import check_numerical as check
from worldagent.verifiers.categories.questions import AMOUNT, SETTLED
from worldagent.verifiers.categories.questions import QUESTIONS as SHARED
from worldagent.verifiers.categories.rigid.questions import NUMERICAL
from worldagent.verifiers.contact.step_travel import thickness
from worldagent.verifiers.diagnosis.cite import diagnose
from worldagent.worlds.arrays import RigidPose
from worldagent.worlds.built import Convex
from worldagent.worlds.cache import Cache, write_container
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Box, HingeJoint, Limits, Part, ReleaseDriver, RigidPhysics, RigidSettings, WorldSpec

FPS, N = 24, 25
TIME = np.arange(N) / FPS
RECORDS = {
    "kinetic_energy": 1.0,
    "potential_energy": 10.0,
    "driver_work": 0.0,
    "max_speed": 1.0,
    "max_travel_per_step": 5e-4,
    "steps": 84.0,
    "step": 5e-4,
    "contacts_max": 4.0,
    "iterations_max": 3.0,
    "iterations_capped": 0.0,
    "overflows": 0.0,
}


def sliding(tmp_path: Path, *, records: dict[str, Any] | None = None, x: Any = None, **more: Any) -> Candidate:
    entities = {
        "floor": ground(),
        "cube": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1), velocity=(1.0, 0, 0)),
        "card": box(0.1, 0.1, 0.01, motion="dynamic", at=(0, 2, 0.005)),
    }
    spec = world(entities, frames=N, settings=more.pop("settings", None), limits=more.pop("limits", None))
    x = TIME if x is None else x
    tracks = {"cube": (np.stack([x, 0 * TIME, 0 * TIME + 0.1], axis=1), more.pop("turn", IDENTITY))}
    return make_candidate(tmp_path, spec, tracks=tracks, records=RECORDS | (records or {}), **more)


def rows_of(candidate: Candidate) -> dict[str, Row]:
    return {r.id.split(":")[1]: r for r in check(candidate)}


def failing(candidate: Candidate) -> set[str]:
    return {n for n, r in rows_of(candidate).items() if r.status != "pass"}


def test_a_sound_run_passes_every_claim(tmp_path: Path) -> None:
    rows = rows_of(sliding(tmp_path))
    assert set(rows) == {
        q.id.partition(":")[2] for q in (*SHARED, *NUMERICAL) if q.check == "numerical" and q not in (AMOUNT, SETTLED)
    }
    assert {r.status for r in rows.values()} == {"pass"}
    assert rows["finite"].id == "numerical:finite:rigid"
    assert rows["speed"].measured == pytest.approx(1.0)
    assert rows["step_travel"].bound == pytest.approx(0.1)  # half of the cube, which moves


def test_a_number_that_is_not_finite_is_found_in_any_channel(tmp_path: Path) -> None:
    x = TIME.copy()
    x[6] = np.nan
    row = rows_of(sliding(tmp_path, x=x))["finite"]
    assert (row.status, row.first_failing_entity) == ("fail", "cube")
    assert row.first_failing_frame == 5  # central differences write the velocity of frame 5 with it
    record = rows_of(sliding(tmp_path / "b", records={"potential_energy": np.where(TIME == 0.5, np.inf, 1.0)}))["finite"]
    assert (record.status, record.first_failing_frame, record.evidence["channel"]) == ("fail", 12, "record/potential_energy")


def test_a_quaternion_off_the_unit_sphere_fails(tmp_path: Path) -> None:
    turn = np.repeat([IDENTITY], N, 0)
    turn[9] *= 1.00001
    row = rows_of(sliding(tmp_path, turn=turn))["quaternion"]
    assert (row.status, row.first_failing_entity, row.first_failing_frame) == ("fail", "cube", 9)
    assert row.measured == pytest.approx(1e-5, rel=1e-3)


def test_speed_is_limited_at_frames_and_between_them(tmp_path: Path) -> None:
    row = rows_of(sliding(tmp_path, limits=Limits(max_speed=0.9)))["speed"]
    assert (row.status, row.first_failing_entity, row.measured, row.bound) == ("fail", "cube", pytest.approx(1.0), 0.9)
    peak = rows_of(sliding(tmp_path / "b", records={"max_speed": np.where(np.arange(N) == 7, 80.0, 1.0)}))["speed"]
    assert (peak.status, peak.first_failing_frame, peak.measured) == ("fail", 7, 80.0)


def test_a_teleport_fails_even_if_the_velocity_hides_it(tmp_path: Path) -> None:
    x = TIME + np.where(np.arange(N) >= 14, 5.0, 0.0)
    candidate = sliding(tmp_path, x=x, channels={"velocity": np.zeros((N, 2, 3))})
    rows = rows_of(candidate)
    assert (rows["travel"].status, rows["travel"].first_failing_frame) == ("fail", 14)
    assert rows["travel"].measured == pytest.approx(5 + 1 / 24)
    assert rows["travel"].bound == pytest.approx(61 / 24)
    assert rows["speed"].status == "pass"


def test_explosive_growth_needs_a_jump_in_speed_and_in_energy(tmp_path: Path) -> None:
    velocity = np.zeros((N, 2, 3))
    velocity[10:, 0, 0] = 3.0  # from rest (counted as 0.05 m/s) to 60 times that
    hit = {"channels": {"velocity": velocity}}
    assert rows_of(sliding(tmp_path, **hit))["growth"].status == "pass"  # hit by something: the energy stays
    gained = {"kinetic_energy": np.where(np.arange(N) >= 10, 20.0, 1.0)}
    row = rows_of(sliding(tmp_path / "b", records=gained, **hit))["growth"]
    assert (row.status, row.first_failing_entity, row.first_failing_frame) == ("fail", "cube", 10)
    assert row.measured == pytest.approx(60)


def test_rows_must_match_the_index(tmp_path: Path) -> None:
    candidate = sliding(tmp_path, channels={"asleep": np.zeros((N, 3), dtype=np.uint8)})
    row = rows_of(candidate)["counts"]
    assert (row.status, row.measured, row.bound) == ("fail", 3.0, 2.0)
    entities = {**candidate.spec.entities, "extra": box(0.1, 0.1, 0.1, motion="dynamic")}
    solver = candidate.spec.simulation.solvers["rigid"].model_copy(update={"members": list(entities)})
    plan = candidate.spec.simulation.model_copy(update={"solvers": {"rigid": solver}})
    spec = candidate.spec.model_copy(update={"entities": entities, "simulation": plan})
    built = {**candidate.built, "extra": candidate.built["cube"]}
    lost = rows_of(dataclasses.replace(candidate, spec=spec, built=built))["counts"]
    assert (lost.status, lost.first_failing_entity) == ("fail", "extra")


def test_engine_warnings_and_capped_iterations_fail(tmp_path: Path) -> None:
    records = {"overflows": np.where(np.arange(N) == 5, 2.0, 0.0), "iterations_capped": 5.0}
    rows = rows_of(sliding(tmp_path, records=records))
    assert (rows["overflow"].status, rows["overflow"].measured, rows["overflow"].first_failing_frame) == ("fail", 2.0, 5)
    assert (rows["iterations"].status, rows["iterations"].measured) == ("fail", pytest.approx(5 / 84))
    assert rows["iterations"].corrections[0].patch[0]["value"] == 120
    assert failing(sliding(tmp_path / "b", records={"iterations_capped": 4.0})) == set()


@pytest.mark.parametrize(("tolerance", "wanted"), [(1e-12, 1e-11), (5e-9, 1e-8), (1e-8, None)])
def test_a_search_finer_than_usual_that_never_ends_is_told_to_end_sooner(
    tmp_path: Path, tolerance: float, wanted: float | None
) -> None:
    """As of a lamp on a cord in a room, whose instance searches to 1e-12: more iterations never sufficed, a tolerance of 1e-11 took one."""
    candidate = sliding(tmp_path, records={"iterations_capped": 5.0}, settings=RigidSettings(tolerance=tolerance))
    row = diagnose(rows_of(candidate)["iterations"], candidate.spec)
    first = row.corrections[0].patch[0] if row.corrections[0].patch else {"path": "", "value": None}
    assert (first["path"].endswith("/settings/tolerance"), first["value"]) == (wanted is not None, wanted or 120)


def test_travel_per_step_is_held_against_the_thinnest_collider(tmp_path: Path) -> None:
    records = {"max_travel_per_step": np.where(np.arange(N) == 8, 0.01, 1e-4)}
    row = rows_of(sliding(tmp_path, records=records, settings=RigidSettings(step=5e-4)))["step_travel"]
    assert (row.status, row.first_failing_frame, row.first_failing_entity) == ("fail", 8, "card")
    assert row.corrections[0].patch[0]["value"] == pytest.approx(0.9 * 5e-4 * 0.005 / 0.01, rel=0.05)


def test_a_pair_that_names_no_collider_is_told_once_and_stops_no_check(tmp_path: Path) -> None:
    candidate = sliding(tmp_path, touches=[Touch(4, "card", "floor")])
    cache = candidate.caches["rigid"]
    log = cache.read(4)
    write_container(cache.path(4), log | {"contact/pair": log["contact/pair"] + 90})
    rows = rows_of(dataclasses.replace(candidate, caches={"rigid": Cache(cache.folder)}))
    assert rows["events"].status == "fail"
    assert "a collider that is not there" in rows["events"].evidence["explanation"]
    assert rows["step_travel"].status == "unverified"


@pytest.mark.parametrize(("beside", "status"), [(0.0, "fail"), (0.13, "pass"), (3.0, "pass")])
def test_a_fast_ball_is_held_against_the_panes_that_it_could_meet(tmp_path: Path, beside: float, status: str) -> None:
    """Ten metres per second in steps of a millisecond are more than half of a pane of a centimetre, wherever that stands."""
    entities = {
        "pane": box(0.01, 0.2, 1.0, at=(0, beside, 1.0)),
        "ball": ball(0.01, motion="dynamic", at=(-1.0, 0, 1.0), velocity=(10, 0, 0)),
        "snail": ball(0.05, motion="dynamic", at=(0.07, beside, 1.0)),
    }
    run = simulate_freely(tmp_path, world(entities, frames=7, gravity=(0, 0, 0), settings=RigidSettings(step=1e-3, refine=0)))
    row = rows_of(run)["step_travel"]
    assert row.status == status
    if status == "fail":
        assert (row.first_failing_entity, row.evidence["fast"]) == ("pane", "ball")
        assert row.measured == pytest.approx(0.01, rel=1e-3)
        assert row.bound == pytest.approx(0.005)
        assert row.first_failing_frame == 3


def struck_lamp(height: float) -> WorldSpec:
    """A ball at 10 m/s strikes the foot of a lamp whose two thin arms stand so high above it."""
    arms = [Part(shape=Box(size=(0.003, 0.3, 0.003 + 0.001 * i)), pose=pose((0, 0, height + 0.02 * i))) for i in range(2)]
    entities = {
        "lamp": entity(Box(size=(0.2, 0.2, 0.1)), *arms, motion="dynamic"),
        "ball": ball(0.02, motion="dynamic", at=(-0.3, 0, 0), velocity=(10, 0, 0)),
    }
    return world(entities, frames=7, fps=48, gravity=(0, 0, 0), settings=RigidSettings(step=5e-4, refine=0))


def test_thin_parts_that_nothing_comes_near_are_not_judged_and_near_ones_are_all_told(tmp_path: Path) -> None:
    """The contact log names entities: the foot was struck, the arms were not."""
    high = rows_of(simulate_freely(tmp_path / "high", struck_lamp(0.8)))["step_travel"]
    assert high.status == "pass"
    low = rows_of(simulate_freely(tmp_path / "low", struck_lamp(0.06)))["step_travel"]
    assert (low.status, low.first_failing_entity) == ("fail", "lamp")
    told = low.evidence["offenders"]
    assert [(o["entity"], o["part"], round(o["thickness"], 6)) for o in told] == [("lamp", "p1", 0.003), ("lamp", "p2", 0.003)]
    assert low.evidence["offenders_total"] == 2
    assert all(0.8 * o["thickness"] / 2 < 10.0 * o["step"] < o["thickness"] / 2 for o in told)
    assert [o["travel"] for o in told] == sorted((o["travel"] for o in told), reverse=True)
    assert "lamp/p1" in low.evidence["explanation"]
    assert "p1" in low.corrections[1].action


def test_a_log_that_names_two_whom_no_way_brings_together_exempts_none_of_their_parts(tmp_path: Path) -> None:
    """A contact between two that seem far apart says that the ways are wrong, not that the parts are safe."""
    entities = {
        "pane": box(0.01, 0.2, 1.0, at=(0, 3.0, 1.0)),
        "ball": ball(0.01, motion="dynamic", at=(-1.0, 0, 1.0), velocity=(10, 0, 0)),
    }
    film = film_of(world(entities, frames=7, gravity=(0, 0, 0), settings=RigidSettings(step=1e-3, refine=0)))
    film.touch(3, "pane", "ball", np.array([0.0, 0.0, 1e-9]))
    row = rows_of(film.candidate(tmp_path))["step_travel"]
    assert (row.status, row.first_failing_entity, row.first_failing_frame) == ("fail", "pane", 3)


@pytest.mark.parametrize(("collide", "status"), [(False, "pass"), (True, "fail")])
def test_joined_bodies_that_do_not_collide_are_no_walls_for_each_other(tmp_path: Path, collide: bool, status: str) -> None:
    entities = {
        "frame": box(0.2, 0.2, 0.01, at=(0, 0, 1.0)),
        "wheel": box(0.3, 0.02, 0.02, motion="dynamic", at=(0, 0, 1.05)),
    }
    hinge = HingeJoint(parent="frame", child="wheel", anchor=(0, 0, 1.05), axis=(0, 0, 1), collide=collide)
    start = RigidPhysics(angular_velocity=(0, 0, 40.0))
    entities["wheel"] = entities["wheel"].model_copy(update={"physics": start})
    spec = world(entities, frames=5, joints={"axle": hinge}, gravity=(0, 0, 0), settings=RigidSettings(step=1e-3, refine=0))
    row = rows_of(simulate_freely(tmp_path, spec))["step_travel"]
    assert row.status == status


def simulate_freely(folder: Path, spec: WorldSpec) -> Candidate:
    return film_of(spec).candidate(folder)


@pytest.mark.parametrize(
    ("kind", "params", "points", "expected"),
    [
        ("box", (0.1, 0.2, 0.05), [], 0.1),
        ("sphere", (0.3,), [], 0.6),
        ("capsule", (0.1, 1.0), [], 0.2),
        ("cylinder", (0.5, 0.02), [], 0.04),
        ("hull", (), [[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 0.3)], 0.3),
    ],
)
def test_thickness_is_the_smallest_width(
    kind: str, params: tuple[float, ...], points: list[list[float]], expected: float
) -> None:
    pose = RigidPose(np.zeros(3), np.array(IDENTITY))
    assert thickness(Convex(kind, params, pose, np.array(points, dtype=float).reshape(-1, 3))) == pytest.approx(expected)


def test_a_rotated_hull_keeps_its_thickness() -> None:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 0.3)])
    c, s = np.cos(0.5), np.sin(0.5)
    turned = corners @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]).T
    assert thickness(Convex("hull", (), RigidPose(np.zeros(3), np.array(IDENTITY)), turned)) == pytest.approx(0.3)


def test_missing_and_damaged_frames_fail(tmp_path: Path) -> None:
    candidate = sliding(tmp_path)
    candidate.caches["rigid"].path(20).unlink()
    rows = rows_of(candidate)
    assert (rows["frames"].status, rows["frames"].first_failing_frame) == ("fail", 20)
    assert rows["digest"].status == "fail"
    assert rows["finite"].status == "unverified"
    damaged = sliding(tmp_path / "b")
    path = damaged.caches["rigid"].path(3)
    content = bytearray(path.read_bytes())
    content[len(content) // 3] ^= 0xFF
    path.write_bytes(bytes(content))
    row = rows_of(damaged)["digest"]
    assert (row.status, row.first_failing_frame) == ("fail", 3)


def test_a_rewritten_frame_does_not_match_its_recorded_digest(tmp_path: Path) -> None:
    candidate = sliding(tmp_path)
    cache = candidate.caches["rigid"]
    digests = [cache.frame_digest(k) for k in range(N)]
    (cache.folder / "digests.txt").write_text("\n".join(digests))
    assert rows_of(candidate)["digest"].status == "pass"
    write_container(cache.path(11), cache.read(11) | {"asleep": np.ones(2, dtype=np.uint8)})
    row = rows_of(dataclasses.replace(candidate, caches={"rigid": Cache(cache.folder)}))["digest"]
    assert (row.status, row.first_failing_frame) == ("fail", 11)


def test_a_bake_that_is_too_short_fails_and_a_probe_may_be(tmp_path: Path) -> None:
    candidate = sliding(tmp_path)
    plan = candidate.spec.simulation.model_copy(update={"frames": 48})
    spec = candidate.spec.model_copy(update={"simulation": plan})
    assert rows_of(dataclasses.replace(candidate, spec=spec))["frames"].status == "fail"
    assert rows_of(dataclasses.replace(candidate, spec=spec, stage="probe"))["frames"].status == "pass"


def test_missing_records_are_unverified(tmp_path: Path) -> None:
    gone = ("overflows", "steps", "max_travel_per_step", "driver_work", "max_speed")
    rows = rows_of(sliding(tmp_path, without=[f"record/{n}" for n in gone]))
    assert {n for n, r in rows.items() if r.status == "unverified"} == {
        "overflow",
        "iterations",
        "step_travel",
        "growth",
        "speed",
        "counters",
    }
    static = make_candidate(tmp_path / "s", sliding(tmp_path / "x").spec)
    assert {r.status for r in check(static)} == {"unverified"}


def test_a_repeated_frame_and_a_body_asleep_in_the_air_fail(tmp_path: Path) -> None:
    repeated = scenes.slide(0)
    repeated.frames[6] = dict(repeated.frames[5])
    row = rows_of(repeated.candidate(tmp_path / "a"))["frozen"]
    assert (row.status, row.first_failing_entity, row.first_failing_frame) == ("fail", "box", 6)
    aloft = scenes.flight(0)
    aloft.put("asleep", np.ones(aloft.count), "small")
    for channel in ("velocity", "angular_velocity"):
        aloft.put(channel, np.zeros((aloft.count, 3)), "small")
    aloft.put("position", np.repeat(aloft.series("position", "small")[:1], aloft.count, axis=0), "small")
    row = rows_of(aloft.candidate(tmp_path / "b"))["resting"]
    assert (row.status, row.first_failing_entity, row.first_failing_frame, row.unit) == ("fail", "small", 0, "m")


@pytest.mark.parametrize(("sleep", "status"), [(1, "fail"), (2, "pass")])
def test_a_sleeping_body_moves_only_in_frames_in_which_it_was_awake(tmp_path: Path, sleep: int, status: str) -> None:
    entities = {"floor": ground(), "crate": ball(0.05, motion="dynamic", at=(0, 0, 0.05))}
    film = film_of(world(entities, frames=6))
    film.put("asleep", np.array([1, 1, 1, sleep, 1, 1]), "crate")
    place = np.repeat(film.series("position", "crate")[:1], film.count, axis=0)
    place[3:, 0] += 5e-6
    film.put("position", place, "crate")
    for channel in ("velocity", "angular_velocity"):
        film.put(channel, np.zeros((film.count, 3)), "crate")
    row = rows_of(film.candidate(tmp_path))["resting"]
    assert row.status == status
    if status == "fail":
        assert (row.first_failing_entity, row.first_failing_frame) == ("crate", 3)


def test_a_held_body_may_still_be_asleep_at_the_moment_of_its_release(tmp_path: Path) -> None:
    """The frame of the release shows the state of the hold."""
    entities = {"floor": ground(), "apple": ball(0.05, motion="dynamic", at=(0, 0, 0.4))}
    drivers = {"let_go": ReleaseDriver(entity="apple", time=6 / 24)}
    candidate = simulate(tmp_path, world(entities, drivers=drivers, frames=12))
    assert candidate.caches["rigid"].series("asleep")[6].all()
    assert rows_of(candidate)["resting"].status == "pass"


def test_impossible_counters_and_logs_fail_at_their_frame(tmp_path: Path) -> None:
    film = scenes.bounce(1)
    steps = film.series("record/steps")
    steps[7] -= 1
    film.set_record("steps", steps)
    row = rows_of(film.candidate(tmp_path / "a"))["counters"]
    assert (row.status, row.first_failing_frame) == ("fail", 7)
    film = scenes.bounce(1)
    frame = next(k for k, f in enumerate(film.frames) if len(f["event/time"]))
    film.frames[frame]["event/time"] = film.frames[frame]["event/time"] + 1.0
    row = rows_of(film.candidate(tmp_path / "b"))["events"]
    assert (row.status, row.first_failing_frame) == ("fail", frame)


def test_an_explosion_within_a_frame_fails_though_its_ends_are_slow(tmp_path: Path) -> None:
    film = scenes.slide(1)
    peak = film.series("record/max_speed")
    shown = peak.max() + 9.81 / film.spec.simulation.fps + 0.05
    for factor, status in ((15.0, "pass"), (21.0, "fail")):
        peak[4] = factor * shown
        film.set_record("max_speed", peak)
        row = rows_of(film.candidate(tmp_path / status))["growth"]
        assert (row.status, row.bound) == (status, 20.0)
    assert row.first_failing_frame == 4


def test_channels_without_digests_and_of_changing_shape_are_unverified(tmp_path: Path) -> None:
    candidate = sliding(tmp_path)
    (candidate.caches["rigid"].folder / "digests.txt").unlink()
    assert rows_of(candidate)["digest"].status == "unverified"
    film = scenes.flight(0)
    film.frames[3]["velocity"] = film.frames[3]["velocity"][:-1]
    rows = rows_of(film.candidate(tmp_path / "b"))
    assert (rows["counts"].status, rows["counts"].first_failing_frame) == ("fail", 3)
    assert rows["speed"].status == "unverified"


def test_ground_below_zero_is_as_thick_as_its_base() -> None:
    """A height field stands on its base below its lowest place, wherever that lies."""
    import numpy as np
    from worldagent.worlds.arrays import RigidPose
    from worldagent.worlds.built import Convex

    pose = RigidPose(np.zeros(3), np.array([1.0, 0, 0, 0]))
    for low in (-7.0, 0.0, 3.0):
        assert thickness(Convex("heightfield", (5.0, 5.0, 1.0), pose, np.array([[low, low + 2], [low + 1, low]]))) == 1.0


def _let_go(*, sleep: bool) -> Any:
    """A cube that lies on the ground and is let go between two frames, and a ball that falls on the ground later.

    Without `sleep`, or beside an elastic body, nothing tells a held body from one that is free.
    """
    entities = {
        "floor": ground(),
        "cube": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1)),
        "ball": ball(0.1, motion="dynamic", at=(0, 2, 1.0)),
    }
    drivers = {"latch": ReleaseDriver(entity="cube", time=3.4 / FPS)}
    return film_of(world(entities, frames=N, drivers=drivers, settings=RigidSettings(sleep=sleep)))


@pytest.mark.parametrize("sleep", [True, False])
def test_a_release_between_two_frames_makes_no_contact_begin_unheard(tmp_path: Path, *, sleep: bool) -> None:
    film = _let_go(sleep=sleep)
    pair = sorted(film.index.colliders.index(n) for n in ("floor", "cube"))
    assert pair in film.frames[4]["contact/pair"].tolist()
    assert pair not in film.frames[3]["contact/pair"].tolist()
    assert rows_of(film.candidate(tmp_path / "real"))["events"].status == "pass"
    struck = next(k for k, f in enumerate(film.frames) if len(f["event/pair"]))
    for name in [n for n in film.frames[struck] if n.startswith("event/")]:
        film.frames[struck][name] = film.frames[struck][name][:0]
    row = rows_of(film.candidate(tmp_path / "edited"))["events"]
    assert (row.status, row.first_failing_entity, row.first_failing_frame) == ("fail", "ball", struck)
