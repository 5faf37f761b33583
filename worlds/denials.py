"""The verb that a negation denies, and the kinds of event that it tells of: `does not fall` denies falls (R131, R155).

Sure in English, where the lexicon knows kinds for the verb; elsewhere what is denied is the agent's reading, which the verdict prints.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import regex

from .prompts.languages import held_words
from .prompts.lexicon import known_kinds, labelled, lemmas, verb_kinds

if TYPE_CHECKING:
    from .claim_targets import Span

__all__ = ["Denied", "denied_verb"]

_END = regex.compile(r"[.;:!?…,()\n]|[—–]")


class Denied(NamedTuple):
    """A verb of a negation."""

    verb: str
    kinds: frozenset[str]
    """Kinds one of which has to be denied: that of the verb's own name where there is one."""


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
    end = next((m.start() for m in [_END.search(prompt, span.end)] if m is not None), len(prompt))
    for word in labelled(prompt):
        if word.type != "event" or word.end <= span.start or word.start >= end:
            continue
        if any(h.start < word.end and word.start < h.end for h in refusals):
            continue
        verb = prompt[word.start : word.end]
        kinds = verb_kinds(verb)
        if kinds is None or not kinds & known_kinds():
            return None
        own = {k for k in kinds for lemma in lemmas(verb.split()[0], "v") if k.split("_")[0] in (f"{lemma}s", f"{lemma}es")}
        return Denied(verb, frozenset(own) or kinds)
    return None
