"""Verdicts on the first frames of a run: what is decided stays decided, and what is not reached yet is no pass."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.simulated_worlds import beat, simulate
from worldagent.testing.worlds.small_cloth import flag_spec
from worldagent.testing.worlds.small_grains import sand_spec
from worldagent.testing.worlds.small_liquids import tank_spec
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, box, ground, make_candidate, world
from worldagent.verifiers.checks import run_checks
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import EvidenceError
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.predicates import Displacement
from worldagent.worlds.requirements import Row

FRAMES = 13


def rigid(folder: Path) -> Candidate:
    """A block that slides by itself, and sinks into the floor from frame 8 on."""
    time = np.arange(FRAMES) / 24
    depth = np.where(np.arange(FRAMES) >= 8, 0.02, 0.0)
    entities = {
        "floor": ground(4.0),
        "cube": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1)),
        "aside": ball(0.1, at=(1, 1, 0.1)),
    }
    beats = {"go": beat("cube", Displacement(entity="cube", min=0.3), frames=(0, FRAMES - 1))}
    spec = world(entities, frames=FRAMES, beats=beats)
    place = np.stack([time, 0 * time, 0.1 - depth], axis=1)
    return make_candidate(folder, spec, tracks={"cube": (place, IDENTITY)})


def simulated(document: dict[str, Any]) -> Callable[[Path], Candidate]:
    return lambda folder: simulate(folder, parse_spec({"prompt": "A small world moves.", **document}))


def floating(folder: Path) -> Candidate:
    """A crate that a liquid carries, let go above its draft: it bobs, and the water bears little of it at first."""
    document = tank_spec(frames=FRAMES, crate_at=0.25)
    document["graph"]["relations"]["bears"] = {"kind": "supports", "a": "water", "b": "crate", "frames": [0, FRAMES - 1]}
    return simulated(document)(folder)


WORLDS: dict[str, Callable[[Path], Candidate]] = {
    "rigid": rigid,
    "grains": simulated(sand_spec(radius=0.012, depth=0.03, frames=FRAMES, preroll=0.1)),
    "cloth": simulated(flag_spec(frames=FRAMES, resolution=0.1)),
    "liquid": simulated(tank_spec(frames=FRAMES)),
    "floating": floating,
}


def judged(candidate: Candidate) -> dict[str, Row]:
    return {row.id: row for row in run_checks(candidate, reruns=False)}


def kept(row: Row) -> tuple[Any, ...]:
    return row.status, row.measured, row.bound, row.unit, row.first_failing_entity, row.first_failing_frame


@pytest.mark.parametrize("name", WORLDS)
def test_what_a_prefix_decides_the_whole_run_keeps(name: str, tmp_path: Path) -> None:
    whole = WORLDS[name](tmp_path)
    ends = (1, 3, 9, whole.last_frame)
    found = [judged(whole.until(end)) for end in ends]
    pairs = [(ends[k], row, later.get(row.id)) for k in range(len(ends)) for later in found[k + 1 :] for row in found[k].values()]
    decided = [(end, row, after) for end, row, after in pairs if after is not None]
    mended = [(end, row.id, row.evidence) for end, row, after in decided if row.status == "fail" != after.status]
    assert mended == []
    overturned = [
        (end, row.id, after.evidence)
        for end, row, after in decided
        if row.status == "pass" and after.status == "fail" and not (after.first_failing_frame or 0) > end
    ]
    assert overturned == []
    assert {i: kept(r) for i, r in found[-1].items()} == {i: kept(r) for i, r in judged(whole).items()}


def test_a_row_fails_from_the_frame_on_at_which_what_it_forbids_happens(tmp_path: Path) -> None:
    whole = rigid(tmp_path)
    rows = [judged(whole.until(end))["contact:floor:cube"] for end in (7, 8, 12)]
    assert [r.status == "fail" for r in rows] == [False, True, True]
    assert [r.first_failing_frame for r in rows[1:]] == [8, 8]


def test_a_beat_whose_interval_has_not_ended_is_open(tmp_path: Path) -> None:
    whole = rigid(tmp_path)
    assert judged(whole.until(3))["beat:go"].status == "unverified"
    assert judged(whole)["beat:go"].status == "pass"


def test_a_view_ends_at_its_frame_and_there_is_none_beyond_the_run(tmp_path: Path) -> None:
    whole = rigid(tmp_path)
    view = whole.until(4)
    assert (view.last_frame, view.stage) == (4, "probe")
    assert all(len(c.series("position")) == 5 for c in view.rigid_caches.values())
    assert whole.until(whole.last_frame) is whole
    with pytest.raises(EvidenceError, match=r"frames 0\.\.12 can be inspected"):
        whole.until(FRAMES)
