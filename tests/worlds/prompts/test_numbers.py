"""Numbers and quantities of quotes: digits, words, units, and the interval that they leave open."""

from __future__ import annotations

import math

import pytest
from worldagent.testing.prompts import honest
from worldagent.worlds.prompts.measures import SI_UNITS
from worldagent.worlds.prompts.numbers import ABOUT, number_in, ordinal_in, quantity_in
from worldagent.worlds.prompts.tables import NUMBER_LANGUAGES, table

COUNTS: dict[str, dict[str, float]] = {
    "en": {"three": 3, "half a dozen": 6, "a dozen goats": 12, "a single": 1, "six times": 6, "twice": 2, "one hundred and twenty": 120,
           "twenty-one": 21, "two hundred thousand three hundred and five": 200305, "2 million": 2e6, "two and a half": 2.5, "2½": 2.5,
           "a third of it": 1 / 3, "two thirds": 2 / 3, "half": 0.5, "both": 2, "a pair of": 2, "1,950": 1950, "1,950.5": 1950.5, "3.25": 3.25,
           "2 1/2": 2.5, "4×10⁵": 4e5, "1.5e3": 1500, "-5": -5, "(−3)": -3, "the second": 2, "3rd": 3, "one second": 1, "the first two": 2},
    "de": {"einundzwanzig": 21, "zweihundertfünfzig": 250, "hundertfünfundzwanzig": 125, "anderthalb": 1.5, "ein halbes Dutzend": 6,
           "beiden": 2, "1.950": 1950, "1,950": 1.95, "dreimal": 3, "dritte": 3},
    "fr": {"soixante et onze": 71, "quatre-vingt-dix-neuf": 99, "deux cent cinquante": 250, "Une dizaine": 10, "un": 1, "cinq fois": 5,
           "2e": 2, "1 000": 1000, "trois et demi": 3.5},
    "es": {"treinta y uno": 31, "doscientos": 200, "media docena": 6, "dos y media": 2.5, "cuarenta": 40},
    "it": {"ventuno": 21, "duecentocinquanta": 250, "tremila": 3000, "mezza dozzina": 6, "Dodici": 12},
    "pt": {"vinte e um": 21, "meia dúzia": 6, "três": 3, "duzentos e cinquenta": 250},
    "nl": {"eenentwintig": 21, "tweehonderdvijftig": 250, "anderhalve": 1.5, "half dozijn": 6},
    "ru": {"двадцать один": 21, "двумя": 2, "четырёх": 4, "полтора": 1.5, "две тысячи пятьсот": 2500, "два с половиной": 2.5, "третий": 3},
    "zh": {"三百二十": 320, "两千零五": 2005, "12只": 12, "3万": 30000, "半": 0.5, "二〇二六": 2026, "第三": 3, "十": 10, "一亿": 10**8},
    "ja": {"五個": 5, "ふたつ": 2, "２かい": 2, "三番目": 3, "百二十": 120, "半分": 0.5},
    "ar": {"ثلاث": 3, "٢٠": 20, "١٫٥": 1.5, "نصف": 0.5},
    "hi": {"चार": 4, "१२": 12, "डेढ़": 1.5},
}  # fmt: skip
NONE: dict[str, list[str]] = {
    "en": [
        "3-4",
        "3–4",
        "three to four",
        "between two and three",
        "two or three",
        "every",
        "a few",
        "no number",
        "0:40",
        "T34",
        "",
    ],
    "de": ["ein paar", "zwei bis drei", "nur"],
    "es": ["un montón", "todos"],
    "nl": ["een paar", "honderden"],
    "zh": ["几十颗", "三到四"],
}


@pytest.mark.parametrize(
    ("language", "text", "value"), [(lang, *item) for lang, found in COUNTS.items() for item in found.items()]
)
def test_a_number_is_read_in_digits_and_words(language: str, text: str, value: float) -> None:
    assert number_in(text, language) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(("language", "text"), [(lang, text) for lang, texts in NONE.items() for text in texts])
def test_ranges_several_numbers_and_vague_words_are_no_number(language: str, text: str) -> None:
    assert number_in(text, language) is None


def test_every_form_of_icu_from_zero_to_a_hundred_is_read_as_its_number() -> None:
    wrong, read = [], 0
    for language in NUMBER_LANGUAGES:
        data = table("numbers")["languages"][language]
        for kind in ("cardinals", "ordinals"):
            for number, forms in data[kind].items():
                read += len(forms)
                wrong += [(language, form) for form in forms if number_in(form, language) != float(number)]
                wrong += [(language, form) for form in forms if kind == "ordinals" and ordinal_in(form, language) != int(number)]
    assert read > 3000
    assert wrong == []


def test_without_a_language_only_what_all_agree_on_is_read() -> None:
    assert number_in("once") is None  # one in English, eleven in Spanish
    assert number_in("1,000") is None
    assert (number_in("1,000", "en"), number_in("1,000", "de")) == (1000, 1)
    assert (number_in("drei"), number_in("12"), number_in("١٢"), number_in("1,25")) == (3, 12, 12, 1.25)
    assert number_in("12", "sv") == 12


def test_an_ordinal_is_told_from_a_count_and_from_a_unit() -> None:
    assert ordinal_in("the second bend", "en") == 2
    assert ordinal_in("второй", "ru") == 2
    assert ordinal_in("第三", "zh") == 3
    assert ordinal_in("two", "en") is None
    assert number_in("10 seconds", "en") == 10


@pytest.mark.parametrize(
    ("language", "text", "value", "unit"),
    [
        ("en", "by thirty degrees", math.pi / 6, "rad"),
        ("en", "2-metre", 2, "m"),
        ("en", "bulk density 1950 kg/m³", 1950, "kg/m3"),
        ("en", "g = 9.81 m/s^2", 9.81, "m/s2"),
        ("en", "a metre high", 1, "m"),
        ("en", "half a kilo", 0.5, "kg"),
        ("en", "5 ft 3 in", 1.6002, "m"),
        ("en", "1 h 30 min", 5400, "s"),
        ("en", "70 degrees F", 294.26111, "K"),
        ("en", "-5 °C", 268.15, "K"),
        ("en", "20 mph", 8.9408, "m/s"),
        ("en", "5 N·m", 5, "N m"),
        ("en", "50 %", 0.5, "1"),
        ("en", "3 KG", 3, "kg"),
        ("de", "aus 1,5 Metern", 1.5, "m"),
        ("fr", "1,20 m", 1.2, "m"),
        ("es", "a 1100 °C", 1373.15, "K"),
        ("it", "40 metri cubi", 40, "m3"),
        ("pt", "meio quilo", 0.5, "kg"),
        ("nl", "20 cm hoog", 0.2, "m"),
        ("ru", "полтора метра", 1.5, "m"),
        ("ru", "5 м/с", 5, "m/s"),
        ("zh", "半吨", 500, "kg"),
        ("zh", "每小时50公里", 50 / 3.6, "m/s"),
        ("ja", "時速50キロメートル", 50 / 3.6, "m/s"),
        ("ja", "厚さ20センチ", 0.2, "m"),
        ("ar", "من ارتفاع ٢٠ مترًا", 20, "m"),
        ("hi", "१२ मीटर ऊँची", 12, "m"),
        (None, "5 kg", 5, "kg"),
    ],
)
def test_a_quantity_is_in_si(language: str | None, text: str, value: float, unit: str) -> None:
    found = quantity_in(text, language)
    assert found.value == pytest.approx(value, rel=1e-6)
    assert found.unit == unit == SI_UNITS[found.dimension]
    assert found.low < found.value < found.high


@pytest.mark.parametrize(
    ("language", "text", "low", "high", "how"),
    [
        ("en", "3 kg", 2.5, 3.5, "written"),
        ("en", "3.0 kg", 2.95, 3.05, "written"),
        ("en", "about 8 kg", 8 * (1 - ABOUT), 8 * (1 + ABOUT), "about"),
        ("en", "about 1 kg", 0.5, 1.5, "about"),
        ("en", "~1.2 kg", 0.9, 1.5, "about"),
        ("en", "at least 3 kg", 3, math.inf, "at least"),
        ("en", "no more than 3 kg", -math.inf, 3, "at most"),
        ("en", "no less than 3 kg", 3, math.inf, "at least"),
        ("en", "3–4 kg", 3, 4, "between"),
        ("en", "3 kg to 4 kg", 3, 4, "between"),
        ("de", "mindestens zwei Kilo", 2, math.inf, "at least"),
        ("de", "nicht mehr als zwei Kilo", -math.inf, 2, "at most"),
        ("fr", "jusqu’à 3 kilos", -math.inf, 3, "at most"),
        ("nl", "tussen 1 en 2 kilo", 1, 2, "between"),
        ("ru", "не более 3 кг", -math.inf, 3, "at most"),
        ("zh", "不超过3千克", -math.inf, 3, "at most"),
        ("zh", "超过3千克", 3, math.inf, "at least"),
        ("ja", "4キログラムくらい", 3, 5, "about"),
    ],
)
def test_the_words_around_a_number_open_its_interval(language: str, text: str, low: float, high: float, how: str) -> None:
    found = quantity_in(text, language)
    assert (found.how, found.unit) == (how, "kg")
    assert (found.low, found.high) == (pytest.approx(low), pytest.approx(high))


@pytest.mark.parametrize(
    "text", ["3 in a row", "3am", "half full", "ankle-deep", "2 kg and 3 kg", "twice as far", "the second", "up to its windows"]
)
def test_what_states_no_one_quantity_is_none(text: str) -> None:
    assert quantity_in(text, "en") is None


def test_quantities_of_honest_prompts_with_digits_and_a_unit_are_read() -> None:
    """Measured on 150 prompts; what is left states none with a unit (`half full`, `as big as a bus`)."""
    spans = [(prompt.language, span.quote) for prompt in honest() for span in prompt.spans if span.type == "quantity"]
    unread = [quote for language, quote in spans if any(map(str.isdecimal, quote)) and quantity_in(quote, language) is None]
    assert len(spans) > 60
    assert unread == ["μ_s = 0.35"]


def test_counts_of_honest_prompts_are_read_or_state_no_number() -> None:
    spans = [(prompt.language, span.quote) for prompt in honest() for span in prompt.spans if span.type == "count"]
    unread = {quote for language, quote in spans if number_in(quote, language) is None}
    assert len(spans) > 50
    assert unread == {"every", "nur", "un montón", "todos", "几十颗", "honderden"}
