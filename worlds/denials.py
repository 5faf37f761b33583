"""The verb that a negation denies, and the kinds of event that it tells of: `does not fall` denies falls (R131, R155).

In English a verb that is the name of a kind has to deny that kind; where the lexicon only thinks of kinds the verdict warns. Elsewhere what is
denied is the agent's reading, which the verdict prints. Motion as such, `does not move`, is no kind: see `stillness.py`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import regex

from .claim_targets import named_in
from .predicates.denying import denying
from .prompts.languages import held_words
from .prompts.lexicon import kinds_meant, known_kinds, labelled, lemmas, verb_kinds
from .prompts.units import units_of
from .stillness import loose_requirement, stillness_of

if TYPE_CHECKING:
    from .claim_targets import Span
    from .spec import WorldSpec

__all__ = ["Denied", "denied_verb", "misdenied"]

_END = regex.compile(r"[.;:!?…,()\n]|[—–]")


class Denied(NamedTuple):
    """A verb of a negation."""

    verb: str
    kinds: frozenset[str]
    """Kinds one of which has to be denied."""
    sure: bool
    """True where they are those of the verb's own name, as `falls`; else the lexicon only thinks so."""


def denied_verb(prompt: str, spans: Sequence[Span], index: int, language: str | None) -> Denied | None:
    """The verb that a span of negation denies: its own, or the next one of its clause; None where none is known.

    Args:
        prompt: text of it.
        spans: of the prompt, in order.
        index: of the span of the negation among them.
        language: code of the language of the prompt.
    """
    if language != "en":
        return None
    span = spans[index]
    refusals = [h for h in held_words(prompt, language) if h.kind == "negation"]
    behind = _END.search(prompt, span.end)
    end = span.end if _END.search(span.text) else len(prompt) if behind is None else behind.start()
    words = [(w.start, w.end) for w in labelled(prompt) if w.type == "event" and w.end > span.start and w.start < end]
    if not any(start < span.end for start, _ in words):
        # A participle that is labelled as a description: `never falling`.
        inside = [u for u in units_of(prompt) if span.start <= u.start < span.end and _own(u.text)]
        words = [*((u.start, u.end) for u in inside), *words]
    for start, last in words:
        if any(h.start < last and start < h.end for h in refusals):
            continue
        verb = prompt[start:last]
        kinds = verb_kinds(verb)
        if kinds is None or not kinds & known_kinds():
            return None
        return Denied(verb, _own(verb) or kinds, bool(_own(verb)))
    return None


def _own(verb: str) -> frozenset[str]:
    """Kinds that bear a verb's own name."""
    bases = lemmas(verb.split()[0], "v")
    return frozenset(k for k in verb_kinds(verb) or () for base in bases if k.split("_")[0] in (f"{base}s", f"{base}es"))


def misdenied(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[tuple[str, str, bool]]:
    """Negations whose requirements deny other kinds of event than their verb tells of: (claim, what is wrong, whether it is sure)."""
    for index, span in enumerate(spans):
        if span.type != "negation" or span.claim is None or spec.claims[span.claim].waived is not None:
            continue
        asked = {
            n: spec.story.requirements[n]
            for n in named_in(spec, span.claim, "story/requirements")
            if n in spec.story.requirements
        }
        still = stillness_of(spec.prompt, spans, index, language)
        if still is not None and asked:
            why = loose_requirement(spec, asked)
            if why is not None:
                yield (
                    span.claim,
                    f"{spec.claims[span.claim].quote!r} says by {still.words!r} that it does not move, and {why}",
                    still.sure,
                )
            continue
        verb = denied_verb(spec.prompt, spans, index, language)
        if verb is None or not asked:
            continue
        kinds = {str(getattr(a, "kind", "")) for r in asked.values() for a in denying(r.predicate)}
        if not verb.kinds & kinds_meant(kinds):
            told = ", ".join(sorted(kinds)) or ", ".join(f"{n} ({getattr(r.predicate, 'kind', '')})" for n, r in asked.items())
            text = f"{spec.claims[span.claim].quote!r} denies {verb.verb!r}, and what must never happen by it is {told}: "
            text += f"give {next(iter(asked))!r} a predicate of kind {' or '.join(sorted(verb.kinds))}, alone or in an `or`"
            yield span.claim, text, verb.sure
