"""Antecedents of `it` and `they` before an event: the only one where the words leave no choice, the one that is read where they do (R131, R155).

English. A pronoun takes up a thing named before it. Which one, the nearest search from the left finds in nine texts of ten where it follows sentences
(Hobbs, J. R. (1978), Resolving pronoun references, Lingua 44, doi:10.1016/0024-3841(78)90006-2), and in three of our ten honest prompts it does not
("An elephant sits on it and it wobbles"). So the rule decides only where all that was named before is one thing; else whom the agent takes
the pronoun for is printed as its reading.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import regex

from .claim_targets import named_in
from .prompts.lexicon import labelled
from .roles import Misplaced, bodies_of

if TYPE_CHECKING:
    from .claim_targets import Span
    from .spec import WorldSpec

__all__ = ["HELPERS", "Antecedents", "antecedents_of", "misread_pronouns", "pronoun_before", "pronoun_readings"]

PRONOUNS = frozenset(("it", "they", "them"))
HELPERS = (
    r"will|would|can|could|may|might|must|shall|should|does|do|did|is|are|was|were|has|have|had|gets?|got|also|then|just|still|soon|once|finally|suddenly|"
    r"slowly|quickly|briefly|gently|hardly|almost|nearly|first|again|in turn|in the end|\w+ly"
)
_BEFORE = regex.compile(rf"\b(it|they)(?:['’](?:ll|s|d|ve|re))?(?:\s+(?:{HELPERS}))*\s*$", regex.IGNORECASE)


class Antecedents(NamedTuple):
    """Things that a pronoun may take up."""

    pronoun: str
    start: int
    """Place in the prompt at which it begins."""
    nouns: tuple[tuple[str, frozenset[str]], ...]
    """Words of all nouns before it, each with its bodies; none of an unclaimed noun."""
    earlier: frozenset[str]
    """All bodies that they name."""
    sure: bool
    """True where its words leave a single one."""


def pronoun_before(prompt: str, start: int) -> tuple[str, int] | None:
    """A pronoun that is the subject of the verb that begins at a place, with its own place; None where there is none."""
    found = _BEFORE.search(prompt, 0, start)
    return None if found is None else (found.group(1).casefold(), found.start(1))


def antecedents_of(spec: WorldSpec, spans: Sequence[Span], pronoun: str, start: int) -> Antecedents:
    """Things that a pronoun at a place of an English prompt may take up."""
    nouns = tuple(_nouns(spec, spans, start))
    earlier = frozenset[str]().union(*(bodies for _, bodies in nouns))
    sure = len(nouns) == 1 and bool(earlier) and _agrees(pronoun, *nouns[0])
    return Antecedents(pronoun, start, nouns, earlier, sure)


def _agrees(pronoun: str, noun: str, bodies: frozenset[str]) -> bool:
    """True where a pronoun and a noun are of one number; `it` may be a tower of many blocks, and no blocks."""
    if pronoun == "it":
        return len(bodies) == 1 or not noun.casefold().endswith("s")
    return len(bodies) > 1


def _nouns(spec: WorldSpec, spans: Sequence[Span], end: int) -> Iterator[tuple[str, frozenset[str]]]:
    """Nouns of things up to a place of the prompt, those that no claim of a thing takes up too; a name for the same bodies counts once."""
    seen: set[frozenset[str]] = set()
    taken = [(s.start, s.end) for s in spans if s.claim is not None]
    for span in spans:
        bodies = bodies_of(spec, span.claim) if span.claim is not None and span.type in ("thing", "count") else frozenset()
        if bodies and span.start < end and not any(bodies <= other for other in seen):
            seen.add(bodies)
            yield span.text.strip(), bodies
    for word in labelled(spec.prompt):
        if word.type == "thing" and word.start < end and not any(a < word.end and word.start < b for a, b in taken):
            yield spec.prompt[word.start : word.end], frozenset()


def misread_pronouns(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[Misplaced]:
    """Pronouns that are marked as another thing than the only one that they can mean, or as one that is named nowhere before them.

    Args:
        spec: the specification.
        spans: of its prompt, in order.
        language: code of its language; only English is looked at.
    """
    for span, found in _claimed(spec, spans, language):
        own = bodies_of(spec, str(span.claim))
        if not own or not found.earlier or any(own & bodies for _, bodies in found.nouns):
            continue
        if found.sure:
            noun, bodies = found.nouns[0]
            names = ", ".join(repr(n) for n in sorted(bodies)[:3])
            text = f"{span.text.strip()!r} is marked as {', '.join(map(repr, sorted(own)[:3]))}, and the only thing named before it is {noun!r}, {names}: mark it as that"
            yield Misplaced(str(span.claim), text, sure=True)
        elif not own & found.earlier:
            text = f"{span.text.strip()!r} is marked as {', '.join(map(repr, sorted(own)[:3]))}, which nothing before it names"
            yield Misplaced(str(span.claim), text, sure=False)


def _claimed(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[tuple[Span, Antecedents]]:
    """Claims of things whose words are a pronoun, with what it may take up."""
    for span in spans if language == "en" else ():
        if (
            span.claim is not None
            and span.type == "thing"
            and span.text.strip().casefold() in PRONOUNS
            and spec.claims[span.claim].waived is None
        ):
            yield span, antecedents_of(spec, spans, span.text.strip().casefold(), span.start)


def pronoun_readings(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> dict[str, list[str]]:
    """Pronouns that may take up several things: with the words behind them, the pointers that they are read as."""
    made: dict[str, list[str]] = {}
    for span, found in _claimed(spec, spans, language):
        if len(found.nouns) > 1:
            made.setdefault(_context(spec, span.start), [f"/entities/{n}" for n in sorted(bodies_of(spec, str(span.claim)))])
    for span in spans if language == "en" else ():
        if span.claim is None or span.type != "event" or spec.claims[span.claim].waived is not None:
            continue
        said = pronoun_before(spec.prompt, span.start)
        if said is None or any(s.type == "thing" and s.start <= said[1] < s.end for s in spans):
            continue
        if len(antecedents_of(spec, spans, *said).nouns) > 1:
            beats = [spec.story.beats[n].subject for n in named_in(spec, span.claim, "story/beats") if n in spec.story.beats]
            made.setdefault(_context(spec, said[1]), [f"/entities/{n}" for n in dict.fromkeys(beats) if n in spec.entities])
    return {words: pointers for words, pointers in made.items() if pointers}


def _context(spec: WorldSpec, start: int) -> str:
    """A pronoun and the two words behind it."""
    found = regex.match(r"[\w'’-]+(?:\s+[\w'’-]+){0,2}", spec.prompt[start:])
    return found.group() if found is not None else ""
