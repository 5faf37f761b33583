"""Benchmark prompts: how many strangers' prompts a shipped world would be accepted for.

Every accepted world is left as it is, but for its prompt: each of 500 prompts in twelve languages that it is not about takes its place,
with every clause mapped to all beats, requirements and entities, as somebody does who wants a pass and not a world. Whatever the audit lets
through would be accepted, since physics and pictures are those of the accepted world. Target: none.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from ..testing.defects.accepted import specifications
from ..testing.prompts import Stranger, strangers
from ..worlds.audits.audit import audit
from ..worlds.audits.clauses import clauses_of
from ..worlds.spec import WorldSpec

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["dressed_for", "passes", "run"]


def dressed_for(spec: WorldSpec, prompt: str) -> WorldSpec:
    """The same world with another prompt, every clause of which is mapped to all that the story and the scene hold."""
    places: dict[str, dict[str, Any]] = {
        "story/beats": spec.story.beats,
        "story/requirements": spec.story.requirements,
        "entities": spec.entities,
    }
    everything = [f"/{place}/{name}" for place, members in places.items() for name in members]
    clauses = {key: {"met_by": everything} for key in clauses_of(prompt)}
    return WorldSpec.model_validate({**spec.model_dump(mode="json"), "prompt": prompt, "clauses": clauses})


def passes(spec: WorldSpec, prompt: str) -> bool:
    """True where the audit lets the world through as one of this prompt."""
    return audit(dressed_for(spec, prompt)).passed


def run(prompts: Sequence[Stranger] | None = None) -> dict[str, Any]:
    """Count the strangers' prompts that each accepted world passes the audit with.

    Args:
        prompts: all when left out.
    """
    asked = strangers() if prompts is None else prompts
    languages = Counter(p.language for p in asked)
    worlds: dict[str, Any] = {}
    for name, spec in specifications():
        passed = Counter(p.language for p in asked if passes(spec, p.text))
        worlds[name] = {"prompts": len(asked), "passed": passed.total(), "passed_by_language": dict(sorted(passed.items()))}
    return {
        "worlds": worlds,
        "prompts_by_language": dict(sorted(languages.items())),
        "passed_share": sum(w["passed"] for w in worlds.values()) / max(1, len(asked) * len(worlds)),
        "target_share": 0.0,
    }
