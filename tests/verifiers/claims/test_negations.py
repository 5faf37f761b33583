"""Claims of a negation: what is denied is told where it happens, and where it could not happen at all."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from pydantic import TypeAdapter
from worldagent.testing.worlds.event_worlds import event_world
from worldagent.tests.verifiers.claims.claimed import candidate_of, claimed, rows
from worldagent.tests.verifiers.predicates.test_body_events import FALSE, TRUE
from worldagent.verifiers.forged.bodies import BODIES
from worldagent.verifiers.forged.trial import forged_outcome, is_forged
from worldagent.verifiers.predicates.events import EVENTS
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.predicates.models import Predicate

DENIED = {"no": {"quote": "never", "type": "negation", "by": ["/story/requirements/no"]}}
model: Any = TypeAdapter(Predicate).validate_python


def denied(folder: Path, world: str, predicate: Any, **claims: Any) -> Any:
    requirements = {"no": {"predicate": predicate, "never": True}}
    return rows(folder, world, {**DENIED, **claims}, requirements=requirements)["no"]


def atom(kind: str, entity: str, other: str | None = None, **more: Any) -> dict[str, Any]:
    return {"kind": kind, "entity": entity, **({"other": other} if other else {}), **more}


@pytest.mark.parametrize("kind", EVENTS)
def test_a_kind_that_happens_cannot_be_denied_and_one_that_does_not_can(kind: str, tmp_path: Path) -> None:
    """By kind: the world in which the positive is true voids the negation; where it is not, the negation holds and is not vacuous."""
    row = denied(tmp_path / "true", TRUE[kind][0][0], atom(kind, *TRUE[kind][0][1:]))
    assert row.status == "fail"
    assert ", but " in row.evidence["explanation"]
    name, *who = next(c for c in FALSE[kind] if c[0] in ("rest", "held", "hang", "fixed", "slip", "slide", "hit", "lifted"))
    row = denied(tmp_path / "false", name, atom(kind, *who))
    assert (row.status, row.evidence["vacuous"]) == ("pass", {}), row.evidence


@pytest.mark.parametrize("kind", EVENTS)
def test_a_bound_beyond_a_plain_one_says_more_than_the_words(kind: str, tmp_path: Path) -> None:
    name, *who = next(c for c in FALSE[kind] if c[0] in ("rest", "held", "hang", "fixed", "slip", "slide", "hit", "lifted"))
    row = denied(tmp_path / "more", name, atom(kind, *who, min=1e6))
    assert row.status == "fail"
    assert "denies by 'no' what is more than its words" in row.evidence["explanation"]
    # A bound that the prompt quotes is its own.
    at = "/story/requirements/no/predicate/min"
    quoted = {"q": {"quote": "a thousand kilometres", "type": "quantity", "by": [at]}}
    assert denied(tmp_path / "quoted", name, atom(kind, *who, min=1e6), **quoted).status == "pass"


def test_a_forged_motion_stands_for_every_kind_of_bodies() -> None:
    assert set(EVENTS) <= set(BODIES)


PLACED: list[tuple[dict[str, Any], bool]] = [
    ({"kind": "contact", "a": "ball", "b": "floor"}, True),
    ({"kind": "contact", "a": "ball", "b": "floor", "min_impulse": 10.0}, False),
    ({"kind": "topples", "entity": "ball"}, True),
    ({"kind": "topples", "entity": "ball", "min_angle": 3.0}, False),
    ({"kind": "tilts", "entity": "ball", "axis": [1, 2, 0], "min": 0.5}, True),
    ({"kind": "tilts", "entity": "ball", "axis": [0, 1, 0], "min": 1.5}, False),
    ({"kind": "speed", "entity": "ball", "min": 0.1}, True),
    ({"kind": "speed", "entity": "ball", "min": 50.0}, False),
    ({"kind": "displacement", "entity": "ball", "min": 0.1}, True),
    ({"kind": "displacement", "entity": "ball", "axis": [0, 0, 1], "max": -0.2}, True),
    ({"kind": "displacement", "entity": "ball", "axis": [0, 0, 1], "max": -2.0}, False),
    ({"kind": "crosses", "entity": "ball", "point": [3, 1, 0], "normal": [0, 1, 1]}, True),
    ({"kind": "reaches", "entity": "ball", "region": "wide"}, True),
    ({"kind": "reaches", "entity": "ball", "region": "wide", "measure": "surface"}, True),
    ({"kind": "reaches", "entity": "ball", "region": "thin", "measure": "surface"}, False),
    ({"kind": "separation", "a": "ball", "b": "floor", "max": 0.01, "when": "eventually"}, True),
    ({"kind": "separation", "a": "ball", "b": "floor", "min": 0.2, "when": "eventually"}, True),
    ({"kind": "separation", "a": "ball", "b": "floor", "min": 9.0, "when": "eventually"}, False),
    ({"kind": "rests_on", "entity": "ball", "on": "floor"}, True),
]
REGIONS = {
    "wide": {"kind": "box", "min": [-1, -1, 0], "max": [1, 1, 1]},
    "thin": {"kind": "cylinder", "center": [0, 0, 1], "radius": 0.05, "height": 2.0},
}


@pytest.mark.parametrize(("predicate", "can"), PLACED, ids=[f"{p['kind']}-{k}" for k, (p, _) in enumerate(PLACED)])
def test_other_predicates_are_tried_at_their_own_place(predicate: dict[str, Any], can: bool, tmp_path: Path) -> None:
    spec = event_world("drop")
    candidate = candidate_of(tmp_path, spec, DENIED, requirements={"no": {"predicate": predicate, "never": True}}, graph={"regions": REGIONS})  # fmt: skip
    assert is_forged(predicate["kind"])
    assert forged_outcome(candidate, model(predicate)).status == ("pass" if can else "fail")


def test_bounds_grow_with_the_body(tmp_path: Path) -> None:
    """A ball of 0.1 m plainly falls 0.3 m and no metre; one of a metre falls more than that."""
    for radius, can in ((0.1, False), (0.5, True)):
        spec = event_world("drop")
        contract = spec.entities["ball"].model_copy(
            update={"dimensions": spec.entities["ball"].dimensions.model_copy(update={"size": (2 * radius,) * 3})}
        )
        big = spec.model_copy(update={"entities": {**spec.entities, "ball": contract}})
        candidate = candidate_of(tmp_path / str(radius), big, DENIED, requirements={"no": {"predicate": atom("falls", "ball"), "never": True}})  # fmt: skip
        assert (forged_outcome(candidate, model(atom("falls", "ball", min=1.0))).status == "pass") is can


def test_members_are_tried_one_by_one(tmp_path: Path) -> None:
    high, low = atom("falls", "box", min=1e6), atom("falls", "box")
    assert denied(tmp_path / "either", "rest", {"kind": "or", "of": [high, low]}).status == "pass"
    assert denied(tmp_path / "both", "rest", {"kind": "and", "of": [high, low]}).status == "fail"
    many = {"kind": "count", "entities": ["box", "lower"], "predicate": {**low, "entity": "each"}}
    assert denied(tmp_path / "two", "rest", {**many, "min": 2}).status == "pass"
    assert denied(tmp_path / "three", "rest", {**many, "min": 3}).status == "fail"


COULD: dict[str, tuple[str, Any, str]] = {
    "what is static falls": ("rest", atom("falls", "floor"), "'floor' is static"),
    "what is static is pushed": ("rest", atom("pushes", "box", "floor"), "'floor' is static"),
    "two static ones touch": ("lean", {"kind": "contact", "a": "wall", "b": "floor"}, "are both static"),
    "what has no hinge opens": ("rest", atom("opens", "box"), "no joint holds 'box'"),
    "what nothing holds comes loose": ("rest", atom("comes_loose", "box"), "no joint holds 'box'"),
    "what has no pieces breaks": ("drop", atom("breaks", "ball"), "no pieces into which it could break"),
    "more than there are": (
        "rest",
        {"kind": "count", "entities": ["box"], "predicate": atom("falls", "each"), "min": 2},
        "2 of 1 entities",
    ),
}
CAN: dict[str, tuple[str, Any]] = {
    "a body falls": ("rest", atom("falls", "box")),
    "a ball hits the floor": ("drop", atom("hits", "ball", "floor")),
    "a door opens": ("door_moves", atom("opens", "door")),
    "it or the floor falls": ("rest", {"kind": "or", "of": [atom("falls", "floor"), atom("falls", "box")]}),
    "a weld opens": ("fixed", atom("comes_loose", "box")),
}


@pytest.mark.parametrize("name", [*COULD, *CAN])
def test_the_audit_refuses_to_deny_what_cannot_happen(name: str) -> None:
    world, predicate, said = COULD[name] if name in COULD else (*CAN[name], "")
    spec = claimed(event_world(world), DENIED, requirements={"no": {"predicate": predicate, "never": True}})
    found = [p.text for p in claim_problems(spec) if p.pointer == "/story/requirements/no/predicate"]
    assert any("denies what cannot happen" in t and said in t for t in found) if said else found == []


def test_what_is_denied_of_a_body_may_not_happen_to_one_that_looks_the_same_and_that_no_claim_speaks_of(tmp_path: Path) -> None:
    """A box hits another, and the prompt says that it never touches the box: a third one far off is claimed in its place."""
    document = event_world("hit").model_dump(mode="json")
    decoy = {**document["entities"]["box"], "pose": {"position": [5.0, 5.0, document["entities"]["box"]["pose"]["position"][2]]}}
    document["entities"]["decoy"] = decoy
    document["simulation"]["solvers"]["rigid"]["members"].append("decoy")
    touches = {"kind": "contact", "a": "hitter", "b": "decoy"}
    things = {n: {"quote": n, "type": "thing", "by": [f"/entities/{n}"]} for n in ("hitter", "decoy")}
    spec = parse_spec(document)
    requirements = {"no": {"predicate": touches, "never": True}}

    def row(folder: str, more: Any) -> Any:
        return rows(tmp_path / folder, spec, {**DENIED, **things, **more}, requirements=requirements)["no"]

    found = row("dishonest", {})
    assert found.status == "fail"
    assert "'box' looks the same as 'decoy', no claim speaks of it" in found.evidence["explanation"]
    honest = row("honest", {"box": {"quote": "box", "type": "thing", "by": ["/entities/box"]}})
    assert honest.status == "pass", honest.evidence
