"""Questions to readers, and the strict reading of their answers."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from worldagent.testing.worlds.small_worlds import ball, ground, world
from worldagent.workflow.review.questions import (
    STRANGERS,
    Questions,
    asked_of,
    parse_answers,
    parse_choice,
    prompts_to_choose,
)
from worldagent.worlds.errors import InputError
from worldagent.worlds.reviews import Asked
from worldagent.worlds.spec import Claim

PROMPT = "A ball falls onto the floor. It bounces twice."
SPANS = (Asked("ball_id", "A ball", "thing"), Asked("fall_id", "falls", "event"))


def questions(**more: object) -> Questions:
    prompts, right = prompts_to_choose(PROMPT, "d1")
    made = {"account": "2 things", "pictures": ("aa", "bb"), "spans": SPANS, "left_out": 0, "prompts": prompts, "right": right}
    return Questions(**{**made, **more})  # type: ignore[arg-type]


# ---------------------------------------------------------------- what is asked


def test_the_own_prompt_stands_among_strangers_in_an_order_that_the_world_decides() -> None:
    prompts, right = prompts_to_choose(PROMPT, "d1")
    assert prompts[right - 1] == PROMPT
    assert len(set(prompts)) == len(prompts) == STRANGERS + 1
    assert prompts_to_choose(PROMPT, "d1") == (prompts, right)
    assert len({prompts_to_choose(PROMPT, f"d{k}")[1] for k in range(40)}) == STRANGERS + 1


def test_rivals_stand_beside_it_and_the_own_prompt_never_twice() -> None:
    rivals = ["A ball falls onto the floor. It bounces once.", PROMPT.upper()]
    prompts, right = prompts_to_choose(PROMPT, "d1", rivals)
    assert rivals[0] in prompts
    assert rivals[1] not in prompts
    assert prompts[right - 1] == PROMPT


@pytest.mark.parametrize(
    ("prompt", "letters"),
    [
        ("Ein Ball fällt auf den Boden und springt zweimal hoch.", "Eine"),
        ("Une balle tombe sur le sol et rebondit deux fois.", "Un"),
        ("Una pelota cae al suelo y rebota dos veces.", "Un"),
        ("Una palla cade sul pavimento e rimbalza due volte.", "Una"),
        ("Uma bola cai no chão e quica duas vezes.", "Um"),
        ("Een bal valt op de vloer en stuitert twee keer.", "Een"),
        ("Мяч падает на пол и отскакивает два раза.", "и"),
        ("一个球落在地板上，弹了两次。", "一"),
        ("ボールが床に落ち、二回弾む。", "が"),
    ],
)
def test_strangers_are_of_the_prompts_language(prompt: str, letters: str) -> None:
    told = json.loads(Path(prompts_to_choose.__code__.co_filename).with_name("strangers.json").read_text("utf-8"))
    prompts, _ = prompts_to_choose(prompt, "d1")
    others = {p for p in prompts if p != prompt}
    homes = [language for language, texts in told.items() if others & set(texts)]
    assert len(homes) == 1
    assert any(letters in p for p in others)


def test_spans_are_the_clauses_of_a_world_without_claims() -> None:
    spec = world({"floor": ground(), "ball": ball(0.1, motion="dynamic")}).model_copy(update={"prompt": PROMPT})
    spans, left_out = asked_of(spec)
    assert [s.quote for s in spans] == ["A ball falls onto the floor", "It bounces twice"]
    assert {s.type for s in spans} == {"clause"}
    assert left_out == 0


def test_spans_are_those_of_claims_that_are_not_waived_in_the_order_of_the_prompt() -> None:
    claims = {
        "late": Claim(quote="falls", type="event", by=["/story/beats/fall"]),
        "first": Claim(quote="A ball", type="thing", by=["/entities/ball"]),
        "gone": Claim(quote="bounces twice", type="count", waived="nothing counts bounces here"),
    }
    spec = world({"floor": ground(), "ball": ball(0.1, motion="dynamic")})
    spec = spec.model_copy(update={"prompt": PROMPT, "spec_version": "2", "claims": claims})
    assert asked_of(spec) == ((Asked("first", "A ball", "thing"), Asked("late", "falls", "event")), 0)


def test_the_digest_is_of_account_pictures_spans_and_prompts() -> None:
    base = questions()
    assert base.digest == questions().digest
    other = [
        questions(account="3 things"),
        questions(pictures=("aa", "cc")),
        questions(spans=SPANS[:1]),
        questions(prompts=(*base.prompts[:-1], "else")),
    ]
    assert len({base.digest, *(q.digest for q in other)}) == 5


def test_what_a_reader_gets_holds_numbers_and_no_ids_and_the_choice_gives_no_span_away() -> None:
    asked = questions()
    both = asked.choice_text() + asked.spans_text()
    assert "ball_id" not in both
    assert "fall_id" not in both
    assert '1. "A ball" (thing)' in asked.spans_text()
    assert "(thing)" not in asked.choice_text()
    assert "2 things" in asked.choice_text()


# ---------------------------------------------------------------- answers


def test_whole_answers_are_read_bare_or_in_a_fence() -> None:
    text = '{"answers": {"1": "shown", "2": "contradicted"}, "because": {"2": "it rises"}}'
    for reply in (text, f"  {text}\n", f"```json\n{text}\n```"):
        found = parse_answers(reply, 2)
        assert found.answers == {1: "shown", 2: "contradicted"}
        assert found.because == {2: "it rises"}


@pytest.mark.parametrize(
    ("reply", "words"),
    [
        ("The ball falls.", "no JSON"),
        ("[]", "a JSON list"),
        ('{"answers": {"1": "shown"}}', "no answer about the parts 2"),
        ('{"answers": {"1": "shown", "2": "yes"}}', "about part 2 is 'yes'; it must be one of shown, contradicted, not shown"),
        ('{"answers": {"1": "shown", "2": "shown", "3": "shown"}}', r"no parts \['3'\]"),
        ('{"answers": {"1": "shown", "2": "shown"}, "verdict": "pass"}', "keys"),
        ('{"answers": ["shown", "shown"]}', "missing or no object"),
        ('{"answers": {"1": "shown", "2": NaN}}', "no JSON"),
        ('{"answers": {"1": "shown", "2": "shown"}} and more', "no JSON"),
    ],
)
def test_an_answer_that_lacks_something_is_refused_by_name(reply: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        parse_answers(reply, 2)


def test_a_person_may_answer_a_part() -> None:
    assert parse_answers('{"answers": {"2": "not shown"}}', 2, partly=True).answers == {2: "not shown"}


def test_a_choice_is_a_number_of_the_list_or_none() -> None:
    assert parse_choice('{"prompt": 3}', 6) == 3
    assert parse_choice('{"prompt": 0, "because": "none fits"}', 6) == 0


@pytest.mark.parametrize(
    "reply", ['{"prompt": 7}', '{"prompt": "3"}', '{"prompt": true}', "{}", '{"prompt": -1}', '{"prompt": 2.0}']
)
def test_a_choice_beyond_the_list_is_refused_with_its_range(reply: str) -> None:
    with pytest.raises(InputError, match="whole number from 0"):
        parse_choice(reply, 6)
