"""A scripted attacker: an accepted world of version 2 under strangers' prompts, with every span bound to the best that passes.

Spans and types are those that the server proposes. A thing is the next entity that no span has yet, or the same as the first; an event is
all beats that tell one; a count, quantity or negation is bound where the world has as many, that number, or something that never happens.
What nothing fits is left as filler. Nobody reads the prompt: what the audit lets through would be called "accepted, prompt read by nobody".
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from ..testing.prompts import Stranger
from ..worlds.audits.audit import audit
from ..worlds.claims import prompt_record
from ..worlds.patch import parse_spec
from ..worlds.predicates.events import event_atoms
from ..worlds.prompts.languages import language_of
from ..worlds.prompts.numbers import number_in, quantity_in
from ..worlds.prompts.proposals import Proposal, proposed
from ..worlds.prompts.quotes import nth_of
from ..worlds.spec import WorldSpec

__all__ = ["attack_figures", "attacked", "own_world", "stolen"]

EXAMPLE = Path(__file__).resolve().parent.parent / "skills" / "world-building" / "examples" / "two_blocks.json"


def own_world() -> WorldSpec:
    """The shipped example, marked and accepted."""
    return parse_spec(json.loads(EXAMPLE.read_text()))


def stolen(spec: WorldSpec, prompt: str) -> WorldSpec:
    """The world unchanged, its claims too, under another prompt."""
    return WorldSpec.model_validate({**spec.model_dump(mode="json"), "prompt": prompt})


def attacked(spec: WorldSpec, prompt: str) -> WorldSpec:
    """The world under another prompt, with every proposed span bound to the best that there is."""
    claims: dict[str, dict[str, Any]] = {}
    free = [f"/entities/{n}" for n in sorted(spec.entities, key=lambda n: spec.entities[n].motion == "static")]
    first = ""
    for number, span in enumerate(proposed(prompt)):
        name, quote = f"c{number}", prompt[span.start : span.end]
        found: dict[str, Any] | None
        if span.type in ("thing", "unknown"):
            found = {"type": "thing", "by": [free.pop(0)]} if free else {"type": "thing", "same_as": first}
            first = first or name
        else:
            found = _bound(spec, span, quote, prompt)
        if found is not None:
            claims[name] = {"quote": quote, "nth": nth_of(prompt, span.start, span.end), **found}
    return WorldSpec.model_validate({**spec.model_dump(mode="json"), "prompt": prompt, "claims": claims})


def _bound(spec: WorldSpec, span: Proposal, quote: str, prompt: str) -> dict[str, Any] | None:
    language, entities = language_of(prompt), list(spec.entities)
    events = [f"/story/beats/{n}" for n, b in spec.story.beats.items() if event_atoms(b.predicate)]
    denied = [f"/story/requirements/{n}" for n, r in spec.story.requirements.items() if r.never]
    if span.type == "count":
        wanted = number_in(quote, language)
        return (
            None
            if wanted is None or not 1 <= wanted <= len(entities)
            else {"type": "count", "by": [f"/entities/{n}" for n in entities[: round(wanted)]]}
        )
    if span.type == "quantity":
        asked = quantity_in(quote, language)
        match = (
            [] if asked is None else [p for p, v in _leaves(spec.model_dump(mode="json")) if asked.low <= abs(v) <= asked.high]
        )
        return {"type": "quantity", "by": match[:1]} if match else None
    by = {
        "event": events,
        "order": events[:2],
        "negation": denied,
        "property": [f"/entities/{entities[0]}"],
        "place": [f"/entities/{entities[0]}"],
        "route": events[:1],
    }.get(span.type, ["/look/sky"])
    return {"type": span.type, "by": by} if by else None


def _leaves(document: Any, pointer: str = "") -> Iterator[tuple[str, float]]:
    """Every number of a document outside the claims, with its pointer."""
    if isinstance(document, dict):
        for key, item in document.items():
            if pointer or key not in ("claims", "title", "prompt"):
                yield from _leaves(item, f"{pointer}/{key}")
    elif isinstance(document, list):
        for index, item in enumerate(document):
            yield from _leaves(item, f"{pointer}/{index}")
    elif isinstance(document, (int, float)) and not isinstance(document, bool):
        yield pointer, float(document)


def attack_figures(prompts: Sequence[Stranger]) -> dict[str, Any]:
    """Strangers' prompts that the example passes the audit with: unchanged, and bound by the attacker."""
    spec = own_world()
    unchanged, warned, bound, refused = 0, 0, Counter[str](), Counter[str]()
    for prompt in prompts:
        unchanged += audit(stolen(spec, prompt.text)).passed
        world = attacked(spec, prompt.text)
        report = audit(world)
        if report.passed:
            bound[prompt.language] += 1
            warned += any("language" not in w for w in prompt_record(world)["warnings"])
            continue
        row = next(r for r in report.rows if r.status != "pass")
        refused[_why(str((row.evidence.get("problems") or [row.id])[0]))] += 1
    return {
        "prompts": len(prompts),
        "unchanged_passed": unchanged,
        "attacker_passed": bound.total(),
        "attacker_passed_with_warnings": warned,
        "attacker_passed_by_language": dict(sorted(bound.items())),
        "attacker_refused_by": dict(refused.most_common()),
        "claimed_of_its_own_prompt": prompt_record(spec)["claimed"],
    }


def _why(problem: str) -> str:
    """Kind of the first problem."""
    for word in (
        "number word",
        "negation word",
        "order word",
        "counts",
        "says",
        "asks for",
        "name two beats",
        "no claim of a thing",
    ):
        if word in problem:
            return word
    return "other"
