"""Odd characters: found in words that deceive, and in no honest prompt."""

from __future__ import annotations

import unicodedata

import pytest
from worldagent.testing.prompts import honest, strangers
from worldagent.worlds.prompts.odd import ALPHABETS, LIKE_LATIN, odd_characters
from worldagent.worlds.prompts.units import units_of


@pytest.mark.parametrize(
    ("text", "odd", "why"),
    [
        ("A b\u0430ll falls", "b\u0430ll", "one word of Latin and Cyrillic letters (U+0430"),
        (
            "A \u0441\u043e\u0440 falls off",
            "\u0441\u043e\u0440",
            "Cyrillic letters (U+0441 CYRILLIC SMALL LETTER ES) that look Latin: write Latin ones",
        ),
        ("\u0410 ball falls", "\u0410", "that look Latin"),
        ("The \u0391nvil", "\u0391nvil", "Latin and Greek"),
        ("one \u03bfx falls", "\u03bfx", "Latin and Greek"),
        ("an \u03bf\u03bd falls", "\u03bf\u03bd", "Greek letters"),
        ("The \u0570\u0585\u057d rolls", "\u0570\u0585\u057d", "Armenian letters"),
        ("Мяч не падает, \u0063\u006f\u0070 горит", "cop", "Latin letters (U+0063 LATIN SMALL LETTER C) that look Cyrillic"),
        ("Мяч н\u0065 падает", "н\u0065", "Latin and Cyrillic"),
        ("a b\u0251ll falls", "b\u0251ll", "looks like 'a': write that"),
        ("a ba\u200bll falls", "\u200b", "U+200B ZERO WIDTH SPACE is not seen: leave it out"),
        ("a ba\u00adll falls", "\u00ad", "SOFT HYPHEN"),
        ("a ba\u200dll falls", "\u200d", "ZERO WIDTH JOINER"),
        ("a ba\ufe0fll falls", "\ufe0f", "VARIATION SELECTOR-16"),
        ("a ball\u3164 falls", "\u3164", "HANGUL FILLER"),
        ("a \u202ellab\u202c falls", "\u202e", "RIGHT-TO-LEFT OVERRIDE turns the order of letters round"),
        ("a ball\u200f falls", "\u200f", "RIGHT-TO-LEFT MARK"),
        ("a ball\U000e006e\U000e006f falls", "\U000e006e", "TAG LATIN SMALL LETTER N is not seen"),
        ("a ball\x00 falls", "\x00", "U+0000"),
        ("a \ue000ball falls", "\ue000", "has no meaning of its own"),
        ("it does \ua4e0\ua4f3\ua4d4 fall", "\ua4e0\ua4f3\ua4d4", "Lisu letters"),
        ("it does n\u0338ot fall", "n\u0338", "COMBINING LONG SOLIDUS OVERLAY is drawn over a letter"),
        ("\ufeffA ball falls", "\ufeff", "is not seen"),
    ],
)
def test_what_deceives_is_told_with_its_place_and_the_reason(text: str, odd: str, why: str) -> None:
    first = odd_characters(text)[0]
    assert (first.text, text[first.start : first.end]) == (odd, odd)
    assert why in first.why


@pytest.mark.parametrize(
    "text",
    [
        "The sign says «он не упал, а стоит» and falls",
        "Мяч CO2 катится по оси x, потом OK, iPhone и LED",
        "Die Kugel fällt auf das Schild «Не входить»; γ = 3, ρ = 1000 kg/m3, ν",
        "μm kΩ Δt µm Ω",
        "Tシャツ LED등 X線 3D-принтер ลูกบอลLEDตก USBमें",
        "👨‍👩‍👧 ❤️ ☀︎ 1️⃣ 🏴\U000e0067\U000e0062\U000e0065\U000e006e\U000e0067\U000e007f 👩🏽‍🚀 葛\U000e0100城",
        "توپ می‌رود، ك\u200f.",
        "क्‍ष เขา\u200bไป",
        "ıssız kaya düştü; l’œuf, Ångström, naïve, Straße, ﬁn",
        "ＬＥＤのボール",
        "Ọmọ náà ńṣeré, Thẻ này, a ≠ b, ᚠ carved on a stone",
        "ᏣᎳᎩ ᎦᏬᏂᎯᏍᏗ",
        "A ball\n\tfalls\r\n",
        "",
    ],
)
def test_honest_spelling_of_many_scripts_is_not_told(text: str) -> None:
    assert odd_characters(text) == ()


def test_no_prompt_of_650_in_twelve_languages_has_odd_characters() -> None:
    texts = [*(prompt.text for prompt in honest()), *(prompt.text for prompt in strangers())]
    assert len(texts) == 650
    assert [text for text in texts if odd_characters(text)] == []


def test_one_cyrillic_letter_is_found_in_every_english_prompt_that_has_room_for_it() -> None:
    """The first word with a Latin `a`, `e` or `o`, written with the Cyrillic one."""
    swap = {"a": "\u0430", "e": "\u0435", "o": "\u043e"}
    english = [prompt.text for prompt in strangers() if prompt.language == "en"]
    missed = []
    for text in english:
        at = next(k for k, character in enumerate(text) if character in swap)
        changed = text[:at] + swap[text[at]] + text[at + 1 :]
        (odd,) = odd_characters(changed) or (None,)
        missed += [] if odd and odd.start <= at < odd.end else [text]
    assert len(english) == 110
    assert missed == []


def test_an_invisible_character_is_found_in_every_word_of_every_prompt_with_an_alphabet() -> None:
    changed = []
    for prompt in strangers():
        if prompt.language in ("en", "de", "fr", "es", "it", "pt", "nl", "ru"):
            unit = max(units_of(prompt.text), key=lambda unit: unit.end - unit.start)
            changed.append((prompt.text[: unit.start + 1] + "\u200b" + prompt.text[unit.start + 1 :], unit.start + 1))
    assert len(changed) > 300
    assert [text for text, at in changed if [(odd.start, odd.text) for odd in odd_characters(text)] != [(at, "\u200b")]] == []


def test_the_table_of_look_alikes_pairs_letters_of_one_script_with_plain_latin_ones() -> None:
    wrong = [
        (letter, plain)
        for script, table in LIKE_LATIN.items()
        for letter, plain in table.items()
        if not unicodedata.name(letter).startswith(script.upper()) or not plain.isascii() or letter.isascii()
    ]
    assert wrong == []
    assert set(LIKE_LATIN) <= set(ALPHABETS)
    assert LIKE_LATIN["Cyrillic"]["\u0430"] == "a"
