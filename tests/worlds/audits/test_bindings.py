"""Words that bind others: orders, quantities and counts are of the events and things beside them, in every pair one honest and one dishonest reading."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.dishonest.cases import without_marks
from worldagent.tests.worlds.audits.test_claims import world
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.claims import prompt_record
from worldagent.worlds.spec import WorldSpec

Pair = tuple[str, str, str]
"""Marked text with `%s` for the target that is asked about, an honest target, a dishonest one."""
BALL, BLOCK, SHELF = "[ball](thing ball)", "[block](thing b3)", "[shelf](thing shelf)"
ROLLS, FALLS = "[rolls](event roll)", "[falls](event fall)"
ROLLT, FAELLT = "[rollt](event roll)", "[fällt](event fall)"
KUGEL, KLOTZ = "[Kugel](thing ball)", "[Klotz](thing b3)"


def told(marked: str, *operations: tuple[str, Any]) -> WorldSpec:
    return world(marked, *operations, prompt=without_marks(marked))


def said(marked: str, *operations: tuple[str, Any]) -> str:
    return " | ".join(p.text for p in claim_problems(told(marked, *operations)))


ORDERS: dict[str, str] = {
    "before": f"A {BALL} {ROLLS} [before](order %s) a {BLOCK} {FALLS}.",
    "after": f"A {BLOCK} {FALLS} [after](order %s) a {BALL} {ROLLS}.",
    "after at the start": f"[After](order %s) a {BALL} {ROLLS}, a {BLOCK} {FALLS}.",
    "before at the start": f"[Before](order %s) a {BLOCK} {FALLS}, a {BALL} {ROLLS}.",
    "then": f"A {BALL} {ROLLS}. [Then](order %s) a {BLOCK} {FALLS}.",
    "after which": f"A {BALL} {ROLLS}, [after which](order %s) a {BLOCK} {FALLS}.",
    "behind its verb": f"A {BALL} {ROLLS} and a {BLOCK} {FALLS} [later](order %s).",
    "after a while": f"A {BALL} {ROLLS}, and [after](order %s) a while a {BLOCK} {FALLS}.",
    "until": f"A {BALL} {ROLLS} [until](order %s) a {BLOCK} {FALLS}.",
    "nachdem": f"[Nachdem](order %s) die {KUGEL} gegen den Klotz {ROLLT}, {FAELLT} ein {KLOTZ} vom Regal.",
    "bevor": f"Eine {KUGEL} {ROLLT} auf dem Regal, [bevor](order %s) ein {KLOTZ} {FAELLT}.",
    "dann": f"Eine {KUGEL} {ROLLT} auf dem Regal, und ein {KLOTZ} {FAELLT} [dann](order %s).",
    "avant": "Une [bille](thing ball) [roule](event roll) sur le sol [avant](order %s) qu'un [cube](thing b3) ne [tombe](event fall).",
    "luego": "Una [bola](thing ball) [rueda](event roll) por el estante y [luego](order %s) un [cubo](thing b3) [cae](event fall).",
    "然后": "[钢球](thing ball)[滚动](event roll)，[然后](order %s)旁边的[木块](thing b3)[落下](event fall)。",
}


@pytest.mark.parametrize("name", ORDERS)
def test_an_order_is_that_of_the_events_beside_its_word_in_its_direction(name: str) -> None:
    assert "comes before" not in said(ORDERS[name] % "roll fall")
    assert ", the reverse: exchange the two, as (order roll fall)" in said(ORDERS[name] % "fall roll")
    assert "name the beats of these words, the first first, as (order roll fall)" in said(ORDERS[name] % "roll strike")


def test_behind_a_thing_the_order_is_the_agents_reading() -> None:
    """`Falls after it and rolls`: the word speaks of the thing, and what stands behind `and` is done by the subject before."""
    for text in (
        f"A [block](thing b1) is [struck](event strike); a {BLOCK} {FALLS} [after](order %s) it and {ROLLS}.",
        f"A [block](thing b1) is [struck](event strike); a {BLOCK} {FALLS} [after](order %s) the {BALL}, and {ROLLS}.",
    ):
        assert "comes before" not in said(text % "strike fall")
    both = f"A {BLOCK} {FALLS} [after](order %s) the [block](thing b1) and the {BALL} {ROLLS}."
    assert ", the reverse: exchange the two, as (order roll fall)" in said(both % "fall roll")


def test_events_that_one_subject_does_stand_together_and_other_words_are_read_by_the_agent() -> None:
    chain = f"A {BALL} {ROLLS} and [strikes](event strike) a [block](thing b1), [then](order %s) a {BLOCK} {FALLS}."
    assert "comes before" not in said(chain % "roll fall") + said(chain % "strike fall")
    single = f"A {BALL} {ROLLS}, a [block](thing b1) is [struck](event strike), [then](order %s) a {BLOCK} {FALLS}."
    assert "comes before" not in said(single % "strike fall")
    assert "'then' says that 'struck' comes before 'falls'" in said(single % "roll fall")
    other = f"A {BALL} {ROLLS} [in turn](order roll fall), and a {BLOCK} {FALLS}."
    assert "in turn" in prompt_record(told(other))["readings"]
    assert "then" not in prompt_record(told(single % "strike fall"))["readings"]


def test_a_requirement_of_order_is_held_to_the_same_events() -> None:
    def asked(predicate: dict[str, Any]) -> str:
        requirement = {"order": {"text": "first the one, then the other", "predicate": predicate}}
        return said(ORDERS["before"] % "/story/requirements/order", ("/story/requirements", requirement))

    rolls, falls = {"kind": "rolls", "entity": "ball"}, {"kind": "falls", "entity": "b3"}
    assert "comes before" not in asked({"kind": "before", "predicate": rolls, "beat": "fall"})
    assert "comes before" not in asked({"kind": "after", "predicate": falls, "beat": "roll"})
    assert "comes before" in asked({"kind": "before", "predicate": falls, "beat": "roll"})
    assert "comes before" in asked({"kind": "after", "predicate": falls, "beat": "strike"})


_SHELF = f"A {BALL} {ROLLS} on a {SHELF} that is [30 cm high](quantity %s)."
QUANTITIES: dict[str, tuple[str, str, str, str]] = {
    "of an unclaimed body": (f"A {BALL} that is [2 m](quantity %s) from the wall {ROLLS}.", "/entities/ball/pose/position/0", "/entities/floor/dimensions/size/1", "which no claim of a thing names"),
    "of the camera": (_SHELF, "/entities/shelf/dimensions/size/2", "/shots/only/keys/a/position/2", "no words of the prompt speak of that"),
    "of a solver": (_SHELF, "/entities/shelf/dimensions/size/2", "/simulation/solvers/rigid/settings/skin", "a setting of a solver"),
    "of another dimension": (_SHELF, "/entities/shelf/dimensions/size/2", "/materials/stone/density", "30 cm high' is a length [m], and /materials/stone/density is a density"),
    "of an angle": (_SHELF, "/entities/shelf/dimensions/size/2", "/story/beats/roll/predicate/min", "is a angle"),
    "along another axis": (_SHELF, "/entities/shelf/dimensions/size/2", "/entities/shelf/dimensions/size/1", "says how high, and /entities/shelf/dimensions/size/1 is a level extent"),
    "before another noun": (f"A {BALL} {ROLLS} on a [30 cm](quantity %s) {SHELF}.", "/entities/shelf/dimensions/size/2", "/entities/ball/dimensions/size/2", "'30 cm' stands before 'shelf' (shelf) and is judged by a number of ball"),
}  # fmt: skip


@pytest.mark.parametrize("name", QUANTITIES)
def test_a_quantity_is_a_number_of_what_the_words_speak_of(name: str) -> None:
    marked, honest, dishonest, hint = QUANTITIES[name]
    more = ("/story/beats/roll/predicate/min", 3.2)
    assert hint not in said(marked % honest, more)
    assert hint in said(marked % dishonest, more), said(marked % dishonest, more)


def test_a_number_of_the_camera_is_one_where_the_words_speak_of_it() -> None:
    at = "/shots/only/keys/a/position/2"
    assert "no words of the prompt speak" not in said(f"A {BALL} {ROLLS}, seen from a camera [55 cm high](quantity {at}).")
    assert "no words of the prompt speak" in said(f"A {BALL} {ROLLS} on a {SHELF} [55 cm high](quantity {at}).")


WAY = {"text": "the way of the block", "predicate": {"kind": "displacement", "entity": "b3", "min": 0.2}}
MOST = {**WAY, "predicate": {"kind": "displacement", "entity": "b3", "max": 0.2}}
SIDES: dict[str, tuple[str, dict[str, Any], str, bool]] = {
    "at most, by a most": ("at most", MOST, "max", True),
    "at most, by a least": ("at most", WAY, "min", False),
    "at most, by a least that must never be": ("at most", {**WAY, "never": True}, "min", True),
    "no more than, by a least": ("no more than", WAY, "min", False),
    "at least, by a least": ("at least", WAY, "min", True),
    "at least, by a most": ("at least", MOST, "max", False),
    "at least, by a least that must never be": ("at least", {**WAY, "never": True}, "min", False),
}


@pytest.mark.parametrize("name", SIDES)
@pytest.mark.parametrize("inside", [True, False])
def test_at_most_asks_for_an_upper_bound_and_at_least_for_a_lower_one(name: str, inside: bool) -> None:
    words, way, field, right = SIDES[name]
    quote = f"[{words} 20 cm]" if inside else f"{words} [20 cm]"
    marked = f"A {BALL} {ROLLS} and a {BLOCK} {FALLS} {quote}(quantity /story/requirements/way/predicate/{field})."
    found = said(marked, ("/story/requirements", {"way": way}))
    assert ("that is asked" not in found) is right, found
    assert "'no'" not in found, "no more than denies nothing"


def test_a_denied_more_than_is_an_upper_bound() -> None:
    marked = f"A {BALL} {ROLLS}, and a {BLOCK} does [not](negation way) [fall] [more than 20 cm](quantity /story/requirements/way/predicate/min)."
    marked = marked.replace("[fall]", "fall")
    assert "that is asked" not in said(marked, ("/story/requirements", {"way": {**WAY, "never": True}}))


COUNTS: dict[str, Pair] = {
    "blocks": (f"A {BALL} {ROLLS} into [three](count %s) [wooden](property b1) [blocks](thing b1 b2 b3).", "b1 b2 b3", "b1 b2 ball"),
    "of the blocks": (f"A {BALL} {ROLLS} into [three](count %s) of the [blocks](thing b1 b2 b3).", "b1 b2 b3", "b1 b2 shelf"),
    "described": (f"A {BALL} {ROLLS} into [three](count %s) old, dusty [blocks](thing b1 b2 b3).", "b1 b2 b3", "b1 shelf ball"),
    "drei": (f"Eine {KUGEL} {ROLLT} gegen [drei](count %s) alte [Klötze](thing b1 b2 b3).", "b1 b2 b3", "b1 b2 ball"),
    "trois": ("Une [bille](thing ball) [roule](event roll) contre [trois](count %s) [cubes](thing b1 b2 b3).", "b1 b2 b3", "b1 b2 ball"),
    "三": ("[钢球](thing ball)[滚动](event roll)，碰到[三](count %s)个[木块](thing b1 b2 b3)。", "b1 b2 b3", "b1 b2 ball"),
}  # fmt: skip


@pytest.mark.parametrize("name", COUNTS)
def test_a_count_is_one_of_what_its_noun_names(name: str) -> None:
    marked, honest, dishonest = COUNTS[name]
    assert "stands before" not in said(marked % honest)
    assert "stands before" in said(marked % dishonest), said(marked % dishonest)


def test_a_number_whose_noun_nobody_claims_is_read_by_the_agent() -> None:
    marked = f"A {BALL} {ROLLS} into [three](count b1 b2 b3) %s, and a [block](thing b3) {FALLS}."
    assert "three" in prompt_record(told(marked % "blocks"))["readings"]
    assert "three" not in prompt_record(told(marked % "[blocks](thing b1 b2 b3)"))["readings"]


AGAIN = {"text": "it falls again", "owner": "rigid", "subject": "b3", "frames": [26, 34], "causes": ["strike"], "predicate": {"kind": "falls", "entity": "b3"}}  # fmt: skip
TIMES: dict[str, tuple[str, str, dict[str, Any], str]] = {
    "twice": ("twice", "fall again", AGAIN, ""),
    "two times": ("two times", "fall again", AGAIN, ""),
    "by one beat": ("twice", "fall", AGAIN, "by names 1 beats: name 2 beats of it"),
    "of frames that overlap": ("twice", "fall again", {**AGAIN, "frames": [20, 34]}, "both may be the same event"),
    "of another kind": ("twice", "fall again", {**AGAIN, "predicate": {"kind": "tips", "entity": "b3"}}, "are of different kinds or bodies"),
    "of another body": ("twice", "fall again", {**AGAIN, "predicate": {"kind": "falls", "entity": "ball"}}, "are of different kinds or bodies"),
}  # fmt: skip


@pytest.mark.parametrize("name", TIMES)
def test_twice_counts_events(name: str) -> None:
    words, beats, again, hint = TIMES[name]
    found = said(f"A {BALL} {ROLLS} and a {BLOCK} {FALLS} [{words}](count {beats}).", ("/story/beats/again", again))
    assert hint in found if hint else not any(other in found for *_, other in TIMES.values() if other)


@pytest.mark.parametrize(
    "marked", [f"A {BALL} {{}} as heavy as a {BLOCK} {ROLLS}.", f"A {BALL} {{}} the size of a {BLOCK} {ROLLS}."]
)
def test_twice_as_heavy_counts_nothing(marked: str) -> None:
    assert "how often" not in said(marked.replace("{}", "[twice](count ball b3)"))


@pytest.mark.parametrize("place", ["/simulation/seed", "/simulation/solvers/rigid/settings/iterations"])
def test_a_setting_counts_nothing(place: str) -> None:
    marked = f"A {BALL} {ROLLS} into [seven](count {place}) [blocks](thing b1 b2 b3)."
    assert "a setting that counts nothing" in said(marked, (place, 7))
