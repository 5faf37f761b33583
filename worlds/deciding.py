"""Words that decide what a sentence says and that nothing judges: `nearly hits`, `another ball`, `every block`, `to the left` (R2, R155).

They refuse nothing. The verdict names each with what it would take to have it judged; words of weather and of the time of day that no claim
takes up too. In English and German; elsewhere weather and time alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import regex

from .claim_targets import Span, named_in, targets_of
from .described import same_noun
from .predicates import atoms_of
from .prompts.deciding_words import ARTICLES, DECIDING, NOT_ALL
from .prompts.descriptions import WordKind, meanings
from .prompts.held_numbers import list_markers
from .prompts.units import APOSTROPHES, Unit, folded, units_of

if TYPE_CHECKING:
    from .prompts.deciding_words import DecidingKind
    from .spec import WorldSpec

__all__ = ["deciding_warnings"]

BAND = 1.1
"""[1] Own choice: most ratio of the two bounds that hold a number exactly."""
NEAR = 3
"""Own choice: words of filler between a deciding word and the claim that it is said of."""
_STOP = regex.compile(r"[.;:!?…()\n]|[—–]")
_DIRECTED = frozenset(("crosses", "reaches", "stays_in", "joint_angle"))
"""Predicates that say where to by themselves."""
_SAID_OF: Mapping[DecidingKind, tuple[str, ...]] = {
    "nearly": ("event",),
    "another": ("thing",),
    "all": ("thing",),
    "only": ("thing", "event", "count"),
    "having": ("event",),
    "exactly": ("quantity",),
}
"""Types of the claim that a word is said of; a direction is said of what stands before it."""
_LEADING: Mapping[DecidingKind, frozenset[str]] = {
    "nearly": frozenset(("also", "even", "then")),
    "having": frozenset(("been", "already", "just")),
}
"""Words that may stand between such a word and an event."""
_TAKES: Mapping[DecidingKind, str] = {
    "nearly": "what nearly happens does not: claim the two as a negation of it, and what it comes close to as a place",
    "another": "no other claim names another one: let the world have both, each with a claim of its own",
    "all": "claim it as a count of all of them",
    "only": "that no other does is not judged: claim it as a negation, by a requirement that the others never do",
    "having": "it puts this before what follows: claim it as an order of the two",
    "exactly": "a quantity is met by what is nearer to it than to half and twice of it: give it `min` and `max` that lie close together",
    "direction": "no direction is judged: name a beat with `displacement` along an axis, `crosses` or `reaches`; left and right are those of the camera",
}
_UNCLAIMED: Mapping[WordKind, str] = {
    "weather": "is weather and no claim takes it up: mark it as weather, by what makes it",
    "time": "is a time of day and no claim takes it up: mark it as time, by the sun of /look",
}


class _Found(NamedTuple):
    """A deciding word, and the span that holds it."""

    kind: DecidingKind
    text: str
    start: int
    end: int
    span: int


def deciding_warnings(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[str]:
    """A line for each word that decides something and that nothing judges.

    Args:
        spec: the specification.
        spans: of its prompt, in order.
        language: code of its language.
    """
    for found in _found(spec.prompt, spans, language or ""):
        at = _said_of(spec.prompt, spans, found, language or "")
        if at is not None and _open(spec, spans, found, at):
            held = "filler" if spans[found.span].claim is None else f"part of {spans[found.span].text!r}"
            of = "" if at == found.span else f" beside {spans[at].text!r}"
            yield f"{found.text!r} is {held}{of}: {_TAKES[found.kind]}"
    loose = [n for n in list_markers(spec.prompt) if any(s.claim is None and s.start <= n < s.end for s in spans)]
    if len(loose) > 1 and sum(s.type == "event" for s in spans) > 1:
        yield f"{len(loose)} numbers mark the items of a list: whether they come in that order is not judged; claim the numbers as order, the first first"
    for span in spans:
        if span.claim is None:
            for kind, text in _UNCLAIMED.items():
                for word in meanings(span.text, language, kind):
                    if word.term not in ("-", "past"):
                        yield f"{word.word!r} {text}"


def _found(prompt: str, spans: Sequence[Span], language: str) -> Iterator[_Found]:
    """Deciding words of a prompt, in order and disjoint, the longest first."""
    known = {
        tuple(folded(u.text) for u in units_of(p)): kind for kind, phrases in DECIDING.get(language, {}).items() for p in phrases
    }
    units = units_of(prompt)
    words = [folded(u.text.translate(APOSTROPHES)) for u in units]
    longest, at = max(map(len, known), default=0), 0
    while at < len(units):
        size = next((n for n in range(min(longest, len(units) - at), 0, -1) if tuple(words[at : at + n]) in known), 0)
        held = _holding(spans, units, at, size)
        if size and held is not None:
            kind = known[tuple(words[at : at + size])]
            if kind not in ("all", "only") or not at or words[at - 1] not in NOT_ALL[language]:
                start, end = units[at].start, units[at + size - 1].end
                yield _Found(kind, prompt[start:end], start, end, held)
        at += max(1, size)


def _holding(spans: Sequence[Span], units: Sequence[Unit], at: int, size: int) -> int | None:
    """Index of the span that holds some words; None where several do."""
    if not size:
        return None
    return next((k for k, s in enumerate(spans) if s.start <= units[at].start and units[at + size - 1].end <= s.end), None)


def _said_of(prompt: str, spans: Sequence[Span], found: _Found, language: str) -> int | None:
    """Index of the claim that a word is said of: its own, the next one, or of a direction the one before; None where it is of none."""
    held = spans[found.span]
    if found.kind == "direction":
        if held.claim is not None:
            return found.span if held.type in ("event", "quantity", "route", "place", "property") else None
        before = next((k for k in range(found.span - 1, -1, -1) if spans[k].claim is not None), None)
        if before is None or _STOP.search(prompt[spans[before].end : found.start]):
            return None
        return next((k for k in range(before, -1, -1) if spans[k].type in ("event", "quantity")), None)
    if held.claim is not None:
        return found.span if held.type in _SAID_OF[found.kind] else None
    between = prompt[found.end : held.end]
    words = [folded(u.text) for u in units_of(between)]
    if _STOP.search(between) or len(words) > NEAR or set(words) - _leading(found.kind, language, words):
        return None
    behind = next((k for k in range(found.span + 1, len(spans)) if spans[k].type not in ("property", "")), None)
    return behind if behind is not None and spans[behind].type in _SAID_OF[found.kind] else None


def _leading(kind: DecidingKind, language: str, words: list[str]) -> frozenset[str]:
    """Words that may stand between a deciding word and the claim that it is said of."""
    if kind in ("another", "all"):
        return ARTICLES[language]
    return _LEADING.get(kind, frozenset(words))


def _open(spec: WorldSpec, spans: Sequence[Span], found: _Found, at: int) -> bool:
    """True where nothing that is claimed judges what a word says."""
    name = str(spans[at].claim)
    if spec.claims[name].waived is not None:
        return False
    if found.kind == "another":
        return not _two(spec, name)
    if found.kind == "having":
        behind = [s for s in spans[at + 1 :] if s.type == "event"]
        return bool(behind) and not _STOP.search(spec.prompt[spans[at].end : behind[0].start])
    if found.kind == "exactly":
        return any(not _held_close(spec, p) for p in targets_of(spec.claims, name))
    if found.kind == "direction":
        own = (name, str(spans[found.span].claim)) if spans[found.span].claim is not None else (name,)
        return not any(_is_directed(spec, n) for n in own)
    return True


def _two(spec: WorldSpec, name: str) -> bool:
    """True where another claim of a thing with the same noun names other bodies."""
    own, quote = set(named_in(spec, name, "entities")), spec.claims[name].quote
    return any(
        n != name
        and c.type in ("thing", "count")
        and set(named_in(spec, n, "entities")) - own
        and (folded(quote) == "another" or same_noun(c.quote, quote))
        for n, c in spec.claims.items()
    )


def _held_close(spec: WorldSpec, pointer: str) -> bool:
    """True where a number is of the thing itself, or a bound whose other side lies close by."""
    keys = pointer.strip("/").split("/")
    if keys[0] != "story":
        return True
    at: Any = getattr(spec.story, keys[1], {}).get(keys[2])
    for key in keys[3:-1]:
        at = at[int(key)] if isinstance(at, list | tuple) and key.isdigit() and int(key) < len(at) else getattr(at, key, None)
    low, high = getattr(at, "min", None), getattr(at, "max", None)
    return bool(low and high and high <= BAND * low)


def _is_directed(spec: WorldSpec, name: str) -> bool:
    """True where a claim names a beat or requirement that says where to, or a region."""
    story = spec.story
    asked = [story.beats[n].predicate for n in named_in(spec, name, "story/beats") if n in story.beats]
    asked += [story.requirements[n].predicate for n in named_in(spec, name, "story/requirements") if n in story.requirements]
    atoms = [a for predicate in asked for a in atoms_of(predicate)]
    return any(
        getattr(a, "kind", "") in _DIRECTED or (getattr(a, "axis", None) is not None and getattr(a, "kind", "") == "displacement")
        for a in atoms
    ) or bool(named_in(spec, name, "graph/regions"))
