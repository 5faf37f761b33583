"""Pointers that a claim loses: what judged nothing, and what another beat or requirement stands in for, are no weakenings (R157)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.patch import apply_patch, parse_spec, weakenings
from worldagent.worlds.spec import WorldSpec

BY = "/claims/falls_off/by"
FALLS = {"kind": "falls", "entity": "b3", "min": 0.15}
LANDS = {"kind": "lands", "entity": "b3", "other": "floor"}
MORE = {"kind": "and", "of": [LANDS, FALLS]}
TRIED = {"kind": "perturbed", "beats": ["fall"], "samples": 16, "min_fraction": 0.9, "speed": 0.1}
LOST = ["claim of 'falls off' is no longer judged by /story/beats/fall"]


def world(**changes: Any) -> WorldSpec:
    return parse_spec({**small_spec(**changes), "prompt": PROMPT})


def edited(spec: WorldSpec, *operations: tuple[str, Any]) -> WorldSpec:
    return apply_patch(spec, [{"op": "add", "path": place, "value": value} for place, value in operations])


def moved(spec: WorldSpec, covers: bool = True, **change: Any) -> list[str]:
    """Weakenings of an edit by which the words are judged by a new beat, `drop`: that of the fall with some fields changed."""
    beat = {**spec.story.beats["fall"].model_dump(mode="json", exclude_none=True), **change}
    shown = [("/shots/only/covers/-", "drop")] if covers else []
    return weakenings(spec, edited(spec, ("/story/beats/drop", beat), (BY, ["/story/beats/drop"]), *shown))


def test_a_beat_that_asks_for_as_much_may_take_the_place_of_another() -> None:
    assert moved(world(), predicate=MORE) == []
    assert moved(world(), predicate=FALLS) == []
    assert moved(world(), predicate=FALLS, frames=[4, 20]) == []
    assert moved(world(), predicate=MORE, causes=["strike", "roll"]) == []


@pytest.mark.parametrize(
    "change",
    [
        {"predicate": LANDS},
        {"predicate": {"kind": "or", "of": [LANDS, FALLS]}},
        {"predicate": MORE, "frames": [4, 30]},
        {"predicate": MORE, "causes": []},
        {"predicate": MORE, "mandatory": False},
        {"predicate": MORE, "observe": False},
        {"predicate": MORE, "subject": "b2"},
        {"predicate": MORE, "margins": {"strike": {"frames": 3}}},
    ],
)
def test_one_that_asks_for_less_in_anything_may_not(change: dict[str, Any]) -> None:
    assert moved(world(), **change) == LOST


def test_it_is_shown_and_tried_where_the_other_was() -> None:
    assert moved(world(), covers=False, predicate=MORE) == LOST
    tried = edited(world(), ("/story/robustness/r", TRIED))
    assert moved(tried, predicate=MORE) == LOST
    beat = {**tried.story.beats["fall"].model_dump(mode="json", exclude_none=True), "predicate": MORE}
    both = edited(tried, ("/story/beats/drop", beat), (BY, ["/story/beats/drop"]), ("/shots/only/covers/-", "drop"),
                  ("/story/robustness/r/beats/-", "drop"))  # fmt: skip
    assert weakenings(tried, both) == []


def test_two_beats_are_not_replaced_by_one_and_one_that_judged_already_replaces_none() -> None:
    first = world().story.beats["fall"].model_dump(mode="json", exclude_none=True)
    two = edited(world(), ("/story/beats/again", first), ("/shots/only/covers/-", "again"), (f"{BY}/-", "/story/beats/again"))
    alone = edited(two, (BY, ["/story/beats/again"]))
    assert weakenings(two, alone) == LOST
    third = edited(
        two, ("/story/beats/drop", {**first, "predicate": MORE}), ("/shots/only/covers/-", "drop"), (BY, ["/story/beats/drop"])
    )
    assert weakenings(two, third) == LOST


def test_an_order_lies_in_its_two_beats_and_neither_is_replaced() -> None:
    spec = small_spec()
    order = {"quote": "falls off", "type": "order", "by": ["/story/beats/strike", "/story/beats/fall"]}
    spec["claims"]["falls_off"] = order
    before = parse_spec({**spec, "prompt": PROMPT})
    beat = {**spec["story"]["beats"]["fall"], "predicate": MORE}
    after = edited(before, ("/story/beats/drop", beat), ("/shots/only/covers/-", "drop"), (BY, ["/story/beats/strike", "/story/beats/drop"]))  # fmt: skip
    assert weakenings(before, after) == LOST


@pytest.mark.parametrize("never", [False, True])
def test_a_requirement_that_denies_more_stands_in_for_one_that_denies_less(never: bool) -> None:
    def asked(predicate: dict[str, Any]) -> dict[str, Any]:
        return {"text": "t", "predicate": predicate, "never": never}

    spec = edited(world(), ("/story/requirements/wide", asked(FALLS)), ("/story/requirements/narrow", asked(MORE)),
                  ("/claims/falls_off", {"quote": "falls off", "type": "property", "by": ["/story/requirements/wide"]}))  # fmt: skip
    narrower = edited(spec, (BY, ["/story/requirements/narrow"]))
    told = ["claim of 'falls off' is no longer judged by /story/requirements/{}"]
    assert weakenings(spec, narrower) == ([told[0].format("wide")] if never else [])
    assert weakenings(narrower, spec) == ([] if never else [told[0].format("narrow")])


def test_a_pointer_that_judged_nothing_is_taken_back_without_loss() -> None:
    shelf, pointers = "/claims/shelf/by", ["/entities/shelf", "/simulation/solvers/rigid", "/entities/plank"]
    spec = edited(world(), (shelf, pointers))
    assert weakenings(spec, edited(spec, (shelf, ["/entities/shelf"]))) == []
    assert weakenings(spec, edited(spec, (shelf, ["/entities/floor"]))) == [
        "claim of 'shelf' is no longer judged by /entities/shelf"
    ]
    assert weakenings(spec, world()) == []


def test_words_that_are_marked_anew_lose_nothing_by_a_pointer_that_judged_nothing() -> None:
    spec = edited(world(), ("/claims/shelf/by", ["/entities/shelf", "/simulation/solvers/rigid"]))
    whole = {"quote": "the shelf", "type": "thing", "by": ["/entities/shelf"]}
    assert weakenings(spec, edited(spec, ("/claims/shelf", whole))) == []
    assert weakenings(spec, edited(spec, ("/claims/shelf", {**whole, "by": ["/entities/floor"]}))) == [
        "claim of 'shelf' is no longer judged by /entities/shelf"
    ]
