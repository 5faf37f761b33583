"""Making of rows: the id names question and subject, numbers that are not finite never pass, and a failing row names things by itself."""

from __future__ import annotations

from pathlib import Path

import pytest
from worldagent.tests.verifiers.categories.test_category import falling
from worldagent.verifiers.checks import run_checks
from worldagent.verifiers.rows.answers import row_of
from worldagent.verifiers.rows.corrections import correction
from worldagent.verifiers.rows.findings import Finding, cache_of, judged
from worldagent.verifiers.rows.questions import GROUP_OF, Question
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import EvidenceError
from worldagent.worlds.requirements import Row, Status

ROPE = Question("support:rope", "p", subject=("entity", "end"))
LAMP = ("lamp", "0")


@pytest.fixture
def world(tmp_path: Path) -> Candidate:
    return falling(tmp_path)


def test_a_question_knows_check_and_ids() -> None:
    assert (ROPE.row_id(LAMP), ROPE.check, ROPE.group) == ("support:rope:lamp:0", "support", "spatial")
    assert ROPE.pattern == "support:rope:<entity>:<end>"
    assert [Question(q, "p").check for q in ("requirement", "probe:phases", "beat:driven")] == ["beat", "beat", "beat"]


def test_every_row_of_a_world_names_its_question_and_subject(world: Candidate) -> None:
    rows = run_checks(world, reruns=False)
    assert len(rows) > 20
    assert all(r.question and r.id.startswith(r.question.partition(":")[0]) for r in rows if r.check != "audit")
    assert all(set(r.id.split(":")) == {*r.question.split(":"), *r.subject} for r in rows if r.check != "audit")
    assert {r.group for r in rows if r.id.startswith(("support:", "scale:"))} == {"spatial"}


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_pass_that_measured_no_number_fails_and_names_it(world: Candidate, value: float) -> None:
    row = row_of(world, ROPE, LAMP, Finding("pass", "e", value, 1.0))
    assert (row.status, row.measured, row.evidence["non_finite"]) == ("fail", None, str(value))
    assert row_of(world, ROPE, LAMP, Finding("unverified", "e", value)).status == "unverified"


def test_a_failing_row_names_its_first_entity_and_a_spatial_one_its_first_frame(world: Candidate) -> None:
    def made(question: str, status: Status) -> Row:
        found = Finding(status, "e", entities=("a", "b"), frames=(2, 5))
        return row_of(world, Question(question, "p"), ("a",), found)

    assert (made("support", "fail").first_failing_entity, made("support", "fail").first_failing_frame) == ("a", 2)
    assert (made("category:x", "fail").first_failing_entity, made("category:x", "fail").first_failing_frame) == ("a", None)
    assert (made("support", "pass").first_failing_entity, made("support", "pass").first_failing_frame) == (None, None)
    assert set(GROUP_OF) == {"terrain", "scale", "interpenetration", "support", "navigability", "relations", "category", "numerical",
                             "contact", "beat", "causal", "claim", "review", "robustness", "shots", "delivery"}  # fmt: skip


def test_corrections_stand_beside_what_is_open_alone(world: Candidate) -> None:
    hint = correction("why", "step", "halve the step")
    statuses: tuple[Status, ...] = ("pass", "fail", "unverified", "not_applicable")
    kept = {s: row_of(world, ROPE, LAMP, Finding(s, "t", hints=(hint,))).corrections for s in statuses}
    assert {s for s, found in kept.items() if found} == {"fail", "unverified"}


def test_a_judge_without_evidence_is_unverified_and_other_errors_surface(world: Candidate) -> None:
    def lacking() -> Finding:
        raise EvidenceError("no channel")

    assert judged(lacking) == Finding("unverified", "no evidence: no channel", evidence={"missing": "no channel"})
    assert judged(lambda: Finding("pass", str(cache_of(world, "nobody")))).status == "unverified"
    with pytest.raises(ZeroDivisionError):
        judged(lambda: Finding("pass", "t", 1 / 0))
