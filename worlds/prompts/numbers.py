"""Numbers and quantities that a quote states, with the interval that its words leave open.

The language decides what `1,000` and `once` are; without one, only what all languages agree on is read. More than one number, or a
range such as `3-4`, is no number.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from typing import Literal, NamedTuple, TypeVar

import regex

from .digits import Found, digit_numbers, prepared
from .measures import SI_UNITS, Measure, measure_behind
from .spelled import spelled_numbers
from .tables import NUMBER_LANGUAGES
from .unit_articles import without_whole
from .units import APOSTROPHES, folded

__all__ = ["HEDGES", "How", "Quantity", "hedge_beside", "hedge_spans", "number_in", "ordinal_in", "quantity_in"]

Answer = TypeVar("Answer")
How = Literal["written", "about", "at least", "at most", "between"]

ABOUT = 0.25
"""Share of a value that `about` leaves open either way; own choice: a person who says about four does not mean three or five."""
HALF = 0.5
"""Share of the last written digit that is left open: the usual reading of a rounded number."""
LONGEST_QUOTE = 300
"""Characters that are read; own choice: a claim spans at most eight words."""

HEDGES: dict[How, tuple[str, ...]] = {
    "at least": (
        "at least", "no less than", "not less than", "no fewer than", "more than", "greater than", "longer than", "taller than",
        "heavier than", "higher than", "minimum", "or more", "upwards of", "no shorter than", "no lighter than", "no lower than",
        "mindestens", "wenigstens", "mehr als", "länger als", "höher als", "schwerer als", "nicht weniger als",
        "au moins", "plus de", "minimum", "pas moins de", "al menos", "por lo menos", "como mínimo", "más de", "no menos de",
        "almeno", "più di", "oltre", "non meno di", "pelo menos", "no mínimo", "mais de", "não menos de",
        "minstens", "ten minste", "meer dan", "niet minder dan", "не менее", "не меньше", "как минимум", "по меньшей мере", "более",
        "больше", "свыше", "至少", "超过", "超過", "以上", "多于", "不少于", "少なくとも", "を超える", "على الأقل", "أكثر من", "कम से कम", "से अधिक",
    ),
    "at most": (
        "at most", "no more than", "not more than", "less than", "fewer than", "shorter than", "lighter than", "lower than", "up to",
        "within", "no farther than", "no further than", "no longer than", "no higher than", "no taller than", "no heavier than", "no wider than",
        "maximum", "or less", "or fewer", "höchstens", "maximal", "nicht mehr als", "weniger als", "bis zu", "kürzer als",
        "au plus", "moins de", "jusqu'à", "pas plus de", "como máximo", "a lo sumo", "menos de", "hasta", "no más de",
        "al massimo", "meno di", "fino a", "non più di", "no máximo", "até", "não mais de", "hooguit", "hoogstens", "minder dan",
        "niet meer dan", "tot maximaal", "не более", "не больше", "максимум", "менее", "меньше", "до",
        "至多", "最多", "不到", "以下", "以内", "不超过", "少于", "未満", "最大", "على الأكثر", "أقل من", "अधिक से अधिक", "से कम",
    ),
    "about": (
        "about", "around", "roughly", "approximately", "approx", "circa", "ca", "nearly", "almost", "or so", "~", "≈", "∼",
        "etwa", "ungefähr", "rund", "zirka", "knapp", "an die", "environ", "à peu près", "presque", "près de",
        "quelque", "aproximadamente", "alrededor de", "unos", "unas", "casi", "cerca de", "circa", "quasi", "all'incirca",
        "uns", "umas", "quase", "ongeveer", "bijna", "zo'n", "около", "примерно", "приблизительно", "почти", "порядка",
        "大约", "大約", "约", "約", "左右", "差不多", "将近", "上下", "およそ", "おおよそ", "だいたい", "ほぼ", "くらい", "ぐらい", "ほど", "前後",
        "حوالي", "نحو", "تقريبا", "تقريبًا", "लगभग", "करीब", "dizaine", "vingtaine", "quinzaine", "trentaine", "centaine",
    ),
}  # fmt: skip
"""Words that open the interval, reviewed by hand; `over` and `under` are left out, since they are also places."""
BETWEEN = ("between", "zwischen", "entre", "tra", "fra", "tussen", "между", "from", "von", "de", "da", "van", "от", "从", "從")
TO = (
    "-", "~", "～", "〜", "to", "or", "bis", "oder", "à", "ou", "a", "o", "tot", "of", "до", "или", "到", "至", "或", "から", "か", "إلى", "से",
)  # fmt: skip
ALSO = ("and", "und", "et", "y", "e", "en", "и", "和", "と")
"""Words between two numbers that make a range: alone, and behind a word of `BETWEEN`."""

_FORWARD = frozenset(
    (
        "within",
        "up to",
        "around",
        "about",
        "bis zu",
        "jusqu'à",
        "hasta",
        "fino a",
        "até",
        "до",
        "de",
        "oltre",
        "cerca de",
        "unos",
        "unas",
        "uns",
        "umas",
    )
)
"""Words that open only what follows them."""

OPEN_BELOW = -math.inf
OPEN_ABOVE = math.inf

_CLUSTERED = regex.compile(r"(?V1)[\p{Han}\p{Hiragana}\p{Katakana}~≈∼～〜\-]")
_GAP = regex.compile(r"[\s,]*(?:and|und|et|y|e|en|и)?[\s,]*")
_A = regex.compile(r"(?i)\b(?:an?)\b")
_LINKS = regex.compile(r"(?:\s+(?:an?|the|of|by|ein|eine|einen|um|un|une|de|una|van|een))?\s*")
"""Words that may stand between an opening word and its quantity."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A value in the SI unit of its dimension, and the interval that the words leave open; open ends are infinite."""

    value: float
    unit: str
    dimension: str
    low: float
    high: float
    how: How

    def opened(self, how: How) -> Quantity:
        """The same value where words beside it say how it is meant: the least, the most or about."""
        if how == "at least":
            return replace(self, low=self.value, high=OPEN_ABOVE, how=how)
        if how == "at most":
            return replace(self, low=OPEN_BELOW, high=self.value, how=how)
        half = ABOUT * abs(self.value) if how == "about" else 0.0
        return replace(self, low=min(self.low, self.value - half), high=max(self.high, self.value + half), how=how)


def number_in(text: str, language: str | None = None) -> float | None:
    """The only number that a text states, in digits or words, cardinal or ordinal; none where it states several or none."""
    return _agreed(text, language, lambda plain, known: _only(_numbers(plain, known), plain))


def ordinal_in(text: str, language: str | None = None) -> int | None:
    """The only place in an order that a text states: `second`, `3rd`, `第三`."""

    def read(plain: str, known: str) -> int | None:
        places = {round(found.value) for found in _numbers(plain, known) if found.ordinal}
        return places.pop() if len(places) == 1 else None

    return _agreed(text, language, read)


def quantity_in(text: str, language: str | None = None) -> Quantity | None:
    """The only quantity that a text states, or none: a number (or range) with a unit."""
    return _agreed(text, language, _quantity)


def _agreed(text: str, language: str | None, read: Callable[[str, str], Answer | None]) -> Answer | None:
    """The answer in one language, or the one that all languages agree on which have one; digits are read in every language."""
    plain = prepared(text[:LONGEST_QUOTE])
    if language is not None:
        return read(plain, language)
    answers = {answer for known in NUMBER_LANGUAGES if (answer := read(plain, known)) is not None}
    return answers.pop() if len(answers) == 1 else None


def _numbers(plain: str, language: str) -> list[Found]:
    digits = digit_numbers(plain, language)
    return spelled_numbers(plain, language, digits) if language in NUMBER_LANGUAGES else digits


def _only(numbers: list[Found], plain: str) -> float | None:
    numbers = [found for found in numbers if not found.article] or numbers
    numbers = [found for found in numbers if not found.ordinal] or numbers
    if any(_range(plain, first, second) for first, second in pairwise(numbers)):
        return None
    values = {found.value for found in numbers}
    return values.pop() if len(values) == 1 else None


@cache
def _any_of(words: tuple[str, ...]) -> regex.Pattern[str]:
    """A pattern of any of these words as whole words; those of scripts without blanks stand anywhere."""
    ordered = sorted(words, key=len, reverse=True)
    spaced, clustered = (
        "|".join(regex.escape(word) for word in ordered if bool(_CLUSTERED.search(word)) is anywhere)
        for anywhere in (False, True)
    )
    # The marks of an edge stand outside of what ignores case: there they would take a second of each process to compile.
    either = rf"(?<![\p{{L}}\p{{M}}])(?i:{spaced})(?![\p{{L}}\p{{M}}])", f"(?i:{clustered})"
    return regex.compile("(?V1)" + "|".join(one for one, some in zip(either, (spaced, clustered), strict=True) if some))


def _range(plain: str, first: Found, second: Found, *, end: int | None = None) -> bool:
    """True where two neighbouring numbers are the ends of a range; `end` is that of the first one's unit."""
    between = plain[first.end if end is None else end : second.start].strip()
    if _any_of(TO).fullmatch(between):
        return True
    return bool(_any_of(ALSO).fullmatch(between) and _any_of(BETWEEN).search(plain[: first.start]))


class _Amount(NamedTuple):
    """Numbers with a unit: lowest and highest, worth of the last digit."""

    start: int
    end: int
    low: float
    high: float
    step: float
    measure: Measure


def _quantity(plain: str, language: str) -> Quantity | None:
    plain = without_whole(plain, language)
    amounts = _amounts(plain, _numbers(plain, language), language)
    if not amounts and language == "en":
        ones = [Found(*match.span(), 1.0, 1.0) for match in _A.finditer(plain)]
        amounts = _amounts(plain, ones, language)
    found = {_open(amount, plain) for amount in _summed(amounts, plain)}
    return found.pop() if len(found) == 1 else None


def _amounts(plain: str, numbers: list[Found], language: str) -> list[_Amount]:
    known = language if language in NUMBER_LANGUAGES else None
    measured = [(found, measure_behind(plain, found.start, found.end, known)) for found in numbers if not found.ordinal]
    amounts, at = [], 0
    while at < len(measured):
        first, measure = measured[at]
        at += 1
        second, later = measured[at] if at < len(measured) else (first, None)
        same = later is not None and (measure is None or measure.dimension == later.dimension)
        if (
            later is not None
            and same
            and second is not first
            and _range(plain, first, second, end=measure.end if measure else None)
        ):
            ends = [_si(first.value, measure or later), _si(second.value, later)]
            unit = later._replace(factor=1.0, offset=0.0)
            amounts.append(_Amount(first.start, later.end, min(ends), max(ends), 0.0, unit))
            at += 1
        elif measure is not None:
            amounts.append(_Amount(first.start, measure.end, first.value, first.value, first.step, measure))
    return amounts


def _summed(amounts: list[_Amount], plain: str) -> list[_Amount]:
    """Amounts, with `5 ft 3 in` as one."""
    summed: list[_Amount] = []
    for amount in amounts:
        last = summed[-1] if summed else None
        if (
            last is not None
            and last.measure.dimension == amount.measure.dimension
            and last.measure.factor > amount.measure.factor
            and not last.measure.offset
            and last.low == last.high
            and _GAP.fullmatch(plain, last.end, amount.start)
        ):
            value = last.low * last.measure.factor / amount.measure.factor + amount.low
            summed[-1] = _Amount(last.start, amount.end, value, value, amount.step, amount.measure)
        else:
            summed.append(amount)
    return summed


def _si(value: float, measure: Measure) -> float:
    return value * measure.factor + measure.offset


def _hedge(plain: str) -> How:
    """Sense in which words around a number leave it open: that of the first of them, the longest where two begin together."""
    hits = [
        (match.start(), -len(match.group()), how) for how, words in HEDGES.items() for match in _any_of(words).finditer(plain)
    ]
    return min(hits)[2] if hits else "written"


def hedge_spans(text: str) -> list[tuple[int, int]]:
    """Places of words that give the least or the most, `no more than` among them: they deny nothing."""
    plain, bounds = text.translate(APOSTROPHES), (*HEDGES["at least"], *HEDGES["at most"])
    return [match.span() for match in _any_of(bounds).finditer(plain)]


def hedge_beside(before: str, behind: str, language: str | None) -> How | None:
    """Sense in which the words right before a quantity, or right behind it, leave it open; None where they say nothing of it.

    Args:
        before: text of its clause before it.
        behind: text of its clause behind it; what leads on to another number is no word about this one.
        language: code of the language of both.
    """
    found: list[tuple[int, How]] = []
    for how, words in HEDGES.items():
        for match in _any_of(words).finditer(folded(before)):
            if _LINKS.fullmatch(folded(before), match.end()):
                found.append((match.end() - match.start(), how))
        for match in _any_of(tuple(w for w in words if w not in _FORWARD)).finditer(folded(behind)):
            if not folded(behind)[: match.start()].strip() and number_in(behind[match.end() :], language) is None:
                found.append((match.end() - match.start(), how))
    return max(found)[1] if found else None


def _open(amount: _Amount, plain: str) -> Quantity:
    measure, value = amount.measure, (amount.low + amount.high) / 2
    how: How = "between" if amount.low != amount.high else _hedge(folded(plain))
    half = HALF * amount.step
    if how == "about":
        half = max(half, ABOUT * abs(value))
    low, high = _si(amount.low - half, measure), _si(amount.high + half, measure)
    if how == "at least":
        low, high = _si(value, measure), OPEN_ABOVE
    elif how == "at most":
        low, high = OPEN_BELOW, _si(value, measure)
    return Quantity(_si(value, measure), SI_UNITS[measure.dimension], measure.dimension, low, high, how)
