"""Rows of reviews: contradicted fails, shown passes, not shown keeps nothing waiting, a person overrules in print."""

from __future__ import annotations

from pathlib import Path

import pytest
from worldagent.testing.worlds.small_worlds import ball, ground, make_candidate, world
from worldagent.verifiers.acceptance import NEEDED
from worldagent.verifiers.review.rows import review_rows
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.requirements import Row
from worldagent.worlds.reviews import Answer, Asked, Reader, Review

ASKED = (Asked("c1", "a ball", "thing"), Asked("c2", "falls", "event"))


@pytest.fixture
def candidate(tmp_path: Path) -> Candidate:
    spec = world({"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(0, 0, 0.1))}, frames=3)
    return make_candidate(tmp_path, spec, tracks={})


def of(reader: Reader, choice: int | None = None, because: str = "", **answers: Answer) -> Review:
    reasons = dict.fromkeys(answers, because) if because else {}
    return Review("d" * 64, reader, "who", answers, choice, None if choice is None else 2, reasons)


def rows(candidate: Candidate, *reviews: Review) -> dict[str, Row]:
    return {r.id: r for r in review_rows(candidate, reviews, ASKED, "reviews/dddd")}


def test_nobody_gives_no_rows(candidate: Candidate) -> None:
    assert rows(candidate) == {}


def test_contradicted_fails_shown_passes_and_not_shown_proves_nothing(candidate: Candidate) -> None:
    found = rows(candidate, of("model", c1="shown", c2="contradicted"))
    assert (found["review:c1"].status, found["review:c1"].mandatory) == ("pass", True)
    assert (found["review:c2"].status, found["review:c2"].mandatory) == ("fail", True)
    assert found["review:c2"].corrections[0].pointers == ("/story",)
    unseen = rows(candidate, of("model", c1="not shown"))["review:c1"]
    assert (unseen.status, unseen.mandatory) == ("unverified", False)


def test_a_row_names_the_reader_what_it_said_and_of_which_digest(candidate: Candidate) -> None:
    row = rows(candidate, of("model", because="it rises", c2="contradicted"))["review:c2"]
    assert row.evidence["reader"] == "model"
    assert row.evidence["digest"] == "d" * 64
    assert row.evidence["because"] == "it rises"
    assert row.evidence["explanation"] == "model 'who' finds 'falls' contradicted: it rises"
    assert (row.check, row.group, row.artifact) == ("review", "observational", "reviews/dddd")


def test_a_person_overrules_a_model_and_that_is_printed(candidate: Candidate) -> None:
    row = rows(candidate, of("model", because="it rises", c2="contradicted"), of("person", c2="shown"))["review:c2"]
    assert row.status == "pass"
    assert row.evidence["overruled"]["because"] == "it rises"
    assert "overrules model 'who', who found it contradicted" in row.evidence["explanation"]


@pytest.mark.parametrize(
    ("choices", "status", "mandatory"),
    [
        ([("model", 2)], "pass", True),
        ([("model", 5)], "fail", True),
        ([("model", 0)], "unverified", False),
        ([("model", 5), ("person", 2)], "pass", True),
        ([("model", 2), ("model", 5)], "fail", True),
        ([("client", 5), ("model", 2)], "pass", True),
    ],
)
def test_the_choice_of_another_prompt_fails_and_of_none_proves_nothing(
    candidate: Candidate, choices: list[tuple[Reader, int]], status: str, mandatory: bool
) -> None:
    row = rows(candidate, *(of(reader, choice=number, c1="shown") for reader, number in choices))["review"]
    assert (row.status, row.mandatory) == (status, mandatory)


def test_acceptance_does_not_wait_for_a_reader() -> None:
    assert "review" not in NEEDED
