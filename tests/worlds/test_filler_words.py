"""Words in filler that say where or how, and events that share a beat, stand in the verdict (R2, R155)."""

from __future__ import annotations

import pytest
from worldagent.tests.worlds.test_subjects import BALL, BLOCK, world
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.claims import reading_of
from worldagent.worlds.prompts.lexicon import labelled


def warned(marked: str, text: str) -> list[str]:
    return [w for w in reading_of(world(marked)).warnings if text in w]


def test_a_word_of_place_before_a_thing_is_told() -> None:
    told = "says where something is"
    assert warned(f"A {BALL} [rolls](event ball_rolls) under a {BLOCK}.", told)
    assert warned(f"Right beside a {BLOCK}, a {BALL} [rolls](event ball_rolls).", told)
    assert warned(
        f"Eine {BALL.replace('ball]', 'Kugel]')} [rollt](event ball_rolls) und bleibt neben einem {BLOCK.replace('block]', 'Block]')}.",
        told,
    )
    assert not warned(f"A {BALL} [rolls](event ball_rolls) over a {BLOCK}.", told)
    assert not warned(f"A {BALL} [rolls](event ball_rolls) off the {BLOCK} onto a {BLOCK}.", told)


def test_adverbs_that_nothing_judges_are_told_together() -> None:
    (text,) = warned(
        f"A {BALL} slowly [rolls](event ball_rolls) uphill and gently [hits](event hit) a {BLOCK} again.", "nothing judges how"
    )
    assert "'slowly', 'uphill', 'gently', 'again'" in text
    assert not warned(f"A {BALL} then finally [rolls](event ball_rolls) off.", "nothing judges how")


def test_events_of_one_beat_are_told() -> None:
    told = "are judged by one beat"
    assert warned(f"A {BALL} [hits](event hit) a {BLOCK}, hits it, and [hits](event hit) it.", told)
    assert not warned(f"A {BALL} [hits](event hit) a {BLOCK} and [rolls](event ball_rolls).", told)
    assert not warned(f"A {BALL} [hits](event hit) a {BLOCK} and [hits](event same_as=hits) it.", told)


@pytest.mark.parametrize("words", ["tips over", "falls off"])
def test_a_verb_behind_a_noun_is_an_event(words: str) -> None:
    text = f"A big book that stands on a desk {words} and knocks a mug off the edge."
    assert (words, "event") in [(text[w.start : w.end], w.type) for w in labelled(text)]


def test_a_verb_that_is_marked_as_a_place_is_told() -> None:
    assert warned(f"A {BALL} on a {BLOCK} [falls](place b3).", "no claim of an event takes it up")


def test_an_unreviewed_language_is_told() -> None:
    assert warned(
        f"एक लाल {BALL.replace('ball]', 'गेंद]')} फर्श पर तीन बार [फिसलती है](event ball_rolls) और {BLOCK.replace('block]', 'लकड़ी के गुटके]')} से टकराती है।",
        "no reviewed word lists",
    )


def test_two_that_collide_on_a_floor_hit_each_other_and_not_the_floor() -> None:
    """The beat is told of both; what stands behind `on` is not what is hit."""
    told = "what stands behind it is"
    assert not [
        p
        for p in claim_problems(world(f"A {BALL} and a {BLOCK} [collide](event hit) on a [floor](thing shelf)."))
        if told in p.text
    ]
    assert [
        p for p in claim_problems(world(f"A {BALL} [hits](event hit) a [tower](thing b2) beside a {BLOCK}.")) if told in p.text
    ]
