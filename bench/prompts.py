"""Benchmark prompts: how many strangers' prompts a shipped world would be accepted for, and what the lexicon finds in honest ones.

Every shipped world is left as it is, its claims too, but for its prompt: each of 500 prompts in twelve languages that it is not about takes
its place. Whatever the audit lets through would be accepted. Target: none. Of 150 honest prompts it counts those that a rule of words refuses
whatever they are told of (`testing/prompts/told.py`). `attack` counts the same for the example of the skill with claims
that a scripted attacker binds (`prompt_attack.py`).

The lexicon labels the English prompts whose spans somebody marked: how many of the marked events and things it finds, how many of its labels are
marked so, how many marks left out or mistyped it warns of, and of how many right ones. A label inside a longer span of another type (a table in
the route "off the table") counts for nothing. Rules were written with a view to the prompts called e*, and without one to a*.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Literal

from ..testing.defects.accepted import SKILLS, recorded, showcases, specifications
from ..testing.prompts import Marked, Stranger, honest, placed, strangers, verbs
from ..testing.prompts.told import refusals, untaken
from ..worlds.audits.audit import audit
from ..worlds.audits.claims import claim_problems
from ..worlds.named_materials import declared_by_name
from ..worlds.patch import parse_spec
from ..worlds.prompts.lexicon import Reading, labelled, verb_kinds, warnings_for
from ..worlds.prompts.proposals import proposed
from ..worlds.spec import WorldSpec
from .prompt_attack import attack_figures, stolen

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "found_and_right",
    "passes",
    "proposal_figures",
    "run",
    "shipped",
    "verb_figures",
    "warning_figures",
    "word_figures",
]

HOLDS: dict[str, frozenset[str]] = {
    "event": frozenset({"negation"}),
    "thing": frozenset({"place", "route", "quantity", "time", "weather", "look", "negation", "event", "order"}),
}
"""By type of a label, types of longer spans that may hold such a word and say nothing of it."""


def passes(spec: WorldSpec, prompt: str) -> bool:
    """True where the audit lets the world through, unchanged, as one of this prompt."""
    world = stolen(spec, prompt)
    # Claims are the quicker half: most strangers fail there.
    return not claim_problems(world) and audit(world).passed


def shipped() -> Iterator[tuple[str, WorldSpec]]:
    """Name and specification of every accepted world that is kept, recorded, shown, or an example of a skill."""
    yield from specifications()
    # A recorded world of version 1 has no claims that could be held against another prompt.
    # Materials that are named alone are declared at creation.
    yield from ((name, declared_by_name(spec)) for name, spec in (*recorded(), *showcases()) if spec.claims)
    for path in sorted(SKILLS.glob("*/examples/*.json")):
        yield f"{path.parts[-3]}/{path.stem}", parse_spec(json.loads(path.read_text(encoding="utf-8")))


def run(prompts: Sequence[Stranger] | None = None) -> dict[str, Any]:
    """Count the strangers' prompts that each shipped world passes the audit with.

    Args:
        prompts: all when left out; honest prompts are asked then alone.
    """
    asked = strangers() if prompts is None else prompts
    languages = Counter(p.language for p in asked)
    own = honest() if prompts is None else ()
    worlds: dict[str, Any] = {}
    for name, spec in shipped():
        passed = Counter(p.language for p in asked if passes(spec, p.text))
        worlds[name] = {"prompts": len(asked), "passed": passed.total(), "passed_by_language": dict(sorted(passed.items()))}
    return {
        "strangers": len(asked),
        "strangers_accepted": sum(w["passed"] for w in worlds.values()),
        "honest": len(own),
        "refused": sum(bool(untaken(p) or refusals(p)) for p in own),
        "worlds": worlds,
        "prompts_by_language": dict(sorted(languages.items())),
        "lexicon": {**word_figures(), **warning_figures(), "verbs": verb_figures()},
        "proposals": proposal_figures(),
        "attack": attack_figures(asked),
        "passed_share": sum(w["passed"] for w in worlds.values()) / max(1, len(asked) * len(worlds)),
        "target_share": 0.0,
    }


def english() -> list[Marked]:
    """The marked prompts in English."""
    return [prompt for prompt in honest() if prompt.language == "en"]


def found_and_right(prompts: Sequence[Marked], kind: Literal["event", "thing"]) -> dict[str, Any]:
    """Precision and recall of the lexicon's labels of one type against the marks."""
    marked = found = given = right = 0
    for prompt in prompts:
        labels = [label for label in labelled(prompt.text) if label.type == kind]
        spans = placed(prompt)
        own = [span for span in spans if span[2] == kind]
        marked += len(own)
        found += sum(any(label.start < end and start < label.end for label in labels) for start, end, _ in own)
        for label in labels:
            over = {of for start, end, of in spans if label.start < end and start < label.end}
            right += kind in over
            given += kind in over or not over & HOLDS[kind]
    return {"marked": marked, "recall": found / marked, "labelled": given, "precision": right / given}


def word_figures() -> dict[str, Any]:
    """Precision and recall of events and things, of all English prompts and of those that the rules were not written for."""
    sets = {"all": english(), "unseen": [prompt for prompt in english() if prompt.id.startswith("a")]}
    return {f"{kind}s": {name: found_and_right(prompts, kind) for name, prompts in sets.items()} for kind in ("event", "thing")}


def warning_figures() -> dict[str, Any]:
    """Warnings about prompts as they are marked, and how often one is made when a mark is left out or mistyped."""
    told: Counter[str] = Counter()
    for prompt in english():
        marks = [Reading(*span) for span in placed(prompt)]
        told["prompts"] += 1
        told["false"] += len(warnings_for(marks, prompt.text, "en"))
        for k, mark in enumerate(marks):
            if mark.type not in HOLDS:
                continue
            rest = marks[:k] + marks[k + 1 :]
            told[mark.type] += 1
            told[f"{mark.type} left out"] += _is_told(mark, rest, prompt.text)
            if mark.type == "event":
                told["event as thing"] += _is_told(mark, [*rest, mark._replace(type="thing")], prompt.text)
    return {
        "false_warnings_per_prompt": told["false"] / told["prompts"],
        "events_left_out_told_share": told["event left out"] / told["event"],
        "events_marked_as_things_told_share": told["event as thing"] / told["event"],
        "things_left_out_told_share": told["thing left out"] / told["thing"],
    }


def _is_told(mark: Reading, marks: list[Reading], text: str) -> bool:
    return any(warned.start < mark.end and mark.start < warned.end for warned in warnings_for(marks, text, "en"))


def verb_figures() -> dict[str, Any]:
    """Kinds of event by verb against those that a reader gave, of verbs that the seeds were chosen for (`seen`) and of others."""
    made: dict[str, Any] = {}
    for name, seen in (("seen", True), ("unseen", False)):
        asked = [verb for verb in verbs() if verb.seen is seen]
        given = [verb_kinds(verb.verb) or frozenset() for verb in asked]
        made[name] = {
            "verbs": len(asked),
            "recall": sum(len(kinds & verb.kinds) for verb, kinds in zip(asked, given, strict=True))
            / sum(len(verb.kinds) for verb in asked),
            "precision": sum(len(kinds & (verb.kinds | verb.also)) for verb, kinds in zip(asked, given, strict=True))
            / sum(map(len, given)),
        }
    return made


def proposal_figures() -> dict[str, Any]:
    """Share of the marked spans that a proposal of the same type meets, by language, of the types that the server knows there."""
    known = {"en": ("thing", "event", "property", "count", "quantity", "order", "negation")}
    made: dict[str, Any] = {}
    for language in sorted({prompt.language for prompt in honest()}):
        met: list[bool] = []
        for prompt in (prompt for prompt in honest() if prompt.language == language):
            found = proposed(prompt.text)
            for start, end, kind in placed(prompt):
                if kind in known.get(language, ("count", "quantity", "order", "negation")):
                    met.append(any(span.type == kind and span.start < end and start < span.end for span in found))
        made[language] = {"marked": len(met), "same_type_share": sum(met) / len(met)}
    return made
