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

__all__ = ["ACROSS", "INSTEAD", "SIZES", "is_setting", "target_problems"]

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
SIZES = frozenset(["tall", "high", "wide", "long", "deep", "thick", "broad"])
"""Words behind a length that make it one of a body."""
ACROSS = "across"
"""As these, where nothing follows that it leads over or starts at."""
_UP_AND_IN = frozenset(["high", "deep"])
"""Size words that say as well how far up or down a body is: `a lamp hangs 2 m high`."""
_UPRIGHT = frozenset(["tall", "high", "deep", "thick", "thickness"])
"""Words of a size that lies along z in a body that stands or lies as it is described."""
_IN = frozenset(["diameter", "width", "length", "thickness", "breadth", "size", "radius"])
"""Nouns that make a size of a length with `in` before them: `8 cm in diameter`."""
_GAPS = frozenset(
    ["gap", "gaps", "space", "spaces", "distance", "opening", "slot", "hole", "clearance", "margin", "interval", "way"]
)
"""Nouns of what lies between bodies, whose width is told by a position."""
_LEADS_AWAY = frozenset(["of", "from", *_GAPS])
"""Words right behind a length and its word that make it no size of the thing before: `passes the post 8 cm wide of it`."""
_IS = frozenset(["is", "are", "that", "which", "measures"])
"""Words that may stand between a thing and its length."""
_RUBBING = regex.compile(
    "friction|resistance|reibung|widerstand|résistance|frottement|fricción|resistencia|attrito|resistenza|atrito|resistência|wrijving|weerstand|трени|"
    "сопротивлен|摩擦|抵抗|阻力",
    regex.IGNORECASE,
)
"""Words of a prompt that speaks of how its bodies rub. Reviewed by hand."""
_ROLLING = regex.compile(r"^/materials/[^/]+/rolling_friction$")
_POSITION = regex.compile(r"^/entities/[^/]+/pose/position/(\d)$")
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
    wanted = quantity_said(spec, name)
    if wanted is not None and wanted.dimension == "length" and _ROLLING.search(pointer) and not _RUBBING.search(spec.prompt):
        text = f"{claim.quote!r} is a length to be seen, and {pointer} says how a material resists rolling, though it is in metres as well: {INSTEAD}"
        yield Problem(place, text)
        return
    if at is None or keys[0] != "entities":
        return
    if (
        wanted is not None
        and wanted.dimension == "length"
        and reading.language == "en"
        and (word := _size_word(spec, reading.spans, at, pointer))
    ):
        axis = 2 if word in _UPRIGHT else 0
        text = (
            f"{claim.quote!r} says the size of a body by {word!r}, and {pointer} is a position: name its size, as "
            f"/entities/{keys[1]}/dimensions/size/{axis}, or that of the part which is meant"
        )
        yield Problem(place, text)
        return
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


def _size_word(spec: WorldSpec, spans: Sequence[Span], at: int, pointer: str) -> str | None:
    """The word that makes a length the size of the one body whose position a pointer names; None where it may be anything else.

    A gap has its width by a position, and so has a row of bodies: only what is said of one thing, right before or right behind it, is sure.
    """
    found = _POSITION.search(pointer)
    inside = [folded(u.text) for u in units_of(spans[at].text)]
    text = spans[at + 1].text if at + 1 < len(spans) and spans[at + 1].claim is None else ""
    outside = [folded(u.text) for u in units_of(text)]
    word = next((w for w in (*inside[-1:], *outside[:1]) if w in SIZES or w == ACROSS), "")
    left = outside if word in inside else outside[1:]
    if outside[:1] == ["in"] and outside[1:2] and outside[1] in _IN:
        word, left = outside[1], outside[2:]
    if found is None or not word or (word == ACROSS and left[:1] == ["from"]) or (word in _UP_AND_IN and found[1] == "2"):
        return None
    later = spans[at + 1 :] if not text else spans[at + 2 :]
    about = _right_behind(spec, later, left) or (None if word in _UP_AND_IN else _right_before(spans, at, left))
    named = set(named_in(spec, about, "entities")) if about is not None else set()
    return word if len(named) == 1 else None


def _right_behind(spec: WorldSpec, later: Sequence[Span], left: Sequence[str]) -> str | None:
    """The claim of the thing that a length and its word stand before, with nothing but properties between: `an 8 cm wide steel block`."""
    spoken = [s for s in later if not (s.claim is None and not s.text.strip(" -"))]
    head = next(iter(spoken[len(list(takewhile(lambda s: s.type == "property", spoken))) :]), None)
    if left or head is None or head.type != "thing":
        return None
    return None if _GAPS & {folded(u.text) for u in units_of(head.text)} else head.claim


def _right_before(spans: Sequence[Span], at: int, left: Sequence[str]) -> str | None:
    """The claim of the thing that a length and its word stand behind: `a block, 8 cm wide, slides`."""
    before = [s for s in spans[:at] if s.text.strip()]
    if before and before[-1].claim is None and {folded(u.text) for u in units_of(before[-1].text)} <= _IS:
        before = before[:-1]
    return before[-1].claim if before and before[-1].type == "thing" and not _LEADS_AWAY & set(left[:1]) else None


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
