"""Marked text compiled into a specification: the claims are those of an edit, and the motion stays."""

from __future__ import annotations

import pytest
from worldagent.examples.jelly_tank import CLAIMS, PROMPT, tank_of_jelly
from worldagent.worlds.claim_marks import claim_operations, claims_from, marked_claims, with_claims
from worldagent.worlds.errors import InputError
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.slices import motion_slice


def test_a_document_with_claims_is_what_an_edit_makes_of_it() -> None:
    document = {key: part for key, part in tank_of_jelly().items() if key not in ("claims", "spec_version")}
    first = parse_spec({**document, "prompt": PROMPT})
    edited = apply_patch(first, claim_operations(CLAIMS, first))
    compiled = parse_spec({**with_claims(document, PROMPT, CLAIMS), "prompt": PROMPT})
    assert compiled == edited
    assert (first.spec_version, compiled.spec_version) == ("1", "2")
    assert motion_slice(compiled) == motion_slice(first)
    assert "/entities/jelly" in marked_claims(compiled)


def test_marks_of_another_prompt_are_refused() -> None:
    with pytest.raises(InputError):
        with_claims(tank_of_jelly(), "A jelly falls.", CLAIMS)


def test_a_part_is_named_by_its_entity_and_its_id() -> None:
    table = {"shape": {"kind": "box", "size": [1, 1, 0.1]}}
    box = {"role": "box", "motion": "static", "material": "oak", "dimensions": {"size": [1, 1, 0.1]}, "parts": {"lid": table}}
    oak = {"density": 700, "substance": "wood"}
    given = {"title": "box", "prompt": "The lid of a box.", "spec_version": "2", "simulation": {"frames": 2}}
    spec = parse_spec({**given, "materials": {"oak": oak}, "entities": {"box": box}})
    marked = "The [lid](thing box/lid) of a [box](thing box)."
    claims = claims_from(marked, spec)
    assert [c["by"] for c in claims.values()] == [["/entities/box/parts/lid"], ["/entities/box"]]
    assert claims_from(marked.replace("box/lid", "box/material"), spec)["lid"]["by"] == ["/entities/box/material"]
