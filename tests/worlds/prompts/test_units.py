"""Units of prompts: what a claim can hold, in twelve languages."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from worldagent.testing.prompts import honest, strangers
from worldagent.worlds.prompts.units import boundaries, counts, folded, letters, unit_at, units_of, word_count

PROMPTS = [*(prompt.text for prompt in honest()), *(prompt.text for prompt in strangers())]


@pytest.mark.parametrize(
    ("text", "units"),
    [
        ("A steel ball rolls off the table.", "A|steel|ball|rolls|off|the|table"),
        ("L'enclume n'a pas d'or, aujourd'hui qu’un", "L'|enclume|n'|a|pas|d'|or|aujourd'hui|qu’|un"),
        ("dell'acqua e un'ora", "dell'|acqua|e|un'|ora"),
        ("It isn't the ball's; he'll, o'clock", "It|is|n't|the|ball|'s|he|'ll|o'clock"),
        ("20°C, 3.5 m/s, 1,000 kg, 50 %, 5kg", "20|°|C|3.5|m|s|1,000|kg|50|%|5kg"),
        ("half-full _ball_ x→y", "half|full|ball|x|→|y"),
        ("球滚下来。", "球|滚|下|来"),
        ("ラーメンが落ちる", "ラ|ー|メ|ン|が|落|ち|る"),
        ("공이 구른다", "공이|구른다"),
        ("กำลัง", "กำ|ลั|ง"),
        ("गाड़ी गिरती", "गाड़ी|गिरती"),
        ("👨‍👩‍👧 falls 🇩🇪", "👨‍👩‍👧|falls|🇩🇪"),
        (" … — !?", ""),
    ],
)
def test_units_are_words_or_clusters_of_scripts_without_blanks(text: str, units: str) -> None:
    assert "|".join(unit.text for unit in units_of(text)) == units


def test_units_cover_every_letter_of_650_prompts_once() -> None:
    assert len(PROMPTS) == 650
    uncovered = [
        (prompt, letters(prompt), sum(letters(unit.text) for unit in units_of(prompt)))
        for prompt in PROMPTS
        if letters(prompt) != sum(letters(unit.text) for unit in units_of(prompt))
    ]
    assert uncovered == []


def test_every_span_that_a_person_marked_in_a_honest_prompt_is_one_of_whole_units() -> None:
    cut = []
    for prompt in honest():
        for quote, nth, _ in prompt.spans:
            start = -1
            for _ in range(nth):
                start = prompt.text.index(quote, start + 1)
            cut += [(prompt.id, quote) for edge in (start, start + len(quote)) if edge not in boundaries(prompt.text)]
    assert cut == []


@settings(deadline=None)
@given(st.text())
def test_units_are_in_order_disjoint_and_hold_every_character_that_counts(text: str) -> None:
    units = units_of(text)
    edges = [edge for unit in units for edge in (unit.start, unit.end)]
    assert edges == sorted(edges)
    assert [text[unit.start : unit.end] for unit in units] == [unit.text for unit in units]
    assert sum(letters(unit.text) for unit in units) == letters(text)
    assert set(edges) <= boundaries(text)


def test_what_counts_is_letters_marks_digits_and_symbols() -> None:
    assert [character for character in "aé́1½٣球%‰&→€\ue000🙂" if not counts(character)] == []
    assert [character for character in " \t\n\u200b\u202e.,;:!?-—'\"()[]\\…。、" if counts(character)] == []
    assert letters("½ kg, 3 °C!") == 6


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("the steel ball", 3),
        ("球", 1),
        ("铁球滚", 2),
        ("三个铁球滚", 3),
        ("鉄の ball が", 3),
        ("", 0),
        ("l'escalier en colimaçon", 4),
    ],
)
def test_a_cluster_of_a_script_without_blanks_counts_half_a_word(text: str, count: int) -> None:
    assert word_count(text) == count


def test_folding_takes_away_case_width_and_presentation() -> None:
    assert folded("Ｋｕｇｅｌ STRASSE ﬁn") == folded("kugel straße fin") == "kugel strasse fin"


def test_the_word_that_a_cut_would_divide_is_named() -> None:
    assert unit_at("the rolls", 6).text == "rolls"
    assert unit_at("the rolls", 4) is None
    assert unit_at("e\u0301x", 1).text == "e\u0301x"
