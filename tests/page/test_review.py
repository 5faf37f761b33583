"""A person reads a world on the page: what it gets, what it may answer, and who may answer."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import pytest
from starlette.testclient import TestClient
from worldagent.server.http import http_app
from worldagent.server.tokens import TokenBook
from worldagent.tests.page.conftest import Made
from worldagent.tests.page.questioned import questioned
from worldagent.tests.stories.small_run import PROMPT
from worldagent.workflow.session import Session
from worldagent.worlds.reviews import Review

JSON = {"Content-Type": "application/json"}
PLACE = "/api/worlds/w/review"


@pytest.fixture
def client(made: Made, monkeypatch: pytest.MonkeyPatch) -> Iterator[TestClient]:
    monkeypatch.setattr("worldagent.server.page.reviews.rows_anew", lambda session, jobs: "job")
    with TestClient(http_app(made.root, tokens=TokenBook(made.root)), base_url="http://127.0.0.1:8931") as found:
        yield found


@pytest.fixture
def session(made: Made) -> Session:
    return questioned(made)


def answers(told: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {
        "digest": told["digest"],
        "name": "Ann",
        "choice": told["right"],
        "answers": {str(s["number"]): "shown" for s in told["spans"]},
        **more,
    }


def test_where_nothing_is_asked_the_page_says_which_call_asks(made: Made, client: TestClient) -> None:
    made.world("w")
    found = client.get(PLACE)
    assert found.status_code == 409
    assert "run_checks(scope='review')" in found.json()["error"]


def test_a_person_gets_account_pictures_prompts_and_spans_without_ids(session: Session, client: TestClient) -> None:
    told = client.get(PLACE).json()
    assert told["account"] == "5 things, 36 frames"
    assert told["prompts"][told["right"] - 1] == PROMPT
    assert [s["quote"] for s in told["spans"]] == ["ball", "falls off"]
    assert "c1" not in json.dumps(told["spans"])
    assert told["read_by"] == "nobody"
    picture = client.get(f"{PLACE}/pictures/1")
    assert (picture.content, picture.headers["content-type"]) == (b"picture", "image/png")
    for number in ("0", "2", "-1", "x", "..%2fquestions"):
        assert client.get(f"{PLACE}/pictures/{number}").status_code == 404


def test_answers_stand_in_the_ledger_with_the_name_and_show_who_has_read(session: Session, client: TestClient) -> None:
    told = client.get(PLACE).json()
    found = client.post(PLACE, json=answers(told, because={"1": "three blocks, one ball"}))
    assert found.json() == {"recorded": 2, "job_id": "job"}
    (review,) = session.ledger.reviews(told["digest"])
    assert (review.reader, review.name, review.choice) == ("person", "Ann", told["right"])
    assert review.answers == {"c1": "shown", "c2": "shown"}
    assert review.because == {"c1": "three blocks, one ball"}
    assert client.get(PLACE).json()["read_by"] == "person"


def test_a_person_sees_what_a_model_answered_and_overrules_a_part(session: Session, client: TestClient) -> None:
    digest = client.get(PLACE).json()["digest"]
    session.ledger.add_review(Review(digest, "model", "tiny", {"c1": "shown", "c2": "contradicted"}, because={"c2": "it stays"}))
    told = client.get(PLACE).json()
    assert told["spans"][1] | {"answer": "contradicted", "by": "model tiny", "because": "it stays"} == told["spans"][1]
    assert client.post(PLACE, json={"digest": digest, "name": "Ann", "answers": {"2": "shown"}}).status_code == 200
    assert client.get(PLACE).json()["spans"][1]["by"] == "person Ann"
    assert client.get(PLACE).json()["read_by"] == "model"


@pytest.mark.parametrize(
    ("more", "status", "words"),
    [
        ({"name": ""}, 400, "give 1 to 80"),
        ({"answers": {"1": "pass"}}, 400, "must be one of shown, contradicted, not shown"),
        ({"answers": {"9": "shown"}}, 400, "there are no parts"),
        ({"choice": 99}, 400, "none of 0 to"),
        ({"choice": True}, 400, "whole number"),
        ({"answers": {}, "choice": None}, 400, "nothing is answered"),
        ({"reader": "model"}, 400, "with the keys"),
        ({"digest": "other"}, 409, "load the page again"),
        ({"because": {"1": "x" * 70_000}}, 400, "at most 60000 are read"),
    ],
)
def test_what_is_no_answer_is_refused_in_words_and_leaves_nothing(
    session: Session, client: TestClient, more: dict[str, Any], status: int, words: str
) -> None:
    found = client.post(PLACE, json=answers(client.get(PLACE).json(), **more))
    assert found.status_code == status
    assert words in found.json()["error"]
    assert session.ledger.reviews() == []


def test_an_edit_closes_the_questions(session: Session, made: Made, client: TestClient) -> None:
    told = client.get(PLACE).json()
    made.edit("w", ("/materials/wood/appearance/color", [0.1, 0.2, 0.7]))
    assert client.get(PLACE).status_code == 409
    assert client.post(PLACE, json=answers(told)).status_code == 409
    assert session.ledger.reviews() == []


def test_answering_needs_a_write_token_and_a_request_no_form_can_make(session: Session, made: Made, client: TestClient) -> None:
    told = client.get(PLACE).json()
    assert client.post(PLACE, content=json.dumps(answers(told)), headers={"Content-Type": "text/plain"}).status_code == 415
    book = TokenBook(made.root)
    with TestClient(http_app(made.root, tokens=book), base_url="http://127.0.0.1:8931") as guarded:
        read = {"Authorization": f"Bearer {book.add('r', 'read')}", **JSON}
        assert guarded.get(PLACE, headers=read).status_code == 200
        assert guarded.post(PLACE, json=answers(told), headers=read).status_code == 403
        assert guarded.post(PLACE, json=answers(told)).status_code == 401
    assert session.ledger.reviews() == []


def test_the_page_of_a_review_is_static_and_holds_no_data(client: TestClient) -> None:
    assert client.get("/static/review.html").status_code == 200
    script = client.get("/static/review.js")
    assert script.headers["content-type"].startswith("text/javascript")
    assert "innerHTML" not in script.text
