"""Cameras between frames, near planes, spinning and zooming pictures, and what is seen through glass or for a moment (R23, R98)."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, MATERIALS, ball, box, entity, ground, make_candidate, world
from worldagent.verifiers.shots.bounds import SCREEN_STEP
from worldagent.verifiers.shots.check import check
from worldagent.verifiers.shots.sight import Sight
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Displacement
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Appearance, Beat, CameraKey, Cylinder, Material, Part, Pose, Shot

N = 49
BEAT = Beat(text="", owner="rigid", subject="ball", frames=(0, N - 1), predicate=Displacement(entity="ball", min=0.05))


def key(position: Any = (0, -4, 0.5), target: Any = (0, 0, 0.5), frame: int = 0, fov: float = 40.0) -> CameraKey:
    return CameraKey(frame=frame, position=position, target=target, fov_deg=fov)


def shot(*keys: CameraKey, frames: tuple[int, int] = (0, N - 1), **more: Any) -> Shot:
    return Shot(frames=frames, keys={f"k{i}": k for i, k in enumerate(keys or (key(),))}, **more)


def scene(tmp_path: Path, shots: dict[str, Shot], walls: dict[str, Any] | None = None, **more: Any) -> Candidate:
    """A ball hovers at (0, 0, 0.5) and jumps 0.1 m to the side at frame 24."""
    path = np.tile([0.0, 0.0, 0.5], (N, 1))
    path[24:, 0] += 0.1
    entities = {"ball": ball(0.2, motion="kinematic", at=path[0]), **(walls or {})}
    glass = Material(density=2500.0, substance="glass", appearance=Appearance(transmission=1.0))
    spec = world(entities, frames=N, beats={"jump": BEAT}, shots=shots, materials={**MATERIALS, "glass": glass})
    return make_candidate(tmp_path, spec, tracks={"ball": (path, IDENTITY), **more})


def rows_of(candidate: Candidate) -> dict[str, Row]:
    return {r.id.removeprefix("shots:"): r for r in check(candidate)}


# ---------------------------------------------------------------- where cameras are


def test_a_camera_that_jumps_over_a_thin_wall_has_passed_through_it(tmp_path: Path) -> None:
    keys = [key((0, -4 - y, 0.5), (0, -y, 0.5), f) for f, y in ((0, 0.0), (10, 0.0), (11, -0.4))]
    wall = {"wall": box(2, 0.001, 2, at=(0, -3.8, 0.5))}
    row = rows_of(scene(tmp_path, {"s": shot(*keys)}, wall))["inside:s"]
    assert (row.status, row.first_failing_entity, row.first_failing_frame) == ("fail", "wall", 11)
    beside = {"wall": box(2, 0.001, 2, at=(1.01, -3.8, 0.5))}
    assert rows_of(scene(tmp_path / "b", {"s": shot(*keys)}, beside))["inside:s"].status == "pass"


def test_a_sheet_that_flies_through_a_camera_at_rest_is_found(tmp_path: Path) -> None:
    path = np.tile([0.0, -5.0, 0.5], (N, 1))
    path[30:, 1] = -3.0
    sheet = {"sheet": box(1, 0.001, 1, motion="kinematic", at=path[0])}
    row = rows_of(scene(tmp_path, {"s": shot()}, sheet, sheet=(path, IDENTITY)))["inside:s"]
    assert (row.status, row.first_failing_entity, row.first_failing_frame) == ("fail", "sheet", 30)


def test_a_body_around_the_camera_at_one_frame_is_found(tmp_path: Path) -> None:
    path = np.tile([0.0, -9.0, 0.5], (N, 1))
    path[37] = (0, -4, 0.5)
    thing = {"thing": ball(0.3, motion="kinematic", at=path[0])}
    row = rows_of(scene(tmp_path, {"s": shot()}, thing, thing=(path, IDENTITY)))["inside:s"]
    assert (row.status, row.first_failing_entity, row.first_failing_frame) == ("fail", "thing", 37)


@pytest.mark.parametrize(("share", "status"), [(0.9, "fail"), (1.1, "pass")])
def test_the_near_plane_may_cut_nothing_open(tmp_path: Path, share: float, status: str) -> None:
    """The corners of the plane at 1 mm lie at 1 mm x sqrt(1 + t^2 (1 + (16 / 9)^2)), t = tan(fov / 2)."""
    tall = math.tan(math.radians(20))
    reach = 1e-3 * math.sqrt(1 + tall**2 * (1 + (16 / 9) ** 2))
    wall = {"wall": box(0.1, 1, 1, at=(0.05 + share * reach, -4, 0.5))}
    assert rows_of(scene(tmp_path, {"s": shot()}, wall))["inside:s"].status == status


def test_a_camera_within_a_room_is_in_no_solid(tmp_path: Path) -> None:
    sides = [Part(shape=box(0.1, 9, 3).parts["p0"].shape, pose=Pose(position=(x, 0, 0))) for x in (-3, 3)]
    room = {"room": entity(*sides, at=(0, 0, 1))}
    assert rows_of(scene(tmp_path, {"s": shot()}, room))["inside:s"].status == "pass"


# ---------------------------------------------------------------- how they move


@pytest.mark.parametrize(("share", "status"), [(0.95, "pass"), (1.05, "fail")])
def test_a_zoom_moves_the_sides_of_the_picture(tmp_path: Path, share: float, status: str) -> None:
    tall = math.tan(math.radians(20)) / (1 + 2 * share * SCREEN_STEP)
    zoomed = key(frame=11, fov=2 * math.degrees(math.atan(tall)))
    row = rows_of(scene(tmp_path, {"s": shot(key(frame=0), key(frame=10), zoomed)}))["motion:s"]
    assert row.status == status
    assert row.measured == pytest.approx(share * SCREEN_STEP, rel=1e-6)


def test_a_camera_that_swings_over_its_aim_spins_the_picture(tmp_path: Path) -> None:
    """The aim stays in the middle and the camera hardly travels, but the picture turns by half a turn."""
    keys = [key((x, 0, 5), (0, 0, 0.5), f) for f, x in ((0, 0.02), (10, 0.02), (11, -0.02))]
    row = rows_of(scene(tmp_path, {"s": shot(*keys)}))["motion:s"]
    assert (row.status, row.first_failing_frame) == ("fail", 11)
    assert row.measured == pytest.approx(1.0, abs=0.01)
    slow = [key((0.02 * math.cos(a), 0.02 * math.sin(a), 5), (0, 0, 0.5), f) for f, a in enumerate(np.linspace(0, 3, N))]
    assert rows_of(scene(tmp_path / "b", {"s": shot(*slow[:30], frames=(0, 29))}))["motion:s"].status == "pass"


# ---------------------------------------------------------------- what is seen


@pytest.mark.parametrize(("clear", "status"), [(True, "pass"), (False, "fail")])
def test_glass_hides_nothing(tmp_path: Path, clear: bool, status: str) -> None:
    pane = box(3, 0.01, 3, at=(0, -1, 0.5)).model_copy(update={"material": "glass" if clear else "wood"})
    rows = rows_of(scene(tmp_path, {"s": shot(covers=["jump"])}, {"pane": pane}))
    assert rows["visible:jump"].status == status


def test_a_plate_flush_with_a_wall_is_not_seen(tmp_path: Path) -> None:
    for y, seen in ((0.0, 0.0), (0.002, 1.0)):
        walls = {"plate": box(1, 0.1, 1, at=(0, 1 - y, 0.5)), "wall": box(4, 0.1, 4, at=(0, 1, 0.5))}
        sight = Sight(scene(tmp_path / str(y), {"s": shot()}, walls))
        # The ball in front hides a part of the plate.
        assert sight.seen("plate", "s", 0).unoccluded == pytest.approx(seen, abs=0.25)


@pytest.mark.parametrize(("reach", "status"), [(5, "pass"), (6, "fail")])
def test_the_moment_at_which_a_beat_comes_true_is_shown(tmp_path: Path, reach: int, status: str) -> None:
    """A screen passes in front: 0.25 s are 6 frames."""
    path = np.tile([9.0, -1.0, 0.5], (N, 1))
    path[24 - reach : 25 + reach, 0] = 0.0
    screen = {"screen": box(1, 0.01, 1, motion="kinematic", at=path[0])}
    row = rows_of(scene(tmp_path, {"s": shot(covers=["jump"])}, screen, screen=(path, IDENTITY)))["visible:jump"]
    assert row.status == status
    if status == "fail":
        assert row.first_failing_frame == 24
        assert "comes true" in row.evidence["explanation"]
        assert row.evidence["explanation"].endswith("behind screen")
        assert "screen stands in the way" in {c.cause for c in row.corrections}


def test_a_moment_that_no_shot_shows_is_not_seen(tmp_path: Path) -> None:
    """Shots before and after it: the subject is clear in both, and the beat comes true between them, at frame 24."""
    shots = {"a": shot(covers=["jump"], frames=(0, 15)), "b": shot(covers=["jump"], frames=(33, N - 1))}
    row = rows_of(scene(tmp_path, shots))["visible:jump"]
    assert row.evidence["moment"]["frame"] == 24
    assert row.evidence["moment"]["unoccluded"] == 0.0
    assert row.status == "fail"


def test_what_a_shot_follows_stays_in_its_picture(tmp_path: Path) -> None:
    for aim, status in ((0.0, "pass"), (6.0, "fail")):
        followed = shot(key(target=(aim, 0, 0.5)), follow="ball")
        assert rows_of(scene(tmp_path / str(aim), {"s": followed}))["framed:s"].status == status


def test_a_subject_that_passes_within_a_few_frames_is_in_the_shot(tmp_path: Path) -> None:
    path = np.tile([-9.0, 0.0, 1.0], (N, 1))
    path[25:28, 0] = (-0.3, 0.0, 0.3)
    path[28:, 0] = 9.0
    bird = {"bird": ball(0.1, motion="kinematic", at=path[0])}
    row = rows_of(scene(tmp_path, {"s": shot(subjects=["bird"])}, bird, bird=(path, IDENTITY)))["framed:s"]
    assert row.status == "pass"
    assert row.evidence["best"]["bird"][0] in (25, 26, 27)


def test_small_and_thin_things_are_measured_between_pixels(tmp_path: Path) -> None:
    """A cable of a third of a pixel, and a plate of the size that counts: both within 2 %."""
    wide, tall = 2 * 4 * math.tan(math.radians(20)) * 16 / 9, 2 * 4 * math.tan(math.radians(20))
    thick = tall / 108 / 3
    cable = entity(Part(shape=Cylinder(radius=thick / 2, height=2.0), pose=Pose(euler=(0, math.pi / 2, 0))), at=(0, 0, 1.013))
    plate = box(0.06, 1e-5, 0.06, at=(0.7, 0, 0.2))
    sight = Sight(scene(tmp_path, {"s": shot()}, {"cable": cable, "plate": plate}))
    assert sight.seen("cable", "s", 0).share == pytest.approx(2.0 * thick / wide / tall, rel=0.03)
    assert sight.seen("plate", "s", 0).share == pytest.approx(0.0036 / wide / tall, rel=0.02)


@pytest.mark.parametrize("shown", [0.23, 0.27])
def test_bars_in_front_are_measured_within_a_hundredth(tmp_path: Path, shown: float) -> None:
    pitch = 0.4 / 7
    slats = [
        Part(shape=box((1 - shown) * pitch / 2, 1e-4, 1).parts["p0"].shape, pose=Pose(position=((k - 3) * pitch / 2, 0, 0)))
        for k in range(7)
    ]
    walls = {"fence": entity(*slats, at=(0, -2, 0.5)), "plate": box(0.4, 1e-5, 0.3, at=(0, -1e-6, 0.5)), "floor": ground()}
    path = np.tile([50.0, 0.0, 0.5], (N, 1))
    candidate = scene(tmp_path, {"s": shot()}, walls, ball=(path, IDENTITY))
    assert Sight(candidate).seen("plate", "s", 0).unoccluded == pytest.approx(shown, rel=0.01)
