"""The thing that an event of crossing is told to cross: that right behind its verb (R131, R155).

`A cart crosses the bridge`: from one side of the bridge to the other, over it. A plane in space, which the predicate `crosses` asks for, may stand
anywhere; the thing that is named does not. The rule that measures it: `verifiers/claims/crossings.py`. Open ground has no sides that one
comes to: who crosses a floor goes some way over it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import regex

from .claim_targets import named_in
from .predicates import Crosses, atoms_of
from .roles import PREPOSITIONS, surroundings, words_in

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .claim_targets import Span
    from .spec import WorldSpec

__all__ = ["crossed_by", "crossing_warnings"]


def _listed(words: str) -> frozenset[str]:
    return frozenset(words.split())


VERBS: Mapping[str, str] = {
    "en": r"cross(?:es|ed|ing)?|travers(?:es?|ed|ing)",
    "de": r"überquer(?:t|en|te|ten)|kreuz(?:t|en)",
    "fr": r"travers(?:e|ent|er)|franchi(?:t|ssent|r)",
    "es": r"cruza(?:n|r)?|atraviesan?|atravesar",
    "it": r"attravers(?:a|ano|are)",
    "pt": r"atravess(?:a|am|ar)|cruza(?:m|r)?",
    "nl": r"kruis(?:t|en)|overschrijd(?:t|en)",
    "ru": r"пересека(?:ет|ют|ть)|переезжа(?:ет|ют)",
    "zh": r"穿过|越过|横穿",
    "ja": r"横切|渡",
}
"""Verbs of crossing. Reviewed by hand; what passes, enters or leaves something needs no other side."""
OPEN = _listed(
    "floor ground earth room hall kitchen yard courtyard field meadow lawn grass plain desert sand snow ice sea ocean sky air scene screen picture frame image stage park lot playground square valley "
    "boden fußboden zimmer raum halle hof feld wiese rasen ebene wüste meer himmel bild bühne sol plancher pièce salle cour champ pré désert mer ciel suelo piso sala habitación "
    "patio campo prado desierto mar cielo pavimento stanza cortile prato deserto mare cielo chão quarto campo gramado deserto vloer grond kamer zaal veld weide woestijn zee "
    "пол земля земле земля комнату двор поле пустыню море небо 地板 地面 房间 床 部屋"
)
"""Nouns of what has no sides that one comes to. Reviewed by hand."""


def crossed_by(spec: WorldSpec, spans: Sequence[Span], name: str, language: str | None) -> frozenset[str]:
    """Bodies that an event's words say are crossed; empty where they say nothing of that, or name open ground.

    Args:
        spec: the specification.
        spans: of its prompt, in order.
        name: of the claim of the event.
        language: code of the language of the prompt.
    """
    index = _said(spec, spans, name, language)
    if index is None:
        return frozenset()
    place = surroundings(spec, spans, index)
    if set(place.between) & PREPOSITIONS or _open(spec, place.next):
        return frozenset()
    return place.next


def crossing_warnings(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[str]:
    """A line for each event of crossing by a plane whose words name no body that it crosses: where the plane stands is the agent's reading."""
    for name, claim in spec.claims.items():
        beats = [spec.story.beats[b].predicate for b in named_in(spec, name, "story/beats") if b in spec.story.beats]
        planes = any(isinstance(a, Crosses) for p in beats for a in atoms_of(p))
        if planes and _said(spec, spans, name, language) is not None and not crossed_by(spec, spans, name, language):
            yield (
                f"{claim.quote!r} is judged by a plane, and no thing with sides of its own is marked right behind it: "
                "where the plane stands is the agent's reading"
            )


def _said(spec: WorldSpec, spans: Sequence[Span], name: str, language: str | None) -> int | None:
    """Index of the span of an event whose words say that something is crossed."""
    claim = spec.claims[name]
    pattern = VERBS.get(language or "")
    if pattern is None or claim.type != "event" or claim.waived is not None:
        return None
    bounded = pattern if language in ("zh", "ja") else rf"\b(?:{pattern})\b"
    if regex.search(bounded, claim.quote, regex.IGNORECASE) is None:
        return None
    return next((k for k, s in enumerate(spans) if s.claim == name), None)


def _open(spec: WorldSpec, bodies: frozenset[str]) -> bool:
    """True where a thing is called by a noun of open ground."""
    for name, claim in spec.claims.items():
        if claim.type == "thing" and bodies & set(named_in(spec, name, "entities")) and OPEN & set(words_in(claim.quote)[-1:]):
            return True
    return False
