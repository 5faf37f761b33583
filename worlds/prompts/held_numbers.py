"""Numbers that stand in a running text, where many number words are something else: `one`, `neuf`, `sei`, `四周`.

Held are digits, and words that are a number beyond doubt; of the doubtful ones those between a function word and a word of content.
"""

from __future__ import annotations

import unicodedata
from typing import Literal

import regex

from .function_words import FUNCTION_WORDS
from .spelled import single_words
from .units import Unit

__all__ = ["han_numbers", "list_markers", "number_spans"]

DOUBTFUL: dict[str, frozenset[str]] = {
    "en": frozenset(("one",)),
    "de": frozenset(("acht", "sieben")),
    "fr": frozenset(("neuf",)),
    "es": frozenset(),
    "it": frozenset(("sei", "venti", "otto", "mille")),
    "pt": frozenset(),
    "nl": frozenset(("acht",)),
    "ru": frozenset(("сорок",)),
}
"""New, the verb to be, winds, to pay heed: held only between a function word and a word of content."""
NEVER: dict[str, frozenset[str]] = {
    "en": frozenset(("once", "both", "single", "pair", "pairs", "couple")),
    "de": frozenset(("ein", "eine", "einen", "einem", "einer", "eines", "eins", "einmal", "beide", "beiden", "beider")),
    "fr": frozenset(("un", "une", "paire", "paires")),
    "es": frozenset(("un", "una", "uno", "par", "pares", "ambos", "ambas", "unos")),
    "it": frozenset(("un", "una", "uno", "paio", "paia", "coppia", "entrambi", "entrambe")),
    "pt": frozenset(("um", "uma", "par", "pares", "ambos", "ambas")),
    "nl": frozenset(("een", "beide")),
    "ru": frozenset((
        "один", "одна", "одно", "одни", "одного", "одной", "одних", "одному", "одним", "одну", "одном", "одними",
        "пара", "пару", "пары", "оба", "обе", "обоих", "обеих",
    )),
}  # fmt: skip
"""Articles, and words for two that are as often `some` or `each`: a person claims them as counts, nobody must."""
DETERMINERS = {
    "en": frozenset(("the", "a", "an", "this", "that", "these", "those", "its", "his", "her", "their", "my", "your", "our", "each", "every",
                     "any", "some", "another", "other", "which")),
    "it": frozenset(("i", "gli", "dei", "degli", "ai", "nei", "sui", "dai", "coi")),
}  # fmt: skip
"""Function words behind which a doubtful word is no number: `the one`, `i venti`."""
LABELS = {
    "en": frozenset(("year", "grade", "class", "scenario", "scene", "shot", "version", "chapter", "exercise", "task", "room", "gate")),
    "de": frozenset(("klasse", "klassenstufe", "jahrgang", "szenario", "szene", "einstellung", "version", "kapitel", "aufgabe", "zimmer", "raum", "gleis")),
    "fr": frozenset(("scénario", "scène", "version", "chapitre", "exercice", "salle", "chambre", "quai")),
    "es": frozenset(("curso", "escenario", "escena", "versión", "capítulo", "ejercicio", "sala", "aula", "andén")),
    "it": frozenset(("classe", "scenario", "scena", "ripresa", "versione", "capitolo", "esercizio", "sala", "aula", "binario")),
    "pt": frozenset(("cenário", "cena", "tomada", "versão", "capítulo", "exercício", "sala", "plataforma")),
    "nl": frozenset(("groep", "klas", "scenario", "scène", "opname", "versie", "hoofdstuk", "opgave", "kamer", "zaal", "spoor")),
    "ru": frozenset(("сценарий", "сцена", "кадр", "дубль", "версия", "глава", "упражнение", "комната", "путь")),
}  # fmt: skip
"""Reviewed by hand: nouns behind which a number names one of a series and counts nothing: `Year 8`, `Szene 3`."""
_AGED = regex.compile(r"(?i)[\s-]*(?:year|month|week|day)s?[\s-]+old\b")
"""Age of somebody or something, in English one word of three: no duration of the film."""
COUNTERS = {
    "zh": "个個只隻条條块塊张張颗顆辆輛枚本把根座台间間层層级級片粒头頭匹架艘棵朵滴桶盆罐杯瓶箱堆排圈次下遍步位名人双對对组組米秒分度厘公千克吨升毫岁天年月",
    "ja": "個箇枚本匹羽人台冊回度つ階段列杯滴粒束組秒分時日年月倍メセキリトグミ",
}
"""Measure words and units behind which a numeral counts."""
FIXED = {
    "zh": "千克|千米|千瓦|千帕|千焦|一下|一起|一样|一直|一点|一些|一阵|一会|一般|一边|一面|一旦|一切|一定|一片|十分|万一|千万|四周|四处|三角|四方|八方|一层层|一级一级|一块接一块|一个接一个|一路",
    "ja": "半分|半ば|一緒|一部|一方|一番|一気|一度に|一面|一斉|十分|三角|四角|一人で",
}
"""Words in which a numeral counts nothing."""
INDEFINITE = tuple("几幾数數")
SAME_ONE = (*INDEFINITE, *"后後每这這那另同某哪一")
"""Characters behind which a numeral, or a one, counts nothing: some tens, the last one, each one."""
ONLY_PICTURE = regex.compile(r"(?i)[23]d|[48]k")
"""Digits of kinds of pictures."""

_MARKER = regex.compile(r"(?:^|\n|(?<=[.!?:;]\s))[ \t]*(\p{Nd}{1,2})\.\s+(?=\p{L})")
_SOME_DAY = regex.compile(r"(?i)one\s+(?:day|morning|afternoon|evening|night)\b(?!\s+(?:later|after|long|of|only|alone))")
"""At the start of a sentence, some day: it counts nothing."""
_OPENS = regex.compile(r"(?:^|[.!?\n])\s*$")
_ENUMERATED = regex.compile(r"\)(?:\s|$)")
_HAN_NUMBER = regex.compile(r"[〇零一二三四五六七八九十百千万亿億两兩半]+|\p{Nd}+(?:[.,]\p{Nd}+)*")


def number_spans(
    text: str, units: tuple[Unit, ...], words: list[str], language: str
) -> list[tuple[int, int, Literal["number", "order"]]]:
    """Spans of numbers in a language with blanks; neighbours are one, and `2)` is a word of order."""
    known = single_words(language) - NEVER[language]
    found: list[tuple[int, int, Literal["number", "order"]]] = []
    last, markers = -2, list_markers(text)
    for at, (unit, word) in enumerate(zip(units, words, strict=True)):
        digits = _has_digits(unit.text)
        if (at and words[at - 1] in LABELS[language]) or (language == "en" and _AGED.match(text, unit.end)):
            continue
        if unit.start in markers or (
            language == "en" and _SOME_DAY.match(text, unit.start) and _OPENS.search(text[: unit.start])
        ):
            continue
        if not digits and (word not in known or (word in DOUBTFUL[language] and not _counted(text, units, words, at, language))):
            continue
        kind: Literal["number", "order"] = (
            "order" if digits and _ENUMERATED.match(text, unit.end) and "(" not in text else "number"
        )
        if last == at - 1 and found and kind == found[-1][2] and text[units[last].end : unit.start].strip(" -:") == "":
            found[-1] = (found[-1][0], unit.end, kind)
        else:
            found.append((unit.start, unit.end, kind))
        last = at
    return found


def list_markers(text: str) -> tuple[int, ...]:
    """Places of the numbers that mark the items of a list, `1. ...`, `2. ...`: two or more, in order from 1; none where they are not."""
    found = [(m.start(1), int(m.group(1))) for m in _MARKER.finditer(text)]
    counted = [n for _, n in found] == list(range(1, len(found) + 1))
    return tuple(start for start, _ in found) if counted and len(found) > 1 else ()


def _has_digits(text: str) -> bool:
    if not any(c.isdecimal() or unicodedata.decomposition(c).startswith("<fraction>") for c in text):
        return False
    return not ONLY_PICTURE.fullmatch(text) and not text[0].isalpha()


def _counted(text: str, units: tuple[Unit, ...], words: list[str], at: int, language: str) -> bool:
    """True of a doubtful word behind a function word (no determiner) or nothing, and before a word of content."""
    behind = words[at - 1] if at else ""
    before = words[at + 1] if at + 1 < len(words) and text[units[at].end : units[at + 1].start].strip() == "" else ""
    bound = not behind or (behind in FUNCTION_WORDS[language] and behind not in DETERMINERS.get(language, ()))
    return bound and bool(before) and before not in FUNCTION_WORDS[language]


def han_numbers(text: str, language: str) -> list[tuple[int, int]]:
    """Spans of digits, and of numerals before a measure word or behind `第`."""
    fixed = {at for match in regex.finditer(FIXED[language], text) for at in range(*match.span())}
    found = []
    for match in _HAN_NUMBER.finditer(text):
        start, end = match.span()
        picture = ONLY_PICTURE.fullmatch(text, start, min(len(text), end + 1))
        counted = match.group()[0].isdecimal() or text[end : end + 1] in tuple(COUNTERS[language]) or text[:start].endswith("第")
        vague = text[max(0, start - 1) : start] in (SAME_ONE if match.group() == "一" else INDEFINITE)
        if start not in fixed and counted and not picture and not vague:
            found.append((start, end))
    return found
