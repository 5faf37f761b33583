"""Whatever a text holds, it is read: nothing raises, spans lie within it, and long ones cost no more than their length."""

from __future__ import annotations

import math

from hypothesis import given, settings
from hypothesis import strategies as st
from worldagent.worlds.prompts.languages import REVIEWED, held_words, language_of
from worldagent.worlds.prompts.numbers import number_in, ordinal_in, quantity_in
from worldagent.worlds.prompts.odd import odd_characters
from worldagent.worlds.prompts.tables import NUMBER_LANGUAGES

PIECES = st.sampled_from([
    "two", "half", "hundred", "and", "a", "3", "1,000", "½", "10^5", "²", "kg", "m/s", "°C", "to", "-", "about", "one", "not", "first", " ", " ",
    "zweihundert", "un", "millón", "ne", "pas", "не", "пока", "三", "百", "半", "第", "個", "ずに", "٣", "१२", "\u200d", "\u0301", "а", "ο", ".", "\n",
])  # fmt: skip
TEXTS = st.one_of(st.text(max_size=60), st.lists(PIECES, max_size=12).map("".join), st.lists(PIECES, max_size=12).map(" ".join))


@settings(deadline=None)
@given(TEXTS, st.sampled_from([None, "sv", *NUMBER_LANGUAGES]))
def test_numbers_and_quantities_of_any_text_are_finite_and_within_their_interval(text: str, language: str | None) -> None:
    number, place, quantity = number_in(text, language), ordinal_in(text, language), quantity_in(text, language)
    assert number is None or math.isfinite(number)
    assert place is None or place >= 0
    assert quantity is None or (math.isfinite(quantity.value) and quantity.low <= quantity.value <= quantity.high)


@settings(deadline=None)
@given(TEXTS, st.sampled_from(REVIEWED))
def test_spans_of_any_text_lie_within_it_and_side_by_side(text: str, language: str) -> None:
    held = held_words(text, language)
    assert language_of(text) in (None, "ar", "hi", *REVIEWED)
    edges = [edge for item in held for edge in (item.start, item.end)]
    assert edges == sorted(edges)
    assert all(text[odd.start : odd.end] == odd.text for odd in odd_characters(text)) is True
    assert {0, *edges, len(text)} == {edge for edge in (0, *edges, len(text)) if 0 <= edge <= len(text)}
