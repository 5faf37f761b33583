"""Words for how many and words that deny, left in filler: in every pair one reading that the world is, and one that it is not (R155)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.dishonest.cases import without_marks
from worldagent.tests.worlds.audits.test_claims import world
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.claims import reading_of
from worldagent.worlds.prompts.languages import held_words
from worldagent.worlds.spec import WorldSpec

ROLLS, FALLS = "[rolls](event roll)", "[falls](event fall)"
BALL = "[ball](thing ball)"


def told(marked: str, *operations: tuple[str, Any]) -> WorldSpec:
    return world(marked, *operations, prompt=without_marks(marked))


def said(marked: str) -> str:
    return " | ".join(p.text for p in claim_problems(told(marked)))


def warned(marked: str) -> str:
    return " | ".join(reading_of(told(marked)).warnings)


AMOUNTS = {
    "pair": ("A pair of wooden [blocks](thing %s) stands on the shelf.", "says 2", "b1 b2", "b1"),
    "couple": ("A couple of shiny wooden [blocks](thing %s) stand on the shelf.", "says 2", "b1 b2", "b1"),
    "trio": ("A trio of [wooden](property b1) [blocks](thing %s) stands on the shelf.", "says 3", "b1 b2 b3", "b1"),
    "score": ("A score of [blocks](thing %s) stands on the shelf.", "says 20", "", "b1 b2 b3"),
    "handful": ("A handful of [blocks](thing %s) stands on the shelf.", "says at least 3", "b1 b2 b3", "b1 b2"),
    "several": ("Several [blocks](thing %s) stand on the shelf.", "says at least 3", "b1 b2 b3", "b1"),
    "many": ("Many [blocks](thing %s) stand on the shelf.", "says at least 5", "", "b1 b2 b3"),
    "dozens": ("Dozens of [blocks](thing %s) stand on the shelf.", "says at least 24", "", "b1 b2 b3"),
    "umpteen": ("Umpteen [blocks](thing %s) stand on the shelf.", "says at least 11", "", "b1 b2 b3"),
    "inside the thing": ("[Several blocks](thing %s) stand on the shelf.", "says at least 3", "b1 b2 b3", "b1"),
    "as a count": ("[Several](count %s) [blocks](thing b1 b2 b3) stand on the shelf.", "says at least 3", "b1 b2 b3", "b1 b2"),
    "both": ("Both [blocks](thing %s) stand on the [shelf](thing shelf).", "says 2", "b1 b2", "b1"),
    "mehrere": ("Auf dem Regal stehen mehrere [Klötze](thing %s), und die Kugel rollt.", "says at least 2", "b1 b2", "b1"),
    "Trio": ("Auf dem Regal steht ein Trio [Klötze](thing %s), und die Kugel rollt.", "says 3", "b1 b2 b3", "b1"),
    "plusieurs": ("Sur le sol il y a plusieurs [cubes](thing %s) et la bille roule.", "says at least 2", "b1 b2", "b1"),
    "varios": ("En el suelo hay varios [cubos](thing %s) y la bola rueda por el estante.", "says at least 2", "b1 b2", "b1"),
    "un paio": ("Sul pavimento ci sono un paio di [cubi](thing %s) e la palla rotola.", "says 2", "b1 b2", "b1"),
    "vários": ("No chão há vários [cubos](thing %s) e a bola rola pela prateleira.", "says at least 2", "b1 b2", "b1"),
    "meerdere": ("Op de plank staan meerdere [blokken](thing %s) en de bal rolt er naartoe.", "says at least 2", "b1 b2", "b1"),
    "несколько": ("На полке стоят несколько [кубиков](thing %s), и шар катится к ним.", "says at least 2", "b1 b2", "b1"),
    "许多": ("架子上有许多[木块](thing %s)，球在滚动。", "says at least 5", "", "b1 b2 b3"),
    "複数の": ("棚の上に複数の[積み木](thing %s)があり、ボールが転がる。", "says at least 2", "b1 b2", "b1"),
}  # fmt: skip


@pytest.mark.parametrize("name", AMOUNTS)
def test_a_word_for_how_many_is_met_by_what_is_named_beside_it(name: str) -> None:
    marked, says, honest, dishonest = AMOUNTS[name]
    assert says in said(marked % dishonest)
    if honest:
        assert "says" not in said(marked % honest), said(marked % honest)


@pytest.mark.parametrize(
    "marked",
    [
        "A pair of [scissors](thing b1) lies on the shelf.",
        "A pair of steel [tongs](thing b1) lies on the shelf.",
        f"While a score is kept, the {BALL} {ROLLS}.",
        f"After several seconds the {BALL} {ROLLS}.",
        f"The {BALL} {ROLLS} for a couple of seconds.",
        f"All but one of us see the {BALL} that {ROLLS}.",
        "A [ball](thing ball) and a [block](thing b1) stand there, and both are red.",
        "Both the [ball](thing ball) and the [block](thing b1) stand there.",
        f"Many thanks, the {BALL} {ROLLS}.",
    ],
)
def test_words_that_count_nothing_here_are_not_refused(marked: str) -> None:
    assert "says" not in said(marked), said(marked)


def test_words_that_may_be_of_one_body_warn() -> None:
    assert "'triple' says more than one" in warned("A triple [block](thing b1) stands on the shelf.")
    assert "'crowd' says more than one" in warned("A crowd of [blocks](thing b1) stands on the shelf.")
    assert "says more than one" not in warned("A crowd of [blocks](thing b1 b2) stands on the shelf.")


HEDGED = {
    "almost": (f"A {BALL} %s[rolls](%s) along the shelf.", "almost "),
    "nearly": (f"A {BALL} %s[rolls](%s) along the shelf.", "nearly "),
    "all but": (f"A {BALL} %s[rolls](%s) along the shelf.", "all but "),
    "would": (f"A {BALL} %s[roll](%s) along the shelf.", "would "),
    "too slow to": (f"A {BALL} is %s[roll](%s) along the shelf.", "too slow to "),
    "with words between": (f"A {BALL} %s[rolls](%s) along the shelf.", "almost even "),
    "beinahe": ("Eine [Kugel](thing ball) %s[rollt](%s) über das Regal und der Klotz steht.", "beinahe "),
    "casi": ("Una [bola](thing ball) %s[rueda](%s) por el estante y el cubo está ahí.", "casi "),
    "faillit": ("Une [bille](thing ball) %s[rouler](%s) sur le sol et le cube est là.", "faillit "),
    "几乎": ("一个[球](thing ball)在架子上%s[滚动](%s)。", "几乎"),
}


@pytest.mark.parametrize("name", HEDGED)
def test_an_event_that_its_words_deny_is_no_event(name: str) -> None:
    marked, word = HEDGED[name]
    assert "does not happen" in said(marked % (word, "event roll"))
    assert "does not happen" not in said(marked % ("", "event roll"))
    assert "does not happen" not in said((marked % (word, "event roll")).replace("(event roll)", "(place shelf)"))


@pytest.mark.parametrize(
    "marked",
    [
        f"I would like a {BALL} that {ROLLS}.",
        f"Would you show how a {BALL} {ROLLS}?",
        f"Show how a {BALL} would [roll](event roll) along the shelf.",
        f"A {BALL} almost 5 cm wide {ROLLS}.",
        f"A {BALL} {ROLLS} almost to the end.",
        f"All but one see that a {BALL} {ROLLS}.",
    ],
)
def test_hedges_of_something_else_are_not_refused(marked: str) -> None:
    assert "does not happen" not in said(marked), said(marked)


def test_words_that_leave_it_open_warn() -> None:
    assert "'might' before 'roll' leaves open" in warned(f"A {BALL} might [roll](event roll) along the shelf.")


@pytest.mark.parametrize(
    ("language", "text", "words"),
    [
        ("en", "The block is kept from hitting it, prevented from striking it, stops short of it and seldom moves", ["kept from", "prevented from", "stops short of", "seldom"]),
        ("en", "A wedge keeps the heavy ball from rolling and prevents it from falling", ["keeps", "prevents"]),
        ("en", "snow kept piling up, kept from the wall, he keeps a ball from the building, a seldom used path, saved from Spring", []),
        ("de", "Ein Keil verhindert den Fall und hindert die Kugel daran zu rollen", ["verhindert", "hindert"]),
        ("fr", "Une cale empêche la bille de rouler sur le sol", ["empêche"]),
        ("es", "Una cuña impide que la bola ruede por el suelo", ["impide"]),
        ("it", "Un cuneo impedisce alla palla di rotolare", ["impedisce"]),
        ("pt", "Uma cunha impede a bola de rolar", ["impede"]),
        ("nl", "Een wig belet de bal om te rollen", ["belet"]),
        ("ru", "Клин предотвращает падение шара", ["предотвращает"]),
        ("zh", "木楔阻止球滚动，球差点落下，差不多", ["阻止", "差点"]),
    ],
)  # fmt: skip
def test_verbs_that_deny_what_stands_behind_them_are_held(language: str, text: str, words: list[str]) -> None:
    assert [text[h.start : h.end] for h in held_words(text, language) if h.kind == "negation"] == words
