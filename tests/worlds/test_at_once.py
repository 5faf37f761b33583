"""Words of simultaneity, and those that begin or end what is told, bind the events beside them (R131, R155)."""

from __future__ import annotations

import pytest
from worldagent.tests.worlds.audits.test_bindings import BALL, BLOCK, FALLS, ROLLS, said, told
from worldagent.worlds.claims import prompt_record

HITS = "[hits](event strike)"
KUGEL, KLOTZ = "[Kugel](thing ball)", "[Klotz](thing b3)"
ENDS: dict[str, str] = {
    "first": f"[First](order %s) a {BALL} {ROLLS}, and a {BLOCK} {FALLS}.",
    "first, a comma": f"[First](order %s), a {BALL} {ROLLS}. A {BLOCK} {FALLS}.",
    "first before its verb": f"A {BALL} [first](order %s) {ROLLS} and a {BLOCK} {FALLS}.",
    "first behind its verb": f"A {BALL} {ROLLS} [first](order %s), and a {BLOCK} {FALLS}.",
    "at first": f"[At first](order %s) a {BALL} {ROLLS}; a {BLOCK} {FALLS}.",
    "finally": f"A {BALL} {ROLLS}, and [finally](order %s) a {BLOCK} {FALLS}.",
    "in the end": f"A {BALL} {ROLLS}. [In the end](order %s) a {BLOCK} {FALLS}.",
    "and finally": f"A {BALL} {ROLLS} [and finally](order %s) a {BLOCK} {FALLS}.",
    "zuerst": f"[Zuerst](order %s) [rollt](event roll) eine {KUGEL}, und ein {KLOTZ} [fällt](event fall) vom Regal.",
    "schließlich": f"Eine {KUGEL} [rollt](event roll) auf dem Regal, und [schließlich](order %s) [fällt](event fall) ein {KLOTZ}.",
    "d'abord": "Une [bille](thing ball) [roule](event roll) [d'abord](order %s) sur le sol, et un [cube](thing b3) [tombe](event fall).",
}


@pytest.mark.parametrize("name", ENDS)
def test_first_begins_what_is_told_and_finally_ends_it(name: str) -> None:
    assert "comes before" not in said(ENDS[name] % "roll fall")
    assert "the reverse: exchange the two" in said(ENDS[name] % "fall roll")


def test_first_and_it_reversed_is_refused() -> None:
    """`First a ball hits a block, and it rolls`, of a ball that rolls and then hits."""
    marked = f"[First](order %s) a {BALL} {HITS} a {BLOCK}, and it {ROLLS}."
    assert "the reverse: exchange the two, as (order strike roll)" in said(marked % "roll strike")
    assert "comes before" not in said(marked % "strike roll")
    assert "First" not in prompt_record(told(marked % "strike roll"))["readings"]


def test_words_of_a_longer_claim_put_nothing_in_order() -> None:
    """`for the first surge` says which one, and `at the end of the shelf` where."""
    for words in ("for the first time", "at the end of the shelf"):
        assert "comes before" not in said(f"A {BALL} {ROLLS} [{words}](order fall roll), and a {BLOCK} {FALLS}.")


ONCE: dict[str, str] = {
    "at the start": f"[At the same time](order %s), a {BALL} {ROLLS} and a {BLOCK} {FALLS}.",
    "of two sentences": f"A {BALL} {ROLLS}. [At the same time](order %s) a {BLOCK} {FALLS}.",
    "behind": f"A {BALL} {ROLLS} and a {BLOCK} {FALLS} [simultaneously](order %s).",
    "between": f"A {BALL} {ROLLS} [at the same time](order %s) as a {BLOCK} {FALLS}.",
    "gleichzeitig": f"[Gleichzeitig](order %s) [rollt](event roll) eine {KUGEL}, und ein {KLOTZ} [fällt](event fall) vom Regal.",
    "zugleich": f"Eine {KUGEL} [rollt](event roll) auf dem Regal, und [zugleich](order %s) [fällt](event fall) ein {KLOTZ}.",
    "en même temps": "Une [bille](thing ball) [roule](event roll) sur le sol et un [cube](thing b3) [tombe](event fall) [en même temps](order %s).",
}


@pytest.mark.parametrize("name", ONCE)
def test_what_comes_at_once_has_no_direction_and_is_of_the_events_beside_the_words(name: str) -> None:
    for by in ("roll fall", "fall roll"):
        assert "come at once" not in said(ONCE[name] % by)
    assert "come at once, and the claim names others: name their beats, as (order roll fall)" in said(ONCE[name] % "roll strike")


def test_what_comes_at_once_contradicts_no_order() -> None:
    marked = f"A {BALL} {ROLLS} [before](order roll fall) a {BLOCK} {FALLS}. [At the same time](order fall strike) it [hits](event strike) a [block](thing b1)."
    assert "exclude each other" not in said(marked)
    assert "exclude each other" in said(marked.replace("At the same time", "Then").replace("fall strike", "fall roll"))


@pytest.mark.parametrize("word", ["First", "Firstly", "At the same moment", "Lastly"])
def test_words_of_order_may_not_stay_filler(word: str) -> None:
    assert f"{word!r} at character 0" in said(f"{word} a {BALL} {ROLLS}, and a {BLOCK} {FALLS}.")
