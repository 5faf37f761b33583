"""Nouns inside claims of place against what the prompt calls the body that they name: `Under a table`, judged against a block (R2, R131).

Warnings alone, and of English prompts: whether a body is a table is for a reader to say.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from .claim_targets import Span, named_in
from .described import same_noun
from .prompts.lexicon import labelled

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = ["place_warnings"]


def place_warnings(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[str]:
    """A line for each noun of a thing in a claim of place whose bodies other claims call by other nouns alone."""
    if language != "en":
        return
    things = {
        name: set(named_in(spec, name, "entities"))
        for name, claim in spec.claims.items()
        if claim.type == "thing" and claim.waived is None and claim.same_as is None
    }
    nouns = [word for word in labelled(spec.prompt) if word.type == "thing"]
    for span in spans:
        if span.claim is None or span.type != "place" or spec.claims[span.claim].waived is not None:
            continue
        bodies = [n for n in named_in(spec, span.claim, "entities") if n in spec.entities]
        called = {name for name, own in things.items() if own & set(bodies)}
        for noun in nouns:
            text = spec.prompt[noun.start : noun.end]
            if not span.start <= noun.start < span.end or not called or any(_same(spec, name, text) for name in called):
                continue
            elsewhere = [b for name, own in things.items() if _same(spec, name, text) for b in sorted(own)]
            others = ", ".join(repr(spec.claims[name].quote) for name in sorted(called))
            then = (
                f"claims of things call {', '.join(elsewhere[:3])} so: name that one"
                if elsewhere
                else "give it a body of its own, claimed as thing, or look whether it is one"
            )
            yield f"the place {span.text!r} is judged against {', '.join(bodies[:3])}, which the prompt calls {others}, no {text!r}: {then}"


def _same(spec: WorldSpec, name: str, noun: str) -> bool:
    return same_noun(noun, spec.claims[name].quote)
