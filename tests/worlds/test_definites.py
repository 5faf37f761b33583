"""`The block` after `a block` is that block; what a plural does is told of all of it (R131, R155)."""

from __future__ import annotations

import pytest
from worldagent.tests.worlds.test_subjects import BALL, world
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.claims import reading_of


def refused(marked: str) -> list[str]:
    return [p.text for p in claim_problems(world(marked)) if "named before is" in p.text]


def warned(marked: str) -> list[str]:
    return [w for w in reading_of(world(marked)).warnings if "and not of" in w]


def test_a_definite_noun_is_the_thing_that_the_same_words_introduced() -> None:
    """Another block that does what the words tell of the first one is refused."""
    told = f"A {BALL} [hits](event hit) a [wooden](property b3) [block](thing b3). The [wooden](property b2) [block](thing b2) falls."
    (text,) = refused(told)
    assert "'the wooden block' is marked as 'b2', and the only 'wooden block' named before is 'b3'" in text


@pytest.mark.parametrize(
    "marked",
    [
        f"A {BALL} [hits](event hit) a wooden [block](thing b3). The wooden [block](thing same_as=block) falls.",
        f"A {BALL} [hits](event hit) a wooden [block](thing b3). The other [block](thing b2) falls.",
        f"A {BALL} [hits](event hit) a [block](thing b3) beside a [block](thing b2). The [block](thing same_as=block_2) falls.",
        f"The {BALL} [hits](event hit) the [block](thing b3).",
        f"A {BALL} [hits](event hit) a [block](thing b3). The steel [block](thing b2) falls.",
    ],
)
def test_honest_nouns_are_not_refused(marked: str) -> None:
    assert refused(marked) == []


def test_an_event_of_a_plural_that_one_body_does_is_warned_of() -> None:
    assert warned("The [blocks](thing b2 b3) [tip over](event block_tips).")
    assert warned("The [blocks](thing b2 b3) then [tip over](event block_tips).")
    assert not warned(f"A {BALL} [hits](event hit) the [blocks](thing b2 b3).")
    assert not warned("The [block](thing b3) [tips over](event block_tips).")
    assert not warned(f"The [blocks](thing b2 b3) stand there, and a {BALL} [rolls](event ball_rolls).")


def test_a_negation_waived_without_what_it_denies_is_refused() -> None:
    """`never` alone waived leaves the opposite of the sentence claimed."""
    why = 'because="no measure of it"'
    for part in (f"[never](waived {why})", f"[quickly never](waived {why})"):
        alone = world(f"A {BALL} {part} [hits](event hit) a [block](thing b3).")
        assert any("is waived without what it denies" in p.text for p in claim_problems(alone))
    whole = world(f"A {BALL} [rolls](event ball_rolls), [never hits](waived {why}) a [block](thing b3).")
    assert not any("is waived without what it denies" in p.text for p in claim_problems(whole))


def test_a_negation_that_denies_no_claimed_event_may_be_waived_alone() -> None:
    """`None` of them is anywhere: nothing that is claimed to happen is denied."""
    why = 'because="no measure of it"'
    free = world(
        f"A {BALL} [rolls](event ball_rolls). There are [blocks](thing b2 b3), [none](waived {why}) on the left. It [hits](event hit) a [block](thing same_as=blocks)."
    )
    assert not any("is waived without what it denies" in p.text for p in claim_problems(free))
    behind = world(f"A {BALL} [hits](event hit) [not](waived {why}) a [block](thing b3).")
    assert any("is waived without what it denies" in p.text for p in claim_problems(behind))
