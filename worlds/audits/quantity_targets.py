"""Numbers that a quantity may be judged by: of the world that is to be seen, and of the thing that its words stand with (R131, R155).

`Within 0.1 s` is no time that is simulated before the first frame, `a block of 0.6 kg` not the mass of another, `10 cm off` no size of a body.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import takewhile

import regex

from ..claim_targets import Span, named_in
from ..claims import reading_of
from ..problems import Problem
from ..prompts.units import folded, units_of
from ..quantities import quantity_said
from ..spec import WorldSpec

__all__ = ["INSTEAD", "is_setting", "target_problems"]

INSTEAD = (
    "name what says it of the world: frames of a beat, a bound of a predicate, a size, position, mass or speed of an entity, a density, a joint, a driver, "
    "gravity, or the number of frames"
)
_SETTINGS = regex.compile(
    r"/simulation/(?:preroll|settle|seed|fps|order|limits|couplings)(?:/|$)|/simulation/solvers/(?!.*/domain/)|/dimensions/tolerance$|/story/beats/[^/]+/margins/|"
    r"/appearance/|/entities/[^/]+/(?:nominal_diagonal|inputs|outputs|exchanges|active)(?:/|$)|/physics/(?:contact_gap|support_drift)$"
)
"""Numbers that say nothing of what is to be seen."""
_OF = {
    "en": "of weighing", "de": "von", "fr": "de d", "es": "de", "it": "di da", "pt": "de", "nl": "van", "ru": "",
}  # fmt: skip
_RELATIVE = {"en": frozenset(("that", "which", "and", "has", "weighs", "is", "measures"))}
"""Words that may lead on from a thing to its quantity: `a block that weighs [5 kg]`."""
_APART = {
    "en": frozenset(("off", "away", "apart", "ahead", "distant", "behind", "beyond", "further", "farther", "from")),
    "de": frozenset(("entfernt", "weg", "abstand", "dahinter", "davor")),
    "nl": frozenset(("verderop", "afstand", "verwijderd")),
}
"""Words right behind a length that make it a distance."""
_SIZE = regex.compile(r"/dimensions/size/\d$|/shape/(?:.*/)?(?:size/\d|radius|height|length)$")


def is_setting(pointer: str) -> bool:
    """True of a number that says nothing of the world."""
    return _SETTINGS.search(pointer) is not None


def target_problems(spec: WorldSpec, name: str, pointer: str) -> Iterator[Problem]:
    """Problems of the number that a quantity names, whatever it is."""
    claim, place = spec.claims[name], f"/claims/{name}/by"
    reading = reading_of(spec)
    at = next((k for k, s in enumerate(reading.spans) if s.claim == name), None)
    keys = pointer.strip("/").split("/")
    if at is None or keys[0] != "entities":
        return
    wanted = quantity_said(spec, name)
    behind = spec.prompt[reading.spans[at].end :]
    first = [folded(u.text) for u in units_of(behind)[:1]]
    inside = [folded(u.text) for u in units_of(claim.quote)[-1:]]
    apart = _APART.get(reading.language or "", frozenset())
    if wanted is not None and wanted.dimension == "length" and _SIZE.search(pointer) and (set(first) | set(inside)) & apart:
        word = next(w for w in (*inside, *first) if w in apart)
        text = f"{claim.quote!r} says how far by {word!r}, and {pointer} is the size of a body: name a position, or the bound of a `separation`"
        yield Problem(place, text)
        return
    thing = _stands_with(spec, reading.spans, at, reading.language or "")
    if thing is None or spec.claims[thing].waived is not None:
        return
    own = set(named_in(spec, thing, "entities"))
    if own and keys[1] not in own:
        text = f"{claim.quote!r} stands with {spec.claims[thing].quote!r} ({', '.join(sorted(own)[:3])}), and {pointer} is of another: name a number of that"
        yield Problem(place, text)


def _stands_with(spec: WorldSpec, spans: Sequence[Span], at: int, language: str) -> str | None:
    """The claim of the thing that a quantity is said of beyond doubt: `a [0.6 kg] steel [block]`, `a [block] of [0.6 kg]`."""
    later = [s for s in spans[at + 1 :] if not (s.claim is None and not s.text.strip(" -"))]
    described = list(takewhile(lambda s: s.type == "property", later))
    head = later[len(described) : len(described) + 1]
    if head and head[0].type == "thing":
        # What stands right before a noun describes that: `a tower of [5 cm] [cubes]`.
        return head[0].claim if language == "en" and _article(spec, spans, at) else None
    before = [s for s in spans[:at] if s.text.strip()]
    between = before[-1].text if before and before[-1].claim is None else ""
    words = [folded(u.text) for u in units_of(between)]
    if regex.search(r"[,.;:!?]", between) or not words:
        return None
    of = _OF.get(language, "").split()
    last = before[-2] if len(before) > 1 else None
    if last is not None and last.type == "thing" and words[-1] in of and set(words[:-1]) <= _RELATIVE.get(language, frozenset()):
        return last.claim
    weighs = language == "en" and words in (["that", "weighs"], ["which", "weighs"], ["weighing"])
    return last.claim if last is not None and last.type == "thing" and weighs else None


def _article(spec: WorldSpec, spans: Sequence[Span], at: int) -> bool:
    """True where an article or a property stands before a quantity, which then describes the noun behind it."""
    if any(u.text.casefold() in ("a", "an", "the", "each") for u in units_of(spans[at].text)[:1]):
        return True
    before = units_of(spec.prompt[: spans[at].start])
    return bool(before) and folded(before[-1].text) in (
        "a",
        "an",
        "the",
        "each",
        "of",
        "with",
        "one",
        "two",
        "three",
        "four",
        "another",
    )
