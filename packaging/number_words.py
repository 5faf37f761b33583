"""Make `worlds/prompts/data/{numbers,units}.json` from ICU: `python packaging/number_words.py [FOLDER]`, with PyICU installed.

Debian's `python3-icu` or PyICU from source; no part of the package needs it. `tests/worlds/prompts/test_data.py` holds the digests.
"""

from __future__ import annotations

import ctypes.util
import hashlib
import json
import sys
import unicodedata
from pathlib import Path
from typing import Any

import icu

DATA = Path(__file__).resolve().parent.parent / "worlds" / "prompts" / "data"
LANGUAGES = ("en", "de", "fr", "es", "it", "pt", "nl", "ru", "zh", "ja", "ar", "hi")
REGIONS = {"en": ("en", "en_GB"), "pt": ("pt", "pt_PT"), "zh": ("zh", "zh_Hant")}
CARDINALS = (*range(101), *range(200, 1000, 100), 1000, 1_000_000)
ORDINALS = range(1, 32)
COUNTS = (1, 2, 3, 5, 11, 100, 1.5)
"""Amounts that between them take every plural form of these languages."""
UNITS: dict[str, tuple[str, float, float]] = {
    "micrometer": ("length", 1e-6, 0), "millimeter": ("length", 1e-3, 0), "centimeter": ("length", 1e-2, 0),
    "decimeter": ("length", 0.1, 0), "meter": ("length", 1, 0), "kilometer": ("length", 1000, 0), "inch": ("length", 0.0254, 0),
    "foot": ("length", 0.3048, 0), "yard": ("length", 0.9144, 0), "mile": ("length", 1609.344, 0),
    "square-millimeter": ("area", 1e-6, 0), "square-centimeter": ("area", 1e-4, 0), "square-meter": ("area", 1, 0),
    "hectare": ("area", 1e4, 0), "square-kilometer": ("area", 1e6, 0), "square-foot": ("area", 0.09290304, 0),
    "milliliter": ("volume", 1e-6, 0), "centiliter": ("volume", 1e-5, 0), "deciliter": ("volume", 1e-4, 0),
    "liter": ("volume", 1e-3, 0), "hectoliter": ("volume", 0.1, 0), "cubic-centimeter": ("volume", 1e-6, 0),
    "cubic-meter": ("volume", 1, 0),
    "milligram": ("mass", 1e-6, 0), "gram": ("mass", 1e-3, 0), "kilogram": ("mass", 1, 0), "tonne": ("mass", 1000, 0),
    "ounce": ("mass", 0.028349523125, 0), "pound": ("mass", 0.45359237, 0),
    "millisecond": ("time", 1e-3, 0), "second": ("time", 1, 0), "minute": ("time", 60, 0), "hour": ("time", 3600, 0),
    "day": ("time", 86400, 0), "week": ("time", 604800, 0),
    "degree": ("angle", 0.017453292519943295, 0), "radian": ("angle", 1, 0), "revolution": ("angle", 6.283185307179586, 0),
    "celsius": ("temperature", 1, 273.15), "fahrenheit": ("temperature", 5 / 9, 459.67 * 5 / 9), "kelvin": ("temperature", 1, 0),
    "newton": ("force", 1, 0), "kilonewton": ("force", 1000, 0), "pound-force": ("force", 4.4482216152605, 0),
    "newton-meter": ("torque", 1, 0),
    "joule": ("energy", 1, 0), "kilojoule": ("energy", 1000, 0), "kilowatt-hour": ("energy", 3.6e6, 0),
    "watt": ("power", 1, 0), "kilowatt": ("power", 1000, 0), "megawatt": ("power", 1e6, 0),
    "pascal": ("pressure", 1, 0), "hectopascal": ("pressure", 100, 0), "kilopascal": ("pressure", 1000, 0),
    "megapascal": ("pressure", 1e6, 0), "bar": ("pressure", 1e5, 0), "millibar": ("pressure", 100, 0),
    "hertz": ("frequency", 1, 0), "kilohertz": ("frequency", 1000, 0),
    "meter-per-second": ("speed", 1, 0), "centimeter-per-second": ("speed", 0.01, 0), "kilometer-per-hour": ("speed", 1 / 3.6, 0),
    "mile-per-hour": ("speed", 0.44704, 0), "foot-per-second": ("speed", 0.3048, 0),
    "knot": ("speed", 1852 / 3600, 0),
    "meter-per-square-second": ("acceleration", 1, 0),
    "kilogram-per-cubic-meter": ("density", 1, 0), "gram-per-cubic-centimeter": ("density", 1000, 0),
    "kilogram-per-liter": ("density", 1000, 0),
    "percent": ("ratio", 0.01, 0),
}  # fmt: skip
"""By ICU's identifier: dimension, factor and offset to SI (SI Brochure, 9th ed.; international yard and pound of 1959; nautical mile)."""
NARROW = ("degree", "inch", "foot", "percent")
"""Units whose narrowest names are of one meaning; `5m` for minutes is left out."""


def source() -> dict[str, Any]:
    """Versions of what the tables are made of, and the digest of ICU's data."""
    name = ctypes.util.find_library("icudata") or ""
    candidates = sorted(Path("/usr/lib").rglob(f"{name}*")) if name else []
    digest = hashlib.sha256(candidates[0].read_bytes()).hexdigest() if candidates else None
    return {
        "made_by": "packaging/number_words.py",
        "icu": icu.ICU_VERSION, "unicode": icu.UNICODE_VERSION, "pyicu": icu.VERSION,
        "library": name, "library_sha256": digest, "licence": "Unicode-DFS-2016, see UNICODE-LICENSE.txt",
    }  # fmt: skip


def plain(text: str) -> str:
    """The text without soft hyphens, direction marks and blanks at its ends."""
    kept = "".join(c for c in text if unicodedata.category(c) != "Cf")
    return " ".join(kept.split())


def spelled(language: str, numbers: Any, *, ordinal: bool) -> dict[str, list[str]]:
    """Spelled-out forms of each number in all genders and cases that ICU knows."""
    maker = icu.RuleBasedNumberFormat(icu.URBNFRuleSetTag.SPELLOUT, icu.Locale(language))
    names = [maker.getRuleSetName(k) for k in range(maker.getNumberOfRuleSetNames())]
    wanted = [name for name in names if ("ordinal" in name if ordinal else "cardinal" in name or name.endswith("-numbering"))]
    found: dict[str, list[str]] = {}
    for number in numbers:
        forms = {}
        for name in wanted:
            maker.setDefaultRuleSet(name)
            form = plain(maker.format(number))
            if not any(c.isdigit() and c.isascii() for c in form):
                forms[form] = None
        found[str(number)] = list(forms)
    return found


def unit_names(language: str, unit: str) -> list[str]:
    """All names of a unit, in words and symbols, in every plural and case; `{0}` is where a number stands that does not come first."""
    width, case = icu.UNumberUnitWidth, icu.UDisplayOptionsGrammaticalCase
    cases = (case.NOMINATIVE, case.ACCUSATIVE, case.GENITIVE, case.DATIVE, case.INSTRUMENTAL, case.PREPOSITIONAL, case.OBLIQUE)
    found: dict[str, None] = {}
    for region in REGIONS.get(language, (language,)):
        maker = icu.NumberFormatter.withLocale(icu.Locale(region)).unit(icu.MeasureUnit.forIdentifier(unit))
        kinds = [maker.unitWidth(width.SHORT)]
        kinds += [maker.unitWidth(width.NARROW)] if unit in NARROW else []
        for grammatical in cases:
            options = icu.DisplayOptions.builder().setGrammaticalCase(grammatical).build()
            kinds.append(maker.unitWidth(width.FULL_NAME).displayOptions(options))
        for kind in kinds:
            for count in COUNTS:
                bare = icu.NumberFormatter.withLocale(icu.Locale(region)).formatDouble(count)
                text = kind.formatDouble(count)
                if bare in text:  # a dual of Arabic says its number itself
                    found[plain(text.replace(bare, " {0} ", 1)).removeprefix("{0} ")] = None
    return sorted(found)


def written(path: Path, table: dict[str, Any]) -> None:
    """One line for each entry of the second level, so that a difference can be read."""
    body = json.dumps(table["languages"], ensure_ascii=False, sort_keys=True)
    head = {"source": {**source(), "languages_sha256": hashlib.sha256(body.encode()).hexdigest()}}
    head.update({key: value for key, value in table.items() if key != "languages"})
    lines = [f" {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}" for key, value in head.items()]
    inner = []
    for language, parts in table["languages"].items():
        rows = [f"   {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}" for key, value in parts.items()]
        inner.append(f'  "{language}": {{\n' + ",\n".join(rows) + "\n  }")
    text = "{\n" + ",\n".join([*lines, ' "languages": {\n' + ",\n".join(inner) + "\n }"]) + "\n}\n"
    path.write_text(text, encoding="utf-8")


def main(folder: Path) -> None:
    """Both tables, into a folder."""
    numbers = {}
    for language in LANGUAGES:
        symbols = icu.DecimalFormatSymbols(icu.Locale(language))
        numbers[language] = {
            "decimal": symbols.getSymbol(icu.DecimalFormatSymbols.kDecimalSeparatorSymbol),
            "cardinals": spelled(language, CARDINALS, ordinal=False),
            "ordinals": spelled(language, ORDINALS, ordinal=True),
        }
    written(folder / "numbers.json", {"languages": numbers})
    units = {language: {unit: unit_names(language, unit) for unit in UNITS} for language in LANGUAGES}
    table = {unit: {"dimension": kind, "factor": factor, "offset": offset} for unit, (kind, factor, offset) in UNITS.items()}
    written(folder / "units.json", {"units": table, "languages": units})


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else DATA)
