"""Claims that contradict each other are an error of the audit, and claims near them that do not are none."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.worlds.small_worlds import ball, box, ground, world
from worldagent.tests.verifiers.claims.claimed import claimed
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.audits.contradictions import contradiction_problems

FALLS, ROLLS = {"kind": "falls", "entity": "ball"}, {"kind": "rolls", "entity": "ball", "other": "floor"}


def never(predicate: Any) -> dict[str, Any]:
    return {"requirements": {"no": {"predicate": predicate, "never": True}}}


def claim(kind: str, *by: str, quote: str | None = None, **more: Any) -> dict[str, Any]:
    return {"quote": quote or kind, "type": kind, "by": list(by), **more}


A, B, NO = "/story/beats/a", "/story/beats/b", "/story/requirements/no"
DENIED = {"event": claim("event", A), "negation": claim("negation", NO)}
BOTH = {"kind": "and", "of": [FALLS, ROLLS]}
EITHER = {"kind": "or", "of": [FALLS, ROLLS]}
ALL = {
    "kind": "count",
    "entities": ["ball", "box"],
    "predicate": {"kind": "falls", "entity": "each"},
    "min": 2,
}
TOUCH = {"kind": "contact", "a": "ball", "b": "box"}


def told(predicate: Any) -> dict[str, Any]:
    return {"beats": {"a": {"subject": "ball", "predicate": predicate}}}


ORDERED = {"beats": {"a": ("ball", FALLS), "b": ("ball", ROLLS)}}
THEN = {"then": claim("order", A, B, quote="then")}
TURNED = {**THEN, "first": claim("order", B, A, quote="first")}
BEFORE = {"r": {"predicate": {"kind": "before", "beat": "a", "predicate": ROLLS}}}
INSIDE = {**THEN, "first": claim("order", "/story/requirements/r", quote="first")}
TWO = claim("count", "/entities/ball", "/entities/box", quote="two")
SIZE = "/entities/box/dimensions/size/0"

CONTRADICT: dict[str, tuple[dict[str, Any], dict[str, Any], str]] = {
    "an event and its negation": (DENIED, {**told(FALLS), **never(FALLS)}, "/claims/event/by"),
    "one of two events": (DENIED, {**told(BOTH), **never(FALLS)}, "/claims/event/by"),
    "one of two negations": (DENIED, {**told(FALLS), **never(EITHER)}, "/claims/event/by"),
    "more than what is denied": (DENIED, {**told({**FALLS, "min": 2.0}), **never({**FALLS, "min": 1.0})}, "/claims/event/by"),
    "on somebody and on anybody": (DENIED, {**told(ROLLS), **never({"kind": "rolls", "entity": "ball"})}, "/claims/event/by"),
    "of all and of one": (DENIED, {**told(ALL), **never(FALLS)}, "/claims/event/by"),
    "a touch the other way round": (DENIED, {**told(TOUCH), **never({**TOUCH, "a": "box", "b": "ball"})}, "/claims/event/by"),
    "an order and its reverse": (TURNED, ORDERED, "/claims/then/by"),
    "an order and its reverse inside a requirement": (INSIDE, {**ORDERED, "requirements": BEFORE}, "/claims/then/by"),
    "an order for which the frames leave no room": (
        THEN, {"beats": {"a": {"subject": "ball", "predicate": FALLS, "frames": [9, 12]}, "b": {"subject": "ball", "predicate": ROLLS, "frames": [2, 9]}}}, "/claims/then/by"),
    "two numbers of the same": ({"two": TWO, "three": {**TWO, "quote": "three"}}, {}, "/claims/three/by"),
    "another number of the same": ({"two": TWO, "three": {"quote": "three", "type": "count", "same_as": "two"}}, {}, "/claims/three/by"),
    "two sizes": ({"a": claim("quantity", SIZE, quote="2 m"), "b": claim("quantity", SIZE, quote="30 cm")}, {}, "/claims/b/by"),
    "a size and a mass": ({"a": claim("quantity", SIZE, quote="2 m"), "b": claim("quantity", SIZE, quote="2 kg")}, {}, "/claims/b/by"),
    "two materials": (
        {"a": claim("property", "/entities/box", quote="wooden"), "b": claim("property", "/entities/box", quote="steel")}, {}, "/claims/b/by"),
}  # fmt: skip
AGREE: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "a negation of another": (DENIED, {**told(FALLS), **never({**FALLS, "entity": "box"})}),
    "a negation of another kind": (DENIED, {**told(FALLS), **never(ROLLS)}),
    "a negation of more": (DENIED, {**told(FALLS), **never({**FALLS, "min": 1.0})}),
    "a negation of both at once": (DENIED, {**told(FALLS), **never(BOTH)}),
    "one of two that may happen": (DENIED, {**told(EITHER), **never(FALLS)}),
    "on anybody and on somebody": (DENIED, {**told({"kind": "rolls", "entity": "ball"}), **never({**ROLLS, "other": "box"})}),
    "one order": (THEN, ORDERED),
    "the same number twice": ({"two": TWO, "both": {"quote": "two", "nth": 2, "type": "count", "same_as": "two"}}, {}),
    "sizes that overlap": (
        {"a": claim("quantity", SIZE, quote="2 m"), "b": claim("quantity", SIZE, quote="at least 1 m")}, {}),
    "materials of two things": (
        {"a": claim("property", "/entities/ball", quote="wooden"), "b": claim("property", "/entities/box", quote="steel")}, {}),
    "a metal and iron": (
        {"a": claim("property", "/entities/box", quote="metal"), "b": claim("property", "/entities/box", quote="iron")}, {}),
}  # fmt: skip


def spec(claims: dict[str, Any], more: dict[str, Any]) -> Any:
    bodies = {"ball": ball(0.1, motion="dynamic", at=(0, 0, 1)), "box": box(0.2, 0.2, 0.2, motion="dynamic", at=(1, 0, 1))}
    return claimed(world({"floor": ground(), **bodies}, frames=24), claims, **more)


@pytest.mark.parametrize("name", CONTRADICT)
def test_claims_that_contradict_each_other_are_an_error(name: str) -> None:
    claims, more, pointer = CONTRADICT[name]
    found = spec(claims, more)
    assert pointer in [p.pointer for p in contradiction_problems(found)]
    assert set(contradiction_problems(found)) <= set(claim_problems(found))


@pytest.mark.parametrize("name", AGREE)
def test_claims_that_agree_are_none(name: str) -> None:
    assert list(contradiction_problems(spec(*AGREE[name]))) == []
