"""Words of order and the two events that they put in order, by where their spans stand (R131, R155).

`A before B` and `before B, A` say the same, and so do `B after A` and `after A, B`; `then` leads from what stands before it to the event of its own
clause. `first` and `finally` say that the event of their clause begins or ends what is told, `at the same time` that two events of its sentence, or
one and the last before it, come at once. Events that one subject does, bound by `and`, stand together: `rolls and falls, then`. Words that are not
in `prompts/order_words.py`, and languages without reviewed lists, leave the order to the agent's reading, which the verdict prints.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise, permutations
from typing import TYPE_CHECKING, NamedTuple

import regex

from .prompts.held_lists import ORDERS
from .prompts.order_words import ALONE, WORDS
from .prompts.units import APOSTROPHES, folded, units_of

if TYPE_CHECKING:
    from .claim_targets import Span
    from .prompts.order_words import OrderKind
    from .spec import WorldSpec

__all__ = ["Ordered", "orders_said", "says_together"]

_WHILE = regex.compile(
    r"\s*(?:\p{L}+\s+){0,2}(?:while|moment|moments|bit|time|instant|seconds?|minutes?|s|weile|moment|augenblick|zeit|sekunden?|minuten?|instant|"
    r"secondes?|rato|segundos?|minutos?|momento|secondi|secondo|minuti|po'|tempo|instante|tijdje|seconden?|ogenblik)\b",
    regex.IGNORECASE,
)
"""Lengths of time behind `after`: they make it `then`, as `after a while`."""
_AND = frozenset(("and", "und", "et", "y", "e", "en", "и", "并", "且"))
_UNSPACED = ("zh", "ja")
_SENTENCE = regex.compile(r"[.!?…;。！？；\n]|\s[—–]\s")
_COMMA = regex.compile(r"[,，、]")
_CLAUSE = regex.compile(
    r"[.!?…;。！？；\n,，、:()]|[—–]|\b(?:and|und|et|y|e|en|и|but|aber|mais|pero|ma|mas|maar|но)\b", regex.IGNORECASE
)


class Ordered(NamedTuple):
    """One reading of a word of order: one of the earlier spans before one of the later ones."""

    earlier: tuple[str, ...]
    """Claims of events that stand together."""
    later: tuple[str, ...]
    together: bool = False
    """True where both come at once."""


def orders_said(spec: WorldSpec, spans: Sequence[Span], index: int, language: str | None) -> list[Ordered]:
    """Readings of a claim of order that its place allows; none where its word, its language or its place tells of none.

    Args:
        spec: the specification.
        spans: of its prompt, in order.
        index: of the span of order among them.
        language: code of the language of the prompt.
    """
    kind = _kind(spans[index].text, language)
    if kind is None:
        return []
    rest = spec.prompt[spans[index].end :]
    if kind == "after" and (_WHILE.search(spans[index].text) or _WHILE.match(rest) or _is_number(spans, index + 1)):
        kind = "then"
    events = [k for k, s in enumerate(spans) if s.claim is not None and s.type in ("event", "negation")]
    left, right = [k for k in events if k < index], [k for k in events if k > index]
    if kind == "then":
        pairs = list(_then(spec, spans, index, left, right, language))
    elif kind in ("first", "last"):
        pairs = list(_ends(spec, spans, index, kind, left, right))
    elif kind == "together":
        pairs = list(_at_once(spec, spans, index, left, right))
    else:
        pairs = list(_joined(spec, spans, index, kind, left, right))
    if any(_denies(spec, spans, k) for pair in pairs for k in pair):
        return []
    if kind == "together":
        return [Ordered((str(spans[a].claim),), (str(spans[b].claim),), together=True) for a, b in pairs]
    return [Ordered(_together(spec, spans, a, index, b), _together(spec, spans, b, index, a)) for a, b in pairs]


def _kind(text: str, language: str | None) -> OrderKind | None:
    """The way in which the words of a claim put events in order."""
    plain = _plain(text, language)
    own = WORDS.get(language or "", {})
    listed = {word for words in own.values() for word in words}
    if any(" " in phrase and phrase not in listed and f" {phrase} " in f" {plain} " for phrase in ORDERS.get(language or "", ())):
        return None  # `one after another` has an `after` of its own.
    found: list[tuple[int, OrderKind]] = []
    for kind, words in own.items():
        for word in words:
            form = _plain(word, language)
            if kind in ALONE:
                met = form == " ".join(w for w in plain.split() if w not in _AND)
            else:
                met = form in plain if language in _UNSPACED else f" {form} " in f" {plain} "
            if met:
                found.append((len(form), kind))
    return max(found)[1] if found else None


def _plain(text: str, language: str | None) -> str:
    """Words of a text, folded and apart by one blank; in languages without blanks the text without what stands around it."""
    if language in _UNSPACED:
        return text.strip(" ，,。、")
    return " ".join(folded(u.text.translate(APOSTROPHES)) for u in units_of(text))


def says_together(text: str, language: str | None) -> bool:
    """True of words that say that two events come at once."""
    return _kind(text, language) == "together"


def _is_number(spans: Sequence[Span], at: int) -> bool:
    """True where nothing but blanks and the claim of a quantity come next."""
    while at < len(spans) and spans[at].claim is None and not units_of(spans[at].text):
        at += 1
    return at < len(spans) and spans[at].type == "quantity"


def _denies(spec: WorldSpec, spans: Sequence[Span], at: int) -> bool:
    """True of what is no event that happens, as `must [not](negation) snap`: nothing comes before or after it."""
    if spans[at].type != "event" or spec.claims[str(spans[at].claim)].waived is not None:
        return True
    denials = [k for k in range(at) if spans[k].type == "negation" and not _CLAUSE.search(_between(spec, spans, k, at))]
    return any(not any(s.type == "event" for s in spans[k + 1 : at]) for k in denials)


def _between(spec: WorldSpec, spans: Sequence[Span], a: int, b: int) -> str:
    """Text of the prompt between two spans."""
    return spec.prompt[spans[a].end : spans[b].start]


def _together(spec: WorldSpec, spans: Sequence[Span], at: int, word: int, other: int) -> tuple[str, ...]:
    """An event and those that the same subject does beside it, up to a word of order and to the `other` event: `falls on a table and wobbles`."""
    events = [k for k, s in enumerate(spans) if s.claim is not None and s.type == "event" and (k < word) == (at < word)]
    place, found = events.index(at), [at]
    for step in (-1, 1):
        k = place
        while 0 <= k + step < len(events):
            one, two = sorted((events[k], events[k + step]))
            if other in (one, two) or not _same_subject(spec, spans, one, two):
                break
            k += step
            found.append(events[k])
    return tuple(str(spans[k].claim) for k in sorted(found))


def _same_subject(spec: WorldSpec, spans: Sequence[Span], one: int, two: int) -> bool:
    """True where the later event follows `and` or a comma right before it, in the same sentence: no other subject stands there."""
    if _SENTENCE.search(_between(spec, spans, one, two)) or spans[two - 1].claim is not None:
        return False
    gap = spans[two - 1].text
    words = [folded(u.text) for u in units_of(gap)]
    return (
        bool(words and words[-1] in _AND)
        or (not words and bool(_COMMA.search(gap)))
        or (bool(words) and gap.rstrip()[-1:] == ",")
    )


def _then(
    spec: WorldSpec, spans: Sequence[Span], index: int, left: list[int], right: list[int], language: str | None
) -> Iterator[tuple[int, int]]:
    """The event of the word's own clause, after the nearest one before that."""
    near = [k for k in right[:1] if not any(s.type == "order" for s in spans[index + 1 : k])]
    own_right = [k for k in near if not _CLAUSE.search(_between(spec, spans, index, k))]
    own_left = [k for k in left[-1:] if not _CLAUSE.search(_between(spec, spans, k, index))]
    if own_left and left[:-1] and not own_right and language != "zh":
        yield left[-2], left[-1]
    elif near and left and not _SENTENCE.search(_between(spec, spans, index, near[0])):
        yield left[-1], near[0]
        if own_left and own_right and left[:-1] and language in ("de", "nl"):
            # `er fällt dann auf einen Boden, der bebt`: behind its verb.
            yield left[-2], left[-1]


def _ends(
    spec: WorldSpec, spans: Sequence[Span], index: int, kind: OrderKind, left: list[int], right: list[int]
) -> Iterator[tuple[int, int]]:
    """The event of the clause of `first` before others, or that of `finally` behind them: those of its sentence, else the nearest one."""
    near = [k for k in left[-1:] if not _CLAUSE.search(_between(spec, spans, k, index))]
    ahead = [k for k in right[:1] if not _SENTENCE.search(_between(spec, spans, index, k))]
    ahead = [k for k in ahead if not near or not _CLAUSE.search(_between(spec, spans, index, k))]
    for own in (*near, *ahead):
        before = [k for k in (*left, *right) if k < own][::-1]
        behind = [k for k in right if k > own]
        others = (behind or before) if kind == "first" else before
        beside = [k for k in others if not _SENTENCE.search(_between(spec, spans, *sorted((k, own))))]
        for other in dict.fromkeys((*beside, *others[:1])):
            yield (own, other) if kind == "first" else (other, own)


def _at_once(spec: WorldSpec, spans: Sequence[Span], index: int, left: list[int], right: list[int]) -> Iterator[tuple[int, int]]:
    """Every two events of a sentence, and, where none of it stands before the word, the last one before that with each of them."""
    mine = [k for k in left if not _SENTENCE.search(_between(spec, spans, k, index))]
    mine += [k for k in right if not _SENTENCE.search(_between(spec, spans, index, k))]
    if left and left[-1] not in mine:
        mine = [left[-1], *mine]
    yield from permutations(mine, 2)


def _joined(
    spec: WorldSpec, spans: Sequence[Span], index: int, kind: OrderKind, left: list[int], right: list[int]
) -> Iterator[tuple[int, int]]:
    """The events of the two clauses that a conjunction joins, in the order that it tells."""
    if (
        not right
        or _COMMA.search(_between(spec, spans, index, right[0]))
        or _SENTENCE.search(_between(spec, spans, index, right[0]))
    ):
        return
    joined = [folded(u.text) for u in units_of(_between(spec, spans, index, right[0]))]
    if joined and joined[-1] in _AND:
        return  # `drops after it and rolls`: the word speaks of a thing, and which event of that is meant is the agent's reading
    opens = (
        not left or bool(_SENTENCE.search(_between(spec, spans, left[-1], index))) or _opens_behind(spec, spans, left[-1], index)
    )
    if not opens:
        yield (left[-1], right[0]) if kind == "before" else (right[0], left[-1])
    else:
        for main in _mains(spec, spans, right):
            yield (main, right[0]) if kind == "before" else (right[0], main)


def _opens_behind(spec: WorldSpec, spans: Sequence[Span], at: int, index: int) -> bool:
    """True where a word of order opens a clause of its own behind `and` or another joining word: `it rolls, and after it hits, it falls`."""
    gap = spec.prompt[spans[at].end : spans[index].start].rstrip()
    words = [folded(u.text) for u in units_of(gap)]
    return bool(words) and words[-1] in _AND and bool(_COMMA.search(gap))


def _mains(spec: WorldSpec, spans: Sequence[Span], right: list[int]) -> Iterator[int]:
    """Events that may be those of the main clause behind a clause that opens the sentence: the first behind each comma, in its sentence."""
    first = right[0]
    for before, k in pairwise(right):
        if _SENTENCE.search(_between(spec, spans, first, k)):
            return
        if _COMMA.search(_between(spec, spans, before, k)):
            yield k
