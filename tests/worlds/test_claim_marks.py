"""Marked text compiled into a specification: the claims are those of an edit, and the motion stays."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from worldagent.bench.prompts import shipped
from worldagent.examples.jelly_tank import CLAIMS, PROMPT, tank_of_jelly
from worldagent.worlds.claim_marks import claim_operations, claims_from, marked_claims, with_claims
from worldagent.worlds.errors import InputError
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.prompts.units import word_count
from worldagent.worlds.slices import motion_slice
from worldagent.worlds.spec import WorldSpec

SOLVED = Path(__file__).resolve().parents[2] / "bench" / "evaluation" / "solutions"
PER_FORTY = 1500
"""Characters of the marked text of a prompt of forty words, at most: what an agent writes in its one call for them."""


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


def claimed_worlds() -> Iterator[tuple[str, WorldSpec]]:
    """Every shipped world, and every prompt of the evaluation that is solved by a whole specification."""
    yield from shipped()
    for path in sorted(SOLVED.glob("*/*.json")):
        solution = json.loads(path.read_text(encoding="utf-8"))
        if "spec" in solution:
            told = {key: solution["spec"][key] for key in ("spec_version", "title", "prompt", "claims")}
            yield path.stem, parse_spec({**told, "simulation": {"frames": 2}})


def test_forty_words_are_marked_in_fifteen_hundred_characters() -> None:
    worlds = dict(claimed_worlds())
    long = [name for name, spec in worlds.items() if word_count(spec.prompt) >= 40]
    asked = {name: len(marked_claims(spec)) / word_count(spec.prompt) * 40 for name, spec in worlds.items()}
    assert len(worlds) > 40
    assert len(long) >= 3
    assert {name: round(size) for name, size in asked.items() if size > PER_FORTY} == {}
