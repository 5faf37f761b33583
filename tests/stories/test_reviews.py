"""A reader reads an accepted world: who is asked what, what an answer does to rows and verdict, and what `verify` says of it.

The reader is a fake on this machine: it proves the plumbing and yields no figure.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT
from worldagent.tests.workflow.review.fake_reader import Call, openai, serving
from worldagent.workflow.review.endpoint import ENV_MODEL, ENV_URL
from worldagent.workflow.verify_folder import verify_folder
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.reviews import Review

SPANS = ("steel", "ball", "rolls", "three", "blocks", "block", "falls_off", "shelf")
"""Claims of the small world, in the order of its prompt."""
FALLS = 1 + SPANS.index("falls_off")


def reading(spans: Mapping[int, str], *, prompt: str = PROMPT) -> Any:
    """A reader that finds a prompt in the list, and answers `shown` about all spans but those given."""

    def answer(call: Call, n: int) -> tuple[int, dict[str, str], bytes]:
        listed = dict(re.findall(r"^(\d+)\. (\".*?\")(?: \(.*\))?$", call.text, re.MULTILINE))
        if "Which of these prompts" in call.text:
            number = next(int(k) for k, text in listed.items() if json.loads(text) == prompt)
            return openai({"prompt": number})
        told = {k: spans.get(int(k), "shown") for k in listed}
        return openai({"answers": told, "because": {k: "so it looks" for k, v in told.items() if v != "shown"}})

    return answer


@pytest.fixture
def named(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Name a reader in the environment that jobs inherit."""

    def name(url: str) -> None:
        monkeypatch.setenv(ENV_URL, url)
        monkeypatch.setenv(ENV_MODEL, "tiny")

    return name


def rows_of(agent: Any) -> dict[str, tuple[str, bool]]:
    ledger = Ledger(agent.workspace / "w" / "ledger.sqlite")
    return {r.id: (r.status, r.mandatory) for r in ledger.rows() if r.check == "review"}


@pytest.mark.slow
def test_nobody_reads_unless_the_owner_names_a_reader(accepted: Any) -> None:
    told = accepted.call("run_checks", world="w", scope="review")
    assert told["read_by"] == "nobody"
    assert "WORLDAGENT_REVIEW_URL and WORLDAGENT_REVIEW_MODEL" in told["summary"]
    assert (told["accepted"], told["next"]) == (True, "render_shot(world='w', kind='final')")
    assert told["asked"]["spans"] == len(SPANS)
    assert rows_of(accepted) == {}
    folder = accepted.workspace / "w" / told["asked"]["folder"]
    asked = json.loads((folder / "questions.json").read_text())
    assert asked["account"] == (folder / "account.txt").read_text()
    assert len(asked["pictures"]) == len(list(folder.glob("picture_*"))) == 6
    verdict = accepted.call("run_checks", world="w", scope="acceptance")
    assert (verdict["verdict"], verdict["read_by"]) == ("accepted", "nobody")


@pytest.mark.slow
def test_a_model_that_sees_everything_is_in_the_verdict_and_asked_once(accepted: Any, named: Any) -> None:
    with serving(reading({})) as fake:
        named(fake.url)
        told = accepted.call("run_checks", world="w", scope="review")
        again = accepted.call("run_checks", world="w", scope="review")
    assert told["read_by"] == again["read_by"] == "model"
    assert [c.body["model"] for c in fake.calls] == ["tiny", "tiny"], "one choice and one reading, for both calls"
    assert rows_of(accepted) == dict.fromkeys(("review", *(f"review:{name}" for name in SPANS)), ("pass", True))
    assert PROMPT not in json.dumps([p for p in fake.calls[0].body["messages"][0]["content"] if p["type"] != "text"])
    verdict = accepted.call("run_checks", world="w", scope="acceptance")
    assert (verdict["verdict"], verdict["read_by"]) == ("accepted", "model")
    found = verify_folder(accepted.workspace / "w", replay=False, seed=1)
    assert found["verdict"] == "accepted"
    assert found["differences"] == []
    assert [(r["reader"], r["standing"]) for r in found["reviews"]] == [("model", "of this very bake")]


@pytest.mark.slow
def test_a_contradiction_closes_the_film_until_a_person_overrules_it(accepted: Any, named: Any) -> None:
    with serving(reading({FALLS: "contradicted", 1: "not shown"})) as fake:
        named(fake.url)
        accepted.call("run_checks", world="w", scope="review")
    assert rows_of(accepted)["review:falls_off"] == ("fail", True)
    assert rows_of(accepted)["review:steel"] == ("unverified", False)
    verdict = accepted.call("run_checks", world="w", scope="acceptance")
    assert verdict["verdict"] == "incomplete"
    assert "review:falls_off" in json.dumps(verdict["open_rows"])
    assert verdict["counts"]["mandatory_open"] == 1
    assert "not accepted" in accepted.refused("render_shot", world="w", kind="final")
    ledger = Ledger(accepted.workspace / "w" / "ledger.sqlite")
    (model,) = ledger.reviews()
    ledger.add_review(Review(model.digest, "person", "Ann", {"falls_off": "shown"}))
    verdict = accepted.call("run_checks", world="w", scope="acceptance")
    assert verdict["verdict"] == "accepted"
    assert verdict["read_by"] == "model", "a person who answers a part has not read the world"
    row = accepted.call("inspect_world", world="w", part="row", row="review:falls_off")["row"]
    assert row["evidence"]["overruled"]["because"] == "so it looks"


def test_the_choice_of_a_strangers_prompt_fails(accepted: Any, named: Any) -> None:
    def wrong(call: Call, n: int) -> tuple[int, dict[str, str], bytes]:
        if "Which of these prompts" not in call.text:
            return reading({})(call, n)
        listed = re.findall(r"^(\d+)\. (\".*\")$", call.text, re.MULTILINE)
        return openai({"prompt": next(int(k) for k, text in listed if json.loads(text) != PROMPT)})

    with serving(wrong) as fake:
        named(fake.url)
        accepted.call("run_checks", world="w", scope="review")
    assert rows_of(accepted)["review"] == ("fail", True)


def test_an_answer_that_cannot_be_read_is_asked_for_once_more_and_then_leaves_no_review(accepted: Any, named: Any) -> None:
    with serving(lambda call, n: openai("It is fine.")) as fake:
        named(fake.url)
        answer = accepted.result("run_checks", world="w", scope="review")
    assert answer.is_error
    assert "2 answers that cannot be read" in answer.content[0].text
    assert "Your last answer could not be read: the answer is no JSON" in fake.calls[1].text
    assert Ledger(accepted.workspace / "w" / "ledger.sqlite").reviews() == []


@pytest.mark.slow
def test_an_edit_of_a_look_makes_the_answers_stale_and_a_review_of_other_pictures_counts_no_more(
    accepted: Any, named: Any
) -> None:
    with serving(reading({FALLS: "contradicted"})) as fake:
        named(fake.url)
        accepted.call("run_checks", world="w", scope="review")
        accepted.edit(("/materials/wood/appearance/color", [0.1, 0.2, 0.7]))
        assert rows_of(accepted)["review:falls_off"] == ("unverified", True)
        verdict = accepted.call("run_checks", world="w", scope="acceptance")
        assert verdict["read_by"] == "nobody"
        assert verdict["earlier_contradictions"] == 1
        told = accepted.call("run_checks", world="w", scope="review")
    assert told["earlier_reviews"] == 1
    assert len(fake.calls) == 4
    found = verify_folder(accepted.workspace / "w", replay=False, seed=1)
    assert [r["standing"] for r in found["reviews"]] == ["of another bake, or of other parts of the prompt", "of this very bake"]


@pytest.mark.slow
def test_a_picture_that_was_replaced_since_is_told_by_verify(accepted: Any, named: Any) -> None:
    with serving(reading({})) as fake:
        named(fake.url)
        told = accepted.call("run_checks", world="w", scope="review")
    picture = next((accepted.workspace / "w" / told["asked"]["folder"]).glob("picture_1.*"))
    picture.write_bytes(picture.read_bytes() + b" ")
    found = verify_folder(accepted.workspace / "w", replay=False, seed=1)
    assert "picture 1" in found["reviews"][0]["standing"]
    assert "missing or altered" in found["reviews"][0]["standing"]
