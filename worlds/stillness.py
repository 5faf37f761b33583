"""Negations of motion as such, `does not move`, `stays still`: what denies them says how far or how fast a body never goes (R131, R155).

A body that never rolls may slide, tip and fly: only a bound on how far or how fast it goes says that it does not move. In English a bare verb
of motion is sure, and so are words of a lasting state; where more words follow, or words of order stand in the sentence, the verdict warns,
and so it does in other languages.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import regex

from .claim_targets import named_in
from .predicates import Count, Displacement, Eventually, Or, Speed, atoms_of
from .prompts.languages import held_words
from .prompts.units import units_of
from .prompts.wordnet import lemmas

if TYPE_CHECKING:
    from .claim_targets import Span
    from .spec import Requirement, SpecModel, WorldSpec

__all__ = ["STIR", "Still", "loose_requirement", "stillness_of", "stillness_warnings"]

STIR = 0.1
"""Own choice: a body that goes a tenth of its least extent is seen to have moved."""
CREEP = 0.05
"""[m/s] Own choice: greatest least speed of what is said not to move; a body that is knocked on is faster."""
MOVES = frozenset(("move", "budge", "stir", "shift"))
"""English verbs of motion as such. Reviewed by hand."""
STATES: Mapping[str, str] = {
    "en": r"(?:stay|remain|stand|sit|lie|keep|hold|rest)(?:s|ed|ing)? (?:quite |perfectly |completely |absolutely )?(?:still|put|motionless|in place|"
    r"where (?:it|he|she) (?:is|was|stands|stood)|where they (?:are|were|stand|stood))|(?:stays|stay|remains|remain) unmoved",
    "de": r"(?:bleib(?:t|en)|blieb(?:en)?|verharr(?:t|en)) (?:völlig |ganz )?(?:unbewegt|reglos|regungslos|bewegungslos|an ort und stelle|am platz)",
    "fr": r"(?:reste(?:nt)?|demeure(?:nt)?) (?:immobiles?|en place|sur place)",
    "es": r"(?:(?:se )?queda(?:n)?|permanecen?) (?:inmóvil(?:es)?|quiet[oa]s?|en su sitio|en su lugar)",
    "it": r"(?:resta(?:no)?|rimane|rimangono) (?:immobil[ei]|ferm[oaie]|al (?:suo )?posto)",
    "pt": r"(?:fica|ficam|permanecem?) (?:imóvel|imóveis|parad[oa]s?|no lugar)",
    "nl": r"(?:blijft|blijven) (?:onbeweeglijk|roerloos|op (?:zijn|haar|hun) plaats)",
}
"""Words of a lasting rest. Reviewed by hand."""
VERBS: Mapping[str, str] = {
    "de": r"beweg(?:t|en)|rühr(?:t|en)",
    "fr": r"boug(?:e|ent|er)|déplac(?:e|ent|er)",
    "es": r"muev(?:e|en)|mover(?:se)?",
    "it": r"muov(?:e|ono)|muover(?:e|si)",
    "pt": r"mov(?:e|em|er)|mex(?:e|em|er)",
    "nl": r"beweegt|bewegen",
    "ru": r"дви(?:гается|гаются|жется|жутся|гаться)|шевел(?:ится|ятся|иться)",
}
"""Verbs of motion as such in other languages. Reviewed by hand."""
BARE = regex.compile(
    r"\s*(?:$|(?:at all|anywhere|an inch|a millimet(?:re|er)|a bit|one bit|even|from (?:its|the|their) (?:place|spot))\b)"
)
"""Words behind a verb of motion that leave it as it is."""
ONWARDS = regex.compile(
    r"\s*(?:the|a|an|its|their|it|them|until|till|before|after|when|while|as|because|and|but|or|during|though|although)\b"
)
"""Words behind it that end what it says, or name whom it moves."""
_END = regex.compile(r"[.;:!?…,()\n]|[—–]")
_CLAUSE = regex.compile(r"[.;:!?…,()\n]|[—–]|\b(?:und|et|y|e|en|и|and|but|aber|mais|pero|ma|mas|maar|но)\b", regex.IGNORECASE)


class Still(NamedTuple):
    """Words that say that something does not move."""

    words: str
    sure: bool
    """True where the rule decides it; else it is a warning."""


def stillness_of(prompt: str, spans: Sequence[Span], index: int, language: str | None) -> Still | None:
    """Words of rest in a negation; None where it denies something else, or nothing is known of its words.

    Args:
        prompt: text of it.
        spans: of the prompt, in order.
        index: of the span of the negation among them.
        language: code of the language of the prompt.
    """
    span = spans[index]
    state = (
        regex.search(rf"\b(?:{STATES[language]})\b", span.text, regex.IGNORECASE)
        if language is not None and language in STATES
        else None
    )
    if state is not None:
        return Still(state.group(), language == "en" and not _ordered(prompt, span, language))
    if language == "en":
        return _denied(prompt, spans, index)
    if language is None or language not in VERBS:
        return None
    start = max((m.end() for m in _CLAUSE.finditer(prompt, 0, span.start)), default=0)
    behind = _CLAUSE.search(prompt, span.end)
    end = len(prompt) if behind is None else behind.start()
    if any(s.type == "event" and s.start < end and s.end > start for s in spans):
        return None
    verb = regex.search(rf"\b(?:{VERBS[language]})\b", prompt[start:end], regex.IGNORECASE)
    return Still(verb.group(), sure=False) if verb is not None else None


def stillness_warnings(spec: WorldSpec, language: str | None) -> Iterator[str]:
    """A line for each claim of another type than a negation whose words say that something stays at rest, where nothing that it names bounds its motion."""
    if language is None or language not in STATES:
        return
    for name, claim in spec.claims.items():
        state = regex.search(rf"\b(?:{STATES[language]})\b", claim.quote, regex.IGNORECASE)
        if state is None or claim.waived is not None or claim.type in ("negation", "event", "order"):
            continue
        told = {r: spec.story.requirements[r] for r in named_in(spec, name, "story/requirements") if r in spec.story.requirements}
        denied = {r: q for r, q in told.items() if q.never}
        lasting = [a for q in told.values() if not q.never for a in atoms_of(q.predicate)]
        held = any(isinstance(a, Displacement | Speed) and a.when == "always" and a.max is not None for a in lasting)
        if not held and (not denied or loose_requirement(spec, denied) is not None):
            text = f"{claim.quote!r} says by {state.group()!r} that it does not move, and nothing that it names bounds its motion: mark it as negation, "
            yield text + "by a requirement with never: true of a `displacement`"


def _denied(prompt: str, spans: Sequence[Span], index: int) -> Still | None:
    """A bare English verb of motion that a negation denies: its own, or the next word behind it."""
    span = spans[index]
    refusals = [h for h in held_words(prompt, "en") if h.kind == "negation"]
    own = [
        u
        for u in units_of(prompt)
        if span.start <= u.start < span.end and not any(h.start < u.end and u.start < h.end for h in refusals)
    ]
    behind = [u for u in units_of(prompt) if u.start >= span.end][:1] if not own and not _END.search(span.text) else []
    for unit in [*own, *behind]:
        if not MOVES & set(lemmas(unit.text, "v")) or (unit in behind and _END.search(prompt, span.end, unit.start)):
            continue
        stop = _END.search(prompt, unit.end)
        rest = prompt[unit.end : len(prompt) if stop is None else stop.start()].casefold()
        if BARE.match(rest):
            return Still(unit.text, not _ordered(prompt, span, "en"))
        return Still(unit.text, sure=False) if ONWARDS.match(rest) else None
    return None


def _ordered(prompt: str, span: Span, language: str) -> bool:
    """True where words of order stand in the sentence of a span: it may rest for a while alone."""
    start = max((prompt.rfind(mark, 0, span.start) for mark in ".!?;\n"), default=-1)
    end = min((k for mark in ".!?;\n" if (k := prompt.find(mark, span.end)) >= 0), default=len(prompt))
    return any(h.kind == "order" and start < h.start < end for h in held_words(prompt, language))


def loose_requirement(spec: WorldSpec, asked: Mapping[str, Requirement]) -> str | None:
    """Why none of some requirements with `never` says that a body does not move; None where one does."""
    found = [(n, why) for n, r in asked.items() for why in _each(spec, r.predicate)]
    if any(not why for _, why in found):
        return None
    first = next(iter(asked))
    told = next(
        (why for _, why in found if why != "other"),
        f"{first!r} denies {asked[first].predicate.kind}, beside which it may move as it likes",
    )
    return f"{told}: give {first!r} a `displacement` with `min` at most {STIR:g} of its least extent, or a `speed` with `min` at most {CREEP:g}"


def _each(spec: WorldSpec, predicate: SpecModel, each: str | None = None) -> Iterator[str]:
    """For every atom that a requirement denies, why it is no bound on motion; empty where it is one."""
    if isinstance(predicate, Or):
        for member in predicate.of:
            yield from _each(spec, member, each)
    elif isinstance(predicate, Count) and predicate.max is None and (predicate.min or 0) <= 1:
        for name in predicate.entities:
            yield from _each(spec, predicate.predicate, name)
    elif isinstance(predicate, Eventually) and predicate.frames is None:
        yield from _each(spec, predicate.predicate, each)
    elif (
        isinstance(predicate, Displacement)
        and predicate.when == "eventually"
        and predicate.max is None
        and predicate.axis is None
    ):
        entity = spec.entities.get(each if each and predicate.entity == "each" else predicate.entity)
        most = STIR * min(entity.dimensions.size) if entity is not None else 0.0
        least = predicate.min or 0.0
        yield (
            ""
            if entity is None or least <= most * (1.0 + 1e-9)
            else f"it may go {least:g} m and still not have moved, at most {most:.3g} m"
        )
    elif isinstance(predicate, Speed) and predicate.when == "eventually" and predicate.max is None:
        yield "" if (predicate.min or 0.0) <= CREEP else f"it may go at {predicate.min:g} m/s and still not have moved"
    else:
        yield "other"
