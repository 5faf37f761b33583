"""Words of posture beside a word of place: what stands, sits, hangs, leans or lies there, and at which frames the words speak of it (R131, R155).

`A vase stands on the table` says more than where it is: it is at rest and upright there, from the first frame on unless an event before these
words brings it there. A verb counts where it is in the place's own words, stands directly before them, one adverb between, or where the
place begins its sentence and the verb follows; in Chinese and Japanese anywhere in its clause. A verb that a claim of another type takes up is
judged by that, as `sits on it` by its beat. The rules that measure it: `verifiers/claims/described/postures.py`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Literal, NamedTuple, get_args

import regex

from .claim_targets import named_in
from .errors import InputError
from .prompts.languages import held_words, language_of
from .prompts.marks import occurrence
from .roles import PREPOSITIONS, words_in

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = ["POSES", "VERBS", "Pose", "Posed", "pose_said", "spoken_later", "subjects_of"]

Pose = Literal["stand", "sit", "hang", "lean", "lie"]
POSES: frozenset[str] = frozenset(get_args(Pose))
VERBS: Mapping[str, Mapping[Pose, str]] = {
    "en": {
        "stand": r"stands?|stood|standing",
        "sit": r"sits?|sat|sitting|perched|perches|perching",
        "hang": r"hangs?|hung|hanging|dangles?|dangling|suspended",
        "lean": r"leans?|leant|leaned|leaning|propped(?: up)?",
        "lie": r"lies?|lay|lying",
    },
    "de": {
        "stand": r"steht|stehen|standen|stehende[nrsm]?",
        "sit": r"sitzt|sitzen|saß(?:en)?|sitzende[nrsm]?",
        "hang": r"hängt|hängen|hing(?:en)?|hängende[nrsm]?|baumelt|baumeln",
        "lean": r"lehnt|lehnen|lehnten?|angelehnt|lehnende[nrsm]?",
        "lie": r"liegt|liegen|lag(?:en)?|liegende[nrsm]?",
    },
    "fr": {
        "stand": r"se dresse(?:nt)?|se tient debout|se tiennent debout",
        "sit": r"assise?s?",
        "hang": r"pend|pendent|suspendue?s?|accrochée?s?",
        "lean": r"appuyée?s?|adossée?s?|s'appuie(?:nt)?|s'adosse(?:nt)?",
        "lie": r"gît|gisent|couchée?s?|allongée?s?",
    },
    "es": {
        "stand": r"est(?:á|án) de pie|se alzan?|se yerguen?",
        "sit": r"sentad[oa]s?",
        "hang": r"cuelgan?|colgad[oa]s?|penden?|suspendid[oa]s?",
        "lean": r"apoyad[oa]s?|se apoyan?|recostad[oa]s?",
        "lie": r"yacen?|tumbad[oa]s?|tendid[oa]s?",
    },
    "it": {
        "stand": r"sta in piedi|stanno in piedi|si erge|si ergono",
        "sit": r"sedut[oaie]|siede|siedono",
        "hang": r"pende|pendono|appes[oaie]|sospes[oaie]",
        "lean": r"appoggiat[oaie]|si appoggia(?:no)?",
        "lie": r"giac(?:e|ciono)|sdraiat[oaie]|coricat[oaie]",
    },
    "pt": {
        "stand": r"est(?:á|ão) de pé|ergue-se|erguem-se|se erguem?",
        "sit": r"sentad[oa]s?",
        "hang": r"pendem?|pendurad[oa]s?|suspens[oa]s?",
        "lean": r"encostad[oa]s?|apoiad[oa]s?|se apoiam?",
        "lie": r"jaz|jazem|deitad[oa]s?",
    },
    "nl": {
        "stand": r"staat|staan|stond(?:en)?|staande",
        "sit": r"zit|zitten|zat(?:en)?|zittende?",
        "hang": r"hangt|hangen|hing(?:en)?|hangende?|bungelt|bungelen",
        "lean": r"leunt|leunen|leunden?|leunende?",
        "lie": r"ligt|liggen|lag(?:en)?|liggende?",
    },
    "ru": {
        "stand": r"сто(?:ит|ят|ял|яла|яло|яли)",
        "sit": r"сид(?:ит|ят|ел|ела|ело|ели)",
        "hang": r"вис(?:ит|ят|ел|ела|ело|ели)|свиса(?:ет|ют)|подвешен[аоы]?",
        "lean": r"прислон[её]н[аоы]?|опира(?:ется|ются)",
        "lie": r"леж(?:ит|ат|ал|ала|ало|али)",
    },
    "zh": {
        "stand": r"立着|立在|竖立|站在|站着",
        "sit": r"坐在|坐着",
        "hang": r"挂在|挂着|悬挂|吊在|吊着|掛在|掛著",
        "lean": r"靠在|靠着|斜靠|倚着|倚在",
        "lie": r"躺在|躺着|平放|横卧",
    },
    "ja": {
        "stand": r"立って(?:い|お)|立つ|立てられて",
        "sit": r"座って(?:い|お)",
        "hang": r"ぶら下が|吊るされて|吊り下げられて|掛かって(?:い|お)|掛けられて",
        "lean": r"もたれ|寄りかか|立てかけ",
        "lie": r"横たわ",
    },
}
"""Verbs and participles of posture by language. Reviewed by hand; French *posé*, Spanish *está*, Italian *si trova* say no posture and are not here."""
_BARE = regex.compile(r"\b(?:stand|sit|hang|lean|lie)\b", regex.IGNORECASE)
"""English forms of which a noun or an imperative may be meant: `on a cake stand`."""
_PARTICIPLE = regex.compile(r"\w+ing|hung|suspended|perched|leant|leaned|propped(?: up)?", regex.IGNORECASE)
"""English forms that may describe the noun before them."""
_PLURAL = regex.compile(r"(?:(?<![su])s|\band \S+|\b(?:people|men|women|children|geese|sheep|mice|dice|that|which|who|they|we|you))\s*(?:\w+ly\s*)?$", regex.IGNORECASE)  # fmt: skip
_DENIED = regex.compile(r"\b(?:not|never|no longer|nicht|nie|kein\w*|ne|pas|no|non|nunca|mai|não|nao|niet|nooit|не)\s*$|n['’]t\s*$|[不没]$", regex.IGNORECASE)  # fmt: skip
_SENTENCE = regex.compile(r"[.!?…;。！？；\n]")
_CLAUSE = regex.compile(r"[.!?…;。！？；\n，,、:：]")
_JUTS = regex.compile(
    r"\b(?:edge|rim|brink|side|end|lip|kante|rand|bord|borde|bordo|beira|borda|край|края)\b|边", regex.IGNORECASE
)
"""Nouns beside which *hangs* says that something juts out: `hangs over the edge of the table`."""
_UNSPACED = frozenset(("zh", "ja"))
_OWN = frozenset(("place", "property", "route", "look"))
"""Types of claims that do not take a verb up."""


class Posed(NamedTuple):
    """A posture that the words beside a place say."""

    pose: Pose
    word: str
    start: int
    """Place in the prompt at which its verb begins."""


def pose_said(spec: WorldSpec, name: str) -> Posed | None:
    """The posture that the words of a claim of place say, or those beside it; None where there is none, or it is denied or judged elsewhere."""
    claim, prompt = spec.claims[name], spec.prompt
    language = language_of(prompt)
    if claim.type != "place" or claim.waived is not None or language is None or language not in VERBS:
        return None
    span = _span(spec, name)
    if span is None:
        return None
    for start, end in _looked_at(prompt, span, language):
        for pose, verbs in VERBS[language].items():
            pattern = verbs if language in _UNSPACED else rf"\b(?:{verbs})\b"
            for found in regex.finditer(pattern, prompt, regex.IGNORECASE, pos=start, endpos=end):
                juts = pose == "hang" and _JUTS.search(prompt[span[0] : span[1] + 12])
                if not juts and _beside(prompt, span, found.span(), language) and _is_meant(spec, found.span(), language):
                    return Posed(pose, found.group(), found.start())
    return None


def _span(spec: WorldSpec, name: str) -> tuple[int, int] | None:
    try:
        return occurrence(spec.prompt, spec.claims[name].quote, spec.claims[name].nth)
    except InputError:
        return None


def _looked_at(prompt: str, span: tuple[int, int], language: str | None) -> Iterator[tuple[int, int]]:
    """Spans of the prompt in which a verb is looked for: the place's own words, then the sentence or clause around them."""
    yield span
    ends = _CLAUSE if language in _UNSPACED else _SENTENCE
    yield max((m.end() for m in ends.finditer(prompt, 0, span[0])), default=0), span[0]
    behind = ends.search(prompt, span[1])
    yield span[1], len(prompt) if behind is None else behind.start()


def _beside(prompt: str, span: tuple[int, int], verb: tuple[int, int], language: str | None) -> bool:
    """True of a verb in the place's own words, or as near to it as the language asks for."""
    if language in _UNSPACED or (span[0] <= verb[0] and verb[1] <= span[1]):
        return True
    if verb[1] <= span[0]:
        return regex.fullmatch(r"(?:\s+[\w-]+)?\s*", prompt[verb[1] : span[0]]) is not None
    opens = not _SENTENCE.split(prompt[: span[0]])[-1].strip()
    return opens and regex.fullmatch(r"(?:\s+[\w-]+){0,3}?\s+", prompt[span[1] : verb[0]]) is not None


def _is_meant(spec: WorldSpec, verb: tuple[int, int], language: str | None) -> bool:
    """True of a verb that is not denied, no noun, and that no claim of an event or a thing takes up."""
    before = _SENTENCE.split(spec.prompt[: verb[0]])[-1]
    if _DENIED.search(before):
        return False
    if (
        language == "en"
        and _BARE.fullmatch(spec.prompt[verb[0] : verb[1]])
        and before.strip()
        and not _PLURAL.search(before.rstrip())
    ):
        return False
    for name, claim in spec.claims.items():
        span = _span(spec, name) if claim.type not in _OWN else None
        if span is not None and span[0] < verb[1] and verb[0] < span[1]:
            return False
    return True


def spoken_later(spec: WorldSpec, posed: Posed) -> bool:
    """True where words before a posture tell of an event, or words of order stand in its sentence: it may come about later than frame 0."""
    spans = [_span(spec, n) for n, c in spec.claims.items() if c.type in ("event", "order", "negation", "route")]
    if any(span is not None and span[0] < posed.start for span in spans):
        return True
    start = max((m.end() for m in _SENTENCE.finditer(spec.prompt, 0, posed.start)), default=0)
    behind = _SENTENCE.search(spec.prompt, posed.start)
    end = len(spec.prompt) if behind is None else behind.start()
    held = held_words(spec.prompt, language_of(spec.prompt))
    return any(h.kind == "order" and start <= h.start < end for h in held)


def subjects_of(spec: WorldSpec, posed: Posed) -> list[str]:
    """Bodies that an English posture may be about: of the things before it in its sentence that no preposition leads in; empty where there are none.

    A participle is also about the thing right before it: `drops on a cloth hung between posts`.
    """
    if language_of(spec.prompt) != "en":
        return []
    start = max((m.end() for m in _SENTENCE.finditer(spec.prompt, 0, posed.start)), default=0)
    found: list[str] = []
    for name, claim in spec.claims.items():
        span = _span(spec, name) if claim.type in ("thing", "count") and claim.waived is None else None
        if span is None or not start <= span[0] < posed.start:
            continue
        beside = _PARTICIPLE.fullmatch(posed.word) is not None and not spec.prompt[span[1] : posed.start].strip()
        if beside or not _led_in(spec, span[0], start):
            found += [n for n in named_in(spec, name, "entities") if n in spec.entities]
    return list(dict.fromkeys(found))


def _led_in(spec: WorldSpec, at: int, start: int) -> bool:
    """True where the nearest words before a thing that are no description of it hold a preposition."""
    spans = [_span(spec, n) for n, c in spec.claims.items() if c.type in ("property", "count", "quantity")]
    text = spec.prompt[start:at]
    for span in spans:
        if span is not None and start <= span[0] and span[1] <= at:
            text = text[: span[0] - start] + " " * (span[1] - span[0]) + text[span[1] - start :]
    return bool(PREPOSITIONS & set(words_in(text)[-2:]))
