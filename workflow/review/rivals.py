"""Rivals of a prompt: the same words telling what the world's claims exclude, among which a reader must find the true one.

- *Roles*: what an event is told of changes places with another thing of the prompt, first where the kind of event is directed.
- *Number*: a count of one more; a quantity twice as large, where its words leave no side open.
- *Negation*: an event that never happens; what is denied, affirmed.
- *Order*: before for after.

Made from claims and prompt alone, in languages whose words are listed. What follows from the world's own story is no rival.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain, zip_longest
from typing import TYPE_CHECKING, Any

from ...worlds.claims import Reading, Span, named_in, reading_of
from ...worlds.predicates.events import event_atoms
from ...worlds.predicates.registry import PREDICATES
from ...worlds.prompts.languages import HeldKind
from ...worlds.prompts.numbers import number_in, quantity_in
from ...worlds.prompts.tables import NUMBER_LANGUAGES, table
from ...worlds.prompts.units import folded, units_of

if TYPE_CHECKING:
    from ...worlds.spec import WorldSpec

__all__ = ["rival_prompts"]

_NEVER: Mapping[str, str] = {
    "en": "never {}", "es": "nunca {}", "pt": "nunca {}", "it": "non {}", "ru": "не {}", "zh": "没有{}",
    "de": "{} nie", "nl": "{} nooit", "fr": "ne {} jamais",
}  # fmt: skip
"""Words that deny an event, by language; in German, Dutch and French around its first word, the verb."""
_AROUND_THE_VERB = ("de", "nl", "fr")
_TURNED: Mapping[str, tuple[tuple[str, str], ...]] = {
    "en": (("before", "after"), ("first", "last")),
    "de": (("bevor", "nachdem"), ("davor", "danach"), ("zuerst", "zuletzt"), ("vorher", "nachher")),
    "fr": (("avant", "après"), ("avant que", "après que")),
    "es": (("antes", "después"),),
    "it": (("prima", "dopo"),),
    "pt": (("antes", "depois"),),
    "nl": (("voordat", "nadat"), ("daarvoor", "daarna")),
    "ru": (("прежде чем", "после того как"), ("до того как", "после того как")),
    "zh": (("之前", "之后"),),
}
"""Words of order with their contrary, as `held_lists.py` has them."""

_Edit = tuple[int, int, str]
"""Begin and end in the prompt, and what stands there instead."""


def rival_prompts(spec: WorldSpec) -> list[str]:
    """Rivals of a prompt, one of each sort first; none for a world without claims."""
    reading = reading_of(spec)
    spans = [s for s in reading.spans if s.claim is not None and spec.claims[s.claim].waived is None]
    sorts = (_roles(spec, spans), _numbers(reading, spans), _denied(reading, spans), _turned(reading, spans))
    edits = [e for e in chain.from_iterable(zip_longest(*sorts)) if e is not None]
    texts = (_edited(spec.prompt, e) for e in edits)
    return list(dict.fromkeys(t for t in texts if folded(t) != folded(spec.prompt)))


def _edited(text: str, edits: list[_Edit]) -> str:
    """The text with parts of it replaced; blanks that a removed word leaves are taken away with it."""
    for start, end, new in sorted(edits, reverse=True):
        gap = not new and text[:start].endswith(" ") and text[end : end + 1] in (" ", ".", ",", "")
        text = text[: start - gap] + new + text[end:]
    begin = text.lstrip()
    return begin[:1].upper() + begin[1:]


# ---------------------------------------------------------------- roles


def _roles(spec: WorldSpec, spans: list[Span]) -> Iterator[list[_Edit]]:
    """Two things of the prompt in each other's place: doer and done-to first, then whom an event is told of and another thing."""
    things = [s for s in spans if s.type == "thing" and s.claim is not None]
    events = [(s, atom) for s in spans if s.type == "event" for atom in _atoms(spec, str(s.claim))]
    told = {(atom.kind, atom.entity, getattr(atom, "other", None)) for _, atom in events}
    of = {(atom.kind, atom.entity) for _, atom in events}
    later = list[list[_Edit]]()
    for event, atom in events:
        doer = _nearest(spec, things, atom.entity, event)
        other = getattr(atom, "other", None)
        if doer is None:
            continue
        if PREDICATES[atom.kind].directed and (atom.kind, other, atom.entity) not in told:
            done_to = _nearest(spec, things, other, event)
            if done_to is not None:
                yield _exchanged(doer, done_to)
                continue
        strange = [s for s in things if s.text != doer.text and not _speaks(spec, s, atom.entity)]
        strange = [s for s in strange if not any(k == atom.kind and _speaks(spec, s, body) for k, body in of)]
        if strange:
            alike = len(named_in(spec, str(doer.claim), "entities"))  # one thing for another, not for many
            best = min(strange, key=lambda s: (len(named_in(spec, str(s.claim), "entities")) != alike, _apart(s, event)))
            later.append(_exchanged(doer, best))
    yield from later


def _atoms(spec: WorldSpec, claim: str) -> list[Any]:
    """Events of bodies that the beats of a claim ask for."""
    beats = [spec.story.beats[b] for b in named_in(spec, claim, "story/beats") if b in spec.story.beats]
    return [a for beat in beats for a in event_atoms(beat.predicate) if getattr(a, "entity", None)]


def _speaks(spec: WorldSpec, span: Span, body: str | None) -> bool:
    return body is not None and body in named_in(spec, str(span.claim), "entities")


def _nearest(spec: WorldSpec, things: list[Span], body: str | None, event: Span) -> Span | None:
    """The span of a body that stands nearest to an event."""
    return min((s for s in things if _speaks(spec, s, body)), key=lambda s: _apart(s, event), default=None)


def _apart(one: Span, other: Span) -> int:
    return max(other.start - one.end, one.start - other.end)


def _exchanged(one: Span, other: Span) -> list[_Edit]:
    return [(one.start, one.end, other.text), (other.start, other.end, one.text)]


# ---------------------------------------------------------------- numbers


def _numbers(reading: Reading, spans: list[Span]) -> Iterator[list[_Edit]]:
    language = reading.language
    for span in (s for s in spans if s.type in ("count", "quantity")):
        held = _held(reading, span, "number")
        if len(held) != 1 or language is None:
            continue
        start, end, text = held[0]
        more = _other_number(span, number_in(text, language), language)
        if more is not None:
            yield [(start, end, _written(text, more, language))]


def _held(reading: Reading, span: Span, kind: HeldKind) -> list[_Edit]:
    """Words of a span that cannot be filler: begin and end in the prompt, and the words."""
    inside = (h for h in reading.held if h.kind == kind and span.start <= h.start and h.end <= span.end)
    return [(h.start, h.end, span.text[h.start - span.start : h.end - span.start]) for h in inside]


def _other_number(span: Span, value: float | None, language: str) -> float | None:
    """A number that the words of a claim exclude; None where they leave a side open, or one thing would need another grammar."""
    if value is None:
        return None
    if span.type == "count":
        return value + 1 if value > 1 and value == int(value) else None
    quantity = quantity_in(span.text, language)
    open_side = quantity is not None and quantity.how in ("at least", "at most")
    return None if open_side or value == 0 else 2 * value


def _written(text: str, value: float, language: str) -> str:
    """A number as the text writes its own: in words where it does and they are listed, else in digits."""
    known: Mapping[str, Any] = table("numbers")["languages"].get(language, {}) if language in NUMBER_LANGUAGES else {}
    words = known.get("cardinals", {}).get(f"{value:g}")
    if words and not any(c.isdecimal() for c in text):
        return str(words[0]).capitalize() if text[:1].isupper() else str(words[0])
    return f"{value:g}".replace(".", str(known.get("decimal", ".")))


# ---------------------------------------------------------------- negation and order


def _denied(reading: Reading, spans: list[Span]) -> Iterator[list[_Edit]]:
    """Edits that affirm what is denied, then those that deny an event each."""
    language = reading.language
    for span in (s for s in spans if s.type == "negation"):
        words = _held(reading, span, "negation")
        if words and len(words) < len(units_of(span.text)):
            yield [(start, end, "") for start, end, _ in words]
    if language is None or language not in _NEVER:
        return
    for span in (s for s in spans if s.type == "event"):
        first = units_of(span.text)[0].end if language in _AROUND_THE_VERB else len(span.text)
        yield [(span.start, span.start + first, _NEVER[language].format(span.text[:first]))]


def _turned(reading: Reading, spans: list[Span]) -> Iterator[list[_Edit]]:
    pairs = _TURNED.get(reading.language or "", ())
    contrary = {a: b for one, other in pairs for a, b in ((one, other), (other, one))}
    for span in (s for s in spans if s.type == "order"):
        for start, end, word in _held(reading, span, "order"):
            new = contrary.get(folded(word))
            if new is not None:
                yield [(start, end, new.capitalize() if word[:1].isupper() else new)]
