"""Antecedents of `it` and `they` before an event: the only one where the words leave no choice, the one that is read where they do (R131, R155).

English. A pronoun before a verb takes up a thing named before it, as a rule the subject of its own sentence or of the one before (Hobbs, J. R. (1978),
Resolving pronoun references, Lingua 44, doi:10.1016/0024-3841(78)90006-2: the nearest antecedent of the search from the left is right in nine of ten).
Only where a single noun stands in that sentence before it the rule is sure, and not where that noun's clause is opened by `when` or `as` and other
things were named earlier: `A vase stands on a table. When the ball comes, it tips over.` Several nouns are the agent's reading, which is printed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import regex

from .claim_targets import named_in
from .prompts.lexicon import labelled
from .roles import SENTENCE, Misplaced, bodies_of

if TYPE_CHECKING:
    from .claim_targets import Span
    from .spec import WorldSpec

__all__ = ["Antecedents", "antecedents_of", "misread_pronouns", "pronoun_before", "pronoun_readings"]

PRONOUNS = frozenset(("it", "they", "them"))
_HELPERS = (
    r"will|would|can|could|may|might|must|shall|should|does|do|did|is|are|was|were|has|have|had|gets?|got|also|then|just|still|soon|once|finally|suddenly|"
    r"slowly|quickly|briefly|gently|hardly|almost|nearly|first|again|in turn|in the end|\w+ly"
)
_BEFORE = regex.compile(rf"\b(it|they)(?:['’](?:ll|s|d|ve|re))?(?:\s+(?:{_HELPERS}))*\s*$", regex.IGNORECASE)
_SUBORDINATE = regex.compile(
    r"\b(?:when|whenever|as|while|if|once|after|before|until|till|because|since|where|although|though|unless)\b", regex.IGNORECASE
)


class Antecedents(NamedTuple):
    """Things that a pronoun may take up."""

    pronoun: str
    start: int
    """Place in the prompt at which it begins."""
    nouns: tuple[tuple[str, frozenset[str]], ...]
    """Words of the nouns of its sentence before it, or of the sentence before that where it has none, each with its bodies; none of an unclaimed noun."""
    earlier: frozenset[str]
    """All bodies that were named before it."""
    sure: bool
    """True where its words leave a single one."""


def pronoun_before(prompt: str, start: int) -> tuple[str, int] | None:
    """A pronoun that is the subject of the verb that begins at a place, with its own place; None where there is none."""
    found = _BEFORE.search(prompt, 0, start)
    return None if found is None else (found.group(1).casefold(), found.start(1))


def antecedents_of(spec: WorldSpec, spans: Sequence[Span], pronoun: str, start: int) -> Antecedents:
    """Things that a pronoun at a place of an English prompt may take up."""
    ends = [0, *(m.end() for m in SENTENCE.finditer(spec.prompt, 0, start))]
    earlier = frozenset(
        b for s in spans if s.start < start and s.type in ("thing", "count") and s.claim for b in bodies_of(spec, s.claim)
    )
    for k in range(len(ends) - 1, max(len(ends) - 3, -1), -1):
        low, high = ends[k], start if k == len(ends) - 1 else ends[k + 1]
        nouns = tuple(_nouns(spec, spans, low, high))
        if nouns:
            noun, own = nouns[0]
            opened = k == len(ends) - 1 and _SUBORDINATE.search(spec.prompt, low, start) is not None
            sure = len(nouns) == 1 and bool(own) and _agrees(pronoun, noun, own) and not (opened and bool(earlier - own))
            return Antecedents(pronoun, start, nouns, earlier, sure)
    return Antecedents(pronoun, start, (), earlier, sure=False)


def _agrees(pronoun: str, noun: str, bodies: frozenset[str]) -> bool:
    """True where a pronoun and a noun are of one number; `it` may be a tower of many blocks, and no blocks."""
    if pronoun == "it":
        return len(bodies) == 1 or not noun.casefold().endswith("s")
    return len(bodies) > 1


def _nouns(spec: WorldSpec, spans: Sequence[Span], low: int, high: int) -> Iterator[tuple[str, frozenset[str]]]:
    """Nouns of things between two places of the prompt, those that no claim of a thing takes up too; a name for the same bodies counts once."""
    seen: set[frozenset[str]] = set()
    taken: list[tuple[int, int]] = []
    for span in spans:
        if span.claim is None or not low <= span.start < high:
            continue
        taken.append((span.start, span.end))
        bodies = bodies_of(spec, span.claim) if span.type == "thing" else frozenset()
        if bodies and not any(bodies <= other for other in seen):
            seen.add(bodies)
            yield span.text.strip(), bodies
    for word in labelled(spec.prompt):
        free = not any(a < word.end and word.start < b for a, b in taken)
        if word.type == "thing" and low <= word.start < high and free:
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
    found = regex.match(r"\S+(?:\s+\S+){0,2}", spec.prompt[start:])
    return found.group().rstrip(".,;:!?") if found is not None else ""
