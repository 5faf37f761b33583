"""Roles swapped are no rival once the event is over: kicks back pass, and what is done to the doer first, or at once, voids the claim."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from worldagent.tests.verifiers.claims.claimed import claimed
from worldagent.verifiers.claims.check import check
from worldagent.verifiers.forged.bodies import BLOCK, on_floor
from worldagent.verifiers.forged.bounds import HALF
from worldagent.verifiers.forged.stage import Stage

FRAMES = 25
CLAIM = {"e": {"quote": "it happens", "type": "event", "by": ["/story/beats/b"]}}
FAST = 2.0
HITS = {"kind": "hits", "entity": "it", "other": "other"}
BACK = {"kind": "hits", "entity": "other", "other": "it"}
PUSHES = {"kind": "pushes", "entity": "it", "other": "other"}


def row(stage: Stage, predicate: dict[str, Any], frames: tuple[int, int] = (0, FRAMES - 1)) -> Any:
    candidate = stage.open()
    beat = {"owner": "stage", "subject": "it", "predicate": predicate, "frames": list(frames)}
    (found,) = check(dataclasses.replace(candidate, spec=claimed(candidate.spec, CLAIM, beats={"b": beat})))
    return found


def void(stage: Stage, predicate: dict[str, Any]) -> bool:
    found = row(stage, predicate)
    assert (found.status == "fail") == bool(found.evidence["true_rivals"]), found.evidence
    return any("roles swapped" in t for t in found.evidence["true_rivals"])


def hitting(*blows: tuple[int, float, float], names: tuple[str, ...] = ("other",)) -> Stage:
    """Blocks that meet at the ends of intervals, at velocities of `it` and of the others [m/s] before each; between them they drift."""
    stage = on_floor(FRAMES)
    mine, theirs = np.zeros((FRAMES, 3)), np.zeros((FRAMES, 3))
    for at, one, two in blows:
        mine[at, 0], theirs[at, 0] = one, two
    stage.add("it", BLOCK, (0, 0, HALF), velocity=mine)
    for k, name in enumerate(names):
        stage.add(name, BLOCK, (2 * HALF, 3 * HALF * k, HALF), velocity=theirs)
        for at, one, two in blows:
            impulse = (stage.actors["it"].mass * 0.5 * (one - two), 0, 0)
            stage.touch("it", name, impulse=impulse, over=slice(at, at + 1), speed=one - two)
    return stage


def pushing(mine: Any, theirs: Any, pressed: Any) -> Stage:
    """Blocks that press each other apart in intervals told, at velocities along x [m/s]."""
    stage = on_floor(FRAMES)
    stage.add("it", BLOCK, (0, 0, HALF), velocity=np.outer(mine, (1, 0, 0)))
    stage.add("other", BLOCK, (2 * HALF, 0, HALF), velocity=np.outer(theirs, (1, 0, 0)))
    impulse = np.outer(np.asarray(pressed)[:-1], (stage.actors["other"].mass * 0.1, 0, 0))
    stage.touch("it", "other", impulse=impulse)
    return stage


def over(first: int, last: int, value: float) -> Any:
    return np.where((np.arange(FRAMES) >= first) & (np.arange(FRAMES) <= last), value, 0.0)


KICKED = hitting((5, FAST, 0.0), (11, 0.0, -FAST))
STRUCK_FIRST = hitting((5, 0.0, -FAST), (11, FAST, 0.0))
AT_ONCE = hitting((5, FAST, -FAST))


def test_a_later_kick_back_is_another_event() -> None:
    assert not void(KICKED, HITS)
    assert not void(hitting((5, FAST, 0.0), (7, 0.0, -FAST)), HITS)


def test_who_is_hit_first_or_at_the_same_contact_voids_the_claim() -> None:
    assert void(STRUCK_FIRST, HITS)
    assert void(AT_ONCE, HITS)


def test_who_is_only_hit_does_not_hit() -> None:
    found = row(hitting((5, 0.0, -FAST)), HITS)
    assert "does not come true" in found.evidence["explanation"]


@pytest.mark.parametrize("more", [{"kind": "displacement", "entity": "it", "min": 0.0, "when": "end"},
                                  {"kind": "displacement", "entity": "other", "min": 0.01}])  # fmt: skip
def test_it_is_asked_of_each_event_of_what_several_conditions_join(more: dict[str, Any]) -> None:
    # The last condition comes true after the kick back, and not by the end of the first blow.
    joined = {"kind": "and", "of": [HITS, more]}
    assert not void(KICKED, joined)
    assert void(STRUCK_FIRST, joined)
    assert void(AT_ONCE, joined)


def test_one_of_two_readings_that_is_swapped_first_voids_both() -> None:
    assert void(KICKED, {"kind": "or", "of": [HITS, BACK]})
    assert void(STRUCK_FIRST, {"kind": "or", "of": [HITS, {**HITS, "min": 1e6}]})


def test_that_both_hit_each_other_in_turn_has_no_rival_in_itself() -> None:
    assert not void(KICKED, {"kind": "and", "of": [HITS, BACK]})


@pytest.mark.parametrize(
    ("blows", "voids"),
    [
        (((5, FAST, 0.0), (11, 0.0, -FAST)), False),
        (((5, 0.0, -FAST), (11, FAST, 0.0)), True),
        (((5, FAST, -FAST),), True),
    ],
)
def test_it_is_asked_of_each_of_several_bodies(blows: tuple[tuple[int, float, float], ...], voids: bool) -> None:
    each = {"kind": "count", "entities": ["one", "two"], "min": 2, "predicate": {**HITS, "other": "each"}}
    assert void(hitting(*blows, names=("one", "two")), each) == voids


@pytest.mark.parametrize(
    "wrapped", [{"kind": "eventually", "predicate": HITS}, {"kind": "eventually", "predicate": HITS, "frames": [6, 24]}]
)
def test_inside_a_choice_of_frames_all_frames_are_asked(wrapped: dict[str, Any]) -> None:
    assert void(hitting((5, FAST, 0.0), (8, 0.0, -FAST), (14, FAST, 0.0)), wrapped)


def test_who_pushes_back_later_does_another_thing() -> None:
    there, back = over(1, 9, 0.6), over(14, 23, -0.6)
    pressed = (there != 0) | (back != 0)
    assert not void(pushing(there + back, there + back, pressed), PUSHES)
    assert void(pushing(-there - back, -there - back, pressed), PUSHES)


def test_who_pushes_back_from_the_same_onset_on_voids_the_claim_however_late_it_is_far_enough() -> None:
    apart = pushing(over(1, 20, -0.12), over(1, 5, 0.8), over(1, 20, 1.0))
    assert void(apart, PUSHES)
    mine, theirs = (row(apart, p).evidence["beats"]["b"] for p in (PUSHES, {**PUSHES, "entity": "other", "other": "it"}))
    assert mine < theirs
