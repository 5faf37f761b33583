"""Words that say how often something happens: `twice`, `three times`, `dreimal`, `deux fois` (R131)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import regex

from .errors import InputError
from .prompts.languages import language_of
from .prompts.marks import occurrence
from .prompts.numbers import number_in
from .prompts.units import folded

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = ["is_repeat", "times_of"]

_WORDS: dict[str, dict[str, float]] = {
    "en": {"twice": 2, "thrice": 3},
    "de": {f"{n}mal": k for k, n in enumerate(("zwei", "drei", "vier", "fünf", "sechs", "sieben", "acht", "neun", "zehn"), 2)},
    "nl": {f"{n}maal": k for k, n in enumerate(("twee", "drie", "vier", "vijf", "zes", "zeven", "acht", "negen", "tien"), 2)},
    "ru": {"дважды": 2, "трижды": 3, "четырежды": 4},
}
"""Words that say how often, by language."""
_TIMES = {
    "en": r"times?", "de": r"mal|male", "fr": r"fois", "es": r"veces", "it": r"volte", "pt": r"vezes", "nl": r"keer|maal", "ru": r"раза?",
    "zh": r"次|遍|回", "ja": r"回|度",
}  # fmt: skip
"""Words behind a number that make it one of events. Reviewed by hand."""
_COMPARED = {
    "en": r"(?:as|the|more|longer|higher|larger|bigger|heavier|faster|farther|further|its)\b", "de": r"(?:so|mehr|größer|höher|schwerer|schneller)\b",
    "fr": r"(?:plus|moins|aussi)\b", "es": r"(?:más|menos|el|la|su)\b", "it": r"(?:più|meno|tanto)\b", "pt": r"(?:mais|menos|o|a)\b",
    "nl": r"(?:zo|meer)\b", "ru": r"(?:больше|выше|тяжелее|быстрее)\b",
}  # fmt: skip
"""Words behind them that compare two sizes: `three times as heavy` counts nothing."""


def times_of(spec: WorldSpec, name: str) -> float | None:
    """Number of times that something happens by the words of a claim of a count; None where they count no events."""
    claim, language = spec.claims[name], language_of(spec.prompt)
    if claim.type != "count" or language not in _TIMES:
        return None
    try:
        _, end = occurrence(spec.prompt, claim.quote, claim.nth)
    except InputError:
        return None
    quote, behind = folded(claim.quote).strip(), folded(spec.prompt[end:]).lstrip(" -")
    compared = _COMPARED.get(language)
    one = _WORDS.get(language, {}).get(quote)
    if one is not None:
        return None if compared and regex.match(compared, behind) else one
    inside = regex.search(rf"(?:{_TIMES[language]})$", quote)
    beside = inside or (
        regex.match(rf"(?:{_TIMES[language]})(?!\p{{L}})", behind)
        if language not in ("zh", "ja")
        else regex.match(_TIMES[language], behind)
    )
    if beside is None:
        return None
    rest = behind if inside else behind[beside.end() :].lstrip()
    if compared and regex.match(compared, rest):
        return None
    return number_in(claim.quote, language)


def is_repeat(spec: WorldSpec, name: str) -> bool:
    """True where a claim of a count says how often something happens."""
    return times_of(spec, name) is not None
