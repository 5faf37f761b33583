"""The catalogue of questions: each is whole, and every recorded row answers one of them."""

from __future__ import annotations

import json
import re
from collections import Counter
from pathlib import Path

import pytest
from worldagent.tests.verifiers.categories.test_category import falling
from worldagent.verifiers.catalogue import QUESTIONS, TABLES
from worldagent.verifiers.checks import run_checks
from worldagent.verifiers.rows.questions import Question

GOLDEN = Path(__file__).parents[1] / "golden"


def _ids() -> list[str]:
    recorded = [json.loads(path.read_text()) for path in sorted(GOLDEN.glob("*.json"))]
    return sorted({row[0] for worlds in recorded for rows in worlds.values() for row in rows})


def _pattern(question: Question) -> re.Pattern[str]:
    return re.compile(re.sub(r"<[^>]*>", "[^:]+", question.pattern))


def test_no_two_questions_have_one_id_or_one_pattern() -> None:
    asked = [question for table in TABLES for question in table.QUESTIONS]
    assert [i for i, n in Counter(q.id for q in asked).items() if n > 1] == []
    assert [p for p, n in Counter(_pattern(q).pattern for q in asked).items() if n > 1] == []


@pytest.mark.parametrize("question", QUESTIONS.values(), ids=lambda q: q.id)
def test_a_question_says_what_is_measured_in_which_unit_against_which_bound(question: Question) -> None:
    assert question.group
    assert question.predicate.format(*question.subject)
    numbers = [question.measures, question.unit, question.comparison, question.bound]
    assert all(numbers) or not any(numbers)


def test_every_recorded_row_answers_a_question_of_the_catalogue() -> None:
    patterns, ids = [_pattern(q) for q in QUESTIONS.values()], _ids()
    assert ids
    assert [i for i in ids if not any(p.fullmatch(i) for p in patterns)] == []


def test_every_row_of_a_run_carries_a_question_of_the_catalogue_and_its_id(tmp_path: Path) -> None:
    rows = run_checks(falling(tmp_path), reruns=False)
    assert len({r.question for r in rows}) > 5
    for row in rows:
        assert row.id == QUESTIONS[row.question].row_id(row.subject)
