"""The table of claim types in the skill against the places where the audit lets a claim of each type be judged."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest
from worldagent.server.skill_files import SKILLS
from worldagent.testing.dishonest.cases import without_marks
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.claim_marks import with_claims
from worldagent.worlds.claim_targets import JUDGED_BY
from worldagent.worlds.claims import prompt_record
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.spec import ClaimType
from worldagent.worlds.spec.claims import CLAIM_TYPES

WORDS = {
    "entit": "entities", "part": "entities", "terrain": "terrains", "material": "materials", "relation": "graph/relations",
    "region": "graph/regions", "beat": "story/beats", "requirement": "story/requirements", "shot": "shots", "look": "look",
    "simulation": "simulation", "driver": "simulation",
}  # fmt: skip
"""Beginnings of words of the table by what they name."""
GROUPS = {"graph": ("graph/relations", "graph/regions"), "story": ("story/beats", "story/requirements")}
FREE = ("quantity",)
"""A pointer to any number, which the table says in its own words."""


def told() -> dict[str, str]:
    """The column of names by type; of a line for several types, what stands behind `type:` and what is for all."""
    text = (SKILLS / "world-building" / "SKILL.md").read_text(encoding="utf-8")
    found: dict[str, str] = {}
    for line in text.splitlines():
        cells = [c.strip() for c in line.split("|")]
        types = re.findall(r"`(\w+)`", cells[1]) if len(cells) >= 4 else []
        if not types or not set(types) <= set(CLAIM_TYPES):
            continue
        for kind in types:
            pieces = [p.strip() for p in cells[2].split(";")]
            own = [p for p in pieces if not re.match(r"\w+:", p) or p.startswith(f"{kind}:")]
            found[kind] = "; ".join(p for p in own if not p.startswith("no "))
    return found


def named(text: str) -> set[str]:
    words = re.findall(r"[a-z]+", text.lower())
    return {place for word in words for start, place in WORDS.items() if word.startswith(start)}


@pytest.mark.parametrize("kind", [k for k in CLAIM_TYPES if k not in FREE])
def test_the_table_names_what_the_audit_takes_and_nothing_else(kind: ClaimType) -> None:
    allowed = {place for root in JUDGED_BY[kind] for place in GROUPS.get(root, (root,))}
    assert named(told()[kind]) <= allowed
    if kind in ("property", "place", "route", "time", "weather", "look"):
        assert named(told()[kind]) == allowed


def marked_texts() -> list[str]:
    """Marked texts of the skill's section on claims, each on one line."""
    section = (SKILLS / "world-building" / "SKILL.md").read_text(encoding="utf-8").split("\n## Claims\n")[1].split("\n## ")[0]
    return [" ".join(block.split()) for block in re.findall(r"```\n(\[?\w[^`]*)```", section)]


@pytest.mark.parametrize("language", ["de", "zh"])
def test_the_skill_shows_a_prompt_in_another_language_that_its_example_passes_with(language: str) -> None:
    example: dict[str, Any] = json.loads((SKILLS / "world-building" / "examples" / "two_blocks.json").read_text(encoding="utf-8"))
    found = []
    for marked in marked_texts()[1:]:
        prompt = without_marks(marked)
        spec = parse_spec({**with_claims({k: v for k, v in example.items() if k != "prompt"}, prompt, marked), "prompt": prompt})
        found.append(prompt_record(spec)["language"])
        assert audit(spec).passed
        assert prompt_record(spec)["waivers"] == {}
    assert language in found
