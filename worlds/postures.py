"""Words of an upright posture that lasts or that something comes to, `stands upright at the end`: judged by how a body is turned (R131, R155).

A place says where a body is, and not how it stands: a toppled block is on its shelf too. `An upright block`, a description alone, stays the
agent's reading, which the verdict prints.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import regex

from .claim_targets import named_in
from .predicates import Compares, JointAngle, Tilts, Topples, atoms_of
from .predicates.event_models import TouchEvent
from .prompts.languages import language_of

if TYPE_CHECKING:
    from .spec import Claim, SpecModel, WorldSpec

__all__ = ["posture_problems", "upright_said"]

STANDS = 0.6
"""[rad] Greatest tilt of what still stands: that from which on `topples` speaks of a fall."""
UPRIGHT: Mapping[str, str] = {
    "en": r"upright|on (?:its|their) feet|erect",
    "de": r"aufrecht(?:e[nrsm]?)?|senkrecht",
    "fr": r"debout|à la verticale",
    "es": r"de pie|erguid[oa]s?|en posición vertical",
    "it": r"in piedi|dritt[oaie]",
    "pt": r"de pé|em pé|na vertical",
    "nl": r"rechtop|overeind",
    "ru": r"стоймя|вертикально",
    "zh": r"直立|竖立|竖直",
    "ja": r"直立|まっすぐ立",
}
"""Words of an upright posture by language. Reviewed by hand."""
LASTS: Mapping[str, str] = {
    "en": r"(?:stay|remain|stand|keep|end|finish|come|land|sit)(?:s|ed|ing|ting)?|stood|kept|came|still|at the end|in the end|finally|throughout|again",
    "de": r"bleib(?:t|en)|blieb(?:en)?|steh(?:t|en)|stand(?:en)?|landet|kommt|noch|am ende|am schluss|wieder",
    "fr": r"rest(?:e|ent)|demeur(?:e|ent)|tient|tiennent|fin(?:it|issent)|encore|à la fin",
    "es": r"(?:se )?queda(?:n)?|permanece(?:n)?|sigue(?:n)?|está(?:n)?|acaba(?:n)?|al final",
    "it": r"rest(?:a|ano)|riman(?:e|gono)|sta(?:nno)?|fini(?:sce|scono)|alla fine|ancora",
    "pt": r"fica(?:m)?|permanece(?:m)?|continua(?:m)?|está|estão|acaba(?:m)?|no final|no fim",
    "nl": r"blij(?:ft|ven)|sta(?:at|an)|ein(?:digt|digen)|nog|aan het eind|op het eind",
    "ru": r"оста(?:ётся|ются|ется|лся|лась|лось)|сто(?:ит|ят)|в конце|всё ещё",
    "zh": r"保持|仍|最后|最终|站|立",
    "ja": r"まま|最後|立",
}
"""Words that say that a posture lasts, or comes at the end. Reviewed by hand."""


def posture_problems(spec: WorldSpec, name: str, claim: Claim) -> Iterator[str]:
    """Why nothing that a claim names says that a body stands upright, where its words say so; nothing where they do not, or it does."""
    upright = upright_said(claim, language_of(spec.prompt))
    if upright is None or claim.waived is not None:
        return
    asked: list[tuple[SpecModel, bool]] = []
    story = spec.story
    asked += [(story.beats[n].predicate, False) for n in named_in(spec, name, "story/beats") if n in story.beats]
    for n in named_in(spec, name, "story/requirements"):
        if n in story.requirements:
            asked.append((story.requirements[n].predicate, story.requirements[n].never))
    if any(_turns(atom, never=never) for predicate, never in asked for atom in atoms_of(predicate)):
        return
    yield (
        f"{claim.quote!r} says by {upright!r} how it stands, and nothing that it names measures how it is turned: mark it as property by a requirement "
        f"`tilts` with `max` at most {STANDS:g} and when `end` or `always`, or as negation by a requirement that it never `topples`"
    )


def upright_said(claim: Claim, language: str | None) -> str | None:
    """Words by which a claim says that something stands upright, or comes to; None where it says nothing of that."""
    upright = _in(UPRIGHT.get(language or ""), claim.quote, language)
    if upright is None or claim.type in ("thing", "count", "quantity", "order"):
        return None
    lasts = claim.type in ("place", "negation", "time") or _in(LASTS.get(language or ""), claim.quote, language)
    return upright if lasts else None


def _in(pattern: str | None, text: str, language: str | None) -> str | None:
    if pattern is None:
        return None
    found = regex.search(pattern if language in ("zh", "ja") else rf"\b(?:{pattern})\b", text, regex.IGNORECASE)
    return found.group() if found else None


def _turns(atom: SpecModel, *, never: bool) -> bool:
    """True of what says that a body is not turned over, or is turned up; `never` where it is denied."""
    if isinstance(atom, Topples):
        return never and atom.min_angle <= STANDS
    if isinstance(atom, Tilts):
        if never:
            return atom.when == "eventually" and atom.max is None and (atom.min or 0.0) <= STANDS
        return atom.when in ("end", "always") and (atom.min is not None or (atom.max or STANDS + 1.0) <= STANDS)
    if isinstance(atom, TouchEvent):
        return never and atom.kind == "tips"
    if isinstance(atom, Compares):
        return atom.quantity == "tilt" and not never
    return isinstance(atom, JointAngle)
