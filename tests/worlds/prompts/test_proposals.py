"""Spans that the server proposes for a new prompt: side by side, short, typed where the language is known, and readable as marked text."""

from __future__ import annotations

from itertools import pairwise

import pytest
from worldagent.bench.prompts import proposal_figures
from worldagent.testing.prompts import honest, strangers
from worldagent.worlds.errors import InputError
from worldagent.worlds.prompts.languages import function_words
from worldagent.worlds.prompts.lexicon import labelled
from worldagent.worlds.prompts.marks import TYPES, parse_marks
from worldagent.worlds.prompts.proposals import Proposal, proposal_text, proposed
from worldagent.worlds.prompts.units import boundaries, letters, units_of, word_count

PROMPTS = [*(prompt.text for prompt in honest()), *(prompt.text for prompt in strangers())]


def quoted(text: str) -> list[tuple[str, str]]:
    return [(text[span.start : span.end], span.type) for span in proposed(text)]


def test_an_english_prompt_becomes_marked_text_without_targets() -> None:
    text = "A steel ball rolls off the table."
    assert proposal_text(text) == "A [steel](property) [ball](thing) [rolls off](event) the [table](thing)."


@pytest.mark.parametrize(
    ("text", "quote", "kind"),
    [
        ("Der Ball rollt nicht vom Tisch, danach fällt die Vase.", "nicht", "negation"),
        ("Der Ball rollt nicht vom Tisch, danach fällt die Vase.", "danach", "order"),
        ("Der Ball rollt nicht vom Tisch, danach fällt die Vase.", "Vase", "unknown"),
        ("Lass drei Fässer in den Fluss rollen.", "drei", "count"),
        ("Un bloc de 2,5 kg tombe du toit.", "2,5 kg", "quantity"),
        ("La colada baja a 1100 °C por la ladera.", "1100 °C", "quantity"),
        ("把三米深的水槽放在桌上，水没有溢出。", "三米", "quantity"),
        ("把三米深的水槽放在桌上，水没有溢出。", "没有", "negation"),
        ("Отпустите груз массой 2 кг, он не падает.", "2 кг", "quantity"),
    ],
)
def test_in_other_languages_numbers_negations_and_order_are_typed(text: str, quote: str, kind: str) -> None:
    assert (quote, kind) in quoted(text)


def test_a_word_of_place_before_a_thing_is_proposed_as_its_place_and_a_study_is_a_room() -> None:
    marked = proposal_text("In a small study a ball comes to rest under the old desk, beside a lamp.")
    assert "[study](place)" in marked
    assert "[under](place) the [old](property) [desk](thing), [beside](place) a [lamp](thing)." in marked
    assert "(place)" not in proposal_text("A ball rolls on a floor, and a man studies it.")
    assert "[under](place)" not in proposal_text("The ship goes under and a boy looks on.")


def test_a_noun_behind_the_is_proposed_as_the_thing_that_was_named_before() -> None:
    marked = proposal_text("A vase stands on a table. The vase falls, and a cup falls on the table.")
    assert "The [vase](thing same_as=vase) [falls](event)" in marked
    assert marked.endswith("on the [table](thing same_as=table).")
    assert "same_as" not in proposal_text("A ball hits a ball, and the cup falls.")


@pytest.mark.parametrize(
    ("text", "verb", "kind"),
    [
        ("A gear and a bottle stand on a floor.", "stand", "property"),
        ("Five books lay on a table.", "lay", "property"),
        ("A lamp is hanging from the ceiling.", "hanging", "property"),
        ("The bench stays where it is.", "stays", "property"),
        ("A curtain hangs in an open window.", "hangs in", "property"),
        ("A wheelbarrow heaped with gravel is tipped.", "heaped", "property"),
        ("A wheelbarrow is heaped with gravel.", "heaped", "event"),
        ("A ball pushed by a rod rolls off.", "pushed", "event"),
        ("The man sits down on a chair.", "sits down", "event"),
        ("A vase falls off a shelf.", "falls off", "event"),
    ],
)
def test_how_something_is_and_stays_is_proposed_as_a_property(text: str, verb: str, kind: str) -> None:
    assert (verb, kind) in quoted(text)


@pytest.mark.parametrize(
    ("text", "known"),
    [
        ("Eine rote Murmel stößt drei Dominosteine um.", {("rote", "property"), ("drei", "count"), ("Murmel", "unknown")}),
        ("一个蓝色的球从桌子上滚下来。", {("一", "count"), ("蓝色", "property"), ("球", "unknown")}),
        ("Por la noche una bola de acero rueda.", {("noche", "time"), ("acero", "property"), ("rueda", "unknown")}),
        ("Une voiture rouge descend la rampe.", {("rouge", "property"), ("voiture", "unknown")}),
    ],
)
def test_words_that_a_rule_judges_are_known_in_other_languages(text: str, known: set[tuple[str, str]]) -> None:
    assert known <= set(quoted(text))


def test_an_article_that_is_also_a_number_is_no_count() -> None:
    assert ("einen", "count") not in quoted("Lass einen Mehlsack von der Leiter fallen.")


def test_spans_lie_side_by_side_on_units_and_are_short() -> None:
    """In all 650 prompts of twelve languages."""
    faults: list[tuple[str, Proposal]] = []
    spans = 0
    for text in PROMPTS:
        found, allowed = proposed(text), boundaries(text)
        spans += len(found)
        faults += [(text, before) for before, after in pairwise(found) if before.end > after.start]
        faults += [
            (text, span) for span in found if not {span.start, span.end} <= allowed or not letters(text[span.start : span.end])
        ]
        longest = {"event": 8, "quantity": 8}
        faults += [(text, span) for span in found if word_count(text[span.start : span.end]) > longest.get(span.type, 4)]
    assert faults == []
    assert spans > 5000


def test_marked_text_gives_the_spans_back_and_asks_for_unknown_types() -> None:
    types, refused = set(), 0
    for text in PROMPTS:
        marked = proposal_text(text)
        known = [(span.start, span.end, span.type) for span in proposed(text)]
        if any(kind == "unknown" for _, _, kind in known):
            refused += 1
            with pytest.raises(InputError, match="has the type 'unknown'"):
                parse_marks(marked, text)
            marked = marked.replace("](unknown)", "](thing)")
        types |= {kind for _, _, kind in known}
        assert [(mark.start, mark.end) for mark in parse_marks(marked, text)] == [(start, end) for start, end, _ in known]
    assert types <= {*TYPES, "unknown"}
    assert 0 < refused < len(PROMPTS)


def test_words_of_grammar_are_neither_things_nor_events() -> None:
    grammar = function_words("en")
    held = [
        (text, word)
        for text in PROMPTS
        for word in labelled(text)
        if word.type in ("thing", "event")
        and all(unit.text.casefold() in grammar for unit in units_of(text[word.start : word.end]))
    ]
    assert held == []
    assert len(grammar) > 80


def test_share_of_marks_that_a_proposal_meets_stays_above_its_floor() -> None:
    """Floors: what was measured, less five points in English and ten elsewhere, where the sets are small."""
    shares = {language: figures["same_type_share"] for language, figures in proposal_figures().items()}
    assert shares["en"] >= 0.82
    low = {"de": 0.65, "es": 0.50, "fr": 0.71, "it": 0.83, "ja": 0.77, "nl": 0.73, "pt": 0.54, "ru": 0.76, "zh": 0.66}
    assert {language: shares[language] for language, floor in low.items() if shares[language] < floor} == {}


def test_of_several_things_that_and_joins_the_bare_form_before_a_preposition_is_the_verb() -> None:
    found = proposal_text("A rubber duck and a wooden soap dish float in it.")
    assert found == "A [rubber](property) [duck](thing) and a [wooden](property) [soap dish](thing) [float](event) in it."
    assert "[boat house](thing)" in proposal_text("A bird and a boat house at the lake.")
