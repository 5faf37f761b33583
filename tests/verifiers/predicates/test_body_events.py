"""Kinds of event that happen to bodies, in worlds that the engine ran: where each is true, and where something near it is."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Any, get_args

import pytest
from worldagent.testing.defects._films import Film, copied, film_of
from worldagent.testing.worlds.event_worlds import event_world
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.predicates import Outcome
from worldagent.verifiers.predicates.events import EVENTS, bounds
from worldagent.worlds.predicates import BodyEvent, PairEvent, TouchEvent
from worldagent.worlds.predicates.event_kinds import BODY_EVENTS
from worldagent.worlds.predicates.events import EVENT_KINDS, event_atoms

MODELS = (BodyEvent, TouchEvent, PairEvent)

TRUE: dict[str, list[tuple[str, ...]]] = {
    "falls": [("drop", "ball"), ("bounce", "ball"), ("topple", "slab")],
    "rises": [("bounce", "ball"), ("lifted", "box")],
    "spins": [("spin", "box")],
    "stops": [("drop", "ball"), ("slide", "box"), ("topple", "slab")],
    "rolls": [("roll", "ball"), ("roll", "ball", "floor")],
    "slides": [("slide", "box"), ("slip", "ball"), ("shove", "box", "floor"), ("push", "box", "floor")],
    "tips": [("topple", "slab"), ("topple", "slab", "floor")],
    "lands": [("drop", "ball"), ("drop", "ball", "floor")],
    "hits": [("hit", "hitter", "box"), ("drop", "ball", "floor"), ("bounce", "ball", "floor")],
    "pushes": [("push", "hand", "box"), ("lifted", "hand", "box")],
}
"""World, entity and other of each kind where it happens."""
FALSE: dict[str, list[tuple[str, ...]]] = {
    # Lowered by a hand, laid down, shoved sideways, rolling, at rest, held.
    "falls": [
        ("lowered", "box"),
        ("lowered", "hand"),
        ("laid_down", "plank"),
        ("shove", "box"),
        ("roll", "ball"),
        ("rest", "box"),
        ("held", "ball"),
        ("rock", "slab"),
    ],
    "rises": [("drop", "ball"), ("roll", "ball"), ("lowered", "box"), ("rest", "box"), ("rock", "slab")],
    "spins": [("roll", "ball"), ("slide", "box"), ("topple", "slab"), ("rest", "box")],
    # Turning points, motion that goes on, rest from the start.
    "stops": [("bounce", "ball"), ("roll", "ball"), ("rest", "box"), ("held", "ball")],
    # Slides without turning, falls onto its side, turns in the air.
    "rolls": [("slide", "box"), ("slip", "ball"), ("topple", "slab"), ("spin", "box"), ("rest", "box")],
    # Rolls without slip, falls, is carried.
    "slides": [("roll", "ball"), ("drop", "ball"), ("lowered", "box"), ("rest", "box"), ("rock", "slab")],
    # Does not reach its balance, is laid down, rolls, slides.
    "tips": [("rock", "slab"), ("laid_down", "plank"), ("roll", "ball"), ("slide", "box"), ("rest", "box")],
    # Bounces on, is taken down, was never in the air.
    "lands": [("bounce", "ball"), ("lowered", "box"), ("slide", "box"), ("rest", "box")],
    # Roles exchanged, resting contact, pressed slowly.
    "hits": [("hit", "box", "hitter"), ("rest", "box", "lower"), ("lowered", "box", "hand"), ("roll", "ball", "floor")],
    # A blow, roles exchanged, the load on what goes down, rest.
    "pushes": [
        ("hit", "hitter", "box"),
        ("push", "box", "hand"),
        ("lowered", "box", "hand"),
        ("lowered", "hand", "box"),
        ("rest", "box", "lower"),
        ("shove", "floor", "box"),
    ],
}
"""The same where it does not, and something near it is true."""


@lru_cache(maxsize=32)
def film(name: str) -> Film:
    return film_of(event_world(name))


def event(kind: str, entity: str, other: str | None = None, **more: Any) -> Any:
    model = next(m for m in MODELS if kind in get_args(m.model_fields["kind"].annotation))
    return model(kind=kind, entity=entity, **({} if other is None else {"other": other}), **more)


@pytest.fixture
def judged(tmp_path: Any) -> Any:
    def run(world: str, kind: str, entity: str, other: str | None = None, **more: Any) -> Outcome:
        candidate = copied(film(world)).candidate(tmp_path)
        frames = more.pop("frames", (0, candidate.last_frame))
        return evaluate(candidate, event(kind, entity, other, **more), frames)

    return run


def cases(table: dict[str, list[tuple[str, ...]]]) -> list[Any]:
    return [
        pytest.param(kind, *case, *[None] * (3 - len(case)), id="-".join((kind, *case)))
        for kind, found in table.items()
        for case in found
    ]


@pytest.mark.parametrize(("kind", "world", "entity", "other"), cases(TRUE))
def test_a_kind_is_met_where_it_happens(judged: Any, kind: str, world: str, entity: str, other: str | None) -> None:
    outcome = judged(world, kind, entity, other)
    assert outcome.status == "pass", outcome.explanation
    assert outcome.unit == EVENT_KINDS[kind].unit
    assert entity in outcome.explanation
    assert "frame" in outcome.explanation


@pytest.mark.parametrize(("kind", "world", "entity", "other"), cases(FALSE))
def test_a_kind_is_not_met_by_something_near_it(judged: Any, kind: str, world: str, entity: str, other: str | None) -> None:
    outcome = judged(world, kind, entity, other)
    assert outcome.status == "fail", outcome.explanation
    assert outcome.first_failing_entity == entity


@pytest.mark.parametrize("kind", [k for k, info in EVENT_KINDS.items() if k in EVENTS])
def test_every_kind_has_a_world_in_which_it_is_true_and_two_in_which_it_is_not(kind: str) -> None:
    assert TRUE[kind]
    assert len(FALSE[kind]) >= 2
    assert {c[0] for c in FALSE[kind]} & {"rest", "held"}, "a body that rests throughout"


@pytest.mark.parametrize("kind", [info.kind for info in BODY_EVENTS if info.directed])
def test_a_directed_kind_is_tried_with_its_roles_exchanged(kind: str) -> None:
    assert {(w, b, a) for w, a, b in TRUE[kind] if a != "floor" and b != "floor"} & {tuple(c) for c in FALSE[kind]}


@pytest.mark.parametrize("info", BODY_EVENTS, ids=lambda i: i.kind)
def test_a_definition_states_numbers_that_are_bounds_of_the_judge(info: Any) -> None:
    numbers = {float(n) for n in re.findall(r"(?<![\w.])\d+\.\d+", info.gloss)}
    known = {abs(v) for n, v in vars(bounds).items() if n.isupper() and isinstance(v, float)} | {0.0005, 0.005}
    assert numbers <= known, numbers - known
    assert info.gloss.endswith(".")
    assert all((info.source, info.unit))


def test_an_event_is_true_from_the_frame_on_at_which_its_measure_is_reached(judged: Any) -> None:
    """After 0.1 m of free fall, 0.143 s, frame 4 at 24 frames per second; up to the floor at 0.452 s."""
    outcome = judged("drop", "falls", "ball")
    assert (outcome.first_true_frame, outcome.details["onset"]) == (4, 0)
    assert outcome.value == pytest.approx(0.999, abs=2e-3)
    assert outcome.truth is not None
    assert [int(k) for k in outcome.truth.nonzero()[0]] == list(range(4, 12))


def test_an_event_before_its_interval_does_not_count_and_one_that_spans_its_begin_counts_from_there(judged: Any) -> None:
    assert judged("drop", "falls", "ball", frames=(13, 35)).status == "fail"
    late = judged("drop", "falls", "ball", frames=(8, 35))
    assert late.status == "pass"
    assert late.value < judged("drop", "falls", "ball").value


def test_an_event_can_ask_for_more_than_its_own_threshold(judged: Any) -> None:
    assert judged("drop", "falls", "ball", min=0.9).status == "pass"
    more = judged("drop", "falls", "ball", min=1.5)
    assert (more.status, more.bound) == ("fail", 1.5)
    assert judged("drop", "falls", "ball", min=1e-6).bound == pytest.approx(0.1), "no less than the kind's own"


def test_who_raised_it_is_told_by_work(judged: Any) -> None:
    lifted, bounced = (judged(w, "rises", e).details["by"] for w, e in (("lifted", "box"), ("bounce", "ball")))
    assert next(iter(lifted)) == "hand"
    assert next(iter(bounced)) == "its own motion"


def test_a_blow_tells_its_speed_and_whose_motion_it_was(judged: Any) -> None:
    outcome = judged("drop", "hits", "ball", "floor")
    assert outcome.details["speed"] == pytest.approx((2 * 9.81 * 0.999) ** 0.5, rel=0.02)
    assert outcome.details["own_share"] == pytest.approx(1.0, abs=0.01)
    assert outcome.first_true_frame == 11


def test_a_push_tells_the_work_and_a_fall_that_is_carried_who_carries(judged: Any) -> None:
    assert judged("push", "pushes", "hand", "box").details["work"] > 1.0
    assert "most by hand" in judged("lowered", "falls", "box").explanation


def test_what_is_not_known_is_not_judged(judged: Any) -> None:
    assert judged("drop", "falls", "nobody").status == "unverified"
    assert judged("drop", "hits", "ball", "nobody").status == "unverified"
    assert judged("drop", "hits", "ball", "ball").status == "unverified"


def test_events_are_found_within_a_predicate_but_not_below_a_not() -> None:
    from worldagent.worlds.predicates import And, Count, Eventually, Not, Speed

    falls = event("falls", "each")
    held = And(of=[Count(entities=["a", "b"], min=2, predicate=falls), Speed(entity="a", min=1.0)])
    assert event_atoms(Eventually(predicate=held)) == [falls]
    assert event_atoms(Not(predicate=falls)) == []
