"""Amounts that an article gives: `a whole minute`, `half a second`, `an hour`, by language. Reviewed by hand.

An article before the name of a unit is a number, as `one` is. Left out is what is as often something else: `a second ball`, `a metre stick`,
`a minute crack`, `a foot`; these are held only behind a word that leads on to a duration and before the end of the phrase.
"""

from __future__ import annotations

from collections.abc import Mapping

import regex

__all__ = ["article_amounts", "without_whole"]

_AFTER_EN = (
    r"(?=\s*(?:$|[.,;:!?)\n])|\s+(?:long|wide|high|tall|deep|thick|away|off|apart|ahead|later|after|before|above|below|beyond|from|of|in|and|or|to|by|into|across|"
    r"behind|until|it|the|a|an|at|on|onto|under|over|along|up|down|passes|pass|while|then|per)\b)"
)
_PATTERNS: Mapping[str, str] = {
    "en": (
        r"\b(?:(?:an?\s+|one\s+)?(?:half|quarter)[\s-]+(?:of\s+)?(?:an?\s+)?|(?:an?|one)\s+(?:whole|full|entire|half|quarter)[\s-]+)"
        r"(?:second|minute|hour|met(?:re|er)|kilomet(?:re|er)|centimet(?:re|er)|millimet(?:re|er)|kilo|kilogram|gram|tonne|ton|lit(?:re|er)|mile|inch|foot|yard)s?\b"
        r"|\ban?\s+(?:minute|hour|met(?:re|er)|kilomet(?:re|er)|centimet(?:re|er)|millimet(?:re|er)|kilogram|kilo|gram|tonne|lit(?:re|er)|mile|inch)"
        + _AFTER_EN
        + r"|(?<=\b(?:for|within|after|lasts|about|over|almost|nearly|under)\s)an?\s+(?:second|foot|yard)(?=\s*(?:$|[.,;:!?)\n])|\s+(?:long|later|apart|off|away|after|before)\b)"
    ),
    "de": r"\bein(?:e[nmrs]?)?\s+(?:(?:ganze|volle|halbe|viertel)[nmrs]?\s+)?(?:sekunde|minute|stunde|meter|zentimeter|millimeter|kilometer|kilogramm|kilo|gramm|tonne|liter)[ns]?\b|"
    r"\bhalbe[nmrs]?\s+(?:sekunde|minute|stunde|meter)[ns]?\b",
    "fr": r"\bune?\s+(?:demi-)?(?:minute|heure|mètre|centimètre|millimètre|kilomètre|kilo|kilogramme|gramme|litre)\b(?:\s+(?:entière?|pleine))?|\bune\s+demi-seconde\b",
    "es": r"\b(?:un[ao]?\s+)?(?:medi[oa]|enter[oa])\s+(?:segundo|minuto|hora|metro|kilo|litro)\b|\buna?\s+(?:minuto|hora|metro|centímetro|milímetro|kilómetro|kilo|gramo|litro)\b(?:\s+enter[oa])?",
    "it": r"\b(?:un[ao]?\s+)?(?:mezz[oa]|inter[oa])\s+(?:secondo|minuto|ora|metro|chilo|litro)\b|\bun\s+(?:minuto|metro|centimetro|millimetro|chilometro|chilo|grammo|litro)\b(?:\s+inter[oa])?",
    "pt": r"\b(?:uma?\s+)?(?:mei[oa]|inteir[oa])\s+(?:segundo|minuto|hora|metro|quilo|litro)\b|\buma?\s+(?:minuto|hora|metro|centímetro|milímetro|quilómetro|quilômetro|quilo|grama|litro)\b(?:\s+inteir[oa])?",
    "nl": r"\been\s+(?:(?:hele|volle|halve|kwart)\s+)?(?:seconde|minuut|uur|meter|centimeter|millimeter|kilometer|kilo|kilogram|gram|ton|liter)\b",
    "ru": r"\b(?:цел(?:ый|ую|ое|ого|ой)\s+(?:секунду|минуту|час|метр|секунды|минуты|часа|метра)|пол(?:секунды|минуты|часа|метра|кило|литра))\b",
}
_WHOLE: Mapping[str, tuple[tuple[str, str], ...]] = {
    "en": ((r"\b(an?|one)\s+(?:whole|full|entire)\s+(?=\p{L})", r"\1 "),),
    "de": ((r"\b(ein(?:e[nmrs]?)?)\s+(?:ganze|volle)[nmrs]?\s+(?=\p{L})", r"\1 "),),
    "es": ((r"\b(una?)\s+enter[oa]\s+(?=\p{L})", r"\1 "),),
    "it": ((r"\b(un[ao]?)\s+inter[oa]\s+(?=\p{L})", r"\1 "),),
    "pt": ((r"\b(uma?)\s+inteir[oa]\s+(?=\p{L})", r"\1 "),),
    "nl": ((r"\been\s+(?:hele|volle)\s+(?=\p{L})", "een "),),
    "ru": (
        (r"\bцел(?:ый|ую|ое|ого|ой)\s+(?=\p{L})", "одну "),
        (r"\bпол(?=(?:секунды|минуты|часа|метра|кило|литра)\b)", "половина "),
    ),
}


def article_amounts(text: str, language: str) -> list[tuple[int, int]]:
    """Spans of a text in which an article, or a half, is the number of a unit."""
    pattern = _PATTERNS.get(language)
    return [] if pattern is None else [match.span() for match in regex.finditer(pattern, text, regex.IGNORECASE)]


def without_whole(plain: str, language: str) -> str:
    """A text in which `a whole minute` is `a minute`."""
    for pattern, put in _WHOLE.get(language, ()):
        plain = regex.sub(pattern, put, plain, flags=regex.IGNORECASE)
    return plain
