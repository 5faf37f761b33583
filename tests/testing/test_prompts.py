"""The prompts of the benchmark: spans are where they say, and the count of strangers is one that a gate can change."""

from __future__ import annotations

import unicodedata
from collections import Counter
from itertools import pairwise

import pytest
from worldagent.bench.prompts import passes, run, shipped
from worldagent.testing.defects.accepted import specifications
from worldagent.testing.prompts import Marked, Stranger, honest, strangers
from worldagent.worlds.audits.audit import audit

WORLDS = dict(specifications())
LONGEST = {"thing": 4, "count": 4, "property": 4, "event": 8}
"""Words of a span at most."""
WITHOUT_SPACES = {"zh", "ja"}


def places(prompt: Marked) -> list[tuple[int, int]]:
    found = []
    for span in prompt.spans:
        at = -1
        for _ in range(span.nth):
            at = prompt.text.index(span.quote, at + 1)
        found.append((at, at + len(span.quote)))
    return sorted(found)


@pytest.mark.parametrize("prompt", honest(), ids=lambda p: p.id)
def test_spans_are_in_the_prompt_and_do_not_overlap(prompt: Marked) -> None:
    spans = places(prompt)
    assert spans
    assert all(before[1] <= after[0] for before, after in pairwise(spans))
    if prompt.language not in WITHOUT_SPACES:
        assert all(len(s.quote.split()) <= LONGEST.get(s.type, 99) for s in prompt.spans)
    said = {k for start, end in spans for k in range(start, end)}
    letters = [k for k, c in enumerate(prompt.text) if unicodedata.category(c)[0] in "LN"]
    assert sum(k in said for k in letters) > 0.3 * len(letters), "most of a prompt says something about the world"


def test_prompts_are_many_different_and_in_twelve_languages() -> None:
    marked, alone = honest(), strangers()
    assert (len({p.text for p in marked}), len({p.text for p in alone})) == (150, 500)
    assert not {p.text for p in marked} & {p.text for p in alone}
    assert len(Counter(p.language for p in marked)) == len(Counter(p.language for p in alone)) == 12
    assert {s.type for p in marked for s in p.spans} >= {
        "thing",
        "count",
        "quantity",
        "event",
        "order",
        "negation",
        "route",
        "look",
    }


def test_a_world_passes_with_its_own_prompt_and_mapping() -> None:
    assert [name for name, spec in WORLDS.items() if not audit(spec).passed] == []
    assert len(WORLDS) >= 6


@pytest.mark.slow
def test_a_shipped_world_passes_with_its_own_prompt_and_unchanged_with_no_strangers() -> None:
    """All 500 are asked by the benchmark; here every tenth."""
    worlds = dict(shipped())
    assert "world-building/two_blocks" in worlds
    assert [name for name, spec in worlds.items() if not passes(spec, spec.prompt)] == []
    assert [(name, p.id) for name, spec in worlds.items() for p in strangers()[::10] if passes(spec, p.text)] == []


@pytest.mark.parametrize("world", WORLDS)
def test_a_world_with_its_own_claims_is_refused_for_a_stranger(world: str) -> None:
    assert not passes(WORLDS[world], "A person walks from the gate along the path to the pond.")
    assert not passes(WORLDS[world], WORLDS[world].prompt.replace("A", "One", 1).replace(" the ", " no "))


def test_the_count_is_of_the_prompts_that_the_audit_lets_through() -> None:
    asked = [Stranger("x", "en", "A person walks from the gate along the path to the pond."), Stranger("y", "en", two_prompt())]
    found = run(asked)
    assert (found["strangers"], found["honest"], found["refused"]) == (2, 0, 0)
    assert found["strangers_accepted"] == sum(w["passed"] for w in found["worlds"].values()) == 2
    assert found["worlds"]["two_blocks"] == {"prompts": 2, "passed": 1, "passed_by_language": {"en": 1}}


def two_prompt() -> str:
    return WORLDS["two_blocks"].prompt
