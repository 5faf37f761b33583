"""The language of a prompt, and the words of it that cannot be filler."""

from __future__ import annotations

import itertools

import pytest
from worldagent.testing.prompts import honest, strangers
from worldagent.worlds.prompts.function_words import FUNCTION_WORDS
from worldagent.worlds.prompts.held_lists import NEGATIONS, ORDERS
from worldagent.worlds.prompts.languages import REVIEWED, held_words, language_of
from worldagent.worlds.prompts.units import boundaries, folded


def held(text: str, language: str) -> list[tuple[str, str]]:
    return [(text[item.start : item.end], item.kind) for item in held_words(text, language)]


def test_the_language_of_the_strangers_is_told_and_never_mistaken() -> None:
    """Measured on 500 prompts in twelve languages; short ones without function words are of none."""
    told = [(prompt.language, language_of(prompt.text)) for prompt in strangers()]
    assert len(told) == 500
    assert [pair for pair in told if pair[1] not in (None, pair[0])] == []
    assert sum(a == b for a, b in told) >= 490


def test_the_language_of_the_honest_prompts_is_told() -> None:
    untold = [prompt.id for prompt in honest() if language_of(prompt.text) != prompt.language]
    assert len(honest()) == 150
    assert untold == ["e04"]  # nouns apart by commas


@pytest.mark.parametrize(
    "text",
    [
        "En boll rullar av bordet och faller på golvet.",
        "Piłka toczy się po stole i spada na podłogę.",
        "Top masadan yuvarlanıp yere düşüyor.",
        "Pallo vierii pöydältä ja putoaa lattialle.",
        "Bola menggelinding dari meja dan jatuh ke lantai.",
        "Quả bóng lăn khỏi bàn và rơi xuống sàn.",
        "М'яч котиться зі столу і падає на підлогу.",
        "Топката се търкаля от масата и пада на пода.",
        "توپ از روی میز می‌غلتد.",
        "공이 탁자에서 굴러 떨어진다",
        "The ball rolls off the table. Der Ball rollt vom Tisch.",
        "xyzzy plugh",
        "12345",
        "",
    ],
)
def test_other_languages_mixed_texts_and_no_language_are_none(text: str) -> None:
    assert language_of(text) is None


def test_a_foreign_word_or_name_leaves_the_language_as_it_is() -> None:
    assert language_of("The sign says «не упал» and the ball rolls off the table of the café in Łódź.") == "en"
    assert language_of("Der Ball rollt über das LED-Panel und fällt auf den Boden.") == "de"


@pytest.mark.parametrize(
    ("language", "text", "words"),
    [
        ("en", "The vase does not fall, nobody touches it; it isn't broken and can't tip.", ["not", "nobody", "n't", "n't"]),
        (
            "en",
            "First it rolls, then it drops before the bell rings; the first ball stops last.",
            ["First", "then", "before", "last"],
        ),
        ("en", "Look after the plant for a while, at first light, with no doubt, why not, in the last second of a second", []),
        ("en", "three balls, half a dozen goats, 5 kg, 2½ litres, a 4K render of T34 tanks", ["three", "dozen", "5", "2½"]),
        ("en", "the green one falls, one of them, at one end, everyone, once, both, a pair", ["one"]),
        ("en", "For my Year 8 class: scenario 4b, if it's not too much trouble, a two-year-old's toy of 8 parts", ["8"]),
        ("en", "1. A ball rolls.\n2. It does not tip.\n3. Three blocks fall.", ["not", "Three"]),
        ("en", "It weighs 5 kg. 2. of 3. is not counted", ["5", "2", "3", "not"]),
        ("en", "One day a ball rolls off the table. One morning it is gone", []),
        ("en", "One day later a ball rolls off the table", ["One", "later"]),
        ("en", "A ball rolls not far from a block and does not go far", ["not"]),
        ("de", "Eine Kugel rollt nicht weit von einem Klotz, nicht weit genug", ["nicht"]),
        ("es", "Una pelota rueda no lejos de un cubo y no cae", ["no"]),
        ("es", "Si no es mucha molestia, que no caiga", ["no"]),
        ("ja", "やがて三個が落ちない", ["三", "ない"]),
        ("en", "saturated till on the left; it holds till the branch gives way", ["till"]),
        (
            "de",
            "Die Ehe, ehe er fällt; bis zum Teich, bis er bricht; nicht, keine, ohne Fahrer, drei",
            ["ehe", "bis", "nicht", "keine", "ohne", "drei"],
        ),
        ("de", "ein Ball, beide Kugeln, noch einmal, erst rollt sie, danach nicht nur sie", ["erst", "danach"]),
        (
            "fr",
            "il n'est pas tombé, à deux pas du mur ; l'après-midi, l'avant du bateau, puis après le bruit",
            ["n'", "pas", "deux", "puis", "après"],
        ),
        ("fr", "une personne tombe, personne ne tombe, un vélo neuf, les neuf quilles", ["personne", "ne", "neuf"]),
        ("es", "el pato nada en la bañera sin embargo no cae; sin agua; nada de viento", ["no", "sin", "nada"]),
        ("es", "la primera, primero cae, luego rebota, desde luego, once botes y un par", ["primero", "luego", "once"]),
        (
            "it",
            "finché non si ferma, non appena cade, non rimbalza; i venti forti, grazie mille",
            ["finché non", "non appena", "non"],
        ),
        ("pt", "o pato nada no lago, não cai nada, antes de bater, um a um, três", ["não", "nada", "antes", "um a um", "três"]),
        (
            "nl",
            "hij is groter dan de bal, en dan valt hij niet; de ene na de andere; een paar",
            ["dan", "niet", "de ene na de andere"],
        ),
        ("ru", "держится, пока не сломается, потом падает, но не сразу; один шар, три шара", ["пока не", "потом", "не", "три"]),
        (
            "zh",
            "不锈钢球不断滚，不掉下来，特别大，别碰它，先滚再停，四周没有人，三个球，一起",
            ["不", "别", "先", "再", "没有", "三"],
        ),
        (
            "ja",
            "必ず崩さずに落ちない、少ない、まず転がってから、その後五個、一緒に、半分まで",
            ["ずに", "ない", "まず", "から", "その後", "五"],
        ),
    ],
)
def test_words_that_cannot_be_filler_are_held_and_their_doubles_are_not(language: str, text: str, words: list[str]) -> None:
    assert [word for word, _ in held(text, language)] == words


@pytest.mark.parametrize("apostrophe", "'’‘ʼʹ＇`´′")
def test_a_negation_is_held_whatever_character_is_its_apostrophe(apostrophe: str) -> None:
    assert held(f"the vase doesn{apostrophe}t fall", "en") == [(f"n{apostrophe}t", "negation")]
    assert held(f"le vase n{apostrophe}a rien", "fr") == [(f"n{apostrophe}", "negation"), ("rien", "negation")]


def test_kinds_are_told_apart() -> None:
    assert held("1) two balls fall 2) then they don't", "en") == [
        ("1", "order"), ("two", "number"), ("2", "order"), ("then", "order"), ("n't", "negation"),
    ]  # fmt: skip


def test_nothing_is_held_in_a_language_whose_lists_are_not_reviewed() -> None:
    assert REVIEWED == ("en", "de", "fr", "es", "it", "pt", "nl", "ru", "zh", "ja")
    assert held_words("три не пять", None) == ()
    assert held_words("लाल गेंद नहीं गिरती", "hi") == ()


def test_negations_that_persons_marked_are_held_but_for_words_of_exception() -> None:
    missed = []
    for prompt in honest():
        if prompt.language in REVIEWED:
            found = [item for item in held_words(prompt.text, prompt.language) if item.kind == "negation"]
            for span in prompt.spans:
                start = -1
                for _ in range(span.nth):
                    start = prompt.text.index(span.quote, start + 1)
                inside = any(start < item.end and item.start < start + len(span.quote) for item in found)
                missed += [] if span.type != "negation" or inside else [span.quote]
    assert sorted(missed) == ["behalve", "except", "menos", "忽略"]


def test_held_words_begin_and_end_where_units_do_and_are_disjoint_in_every_prompt() -> None:
    cut, total = [], 0
    for text in [*(prompt.text for prompt in honest()), *(prompt.text for prompt in strangers())]:
        found = held_words(text, language_of(text))
        total += len(found)
        cut += [text for item in found if not {item.start, item.end} <= boundaries(text)]
        cut += [text for a, b in itertools.pairwise(found) if a.end > b.start]
    assert total > 500
    assert cut == []


def test_no_word_of_the_function_lists_is_held() -> None:
    both = []
    for language in REVIEWED:
        lists = {folded(word) for word in (*NEGATIONS.get(language, ()), *ORDERS.get(language, ()))}
        both += [(language, word) for word in FUNCTION_WORDS[language] & lists]
    assert both == []
    assert min(len(words) for words in FUNCTION_WORDS.values()) > 20
