"""Names of units behind or around a number, in words and symbols; ICU's table and a few reviewed everyday names."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import regex

from .digits import prepared
from .tables import NUMBER_LANGUAGES, table
from .units import folded

__all__ = ["SI_UNITS", "Measure", "measure_behind", "measure_of"]

SI_UNITS = {
    "length": "m", "area": "m2", "volume": "m3", "mass": "kg", "time": "s", "angle": "rad", "temperature": "K", "force": "N",
    "torque": "N m", "energy": "J", "power": "W", "pressure": "Pa", "frequency": "Hz", "speed": "m/s", "acceleration": "m/s2",
    "density": "kg/m3", "ratio": "1",
}  # fmt: skip
"""Unit of each dimension inside."""
EVERYDAY: dict[str, dict[str, tuple[str, ...]]] = {
    "en": {"kilogram": ("kilo", "kilos", "kgs"), "tonne": ("ton", "tons", "tonne", "tonnes"), "centimeter": ("cms",), "pound": ("lbs",),
           "kilometer-per-hour": ("kph", "km/hr", "kmh"), "meter-per-second": ("mps",), "liter": ("ltr",),
           "celsius": ("degrees C", "deg C", "degrees centigrade"), "kilometer": ("kms",), "percent": ("per cent",),
           "fahrenheit": ("degrees F", "deg F"), "square-meter": ("sq m",), "cubic-meter": ("cu m",)},
    "de": {"kilogram": ("Kilo", "Kilos"), "kilometer-per-hour": ("Stundenkilometer", "Stundenkilometern"), "hour": ("Std",),
           "second": ("Sek",)},
    "fr": {"kilogram": ("kilo", "kilos"), "kilometer-per-hour": ("kilomètres à l'heure", "kmh"), "percent": ("pour cent",)},
    "es": {"kilogram": ("kilo", "kilos"), "second": ("seg",), "kilometer": ("kilometros", "kilometro"), "percent": ("por ciento",)},
    "it": {"kilogram": ("chilo", "chili", "kili"), "kilometer-per-hour": ("chilometri all'ora",), "percent": ("per cento",)},
    "pt": {"kilogram": ("quilo", "quilos"), "percent": ("por cento",)},
    "nl": {"kilogram": ("kilo", "kilo's"), "degree": ("graad", "graden"), "tonne": ("ton",), "percent": ("procent",)},
    "ru": {"kilogram": ("кило",), "second": ("сек",), "degree": ("град",)},
    "zh": {"centimeter": ("公分", "厘米"), "kilogram": ("公斤",), "tonne": ("吨", "噸"), "meter": ("米", "公尺"), "kilometer": ("公里", "千米"),
           "liter": ("升", "公升"), "gram": ("克",), "hour": ("小时", "個小時", "个小时", "钟头", "个钟头"), "minute": ("分钟",),
           "second": ("秒", "秒钟"), "milliliter": ("毫升",), "day": ("天",)},
    "ja": {"centimeter": ("センチ",), "millimeter": ("ミリ",), "second": ("秒間",), "minute": ("分間",), "tonne": ("トン",),
           "meter": ("メーター",)},
    "ar": {"kilogram": ("كغ", "كيلو", "كجم"), "meter": ("متراً", "مترا"), "centimeter": ("سنتيمترات",), "second": ("ثواني", "ثوانٍ")},
    "hi": {"meter": ("मी.",), "kilogram": ("किलो",), "degree": ("डिग्री",), "second": ("सेकेंड", "सेकंड")},
}  # fmt: skip
"""Everyday names that ICU lacks."""
SYMBOLS = {
    "µm": "micrometer", "mm": "millimeter", "cm": "centimeter", "dm": "decimeter", "m": "meter", "km": "kilometer",
    "mm2": "square-millimeter", "cm2": "square-centimeter", "m2": "square-meter", "km2": "square-kilometer", "ha": "hectare",
    "ml": "milliliter", "mL": "milliliter", "cl": "centiliter", "dl": "deciliter", "l": "liter", "L": "liter", "hl": "hectoliter",
    "cm3": "cubic-centimeter", "m3": "cubic-meter", "mg": "milligram", "g": "gram", "kg": "kilogram", "t": "tonne",
    "ms": "millisecond", "s": "second", "min": "minute", "h": "hour", "d": "day", "°": "degree", "deg": "degree", "rad": "radian",
    "°C": "celsius", "°F": "fahrenheit", "K": "kelvin", "N": "newton", "kN": "kilonewton", "Nm": "newton-meter", "N m": "newton-meter",
    "N·m": "newton-meter", "J": "joule", "kJ": "kilojoule", "kWh": "kilowatt-hour", "W": "watt", "kW": "kilowatt", "MW": "megawatt",
    "Pa": "pascal", "hPa": "hectopascal", "kPa": "kilopascal", "MPa": "megapascal", "bar": "bar", "mbar": "millibar", "Hz": "hertz",
    "kHz": "kilohertz", "m/s": "meter-per-second", "cm/s": "centimeter-per-second", "km/h": "kilometer-per-hour",
    "m/s2": "meter-per-square-second", "kg/m3": "kilogram-per-cubic-meter", "g/cm3": "gram-per-cubic-centimeter",
    "kg/l": "kilogram-per-liter", "kg/L": "kilogram-per-liter", "%": "percent", "mph": "mile-per-hour", "in": "inch", "ft": "foot",
    "lb": "pound", "oz": "ounce", "″": "inch", "′": "foot", "′′": "inch",
}  # fmt: skip
"""Symbols that hold in every language: the SI's, and some common ones."""
CAPITALS = frozenset(("KG", "Kg", "CM", "Cm", "MM", "KM", "Km", "ML", "Ml", "FT", "LB", "HZ", "hz", "KN", "PA"))
"""Symbols in wrong capitals of which one reading is left."""

DOUBTFUL = frozenset(("in", "с"))
"""Symbols that are a word where another word follows: `3 in a row`, `3 с ручкой`."""

_BESIDE = r"[\s\-]*(?:(?:of\s+an?|of|an?|de|di|del|van|eine[mnrs]?)\s+|d['’]\s*)?"
_NOT_WITHIN = r"(?![\p{Latin}\p{Cyrillic}\p{Greek}\p{Arabic}\p{Devanagari}\p{M}\d]|[/·^]\s?[\p{L}])"


class Measure(NamedTuple):
    """A unit: what SI value one of it is worth, and where its name ends."""

    name: str
    dimension: str
    factor: float
    offset: float
    end: int


class _Names(NamedTuple):
    behind: regex.Pattern[str]
    around: tuple[tuple[str, str, str], ...]
    """Prefix, suffix, unit."""
    symbols: dict[str, str]
    words: dict[str, str]


def _surface(name: str) -> str:
    return " ".join(prepared(name).replace("⋅", "·").split())


@cache
def _names(language: str | None) -> _Names:
    """Names in one language, or those of all that have one meaning."""
    symbols = {_surface(symbol): unit for symbol, unit in SYMBOLS.items()}
    plain = {symbol.lower(): unit for symbol, unit in symbols.items()}
    symbols.update({wrong: plain[wrong.lower()] for wrong in CAPITALS})
    words: dict[str, str] = {}
    around: list[tuple[str, str, str]] = []
    unclear: set[str] = set()
    for known in NUMBER_LANGUAGES if language is None else (language,):
        for unit, forms in table("units")["languages"][known].items():
            for form in (*forms, *EVERYDAY[known].get(unit, ())):
                surface = _surface(form)
                if "{0}" in surface:
                    before, _, after = surface.partition("{0}")
                    around.append((before.strip(), after.strip(), unit))
                elif len(surface) <= 2 or "/" in surface:
                    symbols.setdefault(surface, unit)
                elif words.setdefault(_word(surface), unit) != unit:
                    unclear.add(_word(surface))
    words = {word: unit for word, unit in words.items() if word not in unclear}
    exact = "|".join(_flexible(symbol) for symbol in sorted(symbols, key=len, reverse=True))
    loose = "|".join(_flexible(word) for word in sorted(words, key=len, reverse=True))
    pattern = regex.compile(rf"(?V1){_BESIDE}(?:(?P<word>(?i:{loose}))|(?P<symbol>{exact})){_NOT_WITHIN}")
    return _Names(pattern, tuple(around), symbols, words)


def _word(surface: str) -> str:
    return regex.sub(r"[\s\-]+", " ", folded(surface))


def _flexible(name: str) -> str:
    """A pattern for a name, in which blanks may be hyphens."""
    pattern = r"[\s\-]+".join(map(regex.escape, name.split(" ")))
    return pattern + (r"(?!\s+\p{L})" if name in DOUBTFUL else "")


def measure_of(name: str, end: int) -> Measure:
    """The unit of ICU's identifier."""
    data = table("units")["units"][name]
    return Measure(name, data["dimension"], data["factor"], data["offset"], end)


def measure_behind(text: str, start: int, end: int, language: str | None) -> Measure | None:
    """The unit that a number between these offsets of a prepared text has, or none."""
    names = _names(language)
    for before, after, unit in names.around:
        rest = text[end:].lstrip()
        if text[:start].rstrip().endswith(before) and rest.startswith(after):
            return measure_of(unit, len(text) - len(rest) + len(after))
    match = names.behind.match(text, end)
    if match is None:
        return None
    word = match.group("word")
    unit = names.symbols[match.group("symbol")] if word is None else names.words[_word(word)]
    return measure_of(unit, match.end())
