"""Pen: the definition of R141-R144 on meshes with known depths; what the paper leaves open is own choice (`CHOICES`)."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.bench import pen as benchmark
from worldagent.bench.clearance import box_mesh
from worldagent.bench.contact_shapes import sphere
from worldagent.bench.evaluation.metrics import pen
from worldagent.bench.evaluation.metrics.evaluated import EvaluatedWorld, baked_candidate, pen_of_folder
from worldagent.bench.evaluation.metrics.pen import (
    CHOICES,
    LEAST_DEPTH,
    VERTICES,
    Evaluated,
    directed_depth,
    penetration,
    sampled_frames,
)
from worldagent.bench.evaluation.metrics.pen_peer import peer_depths
from worldagent.geometry.inside import nearest_faces
from worldagent.testing.worlds.small_worlds import ball, box, ground, make_candidate, world
from worldagent.tests.bench.evaluation.folders import baked_folder
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.errors import EvidenceError, InputError

CASES = benchmark.cases()
STILL = (1.0, 0.0, 0.0, 0.0)


def body(name: str, mesh: Any, at: Any = (0, 0, 0), *, dynamic: bool = True, closed: bool = True) -> Evaluated:
    return Evaluated(name, name, dynamic, closed, mesh[0] + np.asarray(at, dtype=float), mesh[1])


def score(*objects: Evaluated) -> Any:
    return penetration(lambda _: objects, (0,))


@pytest.mark.parametrize("name", CASES)
def test_an_analytic_case_is_met_within_one_percent(name: str) -> None:
    """Closed forms: two spheres, boxes, a sphere in a bowl, moving, both dynamic; measured 0.024 %."""
    case = CASES[name]
    found = penetration(case.objects, sampled_frames(case.frames))
    assert found.score == pytest.approx(case.score, rel=0.01)
    assert found.scale == pytest.approx(case.scale, rel=1e-3)
    assert found.pairs[0] == found.worst


def test_there_are_twenty_four_frames_with_both_ends() -> None:
    frames = sampled_frames(240)
    assert len(frames) == 24
    assert frames[0] == 0
    assert frames[-1] == 239
    assert {b - a for a, b in pairwise(frames)} <= {10, 11}
    assert sampled_frames(10) == tuple(range(10))


def test_boxes_that_meet_are_candidates_and_only_crossing_triangles_count() -> None:
    """R142: two balls whose boxes meet at a corner do not touch."""
    found = score(body("a", sphere(0.5)), body("b", sphere(0.5), (0.8, 0.8, 0.0)))
    assert (found.compared, found.score, found.worst) == (1, 0.0, None)


def test_a_box_that_stands_on_another_does_not_cross_it() -> None:
    found = score(body("crate", box_mesh((0.4, 0.4, 0.4)), (0, 0, 0.7)), body("table", box_mesh((1, 1, 1)), dynamic=False))
    assert (found.compared, found.score) == (1, 0.0)


def test_static_pairs_and_parts_of_one_object_are_not_compared() -> None:
    ghosts = [body("a", box_mesh((1, 1, 1)), dynamic=False), body("b", box_mesh((1, 1, 1)), (0.5, 0.1, 0.2), dynamic=False)]
    assert score(*ghosts).compared == 0
    inner = Evaluated("a (open)", "a", True, False, ghosts[1].vertices, ghosts[1].faces)
    assert score(ghosts[0], inner).compared == 0


@pytest.mark.parametrize(
    ("dynamic", "asked"), [((True, False), (True, False)), ((False, True), (False, True)), ((True, True), (True, True))]
)
def test_a_direction_is_asked_for_what_is_dynamic(dynamic: tuple[bool, bool], asked: tuple[bool, bool]) -> None:
    one = body("one", box_mesh((1.0, 1.0, 1.0)), dynamic=dynamic[0])
    two = body("two", box_mesh((0.5, 0.5, 0.5)), (0.11, 0.07, 0.65), dynamic=dynamic[1])
    worst = score(one, two).worst
    assert (worst.forth is not None, worst.back is not None) == asked
    # The lower corners of the small box are 0.1 m below the top; the large one has no corner in the small one.
    assert worst.depth == pytest.approx(0.1 if asked[1] else LEAST_DEPTH)


def test_an_open_sheet_is_no_collider_and_its_corners_are_asked() -> None:
    cloth = np.array([[-0.2, -0.2, 0.45], [0.2, -0.2, 0.45], [0.0, 0.3, 0.6]]), np.array([[0, 1, 2]], dtype=np.int32)
    worst = score(body("rock", box_mesh((1, 1, 1))), body("cloth", cloth, closed=False)).worst
    assert worst.forth is None
    assert worst.back == pytest.approx(0.05)


def test_a_corner_outside_beside_a_sharp_edge_is_not_inside() -> None:
    """The two faces of an edge below 90 degrees: the plane of either may have an outside corner behind it."""
    points = np.array([[0, 0, 0], [0, 1, 0], [-1, 0, 0.2], [-1, 1, 0.2], [-1, 0, -0.2], [-1, 1, -0.2]], dtype=float)
    faces = np.array([[0, 1, 2], [1, 3, 2], [0, 4, 1], [1, 4, 5], [2, 3, 4], [3, 5, 4], [0, 2, 4], [1, 5, 3]], dtype=np.int32)
    wedge = Evaluated("wedge", "wedge", False, True, points, faces)
    needle = np.array([[[0.1, 0.5, 0.05], [0.1, 0.52, -0.05], [-0.05, 0.51, 0.0]]])
    assert directed_depth(needle, wedge) == pytest.approx(
        0.01 / np.hypot(1.0, 0.2), rel=1e-6
    )  # of the third corner; behind a plane the others are 0.03


def test_at_most_128_corners_are_asked_and_always_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    rock, fine = body("rock", box_mesh((2.0, 2.0, 2.0)), (0, 0, -1)), sphere(0.5, 5)
    crossing = (fine[0] - [0, 0, 0.1])[fine[1]]
    asked: list[int] = []

    def watched(solid: Any, points: Any) -> Any:
        asked.append(len(points))
        return nearest_faces(solid, points)

    monkeypatch.setattr(pen, "nearest_faces", watched)
    assert directed_depth(crossing, rock) == directed_depth(crossing, rock)
    assert asked == [VERTICES, VERTICES]


def test_the_deepest_moment_of_each_pair_is_told_and_the_scene_is_measured_at_first() -> None:
    ways = (0.2, 0.45, 0.3, 30.0)
    rock = body("rock", box_mesh((1, 1, 1)), dynamic=False)
    found = penetration(lambda k: [body("ball", sphere(0.1, 1), (0, 0, 0.8 - ways[k])), rock], range(4))
    assert found.worst.frame == 2  # at frame 1 the ball is wholly inside, where no triangles cross
    assert 0.03 < found.worst.depth < 0.04  # of a corner in the lowest ring that crosses, not of the ball's foot
    assert found.scale < 3.0  # the ball that left at the last frame makes the scene no larger
    assert len(found.pairs) == 1
    assert found.as_json()["choices"] == CHOICES


def spec(frames: int = 24) -> Any:
    return world(
        {"floor": ground(4.0), "ball": ball(0.1, motion="dynamic", at=(0, 0, 0.1)), "post": box(0.1, 0.1, 1.0, at=(1, 0, 0.5))},
        frames=frames,
    )


def test_a_sunken_ball_of_a_candidate_is_found_at_its_frame(tmp_path: Path) -> None:
    heights = np.full(24, 0.11)
    heights[7] = 0.06
    track = np.c_[np.zeros(24), np.zeros(24), heights]
    candidate = make_candidate(tmp_path, spec(), tracks={"ball": (track, STILL)})
    found = penetration(EvaluatedWorld(candidate).objects, sampled_frames(24))
    assert (found.worst.frame, found.worst.first, found.worst.second) == (7, "floor", "ball")
    assert 0.0 < found.worst.depth <= 0.04 + 1e-9
    assert found.objects == 3


def test_pen_of_a_baked_folder_needs_no_ledger_and_writes_nothing(tmp_path: Path) -> None:
    folder = baked_folder(tmp_path / "w", {**small_spec(), "prompt": PROMPT})
    before = {p: p.stat().st_mtime_ns for p in folder.root.rglob("*")}
    found = pen_of_folder(folder.root)
    assert {p: p.stat().st_mtime_ns for p in folder.root.rglob("*")} == before
    assert len(found.frames) == 24
    assert found.frames[-1] == 35
    assert found.score == 0.0  # what the server's own contact check holds to as well
    assert found.compared > 0  # the boxes of ball and blocks meet where it pushes them


def test_pen_is_unavailable_without_a_complete_bake(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no world\.json"):
        pen_of_folder(tmp_path)
    folder = baked_folder(tmp_path / "w", {**small_spec(), "prompt": PROMPT}, frames=0)
    with pytest.raises(EvidenceError, match="completely baked"):
        baked_candidate(folder.root)


def test_without_blender_the_peer_gives_null_and_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("WORLDAGENT_BLENDER", raising=False)
    monkeypatch.setenv("PATH", "/nonexistent")
    answer = peer_depths([])
    assert answer["max_relative_difference"] is None
    assert "WORLDAGENT_BLENDER" in answer["reason"]
