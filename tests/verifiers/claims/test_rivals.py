"""Rivals of every kind of event of bodies, on its forged motion: none is true of it, and where one is the truth it is found and voids the claim.

Which rivals a kind has follows from what it is (`unmade`); kinds of matter are in `test_rivals_of_matter.py`.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest
from pydantic import TypeAdapter
from worldagent.tests.verifiers.claims.claimed import claimed
from worldagent.verifiers.claims.check import check
from worldagent.verifiers.claims.rivals import AT_REST, rivals_of
from worldagent.verifiers.forged.bodies import BLOCK, BODIES
from worldagent.verifiers.forged.places import PLACES
from worldagent.verifiers.predicates.evaluators import evaluate
from worldagent.verifiers.predicates.events import EVENTS
from worldagent.verifiers.story.vacuity import check_vacuity
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Predicate
from worldagent.worlds.predicates.events import EVENT_KINDS
from worldagent.worlds.spec import Fastened

DIRECTED = [kind for kind in EVENTS if EVENT_KINDS[kind].directed]
PLACED: dict[str, dict[str, Any]] = {
    "crosses": {"entity": "it", "point": (3, 1, 0), "normal": (0, 1, 1)},
    "topples": {"entity": "it"},
    "contact": {"a": "it", "b": "other"},
}
"""Fields of kinds of which no ledger tells, on motions of the same stage."""
KINDS = (*EVENTS, *PLACED)
model: Any = TypeAdapter(Predicate).validate_python
CLAIM = {"e": {"quote": "it happens", "type": "event", "by": ["/story/beats/b"]}}


def unmade(kind: str) -> dict[str, str]:
    """Rivals that a kind has none of by what it is, with the reason."""
    why = {}
    if not EVENT_KINDS[kind].directed:
        why["roles swapped"] = "nobody does it to another"
    if "entity" not in type(model(told(kind))).model_fields:
        why["rests throughout"] = "both do it to each other, and what touches may well rest"
    elif kind in AT_REST:
        why["rests throughout"] = "by its definition what rests may do it"
    if kind not in EVENTS:
        why["before frame"] = "no ledger tells of it: `beat:vacuous` asks it instead"
    return why


def staged(kind: str, predicate: Any, *, frames: tuple[int, int] | None = None, **more: Any) -> Candidate:
    """The forged motion of a kind, with a beat, a claim of it and somebody who rests."""
    stage = BODIES[kind]() if kind in BODIES else PLACES[kind](BODIES["falls"]().open().spec, model(told(kind)))
    stage.add("witness", BLOCK, (9, 9, 0), motion="static")
    candidate = stage.open()
    beat = {"owner": "stage", "subject": "it", "predicate": predicate, "frames": list(frames or (0, candidate.last_frame))}
    return dataclasses.replace(candidate, spec=claimed(candidate.spec, CLAIM, beats={"b": beat}, **more))


def told(kind: str, entity: str = "it", other: str = "other") -> dict[str, Any]:
    if kind in PLACED:
        return {"kind": kind, **PLACED[kind]}
    asks = {"kind": kind, "entity": entity}
    return {**asks, "other": other} if EVENT_KINDS[kind].directed else asks


def row(candidate: Candidate) -> Any:
    (found,) = check(candidate)
    return found


def either(*predicates: dict[str, Any]) -> dict[str, Any]:
    return {"kind": "or", "of": list(predicates)}


@pytest.mark.parametrize("kind", KINDS)
def test_no_rival_of_a_kind_is_true_of_its_motion(kind: str) -> None:
    candidate = staged(kind, told(kind))
    found = row(candidate)
    assert found.status == "pass", found.evidence
    texts = found.evidence["rivals"]
    for rival in ("roles swapped", "rests throughout"):
        assert any(rival in t for t in texts) == (rival not in unmade(kind)), (rival, unmade(kind))
    assert ("entity=witness" in str(texts)) == ("rests throughout" not in unmade(kind))


@pytest.mark.parametrize("kind", DIRECTED)
def test_roles_swapped_are_found_where_they_are_the_truth(kind: str) -> None:
    turned = staged(kind, told(kind, "other", "it"))
    assert row(turned).status == "fail"
    (swapped,) = [r for r in rivals_of(turned, "b") if "roles swapped" in r.text]
    assert evaluate(turned, swapped.predicate, swapped.frames).status == "pass"
    void = row(staged(kind, either(told(kind), told(kind, "other", "it"))))
    assert void.status == "fail"
    assert any("roles swapped" in t for t in void.evidence["true_rivals"])


@pytest.mark.parametrize("kind", [k for k in KINDS if "rests throughout" not in unmade(k)])
def test_a_body_at_rest_is_found_where_the_same_is_true_of_it(kind: str) -> None:
    # Whoever rests meets one of two branches: that it does the event, or that it lies where it lay.
    lies = {"kind": "displacement", "entity": "it", "max": 1e-6, "when": "always"}
    void = row(staged(kind, either(told(kind), lies)))
    assert void.status == "fail"
    assert any("entity=witness" in t for t in void.evidence["true_rivals"])


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_before_its_onset_is_found(kind: str) -> None:
    honest = staged(kind, told(kind))
    first = evaluate(honest, honest.spec.story.beats["b"].predicate, (0, honest.last_frame)).first_true_frame
    assert first is not None
    assert [r.status for r in check_vacuity(honest, "b")] == ["pass"]
    assert not [r for r in rivals_of(honest, "b") if "before frame" in r.text]
    late = staged(kind, told(kind), frames=(first + 1, honest.last_frame)) if first < honest.last_frame else None
    if late is None:
        return
    # One that goes on is true in its interval as well, and void.
    goes_on = evaluate(late, late.spec.story.beats["b"].predicate, (first + 1, late.last_frame)).status == "pass"
    found = row(late)
    befores = [r for r in rivals_of(late, "b") if "before frame" in r.text]
    if "before frame" in unmade(kind):
        assert not befores
        assert [r.status for r in check_vacuity(late, "b")] == ["fail"] if goes_on else found.status == "fail"
        return
    (before,) = befores
    assert evaluate(late, before.predicate, before.frames).status == "pass"
    assert found.status == "fail"
    assert not goes_on or any("before frame" in t for t in found.evidence["true_rivals"])


def test_an_earlier_time_that_another_beat_tells_of_is_no_rival() -> None:
    candidate = staged("pushes", told("pushes"), frames=(12, 24))
    assert row(candidate).status == "fail"
    beats = {
        "b": {"owner": "stage", "subject": "it", "predicate": told("pushes"), "frames": [12, 24]},
        "a": {"owner": "stage", "subject": "it", "predicate": told("pushes"), "frames": [0, 11]},
    }
    told_twice = dataclasses.replace(candidate, spec=claimed(candidate.spec, CLAIM, beats=beats))
    assert row(told_twice).status == "pass"


def test_what_is_fastened_to_who_does_it_is_no_rival() -> None:
    glued = Fastened(a="it", b="witness", max_depth=0.01, reason="they are glued together")
    candidate = staged("falls", told("falls"), graph={"relations": {"glue": glued.model_dump(mode="json")}})
    assert rivals_of(candidate, "b")
    assert not [r for r in rivals_of(candidate, "b") if "entity=witness" in r.text]


def test_who_does_it_is_asked_and_not_the_subject_of_the_beat() -> None:
    candidate = staged("hits", told("hits"))
    beat = candidate.spec.story.beats["b"].model_copy(update={"subject": "other"})
    story = candidate.spec.story.model_copy(update={"beats": {"b": beat}})
    other = dataclasses.replace(candidate, spec=candidate.spec.model_copy(update={"story": story}))
    assert any("entity=witness" in r.text for r in rivals_of(other, "b"))
