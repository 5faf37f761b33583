"""Bodies that leave the ground for good are found; those that stay, are held, or are sent away by the story are not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import ball, box, ground, make_candidate, world
from worldagent.verifiers.support.check import check
from worldagent.worlds.predicates.models import Crosses, Displacement, Reaches
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, BoxRegion, HingeJoint

FRAMES, FPS = 30, 24
IDENTITY = (1.0, 0.0, 0.0, 0.0)


def _fall(x: float, *, start: int = 6) -> Any:
    """Rolls along x until frame `start`, then falls freely at x."""
    k = np.arange(FRAMES)
    time = np.maximum(k - start, 0) / FPS
    return np.stack([np.where(k < start, x * k / start, x), 0 * time, 0.101 - 0.5 * 9.81 * time**2], axis=1), IDENTITY


def _kept(folder: Path, path: Any, **more: Any) -> Row:
    entities = {"floor": ground(4.0, 1.0), "ball": ball(0.1, motion="dynamic", at=(0, 0, 0.101)), **more.pop("entities", {})}
    spec = world(entities, frames=FRAMES, fps=FPS, **more)
    rows = {r.id: r for r in check(make_candidate(folder, spec, tracks={"ball": path}))}
    return rows["support:kept"]


def _beat(predicate: Any) -> dict[str, Beat]:
    return {"falls": Beat(text="it falls off", owner="rigid", frames=(8, 29), subject="ball", predicate=predicate)}


def test_a_ball_that_falls_beside_the_ground_is_found_with_its_frame_and_place(tmp_path: Path) -> None:
    row = _kept(tmp_path, _fall(2.4))
    assert row.status == "fail"
    assert row.entities == ("ball",)
    assert row.first_failing_frame in (5, 6, 7)
    assert row.evidence["fallen"][0]["place"][0] == pytest.approx(2.4)
    assert {c.group for c in row.corrections} >= {"shape", "initial_state", "story"}


def test_a_ball_that_stays_on_the_ground_passes(tmp_path: Path) -> None:
    k = np.arange(FRAMES)
    path = np.stack([1.8 * k / FRAMES, 0 * k, 0 * k + 0.101], axis=1), IDENTITY
    assert _kept(tmp_path, path).status == "pass"


def test_a_lower_ground_beneath_keeps_it(tmp_path: Path) -> None:
    row = _kept(tmp_path, _fall(2.4), entities={"valley": box(10, 10, 0.2, at=(0, 0, -30))})
    assert row.status == "pass"


def test_a_ball_thrown_over_the_edge_that_still_rises_passes(tmp_path: Path) -> None:
    k = np.arange(FRAMES)
    path = np.stack([2.0 + 0.1 * k, 0 * k, 0.101 + 0.2 * k], axis=1), IDENTITY
    assert _kept(tmp_path, path).status == "pass"


PIT = {"pit": BoxRegion(min=(2, -1, -20), max=(4, 1, -2)), "table": BoxRegion(min=(-1, -1, 0), max=(1, 1, 1))}
SENT = {
    "reaches": (Reaches(entity="ball", region="pit"), "pass"),
    "crosses": (Crosses(entity="ball", point=(2.4, 0, -2), normal=(0, 0, -1)), "pass"),
    "displacement": (Displacement(entity="ball", axis=(0, 0, -1), min=3.0), "pass"),
    "reaches the table": (Reaches(entity="ball", region="table"), "fail"),
    "moves along": (Displacement(entity="ball", axis=(1, 0, 0), min=1.0), "fail"),
}


@pytest.mark.parametrize("kind", SENT)
def test_only_a_beat_that_sends_it_off_the_ground_excuses_it(kind: str, tmp_path: Path) -> None:
    predicate, status = SENT[kind]
    assert _kept(tmp_path, _fall(2.4), regions=PIT, beats=_beat(predicate)).status == status


def test_a_body_on_a_hinge_is_held(tmp_path: Path) -> None:
    joint = HingeJoint(child="ball", anchor=(2.4, 0, 0), axis=(0, 1, 0))
    assert _kept(tmp_path, _fall(2.4), joints={"pin": joint}).status == "pass"


def test_gravity_sideways_is_followed(tmp_path: Path) -> None:
    """The same world turned: the wall at x = 0 is the ground and bodies fall towards +x."""
    position = _fall(2.4)[0]
    turned = np.stack([-position[:, 2], position[:, 1], position[:, 0]], axis=1)
    entities = {"floor": box(1.0, 4.0, 4.0, at=(0.5, 0, 0)), "ball": ball(0.1, motion="dynamic", at=(-0.101, 0, 0))}
    spec = world(entities, frames=FRAMES, fps=FPS, gravity=(9.81, 0, 0))
    rows = {r.id: r for r in check(make_candidate(tmp_path, spec, tracks={"ball": (turned, IDENTITY)}))}
    assert rows["support:kept"].status == "fail"
