"""Containment and adjacency are judged from geometry."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import ball, box, ground, make_candidate, world
from worldagent.verifiers.scene.relations import check
from worldagent.worlds.spec import Adjacent, BoxRegion, Contains

IDENTITY = np.tile([1.0, 0.0, 0.0, 0.0], (24, 1))


def _still(*position: float) -> np.ndarray:
    return np.tile(np.array(position, dtype=float), (24, 1))


def _judge(tmp_path: Path, track: np.ndarray, relation: Contains):
    things = {"floor": ground(), "room": box(2, 2, 2, at=(0, 0, 1)), "b": ball(0.1, motion="dynamic", at=tuple(track[0]))}
    regions = {"corner": BoxRegion(min=(0, 0, 0), max=(1, 1, 1))}
    spec = world(things, relations={"holds": relation}, regions=regions)
    return next(r for r in check(make_candidate(tmp_path, spec, tracks={"b": (track, IDENTITY)})) if r.id == "relations:holds")


@pytest.mark.parametrize("holder", ["corner", "room"])
def test_a_body_that_stays_inside_passes(tmp_path: Path, holder: str) -> None:
    assert _judge(tmp_path, _still(0.5, 0.5, 0.5), Contains(a=holder, b="b")).status == "pass"


@pytest.mark.parametrize(("holder", "outside"), [("corner", 0.2), ("room", 0.2)])
def test_leaving_for_one_frame_fails_at_that_frame_with_the_distance(tmp_path: Path, holder: str, outside: float) -> None:
    track = _still(0.5, 0.5, 0.5)
    track[17, 0] = 1.0 + outside
    row = _judge(tmp_path, track, Contains(a=holder, b="b"))
    assert (row.status, row.first_failing_entity, row.first_failing_frame) == ("fail", "b", 17)
    assert row.measured == pytest.approx(outside, abs=1e-9)


def test_only_the_declared_frames_count(tmp_path: Path) -> None:
    track = _still(0.5, 0.5, 0.5)
    track[17, 0] = 3.0
    assert _judge(tmp_path, track, Contains(a="corner", b="b", frames=(0, 10))).status == "pass"


@pytest.mark.parametrize(("gap", "status"), [(0.3, "pass"), (0.1, "fail")])
def test_adjacency_is_the_distance_of_visible_surfaces(tmp_path: Path, gap: float, status: str) -> None:
    things = {"a": box(1, 1, 1, at=(0, 0, 0.5)), "c": box(1, 1, 1, at=(1.2, 0, 0.5))}
    spec = world(things, relations={"next": Adjacent(a="a", b="c", gap=gap)})
    row = next(r for r in check(make_candidate(tmp_path, spec)) if r.id == "relations:next")
    assert row.status == status
    assert row.measured == pytest.approx(0.2, abs=1e-9)
