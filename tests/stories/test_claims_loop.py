"""A prompt that is not English, marked with claims, from its creation to acceptance through the tools; and the same with words that are not so."""

from __future__ import annotations

from typing import Any

import pytest

PROMPT = "Ein Stahlklotz rutscht über einen Steinboden. Er trifft einen Holzklotz, und der rutscht eine Handbreit weiter, ohne zu kippen."
CLAIMS = (
    "Ein [Stahlklotz](thing steel_block) [rutscht](event slide) über einen [Steinboden](thing floor). [Er](thing same_as=stahlklotz) "
    "[trifft](event hit) einen [Holzklotz](thing wooden_block), und [der](thing same_as=holzklotz) [rutscht](event push) "
    "[eine Handbreit](quantity /story/beats/push/predicate/of/1/min) weiter, [ohne zu kippen](negation never)."
)
TIPS = {"text": "the wooden block tips", "predicate": {"kind": "tips", "entity": "wooden_block"}, "never": True}
MOVES = {"text": "it comes along", "predicate": {"kind": "displacement", "entity": "wooden_block", "min": 0.05}, "never": True}
SLIDES = {"text": "the wooden block slides", "predicate": {"kind": "slides", "entity": "wooden_block"}, "never": True}


def made(agent: Any, never: dict[str, Any], claims: str | None = CLAIMS) -> dict[str, Any]:
    """The answer to the creation of the example of the skill with a German prompt."""
    spec = agent.call("inspect_world", part="schema", pointer="example")["spec"]
    spec["story"]["requirements"] = {"never": never}
    given = {} if claims is None else {"claims": claims}
    found: dict[str, Any] = agent.call("edit_spec", world="w", prompt=PROMPT, spec=spec, **given)
    return found


@pytest.mark.slow
def test_a_german_prompt_is_claimed_in_one_call_and_accepted_without_a_waiver(agent: Any) -> None:
    assert made(agent, TIPS)["audit"]["passed"]
    assert len(CLAIMS) < 1500
    agent.call("place_object", world="w")
    assert agent.call("probe_sim", world="w")["passed"]
    agent.call("bake_sim", world="w")
    verdict = agent.call("run_checks", world="w", scope="acceptance")
    assert (verdict["verdict"], verdict["says"]) == ("accepted", "accepted, prompt read by nobody")
    assert verdict["prompt"]["waivers"] == {}
    assert verdict["prompt"]["language"] == "de"
    shown = agent.call("inspect_world", world="w", part="claims")
    assert {s["row"] for s in shown["spans"] if "row" in s} == {"pass"}
    assert shown["marked"].startswith("Ein [Stahlklotz](thing ")


def test_what_the_words_deny_and_the_motion_shows_fails_the_probe(agent: Any) -> None:
    assert made(agent, MOVES)["audit"]["passed"]
    agent.call("place_object", world="w")
    probe = agent.call("probe_sim", world="w")
    assert not probe["passed"]
    assert "claim:negation:ohne_zu_kippen" in [r["id"] for r in probe["open_rows"]]


def test_words_that_deny_what_others_say_are_told_at_creation(agent: Any) -> None:
    found = made(agent, SLIDES)["audit"]
    assert not found["passed"]
    assert any("says by 'push' what 'ohne zu kippen' denies" in str(row.get("why")) for row in found["open_rows"])


@pytest.mark.parametrize(
    ("claims", "said"),
    [
        (None, "no claim says which words of the prompt are things"),
        (CLAIMS.replace("[ohne zu kippen](negation never)", "ohne zu kippen"), "'ohne' at character"),
        (CLAIMS.replace("(event slide)", "(event /entities/steel_block)"), "a claim of type event is judged by /story/beats"),
    ],
)
def test_words_that_nobody_claims_or_that_are_claimed_wrongly_are_told_at_creation(
    agent: Any, claims: str | None, said: str
) -> None:
    found = made(agent, TIPS, claims)
    assert not found["audit"]["passed"]
    assert any(said in str(row.get("why")) for row in found["audit"]["open_rows"])
    assert ("claims_to_make" in found) is (claims is None)
