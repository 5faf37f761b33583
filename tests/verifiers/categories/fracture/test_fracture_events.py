"""Cracks and breaks: bonds that fail are a crack, pieces that come off a break."""

from __future__ import annotations

import dataclasses
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.physics.fracture_world import simulate, struck_wall
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.verifiers.story.beat_corrections import corrections_of
from worldagent.worlds.cache import Cache, write_container
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.categories.fracture.events import FractureEvent

Channels = dict[str, Any]
POSES = ("position", "quaternion", "velocity", "angular_velocity")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """A small wall that an iron ball goes through."""
    return simulate(tmp_path_factory.mktemp("wall"), struck_wall(15.0, tension=4e5, seconds=0.3, size=(0.6, 0.4), refine=0))


def edited(run: Candidate, folder: Path, change: Callable[[Channels], None]) -> Candidate:
    """The run with its frames altered."""
    shutil.copytree(run.caches["main"].folder, folder / "run" / "main")
    cache = Cache(folder / "run" / "main")
    for frame in range(run.frame_count):
        data = cache.read(frame)
        change(data)
        write_container(cache.path(frame), data)
    return dataclasses.replace(run, folder=folder, caches={"main": cache})


def judged(candidate: Candidate, kind: str, **more: Any) -> Outcome:
    event = FractureEvent.model_validate({"kind": kind, "entity": "wall", **more})
    return evaluate(candidate, event, (0, candidate.last_frame))


def frozen(run: Candidate) -> Callable[[Channels], None]:
    """The wall stays where it was built."""
    first = run.caches["main"].read(0)
    rows = [i for i, n in enumerate(run.caches["main"].index.bodies) if n.startswith("wall/")]

    def change(data: Channels) -> None:
        for name in POSES:
            data[name][rows] = first[name][rows]

    return change


def whole(data: Channels) -> None:
    """No bond breaks."""
    data["bond/broken"][:] = 0
    for name in [n for n in data if n.startswith("break/")]:
        data[name] = data[name][:0]


def test_a_wall_that_a_ball_goes_through_cracks_and_breaks(run: Candidate) -> None:
    hit = next(f for f in range(run.frame_count) if run.caches["main"].read(f)["break/time"].size)
    cracked, broken = (judged(run, kind, other="ball") for kind in ("cracks", "breaks"))
    assert (cracked.status, cracked.first_true_frame) == ("pass", hit)
    assert (broken.status, broken.unit) == ("pass", "1")
    assert (broken.first_true_frame or 0) >= hit
    assert broken.value == pytest.approx(sum(broken.details["came_off"].values()), abs=1e-3)
    assert judged(run, "breaks", min=0.99).status == "fail"


def test_a_wall_whose_bonds_fail_and_whose_pieces_stay_cracks_only(run: Candidate, tmp_path: Path) -> None:
    cracked = edited(run, tmp_path, frozen(run))
    assert judged(cracked, "cracks", other="ball").status == "pass"
    found = judged(cracked, "breaks")
    assert (found.status, found.value) == ("fail", 0.0)


def test_a_wall_that_goes_away_as_a_whole_does_neither(run: Candidate, tmp_path: Path) -> None:
    """All its pieces go as far as those of the broken one, and none comes off another."""
    still, frame = frozen(run), iter(range(run.frame_count))

    def change(data: Channels) -> None:
        still(data)
        whole(data)
        rows = [i for i, n in enumerate(run.caches["main"].index.bodies) if n.startswith("wall/")]
        data["position"][rows] += 0.1 * next(frame)

    carried = edited(run, tmp_path, change)
    assert [judged(carried, kind).status for kind in ("cracks", "breaks")] == ["fail", "fail"]


def test_a_wall_that_breaks_by_another_hand_is_not_broken_by_the_one_that_is_named(run: Candidate) -> None:
    found = judged(run, "breaks", other="floor")
    assert (found.status, found.value) == ("fail", 0.0)
    assert "by floor" in found.explanation


def test_a_wall_at_rest_throughout_does_neither(run: Candidate, tmp_path: Path) -> None:
    still = frozen(run)

    def change(data: Channels) -> None:
        still(data)
        whole(data)

    resting = edited(run, tmp_path, change)
    assert [judged(resting, kind).status for kind in ("cracks", "breaks")] == ["fail", "fail"]


def test_before_the_blow_nothing_has_broken(run: Candidate) -> None:
    hit = next(f for f in range(run.frame_count) if run.caches["main"].read(f)["break/time"].size)
    event = FractureEvent(kind="breaks", entity="wall")
    assert evaluate(run, event, (0, hit - 1)).status == "fail"


def test_what_is_not_breakable_has_no_evidence(run: Candidate) -> None:
    found = evaluate(run, FractureEvent(kind="cracks", entity="ball"), (0, 1))
    assert (found.status, "not breakable" in found.explanation) == ("unverified", True)


def test_a_wall_that_does_not_break_is_told_of_blow_and_bonds(run: Candidate, tmp_path: Path) -> None:
    event = FractureEvent.model_validate({"kind": "breaks", "entity": "wall", "other": "ball"})
    still = edited(run, tmp_path, whole)
    outcome = evaluate(still, event, (0, run.last_frame))
    assert outcome.status == "fail"
    told = {c.group: c for c in corrections_of(still, event, outcome, "/story/beats/break", (0, run.last_frame))}
    assert "speed of ball" in told["initial_state"].action
    assert "/entities/wall/breakable/bond/tension" in told["bonds"].pointers


def test_what_is_to_break_on_something_that_stands_still_is_told_to_fall_harder(run: Candidate, tmp_path: Path) -> None:
    event = FractureEvent.model_validate({"kind": "breaks", "entity": "wall", "other": "floor"})
    still = edited(run, tmp_path, whole)
    assert still.spec.entities["floor"].motion == "static"
    outcome = evaluate(still, event, (0, run.last_frame))
    told = {c.group: c for c in corrections_of(still, event, outcome, "/story/beats/break", (0, run.last_frame))}
    assert "speed of wall itself" in told["initial_state"].action
    assert told["initial_state"].pointers == ("/entities/wall/physics/linear_velocity",)
