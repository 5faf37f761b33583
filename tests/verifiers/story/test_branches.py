"""An `or` is judged by all its branches: one that never comes true is no outcome of the world (R156)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, Touch, ball, box, ground, make_candidate, world
from worldagent.verifiers.story.beats import check
from worldagent.verifiers.story.branches import branch_lines
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Always, And, Contact, Count, Displacement, Not, Or, Separation, Speed
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, Perturbed, Requirement, Story

FRAMES = 41
FAR = Displacement(entity="ball", min=0.5)
TOUCH = Contact(a="ball", b="floor", min_impulse=0.1)
BLOW = Contact(a="ball", b="floor", min_impulse=1000)
NEAR = Separation(a="ball", b="cube", max=2.5, when="always")
APART = Separation(a="ball", b="cube", min=2.0, when="always")


def candidate(folder: Path, predicate: Any, *, asked: Any = None, **more: Any) -> Candidate:
    """A ball that is hit at frame 8 with 0.5 N s and goes 2 m along x; a cube that stays 2 m from where it started."""
    entities = {
        "floor": ground(),
        "ball": ball(0.1, motion="dynamic", at=(0, 0, 1)),
        "cube": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 2, 0.1)),
    }
    beats = {"b": Beat(text="it happens", owner="rigid", subject="ball", frames=(4, FRAMES - 1), predicate=predicate)}
    more |= {} if asked is None else {"requirements": {"r": Requirement(text="t", predicate=asked)}}
    spec = world(entities, frames=FRAMES, story=Story(beats=beats, **more))
    along = np.clip((np.arange(FRAMES) - 8) / 16, 0, 2)
    track = (np.stack([along, 0 * along, 1 + 0 * along], axis=1), IDENTITY)
    return make_candidate(folder, spec, tracks={"ball": track}, touches=[Touch(8, "ball", "floor", 0.5)])


def row(made: Candidate, name: str = "beat:branches:b") -> Row | None:
    return next((r for r in check(made) if r.id == name), None)


EACH = Displacement(entity="each", min=0.5)
STAYS = Speed(entity="each", max=0.02, when="always")


@pytest.mark.parametrize(
    ("predicate", "status"),
    [
        (Or(of=[BLOW, FAR]), "fail"),
        (Or(of=[TOUCH, FAR]), "pass"),
        (And(of=[FAR, Or(of=[TOUCH, BLOW])]), "fail"),
        (Not(predicate=And(of=[Not(predicate=BLOW), Not(predicate=FAR)])), "fail"),
        (Not(predicate=And(of=[Not(predicate=TOUCH), Not(predicate=FAR)])), "pass"),
        (Count(entities=["ball", "cube"], predicate=Or(of=[EACH, STAYS]), min=2), "pass"),
        (Count(entities=["ball"], predicate=Or(of=[EACH, STAYS]), min=1), "fail"),
        (Always(predicate=Or(of=[Displacement(entity="ball", max=0.5), FAR])), "pass"),
    ],
)
def test_every_branch_of_a_choice_has_to_come_true(tmp_path: Path, predicate: Any, status: str) -> None:
    found = row(candidate(tmp_path, predicate))
    assert found is not None
    assert (found.status, found.mandatory) == (status, True), found.evidence


@pytest.mark.parametrize("predicate", [FAR, And(of=[FAR, TOUCH]), Not(predicate=Or(of=[BLOW, APART])), Or(of=[FAR])])
def test_a_predicate_without_a_choice_has_no_such_row(tmp_path: Path, predicate: Any) -> None:
    assert row(candidate(tmp_path, predicate)) is None


def test_the_refusal_names_both_sides_and_drops_the_one_that_never_came(tmp_path: Path) -> None:
    made = candidate(tmp_path, Or(of=[BLOW, FAR]), asked=Or(of=[FAR, BLOW]))
    found = row(made)
    assert found is not None
    assert (found.measured, found.bound, found.unit) == (1.0, 0.0, "branch")
    text = found.evidence["explanation"]
    assert "only " in text
    assert "1000" in text.split(" came true; ")[1]
    assert found.corrections[0].patch == ({"op": "remove", "path": "/story/beats/b/predicate/of/0"},)
    asked = row(made, "requirement:branches:r")
    assert asked is not None
    assert asked.corrections[0].patch == ({"op": "remove", "path": "/story/requirements/r/predicate/of/1"},)
    assert [line["what"] for line in branch_lines(made)] == ["`or` of the beat 'b'", "`or` of the requirement 'r'"]


def test_perturbed_runs_decide_where_a_beat_has_a_sample_and_the_register_tells(tmp_path: Path) -> None:
    sample = {"more": Perturbed(beats=["b"], position=0.001, samples=8, min_fraction=0.5)}
    made = candidate(tmp_path, Or(of=[BLOW, FAR]), robustness=sample)
    found = row(made)
    assert found is not None
    assert found.status == "pass"
    assert "'more' decide" in found.evidence["explanation"]
    assert len(branch_lines(made)) == 1
