"""Answers of a judge: what is no answer never becomes a number."""

from __future__ import annotations

import pytest
from worldagent.bench.evaluation.metrics.rubrics import read_scores, rubrics

RUBRICS = rubrics()


@pytest.mark.parametrize(
    ("kind", "answer", "scores"),
    [
        ("causal_beat", '{"completion": 0.5}', {"completion": 0.5}),
        ("causal_link", ' {"link": 1}\n', {"link": 1.0}),
        (
            "shots",
            '```json\n{"motion": 1, "viewpoints": 5, "transitions": 3.0}\n```',
            {"viewpoints": 5.0, "transitions": 3.0, "motion": 1.0},
        ),
        ("composition", "Yes, there is a hut.", {"yes": 1.0}),
        ("composition", "No.", {"yes": 0.0}),
        (
            "production",
            '{"fidelity": 1, "composition": 2, "consistency": 3, "overall": 4}',
            {"fidelity": 1, "composition": 2, "consistency": 3, "overall": 4},
        ),
    ],
)
def test_an_answer_in_the_form_asked_for_gives_its_scores(kind: str, answer: str, scores: dict[str, float]) -> None:
    assert read_scores(getattr(RUBRICS, kind), answer) == scores


@pytest.mark.parametrize(
    ("kind", "answer"),
    [
        *(
            ("causal_beat", a)
            for a in (
                "",
                "1",
                "completion: 1",
                '{"completion": 0.7}',
                '{"completion": "1"}',
                '{"completion": true}',
                '{"completion": NaN}',
            )
        ),
        *(
            ("causal_beat", a)
            for a in (
                '{"completion": 1, "completion": 0}',
                '{"completion": 1, "link": 1}',
                '[{"completion": 1}]',
                '{"completion": null}',
            )
        ),
        ("causal_beat", 'The answer is {"completion": 1}'),
        ("causal_beat", '{"completion": 1}' + " " * 5000 + "x"),
        ("causal_beat", "[" * 3000),
        *(
            ("shots", a)
            for a in (
                '{"viewpoints": 6, "transitions": 5, "motion": 3}',
                '{"viewpoints": 4.5, "transitions": 5, "motion": 3}',
                '{"viewpoints": 4}',
            )
        ),
        ("shots", '{"viewpoints": 0, "transitions": 5, "motion": 3}'),
        *(("composition", a) for a in ("", "maybe", "Yes and no.", "yes yes", "I cannot see the video.", "noyes")),
    ],
)
def test_anything_else_is_no_score(kind: str, answer: str) -> None:
    assert read_scores(getattr(RUBRICS, kind), answer) is None


def test_rubrics_allow_what_the_paper_allows_and_say_whose_they_are() -> None:
    assert RUBRICS.causal_beat.scores == {"completion": (0, 0.5, 1)}
    assert RUBRICS.causal_link.scores == {"link": (0, 0.5, 1)}
    assert [len(r.scores) for r in (RUBRICS.shots, RUBRICS.production)] == [3, 4]
    assert all(values == (1, 2, 3, 4, 5) for r in (RUBRICS.shots, RUBRICS.production) for values in r.scores.values())
    assert "unpublished" in RUBRICS.origin
    assert RUBRICS.composition.ask.startswith(
        "For the following description, judging whether the description contains in the video"
    )  # VBench-2.0


def test_the_digest_of_the_rubrics_depends_on_every_word() -> None:
    other = RUBRICS.model_copy(update={"sampled": RUBRICS.sampled + " "})
    assert other.digest != RUBRICS.digest
