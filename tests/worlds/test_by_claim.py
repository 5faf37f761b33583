"""Worlds of one prompt are compared by claim, whatever their ids are (R157)."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Any

import pytest
from worldagent.tests.stories.small_run import MARKED, PROMPT, small_spec
from worldagent.tests.worlds.audits.test_claims import FALLS
from worldagent.worlds.by_claim import easier_by_claim
from worldagent.worlds.claim_marks import claim_operations
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.spec import WorldSpec

ROLLS = {"kind": "rolls", "entity": "ball"}

Edit = Callable[[dict[str, Any]], None]
OTHER_IDS = {
    "ball": "kugel", "b1": "b3", "b3": "b1", "shelf": "board", "roll": "opening", "fall": "ending", "steel": "iron", "rigid": "engine",
    "ball_on_shelf": "r1", "only": "whole",
}  # fmt: skip
"""Other ids of the small world; two of its blocks change theirs."""


def world(
    edit: Edit = lambda _: None, *, ids: dict[str, str] | None = None, marked: str = MARKED, prompt: str = PROMPT
) -> WorldSpec:
    """The small world with its claims, edited, then with other ids."""
    spec = small_spec(clauses={})
    spec["story"]["beats"]["roll"]["predicate"] = dict(ROLLS)
    spec["story"]["beats"]["fall"]["predicate"] = dict(FALLS)
    edit(spec)
    ids = ids or {}
    for old, new in ids.items():  # in two steps, since two of them change places
        marked = re.sub(rf"(?<=[ =]){old}(?=[ )])", f"@{new}", marked)
    text = json.dumps(spec)
    for old, new in ids.items():
        text = text.replace(f'"{old}"', f'"@{new}"')
    spec = json.loads(text.replace('"substance": "@iron"', '"substance": "steel"').replace("@", ""))
    for entity in (e for e in spec["entities"].values() if "physics" in e):
        entity["physics"]["category"] = "rigid"
    parsed = WorldSpec.model_validate({**spec, "prompt": prompt, "spec_version": "2"})
    return apply_patch(parsed, claim_operations(marked.replace("@", ""), parsed))


def at(pointer: str, value: Any) -> Edit:
    def edit(spec: dict[str, Any]) -> None:
        *path, last = pointer.split("/")[1:]
        place: Any = spec
        for token in path:
            place = place.setdefault(token, {})
        place[last] = value

    return edit


def test_other_ids_make_no_world_easier() -> None:
    assert easier_by_claim(world(), world(ids=OTHER_IDS)) == []


def test_what_a_claimed_relation_holds_to_is_the_same_where_no_claim_names_it() -> None:
    """A kerb that only a relation of the claim names: it was compared with a copy of itself under another id."""

    def beside(spec: dict[str, Any]) -> None:
        spec["entities"]["kerb"] = json.loads(json.dumps(spec["entities"]["shelf"]))
        spec["graph"]["relations"]["ball_on_shelf"]["a"] = "kerb"

    marked = MARKED.replace("into a row of", "[into](place ball_on_shelf) a row of")
    one = world(beside, marked=marked)
    assert "/graph/relations/ball_on_shelf" in one.claims["into"].by
    assert "/entities/kerb" not in [n for c in one.claims.values() for n in c.by]
    assert easier_by_claim(one, world(beside, marked=marked)) == []


WEAKER: dict[str, tuple[Edit, str]] = {
    "a lighter body": (
        at("/entities/b3/physics", {"category": "rigid", "mass": 0.01}),
        "/entities/b3/physics/mass default -> 0.01",
    ),
    "another substance": (at("/materials/steel/density", 100.0), "/materials/steel/density 7850 -> 100"),
    "a longer interval": (at("/story/beats/fall/frames", [4, 30]), "/story/beats/fall/frames"),
    "less of an event": (at("/story/beats/roll/predicate/entity", "b1"), "/story/beats/roll/predicate loosened or replaced"),
    "an optional beat": (at("/story/beats/fall/mandatory", False), "/story/beats/fall made optional"),
    "no cause": (at("/story/beats/fall/causes", []), "/story/beats/fall/causes lost"),
    "a body on a path": (at("/entities/b3/motion", "static"), "/entities/b3/motion dynamic -> static"),
    "other gravity": (at("/simulation/gravity", [0, 0, -5.0]), "/simulation/gravity"),
}


@pytest.mark.parametrize("what", WEAKER)
def test_what_became_easier_is_found_under_any_ids(what: str) -> None:
    edit, line = WEAKER[what]
    for ids in ({}, OTHER_IDS):
        found = easier_by_claim(world(), world(edit, ids=ids))
        assert len(found) == 1, found
        assert found[0].startswith(line)


def test_a_beat_that_comes_later_and_dressing_that_is_lighter_are_no_weakening() -> None:
    later = at("/story/beats/roll/frames", [10, 16])
    assert easier_by_claim(world(), world(later, ids=OTHER_IDS)) == []
    crate = small_spec()["entities"]["b1"] | {"pose": {"position": [2.0, 0, 0.1]}}
    heavy, light = (world(at("/entities/crate", crate | {"physics": {"category": "rigid", "mass": m}})) for m in (2.0, 0.1))
    assert easier_by_claim(heavy, light) == []


def test_claims_are_matched_by_their_words() -> None:
    gone = MARKED.replace("[falls off](event fall)", "falls off")
    assert easier_by_claim(world(), world(marked=gone)) == ["claim of 'falls off' dropped: these words are filler"]
    shorter = MARKED.replace("[falls off](event fall)", "[falls](event fall) off")
    assert easier_by_claim(world(), world(marked=shorter, ids=OTHER_IDS)) == []
    waived = MARKED.replace("[falls off](event fall)", '[falls off](waived because="nobody sees it")')
    assert easier_by_claim(world(), world(marked=waived)) == ["claim of 'falls off' waived: nobody sees it"]
    thing = MARKED.replace("[three](count b1 b2 b3)", "[three](thing b1 b2 b3 same_as=blocks)")
    assert easier_by_claim(world(), world(marked=thing)) == ["claim of 'three' is thing, was count"]


def test_a_prompt_that_is_written_otherwise_is_matched_word_by_word() -> None:
    marked, prompt = f"Please: {MARKED}", f"Please: {PROMPT}"
    edit, line = WEAKER["a lighter body"]
    (found,) = easier_by_claim(world(), world(edit, marked=marked, prompt=prompt, ids=OTHER_IDS))
    assert found.startswith(line)


def test_roles_that_are_swapped_are_found() -> None:
    hits = {"kind": "hits", "entity": "ball", "other": "b1"}
    swapped = {"kind": "hits", "entity": "b1", "other": "ball"}
    one, other = (world(at("/story/beats/roll/predicate", p), ids=OTHER_IDS) for p in (hits, swapped))
    assert easier_by_claim(one, other) == ["/story/beats/opening/predicate loosened or replaced"]


def test_beside_a_world_without_claims_only_the_whole_is_compared() -> None:
    first = WorldSpec.model_validate({**small_spec(claims={}, spec_version="1"), "prompt": PROMPT})

    def edit(spec: dict[str, Any]) -> None:
        for one in (WEAKER["other gravity"], WEAKER["a lighter body"], WEAKER["an optional beat"]):
            one[0](spec)

    (line,) = easier_by_claim(first, world(edit))
    assert line.startswith("/simulation/gravity")


JOINTS: dict[str, dict[str, Any]] = {
    "hinge": {"axis": [0, 0, 1], "friction": 0.2},
    "slide": {"axis": [0, 0, 1]},
    "weld": {},
}


@pytest.mark.parametrize("other", JOINTS)
def test_joints_of_other_kinds_are_compared_as_far_as_they_have_the_same_fields(other: str) -> None:
    def joint(kind: str) -> Edit:
        ends = {"parent": "shelf", "child": "b3", "kind": kind, "anchor": [0, 0, 0]}
        return at("/simulation/joints/arm", {**ends, **JOINTS[kind]})

    found = easier_by_claim(world(joint("hinge")), world(joint(other), ids=OTHER_IDS))
    assert [line for line in found if "/simulation/joints/arm" not in line] == []


def test_a_pair_of_its_own_that_comes_is_found() -> None:
    pair = {"a": "b3", "b": "shelf", "friction": 0.01, "reason": "the shelf is waxed there"}
    (line,) = easier_by_claim(world(), world(at("/simulation/contacts/slick", pair), ids=OTHER_IDS))
    assert "added: friction 0.01 of b3 and shelf" in line
