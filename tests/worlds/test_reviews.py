"""Reviews in the ledger, the answer that counts, and who has read a world."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest
from worldagent.worlds.errors import EvidenceError, InputError
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.reviews import Answer, Reader, Review, read_by, standing_of, summary


def review(reader: Reader, name: str = "x", digest: str = "d", choice: int | None = None, **answers: Answer) -> Review:
    return Review(digest, reader, name, answers, choice, None if choice is None else 2)


def test_reviews_are_kept_as_given_in_order_and_by_digest(tmp_path: Path) -> None:
    ledger = Ledger(tmp_path / "ledger.sqlite")
    ledger.add_review(review("model", a="shown", b="not shown"))
    ledger.add_review(review("person", digest="other", a="contradicted"))
    first, second = ledger.reviews()
    assert (first.reader, first.answers) == ("model", {"a": "shown", "b": "not shown"})
    assert first.at > 0.0
    assert ledger.reviews("other") == [second]
    assert ledger.reviews("none") == []


def test_a_review_that_was_changed_is_damage_and_not_an_answer(tmp_path: Path) -> None:
    ledger = Ledger(tmp_path / "ledger.sqlite")
    ledger.add_review(review("model", a="contradicted"))
    with sqlite3.connect(ledger.path) as db:
        db.execute("UPDATE reviews SET record = replace(record, 'contradicted', 'shown')")
    db.close()
    with pytest.raises(EvidenceError, match="review:1"):
        ledger.reviews()


def test_an_older_ledger_gets_its_table_when_it_is_opened(tmp_path: Path) -> None:
    path = Ledger(tmp_path / "ledger.sqlite").path
    with sqlite3.connect(path) as db:
        db.execute("DROP TABLE reviews")
    db.close()
    assert Ledger(path).reviews() == []


@pytest.mark.parametrize(
    ("reviews", "answer", "reader", "overruled"),
    [
        ([review("client", a="shown")], "shown", "client", None),
        ([review("client", a="shown"), review("model", a="not shown")], "not shown", "model", None),
        ([review("model", "m1", a="contradicted"), review("model", "m2", a="shown")], "contradicted", "model", None),
        ([review("model", a="contradicted"), review("person", a="shown")], "shown", "person", "model"),
        ([review("person", a="shown"), review("person", a="contradicted")], "contradicted", "person", None),
        ([review("client", a="contradicted"), review("model", a="contradicted")], "contradicted", "model", None),
    ],
)
def test_a_person_counts_before_models_and_these_before_the_client(
    reviews: list[Review], answer: str, reader: str, overruled: str | None
) -> None:
    found = standing_of(reviews, "a")
    assert found is not None
    assert (found.answer, found.review.reader) == (answer, reader)
    assert (None if found.overruled is None else found.overruled.reader) == overruled


def test_where_nobody_answered_there_is_no_answer() -> None:
    assert standing_of([review("model", b="shown")], "a") is None
    assert standing_of([], "a") is None


def test_a_world_is_read_by_the_best_reader_that_answered_everything() -> None:
    assert read_by([], ["a", "b"]) == "nobody"
    assert read_by([review("client", a="shown", b="shown")], ["a", "b"]) == "client"
    whole = review("model", a="shown", b="not shown")
    assert read_by([whole, review("person", a="shown")], ["a", "b"]) == "model"
    assert read_by([whole, review("person", a="shown", b="shown")], ["a", "b"]) == "person"


def test_what_is_no_review_is_refused() -> None:
    with pytest.raises(InputError, match="none of client, model, person"):
        Review("d", "owner", "x", {})  # type: ignore[arg-type]
    with pytest.raises(InputError, match="none of shown, contradicted, not shown"):
        Review("d", "model", "x", {"a": "pass"})  # type: ignore[dict-item]
    with pytest.raises(InputError, match="at most 500"):
        Review("d", "model", "x" * 501, {})


def test_the_summary_tells_counts_contradictions_and_whether_the_prompt_was_found() -> None:
    (told,) = summary([review("model", "m", choice=2, a="shown", b="contradicted")])
    assert told["counts"] == {"shown": 1, "contradicted": 1, "not shown": 0}
    assert told["contradicted"] == ["b"]
    assert told["chose_the_prompt"] is True


@pytest.mark.parametrize(("choice", "against"), [(None, False), (0, False), (2, False), (1, True)])
def test_who_takes_another_prompt_for_the_worlds_contradicts(choice: int | None, against: bool) -> None:
    assert Review("d", "model", "m", {"c": "shown"}, choice, 2).contradicts is against
    assert Review("d", "model", "m", {"c": "contradicted"}, 2, 2).contradicts
