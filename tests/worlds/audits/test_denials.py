"""Words that deny without `not`, the verb that a negation denies, and parts that stand for the whole: in each pair one is honest."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.worlds.audits.test_bindings import BALL, BLOCK, FALLS, ROLLS, SHELF, said, told
from worldagent.worlds.claims import prompt_record

REFUSALS: dict[str, tuple[str, str]] = {
    "refuses to": (f"A {BALL} {ROLLS}, and a {BLOCK} {{refuses to}} {FALLS}.", "refuses to"),
    "fails to": (f"A {BALL} {ROLLS}, and a {BLOCK} {{failed to}} {FALLS}.", "failed to"),
    "avoids": (f"A {BALL} {{avoids}} [hitting](event strike) a {BLOCK}.", "avoids"),
    "instead of": (f"A {BALL} {ROLLS} {{instead of}} [hitting](event strike) a {BLOCK}.", "instead of"),
    "weigert sich": ("Die [Kugel](thing ball) [rollt](event roll), und der [Klotz](thing b3) {weigert} sich zu [fallen](event fall).", "weigert"),
    "évite de": ("La [bille](thing ball) [roule](event roll) sur le sol et {évite} de [heurter](event strike) le [cube](thing b3).", "évite"),
    "se niega a": ("La [bola](thing ball) [rueda](event roll), y el [cubo](thing b3) {se niega a} [caer](event fall).", "se niega a"),
    "rifiuta di": ("La [palla](thing ball) [rotola](event roll) e il [cubo](thing b3) {rifiuta di} [cadere](event fall) dallo scaffale.", "rifiuta di"),
    "evita": ("A [bola](thing ball) [rola](event roll) pelo chão e {evita} [bater](event strike) no [cubo](thing b3).", "evita"),
    "weigert": ("De [bal](thing ball) [rolt](event roll) en het [blok](thing b3) {weigert} te [vallen](event fall).", "weigert"),
    "отказывается": ("[Шар](thing ball) [катится](event roll) по полке, а [кубик](thing b3) {отказывается} [падать](event fall).", "отказывается"),
    "拒绝": ("[钢球](thing ball)[滚动](event roll)，[木块](thing b3){拒绝}[落下](event fall)。", "拒绝"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSALS)
def test_words_that_refuse_or_avoid_are_negations(name: str) -> None:
    marked, words = REFUSALS[name]
    assert f"{words!r} at character" in said(marked.replace("{", "").replace("}", ""))
    stays = {"stays": {"text": "it happens", "predicate": {"kind": "falls", "entity": "b3"}, "never": True}}
    claimed = marked.replace("{", "[").replace("}", "](negation stays)")
    assert "is a negation word" not in said(claimed, ("/story/requirements", stays))


@pytest.mark.parametrize(
    "prompt",
    [
        "The brake fails and a {ball} {rolls}.",
        "A wooden rather than glass {ball} {rolls}.",
        "A {ball} {rolls} instead of a cube.",
        "A {ball} {rolls} no more than a hand's width.",
        "A {ball} {rolls} at least as far as before the storm.",
    ],
)
def test_words_that_only_look_so_are_none(prompt: str) -> None:
    assert "is a negation word" not in said(prompt.replace("{ball}", BALL).replace("{rolls}", ROLLS))


@pytest.mark.parametrize("clock", ["3 pm", "3 p.m.", "three o'clock", "15:30"])
def test_a_time_of_day_is_advised_to_be_marked_as_time(clock: str) -> None:
    number = clock.split()[0].split(":")[0]
    found = said(f"A {BALL} {ROLLS} at {clock} onto a {BLOCK}.")
    assert "mark it as time, with the words of the clock" in found, found
    assert f"{number!r}" in found or clock in found
    assert "mark it as count or quantity" in said(f"A {BALL} {ROLLS} into three {BLOCK}.")
    assert "is a number word" not in said(f"A {BALL} {ROLLS} [at {clock}](time /look/sun_elevation_deg) onto a {BLOCK}.")


def denied(marked: str, predicate: dict[str, Any]) -> str:
    return said(marked, ("/story/requirements", {"stays": {"text": "it happens", "predicate": predicate, "never": True}}))


FALLING, SPINNING = {"kind": "falls", "entity": "b3"}, {"kind": "spins", "entity": "b3"}
DENIALS: dict[str, tuple[str, dict[str, Any], bool]] = {
    "falls": ("does not fall", FALLING, True),
    "falls or spins": ("does not fall", {"kind": "or", "of": [SPINNING, FALLING]}, True),
    "falls and spins at once": ("does not fall", {"kind": "and", "of": [SPINNING, FALLING]}, False),
    "spins": ("does not fall", SPINNING, False),
    "a level shift": ("does not fall", {"kind": "displacement", "entity": "b3", "axis": [1, 0, 0], "min": 0.5}, False),
    "another participle": ("never falling", SPINNING, False),
    "refuses": ("refuses to fall", SPINNING, False),
    "without": ("without tipping over", {"kind": "tips", "entity": "b3"}, True),
    "without, of another": ("without tipping over", FALLING, False),
    "a verb without a kind": ("does not budge", {"kind": "speed", "entity": "b3", "min": 0.05}, True),
    "never hit, by touch": ("never hits the ball", {"kind": "contact", "a": "b3", "b": "ball"}, True),
}


@pytest.mark.parametrize("name", DENIALS)
def test_the_verb_of_a_negation_is_what_its_requirement_denies(name: str) -> None:
    words, predicate, right = DENIALS[name]
    found = denied(f"A {BALL} {ROLLS}, and a {BLOCK} stands there, [{words}](negation stays).", predicate)
    assert ("and what must never happen by it is" not in found) is right, found


def test_a_verb_behind_a_bare_not_is_meant_and_verbs_of_no_own_kind_are_warned_of() -> None:
    assert "denies 'fall'" in denied(f"A {BALL} {ROLLS}, and a {BLOCK} does [not](negation stays) fall.", SPINNING)
    stays = ("/story/requirements", {"stays": {"text": "it happens", "predicate": SPINNING, "never": True}})
    burst = f"A {BALL} {ROLLS}, and a {BLOCK} [does not burst](negation stays)."
    assert "denies" not in said(burst, stays)
    assert any("denies 'burst'" in w for w in prompt_record(told(burst, stays))["warnings"])


def test_what_is_denied_in_a_language_without_verbs_is_read_by_the_agent() -> None:
    stays = ("/story/requirements", {"stays": {"text": "it happens", "predicate": FALLING, "never": True}})
    german = "Eine [Kugel](thing ball) [rollt](event roll), und der [Klotz](thing b3) [fällt nicht](negation stays)."
    assert "fällt nicht" in prompt_record(told(german, stays))["readings"]
    assert (
        "does not fall"
        not in prompt_record(told(f"A {BALL} {ROLLS}, and a {BLOCK} [does not fall](negation stays).", stays))["readings"]
    )


# ---------------------------------------------------------------- parts

LABEL = {"shape": {"kind": "box", "size": [0.001, 0.02, 0.02]}, "pose": {"position": [0.0155, 0, 0]}, "collides": False}
PARTS: dict[str, tuple[str, bool]] = {
    "its label": (f"A {BALL} {ROLLS} into a {BLOCK} with [two](count /entities/b3/parts/body /entities/b3/parts/label) [sides](thing /entities/b3/parts/label).", True),
    "a noun of a part": (f"A {BALL} {ROLLS} into a {BLOCK} with a [label](thing /entities/b3/parts/label).", True),
    "its": (f"A {BALL} {ROLLS} into a {BLOCK} and [its](thing same_as=block) [emblem](thing /entities/b3/parts/label).".replace("[its](thing same_as=block)", "its"), True),
    "of": (f"A {BALL} {ROLLS} into the [emblem](thing /entities/b3/parts/label) of a {BLOCK}.", True),
    "a cat": (f"A {BALL} {ROLLS} into a {BLOCK} with a [cat](thing /entities/b3/parts/label).", False),
    "alone": (f"A {BALL} {ROLLS} into a [cat](thing /entities/b3/parts/label).", False),
    "two parts": (f"A {BALL} {ROLLS} into a [dog](thing /entities/b3/parts/body) and a [cat](thing /entities/b3/parts/label).", False),
    "all parts": (f"A {BALL} {ROLLS} into a [dog](thing /entities/b3/parts/body /entities/b3/parts/label).", True),
    "ein Griff": ("Eine [Kugel](thing ball) [rollt](event roll) gegen einen [Klotz](thing b3) mit einem [Griff](thing /entities/b3/parts/label).", True),
    "eine Katze": ("Eine [Kugel](thing ball) [rollt](event roll) gegen einen [Klotz](thing b3) mit einer [Katze](thing /entities/b3/parts/label).", False),
}  # fmt: skip


@pytest.mark.parametrize("name", PARTS)
def test_a_part_stands_for_a_thing_only_where_the_words_say_part(name: str) -> None:
    marked, right = PARTS[name]
    found = said(marked, ("/entities/b3/parts/label", LABEL))
    assert ("both of the one body" not in found and "do not say that it is a part" not in found) is right, found


def test_parts_of_what_stands_still_are_things_of_their_own() -> None:
    marked = (
        f"A {BALL} {ROLLS} on a [counter](thing /entities/shelf/parts/body) beside a [barrel](thing /entities/shelf/parts/label)."
    )
    assert "of the one body" not in said(marked, ("/entities/shelf/parts/label", LABEL))
    both = f"A {BALL} {ROLLS} on a {SHELF} beside a [barrel](thing /entities/shelf/parts/label)."
    assert "of the one body" in said(both, ("/entities/shelf/parts/label", LABEL))
