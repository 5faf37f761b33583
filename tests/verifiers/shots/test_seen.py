"""Subjects in the light of the film: plates painted by hand, each broken one with its honest twin."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import jsonpatch
import numpy as np
import pytest
from worldagent.testing.worlds.forged_plates import Paint, encoded, forge_plates
from worldagent.testing.worlds.small_gas import fire_spec
from worldagent.testing.worlds.small_worlds import IDENTITY, MATERIALS, ball, box, ground, make_candidate, world
from worldagent.verifiers.categories.registry import judge_of
from worldagent.verifiers.checks import run_checks
from worldagent.verifiers.diagnosis.cite import diagnose
from worldagent.verifiers.shots.bounds import JUST_NOTICEABLE, SEEN_SHARE
from worldagent.verifiers.shots.difference import compared, lab
from worldagent.verifiers.shots.seen import check, seen_ids
from worldagent.verifiers.shots.wanted import wanted
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.plates import MOST_PLATES, Plate, Plates, plate_size, plates_folder
from worldagent.worlds.predicates import Displacement
from worldagent.worlds.predicates.registry import PREDICATES
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, CameraKey, Look, Shot, WorldSpec

N = 25
TIME = np.arange(N) / 24
GREY = (0.3, 0.3, 0.3)


def beat(**more: Any) -> Beat:
    given: dict[str, Any] = {"subject": "ball", "frames": (4, 20), "predicate": Displacement(entity="ball", min=0.3)}
    return Beat(text="", owner="rigid", **{**given, **more})


def rolling(
    folder: Path, beats: dict[str, Beat] | None = None, *, walls: dict[str, Any] | None = None, look: Look | None = None
) -> Candidate:
    """A ball of 10 cm radius rolls along x before a camera at 4 m."""
    entities = {"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(0, 0, 0.1)), **(walls or {})}
    camera = CameraKey(frame=0, position=(0.5, -4, 1), target=(0.5, 0, 0.1), fov_deg=40)
    shots = {"only": Shot(frames=(0, N - 1), keys={"k": camera})}
    materials = {**MATERIALS, "red": MATERIALS["wood"]}
    spec = world(entities, frames=N, beats=beats or {"roll": beat()}, shots=shots, materials=materials)
    painted = spec.entities["ball"].model_copy(update={"material": "red"})
    spec = spec.model_copy(update={"look": look or Look(), "entities": {**spec.entities, "ball": painted}})
    track = (np.stack([TIME, 0 * TIME, 0 * TIME + 0.1], axis=1), IDENTITY)
    return make_candidate(folder, spec, tracks={"ball": track})


def judged(candidate: Candidate, paint: Paint, seed: int = 1) -> Row:
    forge_plates(candidate, paint, np.random.default_rng(seed))
    (row,) = check(candidate)
    return row


def patched(candidate: Candidate, row: Row) -> WorldSpec:
    """The specification after the first patch that the row suggests."""
    data = jsonpatch.apply_patch(candidate.spec.model_dump(mode="json"), list(row.corrections[0].patch))
    return WorldSpec.model_validate(data)


def cause(row: Row) -> str:
    return str(row.evidence["cause"])


def test_a_red_ball_before_a_grey_wall_is_seen(tmp_path: Path) -> None:
    row = judged(rolling(tmp_path), Paint(noise=2.0))
    assert (row.id, row.status, row.group, row.mandatory) == ("shots:seen:roll", "pass", "observational", True)
    assert row.measured is not None
    assert row.measured > 0.98
    assert row.bound == SEEN_SHARE
    assert row.artifact == "cache/plates"


def test_nothing_is_seen_in_a_black_film_and_the_meters_exposure_mends_it(tmp_path: Path) -> None:
    candidate = rolling(tmp_path, look=Look(exposure=-10))
    row = judged(candidate, Paint(stops=-10))
    assert row.status == "fail"
    assert cause(row).startswith("too dark")
    assert "mean luminance 0.000" in row.evidence["explanation"]
    assert row.corrections[0].group == "look"
    assert patched(candidate, row).look.exposure == 0


def test_a_dim_film_shows_its_subject(tmp_path: Path) -> None:
    assert judged(rolling(tmp_path, look=Look(exposure=-2)), Paint(stops=-2)).status == "pass"


def test_nothing_is_seen_in_a_white_film(tmp_path: Path) -> None:
    candidate = rolling(tmp_path, look=Look(exposure=8))
    row = judged(candidate, Paint(stops=8))
    assert row.status == "fail"
    assert cause(row).startswith("too bright")
    assert patched(candidate, row).look.exposure == 0
    assert judged(candidate, Paint(stops=0.5)).status == "pass"


def test_a_dark_film_at_the_meters_exposure_is_lifted_by_its_stops(tmp_path: Path) -> None:
    candidate = rolling(tmp_path)
    row = judged(candidate, Paint(stops=-8))
    assert row.status == "fail"
    assert 7 <= patched(candidate, row).look.exposure <= 10


def test_a_subject_in_the_dark_of_a_light_picture_gets_a_light(tmp_path: Path) -> None:
    candidate = rolling(tmp_path)
    made = forge_plates(candidate, Paint(), np.random.default_rng(1))
    folder, view = plates_folder(candidate), made.views[0]
    plate = made.read(folder, view)
    for picture in plate:
        picture[:] = 200
        picture[:, 60:130, 60:260] = 0
    dataclasses.replace(made, views=(), digests=()).added(folder, view, plate)
    (row,) = check(candidate)
    assert row.status == "fail"
    assert cause(row).startswith("too dark")
    (light,) = patched(candidate, row).look.lights.values()
    assert light.power > 0
    assert np.dot(np.array(light.position) - (0.5, -4, 1), (0.0, -4, 0.9)) > 0, "it stands behind the camera"


def test_a_subject_painted_like_what_is_behind_it_is_not_seen(tmp_path: Path) -> None:
    candidate = rolling(tmp_path)
    row = judged(candidate, Paint(subject=(0.301, 0.3, 0.3), noise=1.0))
    assert row.status == "fail"
    assert "the colour of what is behind it" in cause(row)
    found = patched(candidate, row).materials["red"].appearance.color
    apart = lab(np.round(encoded(np.array([found, GREY]))).astype(np.uint8))
    assert np.linalg.norm(apart[0] - apart[1]) > 10 * JUST_NOTICEABLE
    assert judged(candidate, Paint(subject=(0.4, 0.3, 0.3), noise=1.0)).status == "pass"


def test_what_glows_is_lost_in_the_light_of_the_scene_and_is_given_a_night(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A lamp or another colour would hide a flame the more."""
    candidate = rolling(tmp_path)
    monkeypatch.setattr(type(judge_of(candidate.spec, "ball")), "glows", lambda self, spec, entity: True)
    row = judged(candidate, Paint(subject=(0.301, 0.3, 0.3), noise=1.0))
    assert row.status == "fail"
    assert patched(candidate, row).look.sky == "night"
    fire = WorldSpec.model_validate({**fire_spec(), "prompt": "a fire"})
    name = next(n for n, e in fire.entities.items() if e.physics.category == "gas")
    assert judge_of(fire, name).glows(fire, name)


def test_what_is_gone_by_its_outcome_is_looked_for_before_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The ball rolls behind a wall before the beat comes true."""
    rolls = {"roll": beat(frames=(1, 24), predicate=Displacement(entity="ball", min=0.9))}
    candidate = rolling(tmp_path, rolls, walls={"wall": box(3.0, 0.1, 1.0, at=(1.85, -0.5, 0.5))})
    assert "roll" not in wanted(candidate).of
    monkeypatch.setitem(PREDICATES, "displacement", dataclasses.replace(PREDICATES["displacement"], ends=True))
    assert 1 <= wanted(candidate).of["roll"].frame < 10
    assert {k for k, info in PREDICATES.items() if info.ends} == {"displacement", "goes_out", "gas_clears"}


def test_a_colour_that_others_share_is_named_and_not_changed(tmp_path: Path) -> None:
    candidate = rolling(tmp_path, walls={"wall": box(1, 0.1, 1, at=(5, 3, 0.5)).model_copy(update={"material": "red"})})
    row = judged(candidate, Paint(subject=GREY))
    assert row.status == "fail"
    assert not row.corrections[0].patch
    assert row.corrections[0].pointers == ("/materials/red/appearance/color",)


def test_noise_is_no_subject(tmp_path: Path) -> None:
    row = judged(rolling(tmp_path), Paint(subject=GREY, noise=25.0))
    assert row.status == "fail"
    assert row.measured is not None
    assert row.measured < 0.02


def test_a_subject_lost_in_noise_is_told_so_and_seen_in_less(tmp_path: Path) -> None:
    candidate = rolling(tmp_path)
    row = judged(candidate, Paint(subject=(0.33, 0.33, 0.33), noise=25.0))
    assert row.status == "fail"
    assert "times the noise" in cause(row)
    assert patched(candidate, row).look.lights
    assert judged(candidate, Paint(subject=(0.33, 0.33, 0.33), noise=0.5)).status == "pass"


@pytest.mark.parametrize(("shows", "status"), [(0.9 * SEEN_SHARE, "fail"), (1.15 * SEEN_SHARE, "pass")])
def test_a_quarter_of_a_subject_must_stand_out(tmp_path: Path, shows: float, status: str) -> None:
    assert judged(rolling(tmp_path), Paint(shows=shows, noise=0.5)).status == status


def test_a_subject_behind_another_thing_is_named_with_it(tmp_path: Path) -> None:
    row = judged(rolling(tmp_path, walls={"wall": box(6, 0.1, 2, at=(0, -1, 1.0))}), Paint())
    assert row.status == "fail"
    assert cause(row) == "hidden behind wall"
    assert row.corrections[0].group == "shots"
    assert patched(rolling(tmp_path / "again"), row).shots["only"].keys["k"].position != (0.5, -4, 1)
    low = judged(rolling(tmp_path / "low", walls={"wall": box(6, 0.1, 0.1, at=(0, -1, 0.05))}), Paint())
    assert low.status == "pass"


def test_a_subject_of_which_next_to_nothing_looks_out_is_hidden(tmp_path: Path) -> None:
    """The wall leaves the very top of the ball free."""
    candidate = rolling(tmp_path, walls={"wall": box(6, 0.1, 0.395, at=(0, -1, 0.1975))})
    row = judged(candidate, Paint())
    assert row.status == "fail"
    assert cause(row) == "hidden behind wall"
    assert row.corrections[0].group == "shots"


def test_a_speck_is_too_small(tmp_path: Path) -> None:
    candidate = rolling(tmp_path)
    far = CameraKey(frame=0, position=(0.5, -60, 1), target=(0.5, 0, 0.1), fov_deg=40)
    shots = {"only": Shot(frames=(0, N - 1), keys={"k": far})}
    row = judged(dataclasses.replace(candidate, spec=candidate.spec.model_copy(update={"shots": shots})), Paint())
    assert row.status == "fail"
    assert cause(row) == "too small"


def test_without_plates_nothing_is_known(tmp_path: Path) -> None:
    candidate = rolling(tmp_path)
    (row,) = check(candidate)
    assert row.status == "unverified"
    assert "run_checks(scope='full')" in row.evidence["explanation"]
    assert row.mandatory


@pytest.mark.parametrize("change", [{"exposure": 1.0}, {"sky": "studio"}, {"sun_azimuth_deg": 10.0}])
def test_plates_of_another_look_are_stale(tmp_path: Path, change: dict[str, Any]) -> None:
    candidate = rolling(tmp_path)
    assert judged(candidate, Paint()).status == "pass"
    look = candidate.spec.look.model_copy(update=change)
    (row,) = check(dataclasses.replace(candidate, spec=candidate.spec.model_copy(update={"look": look})))
    assert row.status == "unverified"
    assert "stale" in row.evidence["explanation"]


def test_more_samples_of_the_film_leave_its_plates_as_they_are(tmp_path: Path) -> None:
    candidate = rolling(tmp_path)
    assert judged(candidate, Paint()).status == "pass"
    look = candidate.spec.look.model_copy(update={"samples": 64, "width": 1280, "height": 720})
    (row,) = check(dataclasses.replace(candidate, spec=candidate.spec.model_copy(update={"look": look})))
    assert row.status == "pass"


def test_plates_of_another_bake_are_stale(tmp_path: Path) -> None:
    candidate = rolling(tmp_path)
    assert judged(candidate, Paint()).status == "pass"
    (row,) = check(dataclasses.replace(candidate, digest="another"))
    assert row.status == "unverified"


def test_an_altered_plate_is_no_evidence(tmp_path: Path) -> None:
    candidate = rolling(tmp_path)
    made = forge_plates(candidate, Paint(subject=GREY), np.random.default_rng(1))
    folder = plates_folder(candidate)
    bright = Plate(np.full_like(made.read(folder, made.views[0]).shown, 255), made.read(folder, made.views[0]).bare)
    dataclasses.replace(made, views=(), digests=()).added(folder, made.views[0], bright)
    made.write(folder)
    (row,) = check(candidate)
    assert row.status == "unverified"
    assert "altered" in row.evidence["explanation"]


def test_a_damaged_index_is_no_evidence(tmp_path: Path) -> None:
    candidate = rolling(tmp_path)
    forge_plates(candidate, Paint(), np.random.default_rng(1))
    (plates_folder(candidate) / "index.json").write_text("{")
    (row,) = check(candidate)
    assert row.status == "unverified"


def test_who_was_not_looked_at_is_unverified_and_told_why(tmp_path: Path) -> None:
    candidate = rolling(tmp_path)
    late = {"ball": "the time for plates was over"}
    forge_plates(
        candidate, Paint(), np.random.default_rng(1), alter=lambda p: dataclasses.replace(p, views=(), digests=(), left=late)
    )
    (row,) = check(candidate)
    assert row.status == "unverified"
    assert "the time for plates was over" in row.evidence["explanation"]
    assert row.corrections[0].action.startswith("call run_checks(scope='full')")
    (only,) = diagnose(row, candidate.spec).corrections
    assert only.group == "look"  # more frames would show no more
    assert only.action.startswith("call run_checks(scope='full')")


def test_the_view_is_where_the_subject_is_largest_while_its_beat_comes_true(tmp_path: Path) -> None:
    candidate = rolling(tmp_path)
    view = wanted(candidate).of["roll"]
    assert (view.subject, view.shot) == ("ball", "only")
    assert 2 <= view.frame <= 14, "within a quarter of a second of frame 8, where it has moved by 0.3 m"


def test_beats_of_one_view_share_its_plate(tmp_path: Path) -> None:
    candidate = rolling(tmp_path, {"roll": beat(), "again": beat()})
    plan = wanted(candidate)
    assert len(plan.views) == 1
    assert plan.of["roll"] == plan.of["again"]


def test_beats_that_are_optional_or_that_no_camera_is_asked_to_see_have_no_row(tmp_path: Path) -> None:
    candidate = rolling(tmp_path, {"roll": beat(), "extra": beat(mandatory=False), "unseen": beat(observe=False)})
    forge_plates(candidate, Paint(), np.random.default_rng(1))
    assert [r.id for r in check(candidate)] == ["shots:seen:roll"]
    assert seen_ids(candidate.spec) == {"shots:seen:roll"}


def test_a_world_has_so_many_plates_and_tells_what_is_left_out(tmp_path: Path) -> None:
    beats = {f"b{k:02d}": beat(predicate=Displacement(entity="ball", min=0.01 + 0.033 * k), frames=(0, N - 1)) for k in range(30)}
    candidate = rolling(tmp_path, beats)
    plan = wanted(candidate)
    distinct = len(set(plan.of.values()))
    assert len(plan.views) == min(MOST_PLATES, distinct)
    forge_plates(candidate, Paint(), np.random.default_rng(1))
    rows = {r.subject[0]: r for r in check(candidate)}
    assert rows.keys() == beats.keys()
    assert {n for n, r in rows.items() if not r.mandatory} == set(plan.left)
    assert {r.status for n, r in rows.items() if n not in plan.left} == {"pass"}


def test_checks_judge_by_plates_only_where_some_were_made_or_asked_for(tmp_path: Path) -> None:
    candidate = rolling(tmp_path)
    ids = seen_ids(candidate.spec)
    assert not ids & {r.id for r in run_checks(candidate, only=["shots"])}
    asked = {r.id: r for r in run_checks(candidate, only=["shots"], plates=True)}
    assert asked["shots:seen:roll"].status == "unverified"
    forge_plates(candidate, Paint(), np.random.default_rng(1))
    assert ids <= {r.id for r in run_checks(candidate, only=["shots"])}
    assert not ids & {r.id for r in run_checks(candidate, only=["shots"], plates=False)}


def test_noise_is_estimated_from_the_seeds(tmp_path: Path) -> None:
    """Law: the mean of two has half the variance, and the difference of two means that of both together."""
    rng = np.random.default_rng(7)
    pictures = np.clip(np.round(128 + rng.normal(0, 6, (4, 90, 160, 3))), 0, 255).astype(np.uint8)
    found = compared(Plate(pictures[:2], pictures[2:]))
    told, true = float(np.sqrt((found.noise**2).mean())), float(np.sqrt((found.delta**2).mean()))
    assert told == pytest.approx(true, rel=0.03)
    assert float(found.differs.mean()) < 0.003


def test_colours_in_cielab_are_those_printed() -> None:
    """Law: sRGB primaries in CIELAB under D65, e.g. Lindbloom."""
    primaries = np.array([[255, 255, 255], [255, 0, 0], [0, 255, 0], [0, 0, 255], [0, 0, 0]], dtype=np.uint8)
    printed = [(100, 0, 0), (53.24, 80.09, 67.20), (87.73, -86.18, 83.18), (32.30, 79.19, -107.86), (0, 0, 0)]
    assert np.allclose(lab(primaries), printed, atol=0.06)


def test_plates_have_the_aspect_of_the_film() -> None:
    assert plate_size(Look()) == (320, 180)
    wide, tall = plate_size(Look(width=360, height=640))
    assert tall > wide
    assert wide * tall == pytest.approx(320 * 180, rel=0.01)


def test_an_index_of_too_many_plates_is_refused(tmp_path: Path) -> None:
    candidate = rolling(tmp_path)
    made = forge_plates(
        candidate,
        Paint(),
        np.random.default_rng(1),
        alter=lambda p: dataclasses.replace(p, views=p.views * 25, digests=p.digests * 25),
    )
    assert isinstance(made, Plates)
    (row,) = check(candidate)
    assert row.status == "unverified"
