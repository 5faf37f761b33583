"""Kinds of event that happen to bodies, in worlds that the engine ran: where each is true, and where something near it is."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Any, get_args

import pytest
from worldagent.testing.defects._films import Film, copied, film_of
from worldagent.testing.worlds.event_worlds import event_world
from worldagent.testing.worlds.small_worlds import ball, ground, pose, world
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.predicates.combine import substitute
from worldagent.verifiers.predicates.events import EVENTS, bounds
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.predicates import BodyEvent, Compares, PairEvent, TouchEvent
from worldagent.worlds.predicates.event_kinds import BODY_EVENTS
from worldagent.worlds.predicates.events import EVENT_KINDS, event_atoms
from worldagent.worlds.spec import Box, Part, SlideJoint

MODELS = (BodyEvent, TouchEvent, PairEvent)

TRUE: dict[str, list[tuple[str, ...]]] = {
    "falls": [("drop", "ball"), ("bounce", "ball"), ("topple", "slab")],
    "rises": [("bounce", "ball"), ("lifted", "box")],
    "spins": [("spin", "box")],
    "stops": [("drop", "ball"), ("slide", "box"), ("topple", "slab")],
    "rolls": [("roll", "ball"), ("downhill", "ball"), ("roll", "ball", "floor")],
    "slides": [("slide", "box"), ("slip", "ball"), ("shove", "box", "floor"), ("push", "box", "floor")],
    "tips": [
        ("topple", "slab"),
        ("topple", "slab", "floor"),
        ("topple_against", "cupboard"),
        ("topple_against", "cupboard", "floor"),
    ],
    "lands": [("drop", "ball"), ("drop", "ball", "floor")],
    "hits": [("hit", "hitter", "box"), ("drop", "ball", "floor"), ("bounce", "ball", "floor")],
    "pushes": [("push", "hand", "box"), ("lifted", "hand", "box")],
    "slows": [("slide", "box"), ("uphill", "ball")],
    "swings": [("swing", "bob")],
    "jumps": [("jump", "box")],
    "drifts": [("drift", "ball")],
    "bounces": [("bounce", "ball"), ("bounce", "ball", "floor")],
    "goes_uphill": [("uphill", "ball"), ("uphill", "ball", "ramp")],
    "comes_loose": [("loose", "box"), ("loose", "box", "beam")],
    "opens": [("door_opens", "door"), ("door_opens", "door", "frame")],
    "closes": [("door_closes", "door")],
    "pulls": [("pull", "hand", "box")],
    "lifts": [("lifted", "hand", "box"), ("toss", "hand", "box"), ("seesaw", "beam", "cube")],
    "lowers": [("lowered", "hand", "box")],
    "throws": [("toss", "hand", "box")],
    "rests_against": [("lean", "plank", "wall"), ("wedged", "cart", "block"), ("meets", "box", "wall")],
    "jams": [("jam", "box", "wall")],
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
        ("downhill", "ball"),
    ],
    "rises": [("drop", "ball"), ("roll", "ball"), ("lowered", "box"), ("rest", "box"), ("rock", "slab")],
    "spins": [("roll", "ball"), ("slide", "box"), ("topple", "slab"), ("rest", "box")],
    # Turning points, motion that goes on, rest from the start.
    "stops": [("bounce", "ball"), ("roll", "ball"), ("rest", "box"), ("held", "ball")],
    # Slides without turning, falls onto its side, turns in the air.
    "rolls": [("slide", "box"), ("slip", "ball"), ("topple", "slab"), ("spin", "box"), ("rest", "box")],
    # Rolls without slip, lies under what slides, falls, is carried.
    "slides": [("roll", "ball"), ("slide", "floor"), ("drop", "ball"), ("lowered", "box"), ("rest", "box"), ("rock", "slab")],
    # Does not reach its balance, is laid down, rolls, slides.
    "tips": [("rock", "slab"), ("downhill", "ball"), ("laid_down", "plank"), ("roll", "ball"), ("slide", "box"), ("rest", "box")],
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
    # A blow takes the speed, rest, an even roll.
    "slows": [("drop", "ball"), ("roll", "ball"), ("rest", "box"), ("hang", "bob")],
    # Hangs still, is carried to and fro by a hand, is turned back by a stop, falls.
    "swings": [
        ("hang", "bob"),
        ("waved", "box"),
        ("waved", "hand"),
        ("door_closes", "door"),
        ("topple", "slab"),
        ("rest", "box"),
    ],
    # Bounces, is lifted or tossed by a hand, is sent off by a blow, was never on the ground.
    "jumps": [("bounce", "ball"), ("lifted", "box"), ("toss", "box"), ("drop", "ball"), ("uphill", "ball"), ("rest", "box")],
    # Goes by itself, is pushed by a force, is blown away fast, rests.
    "drifts": [("glide", "ball"), ("shove", "box"), ("roll", "ball"), ("rest", "box")],
    # Lands and stays, falls, slides, rests.
    "bounces": [("drop", "ball"), ("slide", "box"), ("rest", "box"), ("held", "ball")],
    # Is lifted, bounces up, rolls on the level.
    "goes_uphill": [("lifted", "box"), ("bounce", "ball"), ("roll", "ball"), ("rest", "box")],
    # Stays fixed, fell without ever being held by a joint.
    "comes_loose": [("fixed", "box"), ("drop", "ball"), ("loose", "box", "floor"), ("rest", "box")],
    # Closes, opens farther from half open, has no hinge.
    "opens": [("door_closes", "door"), ("door_moves", "door"), ("slide", "box"), ("rest", "box")],
    "closes": [("door_opens", "door"), ("door_moves", "door"), ("slide", "box"), ("rest", "box")],
    # Pushes, is pulled, stands on the floor.
    "pulls": [
        ("push", "hand", "box"),
        ("pull", "box", "hand"),
        ("pull", "floor", "box"),
        ("lifted", "hand", "box"),
        ("rest", "box", "lower"),
    ],
    # Lowers, is lifted, is a slope, is what it bounces on.
    "lifts": [
        ("lowered", "hand", "box"),
        ("lifted", "box", "hand"),
        ("uphill", "ramp", "ball"),
        ("bounce", "floor", "ball"),
        ("rest", "lower", "box"),
    ],
    "lowers": [
        ("lifted", "hand", "box"),
        ("lowered", "box", "hand"),
        ("drop", "floor", "ball"),
        ("toss", "hand", "box"),
        ("rest", "lower", "box"),
    ],
    # Lifts, hits, is thrown, bounces it off.
    "throws": [
        ("lowered", "hand", "box"),
        ("hit", "hitter", "box"),
        ("toss", "box", "hand"),
        ("bounce", "floor", "ball"),
        ("rest", "lower", "box"),
    ],
    # Touches and would stay without it, stops by itself where it touches, has it lean on itself, lies on it, moves along it.
    "rests_against": [
        ("beside", "box", "wall"),
        ("reaches", "box", "wall"),
        ("meets", "wall", "box"),
        ("lean", "wall", "plank"),
        ("lean", "plank", "floor"),
        ("rest", "box", "lower"),
        ("parked", "cart", "block"),
        ("wedged", "cart", "ramp"),
        ("wedged", "cart", "fl"),
    ],
    # Still and driven by nothing, driven and not held by it, held by friction alone, roles exchanged.
    "jams": [
        ("beside", "box", "wall"),
        ("shove", "box", "floor"),
        ("jam", "box", "floor"),
        ("jam", "wall", "box"),
        ("rest", "box", "lower"),
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


@pytest.mark.parametrize(
    ("kind", "world", "entity", "broken", "kept"),
    [
        ("tips", "rock", "slab", "way of that edge around it over its turn", "centre below its highest place"),
        ("tips", "downhill", "ball", "way of that edge around it over its turn", "turned over one edge"),
        ("rolls", "slip", "ball", "slip over the way since it rolls", "turned while it touches"),
        ("slides", "roll", "ball", "slip over the way of its centre", "borne by it"),
    ],
)
def test_an_event_that_does_not_happen_tells_which_of_its_conditions_broke(
    judged: Any, kind: str, world: str, entity: str, broken: str, kept: str
) -> None:
    """By where it came furthest: what each condition measured, what it needs, and which failed first at which frame."""
    outcome = judged(world, kind, entity)
    conditions = {c["condition"]: c for c in outcome.details["conditions"]}
    assert not conditions[broken]["holds"]
    assert conditions[kept]["holds"]
    assert f"{broken} {conditions[broken]['measured']:.3g}" in outcome.explanation
    assert not conditions[outcome.details["failed_first"]]["holds"]
    assert 1 <= outcome.details["failed_first_frame"] <= outcome.details["conditions_frame"]
    assert f"First to fail, at frame {outcome.details['failed_first_frame']}: " in outcome.explanation


def test_an_event_that_happens_tells_nothing_of_conditions(judged: Any) -> None:
    outcome = judged("topple", "tips", "slab")
    assert outcome.status == "pass"
    assert "conditions" not in outcome.details


@pytest.mark.parametrize("kind", [k for k, info in EVENT_KINDS.items() if k in EVENTS])
def test_every_kind_has_a_world_in_which_it_is_true_and_two_in_which_it_is_not(kind: str) -> None:
    assert TRUE[kind]
    assert len(FALSE[kind]) >= 2
    assert {c[0] for c in FALSE[kind]} & {"rest", "held", "hang"}, "a body that rests throughout"


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


COMPARED = [
    ({"a": "ball", "b": "floor", "quantity": "height", "relation": "more", "margin": 1.0}, "pass", 1.2),
    ({"a": "floor", "b": "ball", "quantity": "height", "relation": "more", "margin": 1.0}, "fail", -0.2),
    ({"a": "floor", "b": "ball", "quantity": "height", "relation": "less", "margin": 1.0}, "pass", -1.2),
    ({"a": "ball", "b": "floor", "quantity": "speed", "relation": "more", "margin": 4.0}, "pass", 4.3),
    ({"a": "ball", "b": "floor", "quantity": "tilt", "relation": "same", "margin": 0.1}, "pass", 0.0),
    ({"a": "floor", "b": "ball", "quantity": "size", "relation": "more", "margin": 1.0}, "pass", 19.8),
    ({"a": "ball", "b": "floor", "quantity": "mass", "relation": "less", "margin": 1.0}, "pass", -48000.0),
    ({"a": "ball", "b": "floor", "quantity": "distance_to", "target": "floor", "relation": "more", "margin": 1.0}, "pass", 1.2),
]


@pytest.mark.parametrize(("asked", "status", "value"), COMPARED)
def test_two_measurements_are_compared_with_a_margin(tmp_path: Any, asked: dict[str, Any], status: str, value: float) -> None:
    outcome = evaluate(copied(film("drop")).candidate(tmp_path), Compares(**asked), (0, 35))
    assert outcome.status == status, outcome.explanation
    assert outcome.value == pytest.approx(value, rel=0.05, abs=0.02)


def test_a_comparison_says_from_whom_a_distance_is_and_not_with_itself(tmp_path: Any) -> None:
    same: dict[str, Any] = {"a": "ball", "b": "ball", "quantity": "height", "relation": "more", "margin": 1.0}
    assert evaluate(copied(film("drop")).candidate(tmp_path), Compares(**same), (0, 35)).status == "unverified"
    for wrong in ({"quantity": "distance_to"}, {"target": "floor"}):
        with pytest.raises(ValueError, match="give target"):
            Compares(**{**same, **wrong})


def test_what_a_slide_opens_is_not_told_by_surfaces(tmp_path: Any) -> None:
    base = event_world("door_opens")
    slide = SlideJoint(parent="frame", child="door", anchor=(0, 0, 1), axis=(1, 0, 0))
    spec = base.model_copy(update={"simulation": base.simulation.model_copy(update={"joints": {"slide": slide}})})
    outcome = evaluate(copied(film_of(spec)).candidate(tmp_path), event("opens", "door"), (0, 35))
    assert outcome.status == "unverified"
    assert "joint_angle" in outcome.explanation


@pytest.mark.parametrize(("world", "kind"), [("door_opens", "opens"), ("door_closes", "closes")])
def test_a_door_over_a_floor_that_is_of_one_body_with_its_frame_opens_and_closes(world: str, kind: str, tmp_path: Any) -> None:
    """The lower end of its free edge is near that floor however it stands."""
    base = event_world(world)
    sill = Part(shape=Box(size=(3.0, 3.0, 0.02)), pose=pose((0.43, 0, -0.915)))
    frame = base.entities["frame"]
    room = frame.model_copy(update={
        "parts": {**frame.parts, "sill": sill}, "dimensions": frame.dimensions.model_copy(update={"size": (3.0, 3.0, 2.0)}),
    })  # fmt: skip
    spec = base.model_copy(update={"entities": {**base.entities, "frame": room}})
    other = {"opens": "closes", "closes": "opens"}[kind]
    candidate = copied(film_of(spec)).candidate(tmp_path)
    outcome = evaluate(candidate, event(kind, "door"), (0, candidate.last_frame))
    assert outcome.status == "pass", outcome.explanation
    assert evaluate(candidate, event(other, "door"), (0, candidate.last_frame)).status == "fail"


def test_a_body_that_a_rope_entity_holds_is_pulled_through_it(tmp_path: Any) -> None:
    candidate = copied(film("towed")).candidate(tmp_path)
    outcome = evaluate(candidate, event("pulls", "hand", "box"), (0, candidate.last_frame))
    assert outcome.status == "pass", outcome.explanation
    assert outcome.details["by"] == ["joint"]
    assert evaluate(candidate, event("rolls", "line"), (0, candidate.last_frame)).status == "unverified", "a rope is many bodies"


def test_events_are_found_within_a_predicate_but_not_below_a_not() -> None:
    from worldagent.worlds.predicates import And, Count, Eventually, Not, Speed

    falls = event("falls", "each")
    held = And(of=[Count(entities=["a", "b"], min=2, predicate=falls), Speed(entity="a", min=1.0)])
    assert event_atoms(Eventually(predicate=held)) == [falls]
    assert event_atoms(Not(predicate=falls)) == []


def test_each_of_a_count_stands_for_whom_a_comparison_is_about_and_to_whom() -> None:
    asked: dict[str, Any] = {"quantity": "distance_to", "relation": "more", "margin": 1.0}
    made = substitute(Compares(a="ball", b="each", target="each", **asked), "box")
    assert made == Compares(a="ball", b="box", target="box", **asked)
    assert substitute(event("hits", "hand", "each"), "box") == event("hits", "hand", "box")


@pytest.mark.parametrize("fps", [24, 120])
def test_a_small_slow_ball_rolls_at_any_rate_of_frames(fps: int, tmp_path: Any) -> None:
    """A marble that rolled fifteen radians at a quarter of a metre per second did not count as rolling at 50 frames a second."""
    radius, speed = 0.015, 0.12
    rolling = ball(radius, motion="dynamic", at=(0, 0, radius + 1e-3), velocity=(speed, 0, 0))
    spinning = rolling.model_copy(
        update={"physics": rolling.physics.model_copy(update={"angular_velocity": (0, speed / radius, 0)})}
    )
    spec = world({"floor": ground(), "marble": spinning}, frames=2 * fps, fps=fps)
    candidate = film_of(spec).candidate(tmp_path)
    outcome = evaluate(candidate, event("rolls", "marble", "floor"), (0, candidate.last_frame))
    assert outcome.status == "pass", outcome.explanation
    assert outcome.value == pytest.approx(2 * speed / radius, rel=0.1)
    slides = evaluate(candidate, event("slides", "marble", "floor"), (0, candidate.last_frame))
    assert slides.status == "fail"
