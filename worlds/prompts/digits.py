"""Numbers written in digits: every decimal digit of Unicode, both conventions for thousands and decimals, fractions, powers of ten."""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass

import regex

from .tables import table

__all__ = ["Found", "digit_numbers", "prepared"]

GREATEST_DENOMINATOR = 100
"""Greatest denominator of `3/4` that is read as a fraction; own choice: greater ones are ratios and dates."""
HAN_POWERS = {"十": 10, "百": 100, "千": 1000, "万": 10**4, "萬": 10**4, "亿": 10**8, "億": 10**8}

_LITERAL = regex.compile(
    r"""(?V1)(?<![\p{Latin}\p{Cyrillic}\p{Greek}\d]|\d[.,])
    (?P<sign>(?<![^\s(=≈~:])(?<!\d\s)[-+±])?
    (?P<body>\d{1,3}(?:[ '’]\d{3})+(?:[.,]\d+)?(?![\d.,]*\d)|\d+(?:[.,]\d+)*)
    (?:/(?P<denominator>\d{1,3})(?![\d/]))?
    (?:[eE](?P<e>[-+]?\d{1,2})(?!\w)|\s?[×x·*]\s?10\^(?P<power>[-+]?\d{1,2}))?
    (?P<han>[十百千万萬亿億]+)?
    (?P<ordinal>(?i:st|nd|rd|th|er|re|ère|e|è|ème|eme|nde|de|ste|o|a|-?(?:й|я|е|го|му|ая|ое|ый|ой))(?![\p{L}\p{M}\d])|\s?番目?)?""",
    regex.VERBOSE,
)
_POWER_OF_UNIT = regex.compile(r"(?<=\p{L})\^(?=\d)")
_SUPERSCRIPT = regex.compile(r"(?<=\d)[⁻⁺]?[⁰¹²³⁴-⁹]+")


@dataclass(frozen=True, slots=True)
class Found:
    """A number in a prepared text; `step` is the worth of its last written digit."""

    start: int
    end: int
    value: float
    step: float
    ordinal: bool = False
    article: bool = False
    """It may be the article: `un`, `ein`."""


def prepared(text: str) -> str:
    """The text in NFKC with plain digits, written-out fractions and `^` before raised digits; for reading, offsets change."""
    text = _SUPERSCRIPT.sub(lambda match: "^" + match.group(), text)
    out = []
    for k, character in enumerate(text):
        if unicodedata.decomposition(character).startswith("<fraction>"):
            whole = k > 0 and text[k - 1].isdecimal()
            character = (" " if whole else "") + unicodedata.normalize("NFKC", character).replace("\u2044", "/")
        elif character.isdecimal():
            character = str(unicodedata.decimal(character))
        out.append({"٫": ".", "٬": ",", "−": "-", "–": "-", "‑": "-", "‐": "-", "’": "'"}.get(character, character))
    plain = unicodedata.normalize("NFKC", "".join(out)).replace("\u00ad", "")
    return _POWER_OF_UNIT.sub("", plain)


def digit_numbers(text: str, language: str | None) -> list[Found]:
    """All numbers in digits of a prepared text; those that can be read in two ways are left out."""
    found: list[Found] = []
    for match in _LITERAL.finditer(text):
        read = _body(match.group("body"), language)
        if read is None:
            continue
        value, step = read
        denominator = int(match.group("denominator") or 0)
        if denominator:
            if not value < denominator <= GREATEST_DENOMINATOR or step != 1:
                continue
            value, step = value / denominator, 0.5 / denominator
        power = 10.0 ** int(match.group("e") or match.group("power") or 0)
        for character in match.group("han") or "":
            power *= HAN_POWERS[character]
        sign = -1 if match.group("sign") == "-" else 1
        ordinal = match.group("ordinal") is not None or text[: match.start()].endswith("第")
        item = Found(match.start(), match.end(), sign * value * power, step * power, ordinal)
        found.append(_with_whole(found, item, text) if denominator else item)
    return found


def _with_whole(found: list[Found], part: Found, text: str) -> Found:
    """`2 1/2` as one number."""
    if not found or found[-1].step != 1 or text[found[-1].end : part.start].strip() or part.start - found[-1].end > 1:
        return part
    whole = found.pop()
    return Found(whole.start, part.end, whole.value + part.value, part.step)


def _body(body: str, language: str | None) -> tuple[float, float] | None:
    """Value and worth of the last digit of digits with separators, or none where two readings are left."""
    body = regex.sub("[ '’]", "", body)
    marks = [character for character in body if character in ".,"]
    if not marks:
        return float(body), 1.0
    last = marks[-1]
    groups = regex.split("[.,]", body)
    grouped = 1 <= len(groups[0]) <= 3 and groups[0] != "0" and all(len(group) == 3 for group in groups[1:])
    indian = len(groups) > 2 and len(groups[-1]) == 3 and all(len(group) == 2 for group in groups[1:-1])
    if len(set(marks)) == 2:
        if marks.count(last) > 1 or not all(len(group) == 3 for group in groups[1:-1]):
            return None
        decimal: str | None = last
    elif len(marks) > 1:
        if not grouped and not indian:
            return None
        decimal = None
    elif not grouped:
        decimal = last
    else:
        usual = table("numbers")["languages"].get(language, {}).get("decimal")
        if usual is None:
            return None
        decimal = last if last == {"٫": "."}.get(usual, usual) else None
    if decimal is None:
        return float("".join(groups)), 1.0
    return float("".join(groups[:-1]) + "." + groups[-1]), 10.0 ** -len(groups[-1])
