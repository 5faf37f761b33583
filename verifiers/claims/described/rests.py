"""Words of rest beside a word of place, and the frames at which what they are about is judged.

`A marble lies under the shelf`: the word holds while the marble is still, and not while it rolls past. `It comes to rest there`: at the end.
A verb of rest counts where it stands directly before the place, one adverb between, or where the place begins its sentence and the verb follows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np
import regex

from ....worlds.errors import InputError
from ....worlds.predicates import RestsOn
from ....worlds.prompts.languages import language_of
from ....worlds.prompts.marks import occurrence

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.candidate import Candidate
    from ....worlds.spec import WorldSpec

__all__ = ["SENTENCE", "Rest", "rest_said", "still_at"]

Rest = Literal["lies", "comes"]
SENTENCE = regex.compile(r"[.!?…;。！？；]")
"""Ends of sentences."""
LIES: Mapping[str, str] = {
    "en": r"lies?|lay|lying|rests?|rested|resting",
    "de": r"lieg(?:t|en)|lag(?:en)?|ruh(?:t|en)",
    "fr": r"repos(?:e|ent)|gît|gisent",
    "es": r"reposan?|yacen?",
    "it": r"giac(?:e|ciono)|ripos(?:a|ano)",
    "pt": r"repousam?|jazem?",
    "nl": r"lig(?:t|gen)|lag(?:en)?|rust(?:en)?",
}
"""Verbs of lying at rest. Reviewed by hand; without *stand*, *sit* and *hang*, which are said of what sways, too."""
COMES: Mapping[str, str] = {
    "en": r"(?:comes?|came|coming) to (?:a )?(?:rest|stop|halt|standstill)|ends? up|stops?|stopped|settles?|remains?|stays?",
    "de": r"kommt|kommen|bleib(?:t|en)|landet am ende",
    "fr": r"s'arrête(?:nt)?|s'immobilise(?:nt)?|rest(?:e|ent)",
    "es": r"se (?:detienen?|paran?|quedan?)|permanecen?",
    "it": r"si ferma(?:no)?|rest(?:a|ano)|riman(?:e|gono)",
    "pt": r"para(?:m)?|fica(?:m)?|permanecem?",
    "nl": r"blij(?:ft|ven)|stopt|stoppen",
}
"""Verbs of coming to rest, or of staying. Reviewed by hand; German `kommt` counts with `zur Ruhe`, `zum Stehen`, `zum Liegen` behind the place."""
RUHE = regex.compile(r"\bzu[mr] (?:ruhe|stehen|liegen|stillstand)\b|\bliegen\b|\bstehen\b", regex.IGNORECASE)


def rest_said(spec: WorldSpec, name: str) -> Rest | None:
    """The kind of rest that stands beside a claim of place; None where its verb is another, or none is known."""
    language = language_of(spec.prompt)
    if language is None or language not in LIES:
        return None
    try:
        start, end = occurrence(spec.prompt, spec.claims[name].quote, spec.claims[name].nth)
    except InputError:
        return None
    before, behind = SENTENCE.split(spec.prompt[:start])[-1], SENTENCE.split(spec.prompt[end:])[0]
    for kind, verbs in (("comes", COMES[language]), ("lies", LIES[language])):
        if before.strip():
            found = regex.search(rf"\b(?:{verbs})(?: [\w-]+)?\s*$", before, regex.IGNORECASE)
        else:
            found = regex.match(rf"(?:\s+[\w-]+){{0,3}}?\s+(?:{verbs})\b", behind, regex.IGNORECASE)
        if found is not None and not (language == "de" and kind == "comes" and not RUHE.search(behind)):
            return "comes" if kind == "comes" else "lies"
    return None


def still_at(candidate: Candidate, thing: str, grounds: Sequence[str], frame: int, *, most: float | None = None) -> bool:
    """True where a body's centre is slow as seen from one of the places, about a frame.

    Args:
        candidate: what is judged.
        thing: the body.
        grounds: the places.
        frame: about which its way is taken.
        most: greatest speed [m/s]; what `rests_on` takes for at rest when left out.
    """
    first, last = max(frame - 1, 0), min(frame + 1, candidate.last_frame)
    if first == last:
        return True
    speed = float(RestsOn.model_fields["max_speed"].default) if most is None else most
    way = speed * (last - first) / candidate.spec.simulation.fps
    return any(
        float(np.linalg.norm(_from(candidate, g, thing, last) - _from(candidate, g, thing, first))) <= way for g in grounds
    )


def _from(candidate: Candidate, ground: str, thing: str, frame: int) -> F64:
    """Centre of a body in the frame of another, or less its centre where that deforms or has several bodies [m]."""
    center = candidate.center(thing, frame)
    bodies = candidate.entity(ground).bodies
    if ground in candidate.deforming or len(bodies) != 1:
        return np.asarray(center - candidate.center(ground, frame))
    return np.asarray(candidate.pose(ground, frame, bodies[0].name).inverse().apply(center[None])[0])
