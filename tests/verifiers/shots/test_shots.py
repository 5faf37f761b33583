"""Shot checks: tiling, coverage, visibility by ray casting, camera sanity, and views that the server suggests."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import jsonpatch
import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, box, ground, make_candidate, world
from worldagent.verifiers.register.assemble import approximations
from worldagent.verifiers.shots.check import check
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Count, Displacement
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, CameraKey, Shot, WorldSpec

N = 25
TIME = np.arange(N) / 24


def key(position: Any = (0.5, -4, 1), target: Any = (0.5, 0, 0.1), frame: int = 0, fov: float = 40.0) -> CameraKey:
    return CameraKey(frame=frame, position=position, target=target, fov_deg=fov)


def shot(frames: tuple[int, int] = (0, N - 1), *keys: CameraKey, **more: Any) -> Shot:
    return Shot(frames=frames, keys={f"k{i}": k for i, k in enumerate(keys or (key(),))}, **more)


BEAT = Beat(text="", owner="rigid", subject="ball", frames=(4, 20), predicate=Displacement(entity="ball", min=0.3))


def rolling(
    tmp_path: Path, shots: dict[str, Shot], *, walls: dict[str, Any] | None = None, speed: float = 1.0, **more: Any
) -> Candidate:
    """A ball of 10 cm radius rolls along x at y = 0."""
    entities = {"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(0, 0, 0.1)), **(walls or {})}
    spec = world(entities, frames=N, beats=more.pop("beats", {"roll": BEAT}), shots=shots)
    track = (np.stack([speed * TIME, 0 * TIME, 0 * TIME + 0.1], axis=1), IDENTITY)
    return make_candidate(tmp_path, spec, tracks=more.pop("tracks", {"ball": track}), **more)


def rows_of(candidate: Candidate) -> dict[str, Row]:
    return {r.id.removeprefix("shots:"): r for r in check(candidate)}


def patched(candidate: Candidate, row: Row, index: int = 0) -> Candidate:
    """The candidate after the first patch that the row suggests."""
    data = jsonpatch.apply_patch(candidate.spec.model_dump(mode="json"), list(row.corrections[index].patch))
    return dataclasses.replace(candidate, spec=WorldSpec.model_validate(data))


def test_a_plain_shot_of_a_rolling_ball_passes(tmp_path: Path) -> None:
    rows = rows_of(rolling(tmp_path, {"s": shot(covers=["roll"])}))
    assert {n: r.status for n, r in rows.items()} == dict.fromkeys(
        ("tiling", "cover:roll", "visible:roll", "framed:s", "inside:s", "motion:s"), "pass"
    )
    row = rows["visible:roll"]
    assert (row.group, row.measured, row.evidence["seen_share"]) == ("observational", 1.0, 1.0)
    # A disc of 0.1 m radius, 4.1 m away, in a picture 2 * 4.1 * tan 20 deg = 2.98 m high and 16 / 9 as wide.
    assert row.evidence["best_share"] == pytest.approx(np.pi * 0.01 / (2.98**2 * 16 / 9), rel=0.1)


# ---------------------------------------------------------------- tiling


@pytest.mark.parametrize(
    ("frames", "first_bad", "patch"),
    [
        ([(0, 9), (12, 24)], 10, {"op": "replace", "path": "/shots/s1/frames", "value": [10, 24]}),
        ([(0, 12), (10, 24)], 10, {"op": "replace", "path": "/shots/s1/frames", "value": [13, 24]}),
        ([(0, 9), (10, 20)], 21, {"op": "replace", "path": "/shots/s1/frames", "value": [10, 24]}),
        ([(0, 9), (10, 30)], 25, {"op": "replace", "path": "/shots/s1/frames", "value": [10, 24]}),
        ([(3, 24)], 0, {"op": "replace", "path": "/shots/s0/frames", "value": [0, 24]}),
    ],
)
def test_gaps_and_overlaps_are_found_and_mended(
    tmp_path: Path, frames: list[tuple[int, int]], first_bad: int, patch: dict[str, Any]
) -> None:
    candidate = rolling(tmp_path, {f"s{i}": shot(f) for i, f in enumerate(frames)})
    row = rows_of(candidate)["tiling"]
    assert (row.status, row.first_failing_frame) == ("fail", first_bad)
    assert row.corrections[0].edit_class == "shot"
    assert row.corrections[0].patch[0] == patch
    assert rows_of(patched(candidate, row))["tiling"].status == "pass"


def test_a_plan_without_shots_fails(tmp_path: Path) -> None:
    rows = rows_of(rolling(tmp_path, {}))
    assert (rows["tiling"].status, rows["cover:roll"].status, rows["visible:roll"].status) == ("fail", "fail", "fail")


def test_a_shot_that_claims_a_beat_must_run_while_it_happens(tmp_path: Path) -> None:
    rows = rows_of(rolling(tmp_path, {"a": shot((0, 3), covers=["roll"]), "b": shot((4, 24))}))
    assert (rows["cover:roll"].status, rows["cover:roll"].measured) == ("fail", 0.0)


# ---------------------------------------------------------------- visibility


def test_a_camera_that_looks_away_fails_and_the_suggested_view_passes(tmp_path: Path) -> None:
    candidate = rolling(tmp_path, {"s": shot((0, 24), key(target=(0.5, -10, 1)), covers=["roll"])})
    row = rows_of(candidate)["visible:roll"]
    assert (row.status, row.measured, row.first_failing_entity, row.first_failing_frame) == ("fail", 0.0, "ball", 4)
    index = next(i for i, c in enumerate(row.corrections) if any("/keys/" in p["path"] for p in c.patch))
    assert rows_of(patched(candidate, row, index))["visible:roll"].status == "pass"


def test_a_hidden_subject_fails_names_what_hides_it_and_gets_a_clear_view(tmp_path: Path) -> None:
    walls = {"wall": box(4.0, 0.1, 1.5, at=(0.5, -1, 0.75))}
    candidate = rolling(tmp_path, {"s": shot(covers=["roll"])}, walls=walls)
    row = rows_of(candidate)["visible:roll"]
    assert row.status == "fail"
    assert "wall" in row.evidence["explanation"]
    index = next(i for i, c in enumerate(row.corrections) if "wall stands in the way" in c.cause)
    assert rows_of(patched(candidate, row, index))["visible:roll"].evidence["best_unoccluded"] > 0.9


def test_a_count_tells_which_of_its_members_are_not_seen_when_it_comes_true(tmp_path: Path) -> None:
    """The row is about the subject; the others are told of, and nothing of them changes the verdict."""
    others = {
        "seen": ball(0.1, motion="dynamic", at=(1.2, 0, 0.1)),
        "hidden": ball(0.1, motion="dynamic", at=(0.0, 2, 0.1)),
        "away": ball(0.1, motion="dynamic", at=(9, 0, 0.1)),
        "wall": box(0.8, 0.1, 1.0, at=(0.1, 1.5, 0.5)),
    }
    moved = Count(entities=["ball", "seen", "hidden", "away"], predicate=Displacement(entity="each", min=0.3), min=1)
    beats = {"roll": Beat(text="", owner="rigid", subject="ball", frames=(4, 20), predicate=moved)}
    row = rows_of(rolling(tmp_path, {"s": shot(covers=["roll"])}, walls=others, beats=beats))["visible:roll"]
    assert row.status == "pass"
    assert row.evidence["unseen_members"] == {"hidden": "behind wall", "away": "outside the picture"}
    assert "hidden (behind wall)" in row.evidence["explanation"]


def test_half_hidden_is_measured(tmp_path: Path) -> None:
    """A wall edge through the ball's middle leaves half of it."""
    still = {"ball": (np.array([0, 0, 0.1]), IDENTITY)}
    walls = {"wall": box(2.0, 0.1, 1.0, at=(1.0, -1, 0.5))}
    view = shot((0, 24), key((0, -4, 0.1), (0, 0, 0.1), fov=20), covers=["roll"])
    row = rows_of(rolling(tmp_path, {"s": view}, walls=walls, tracks=still))["visible:roll"]
    assert row.evidence["best_unoccluded"] == pytest.approx(0.5, abs=0.05)
    assert row.status == "pass"


def test_a_speck_is_too_small(tmp_path: Path) -> None:
    far = shot((0, 24), key((0.5, -80, 1)), covers=["roll"])
    row = rows_of(rolling(tmp_path, {"s": far}))["visible:roll"]
    assert (row.status, row.bound) == ("fail", 0.0004)
    assert row.measured is not None
    assert row.measured < 0.0004


def test_a_subject_that_leaves_the_picture_is_followed(tmp_path: Path) -> None:
    close = shot((0, 24), key((0, -1.2, 0.3), (0, 0, 0.1), fov=20), covers=["roll"])
    beats = {"roll": BEAT.model_copy(update={"frames": (2, 24)})}
    candidate = rolling(tmp_path, {"s": close}, speed=4.0, beats=beats)
    row = rows_of(candidate)["visible:roll"]
    assert row.status == "fail"
    index = next(i for i, c in enumerate(row.corrections) if c.patch and c.patch[0]["path"] == "/shots/s/follow")
    after = rows_of(patched(candidate, row, index))["visible:roll"]
    assert after.evidence["seen_share"] > row.evidence["seen_share"]


def test_named_subjects_must_be_in_the_shot(tmp_path: Path) -> None:
    walls = {"tower": box(0.2, 0.2, 2, at=(0, 9, 1)), "behind": box(0.2, 0.2, 2, at=(0, -9, 1))}
    rows = rows_of(rolling(tmp_path, {"s": shot(subjects=["tower", "behind"])}, walls=walls))
    assert (rows["framed:s"].status, rows["framed:s"].first_failing_entity) == ("fail", "behind")


def test_unobserved_beats_need_no_camera_and_are_printed(tmp_path: Path) -> None:
    beats = {"roll": BEAT.model_copy(update={"observe": False}), "far": BEAT}
    candidate = rolling(tmp_path, {"s": shot()}, beats=beats)
    rows = rows_of(candidate)
    assert not {"visible:roll", "cover:roll"} & set(rows)
    said = "beat 'roll' is not seen by any camera (observe: false): displacement(min=0.3, entity=ball"
    assert rows["observed:story"].status == "pass"
    assert said in rows["observed:story"].evidence["explanation"]
    assert any(a["what"].startswith(said) for a in approximations(candidate))
    assert "observed:story" not in rows_of(rolling(tmp_path / "b", {"s": shot()}))


def test_a_story_of_which_no_camera_sees_anything_that_must_happen_fails(tmp_path: Path) -> None:
    beats = {"roll": BEAT.model_copy(update={"observe": False}), "more": BEAT.model_copy(update={"mandatory": False})}
    candidate = rolling(tmp_path, {"s": shot()}, beats=beats)
    row = rows_of(candidate)["observed:story"]
    assert (row.status, row.mandatory, row.measured, row.first_failing_entity) == ("fail", True, 0.0, "ball")
    assert "observed:story" not in rows_of(patched(candidate, row))


@pytest.mark.parametrize(("ends", "status"), [(4, "fail"), (5, "pass")])
def test_a_shot_counts_at_the_frames_of_the_outcome(tmp_path: Path, ends: int, status: str) -> None:
    """A quarter of a second about frame 11 counts, at which it has gone 0.45 m; its interval began long before."""
    roll = {"roll": BEAT.model_copy(update={"frames": (0, 20), "predicate": Displacement(entity="ball", min=0.45)})}
    shots = {"a": shot((0, ends), covers=["roll"]), "b": shot((ends + 1, N - 1))}
    row = rows_of(rolling(tmp_path, shots, beats=roll))["cover:roll"]
    assert (row.status, row.frames) == (status, (5, 17))
    if status == "fail":
        assert "roll comes true at frame 11" in row.evidence["explanation"]
        assert row.first_failing_frame == 11


@pytest.mark.parametrize(("turns", "status"), [(18, "pass"), (19, "fail")])
def test_what_comes_true_at_the_first_frame_of_its_interval_is_seen_there_too(tmp_path: Path, turns: int, status: str) -> None:
    """A camera that shows the subject only long after says nothing of the outcome, at frame 12."""
    roll = {"roll": BEAT.model_copy(update={"frames": (12, 24), "predicate": Displacement(entity="ball", min=0.5)})}
    shots = {"a": shot((0, turns - 1), key(target=(0.5, -10, 1))), "b": shot((turns, N - 1))}
    row = rows_of(rolling(tmp_path, shots, beats=roll))["visible:roll"]
    assert row.status == status
    assert row.evidence["moment"]["frame"] == 12


# ---------------------------------------------------------------- camera


def test_a_camera_inside_a_body_fails(tmp_path: Path) -> None:
    walls = {"wall": box(1, 1, 2, at=(0.5, -4, 1))}
    rows = rows_of(rolling(tmp_path, {"s": shot()}, walls=walls))
    assert (rows["inside:s"].status, rows["inside:s"].first_failing_entity, rows["inside:s"].first_failing_frame) == (
        "fail",
        "wall",
        0,
    )


def test_a_camera_that_jumps_fails_at_the_jump(tmp_path: Path) -> None:
    jump = shot((0, 24), key(frame=0), key(frame=10), key((4, 0, 1), frame=11))
    row = rows_of(rolling(tmp_path, {"s": jump}))["motion:s"]
    assert (row.status, row.first_failing_frame) == ("fail", 11)
    smooth = shot((0, 24), key(frame=0), key((4, 0, 1), frame=24))
    assert rows_of(rolling(tmp_path / "b", {"s": smooth}))["motion:s"].status == "pass"


def test_a_subject_that_rushes_through_the_picture_fails(tmp_path: Path) -> None:
    """The picture is 5.2 m wide where the ball passes: 20 % per frame are 25 m/s at 24 fps."""
    for name, speed, status in (("slow", 20.0, "pass"), ("fast", 40.0, "fail")):
        track = (np.stack([speed * (TIME - 0.5), 0 * TIME, 0 * TIME + 0.1], axis=1), IDENTITY)
        row = rows_of(rolling(tmp_path / name, {"s": shot(covers=["roll"])}, tracks={"ball": track}))["motion:s"]
        assert row.status == status
        assert row.measured == pytest.approx(speed / 24 / (2 * 4.1 * np.tan(np.radians(20)) * 16 / 9), rel=0.05)
    assert row.first_failing_entity == "ball"


def test_a_continued_shot_must_continue(tmp_path: Path) -> None:
    for name, transition, status in (("cut", "cut", "pass"), ("on", "continue", "fail")):
        plan = {"a": shot((0, 9)), "b": shot((10, 24), key((4, 0, 1)), transition=transition)}
        row = rows_of(rolling(tmp_path / name, plan))["motion:b"]
        assert row.status == status
    assert row.first_failing_frame == 10


# ---------------------------------------------------------------- evidence


def test_before_a_simulation_only_the_plan_is_judged(tmp_path: Path) -> None:
    candidate = rolling(tmp_path, {"s": shot(covers=["roll"])})
    static = Candidate(candidate.folder, candidate.spec, candidate.built, "static")
    rows = rows_of(static)
    assert (rows["tiling"].status, rows["cover:roll"].status, rows["visible:roll"].status) == ("pass", "pass", "unverified")
    assert "ball fills" in rows["visible:roll"].evidence["explanation"]


def test_a_probe_that_ends_before_the_beat_does_leaves_it_unverified(tmp_path: Path) -> None:
    beats = {"roll": BEAT.model_copy(update={"frames": (4, 40)})}
    candidate = rolling(tmp_path, {"s": shot((0, 47), covers=["roll"])}, beats=beats)
    plan = candidate.spec.simulation.model_copy(update={"frames": 48})
    spec = candidate.spec.model_copy(update={"simulation": plan})
    rows = rows_of(dataclasses.replace(candidate, spec=spec, stage="probe"))
    assert (rows["tiling"].status, rows["visible:roll"].status, rows["inside:s"].status) == ("pass", "unverified", "unverified")


def test_poses_that_are_not_finite_are_never_a_pass(tmp_path: Path) -> None:
    bad = np.stack([TIME, 0 * TIME, 0 * TIME + 0.1], axis=1)
    bad[5:] = np.nan
    assert (
        rows_of(rolling(tmp_path, {"s": shot(covers=["roll"])}, tracks={"ball": (bad, IDENTITY)}))["visible:roll"].status
        != "pass"
    )


def test_forty_entities_and_ten_beats(tmp_path: Path) -> None:
    walls = {f"b{i}": box(0.1, 0.1, 0.1, at=(0.2 * (i % 8), 0.5 + 0.2 * (i // 8), 0.05)) for i in range(38)}
    beats = {f"r{i}": BEAT.model_copy(update={"frames": (i, 14 + i)}) for i in range(10)}
    candidate = rolling(tmp_path, {"s": shot(covers=list(beats))}, walls=walls, beats=beats)
    rows = check(candidate)
    assert len(rows) >= len(beats)
    assert [r.id for r in rows if r.status != "pass"] == []


def test_a_key_that_looks_at_an_entity_aims_at_its_centre_at_that_frame(tmp_path: Path) -> None:
    """The same rows as for the point; and a key needs one aim."""
    last = CameraKey(frame=N - 1, position=(0.5, -4, 1), look_at="ball")
    looking = shot((0, N - 1), CameraKey(frame=0, position=(0.5, -4, 1), look_at="ball"), last, covers=["roll"])
    pointing = shot((0, N - 1), key(target=(0, 0, 0.1)), key(target=(1, 0, 0.1), frame=N - 1), covers=["roll"])
    found, wanted = (rows_of(rolling(tmp_path / name, {"s": plan})) for name, plan in (("a", looking), ("b", pointing)))
    assert {n: (r.status, r.measured) for n, r in found.items()} == {n: (r.status, r.measured) for n, r in wanted.items()}
    for aim in ({}, {"target": (0, 0, 0), "look_at": "ball"}):
        with pytest.raises(ValueError, match=r"give target .* or look_at"):
            CameraKey(frame=0, position=(0, -4, 1), **aim)


def test_a_shot_that_looks_past_its_subject_is_mended_whatever_it_looked_at(tmp_path: Path) -> None:
    wall = {"wall": box(0.2, 0.2, 0.2, at=(6, 0, 0.1), motion="static")}
    keys = [CameraKey(frame=f, position=(0.5, -4, 1), look_at="wall") for f in (0, N - 1)]
    candidate = rolling(tmp_path, {"s": shot((0, N - 1), *keys, covers=["roll"])}, walls=wall)
    row = rows_of(candidate)["visible:roll"]
    assert row.status == "fail"
    index = next(k for k, c in enumerate(row.corrections) if any("/keys/" in o["path"] for o in c.patch))
    mended = patched(candidate, row, index)
    assert mended.spec.shots["s"].keys != candidate.spec.shots["s"].keys
    turning = [
        CameraKey(frame=0, position=(0.5, -4, 1), look_at="wall"),
        CameraKey(frame=3, position=(0.5, -4, 1), look_at="ball"),
    ]
    swung = rolling(tmp_path / "swung", {"s": shot((0, N - 1), *turning, covers=["roll"])}, walls=wall)
    jump = rows_of(swung)["motion:s"]
    assert jump.status == "fail"
    still = rows_of(patched(swung, jump))
    assert (still["motion:s"].status, still["visible:roll"].status) == ("pass", "pass")
