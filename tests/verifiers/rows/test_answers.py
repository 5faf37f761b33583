"""Rows from a question, its subject and a finding, and what their corrections patch."""

from __future__ import annotations

from pathlib import Path

import pytest
from worldagent.tests.verifiers.categories.test_category import falling
from worldagent.verifiers.rows.answers import guarded, row_of, rows_of
from worldagent.verifiers.rows.corrections import halve_step, move_by
from worldagent.verifiers.rows.findings import Finding
from worldagent.verifiers.rows.questions import Question
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import EvidenceError
from worldagent.worlds.requirements import Row

GAP = Question("support:gap", "{0} touches {1}", "largest gap", "m", "<=", "limits.contact_gap", ("entity", "entity"))


@pytest.fixture
def world(tmp_path: Path) -> Candidate:
    return falling(tmp_path)


def lacking() -> Finding:
    raise EvidenceError("no channel")


def test_a_row_takes_words_unit_and_comparison_of_its_question(world: Candidate) -> None:
    row = row_of(world, GAP, ("a", "b"), Finding("fail", "far", 0.2, 0.1, entities=("a", "b"), frames=(3, 5)))
    assert (row.id, row.question, row.subject, row.check, row.group) == (
        "support:gap:a:b",
        "support:gap",
        ("a", "b"),
        "support",
        "spatial",
    )
    assert (row.predicate, row.unit, row.comparison) == ("a touches b", "m", "<=")
    assert (row.first_failing_entity, row.first_failing_frame) == ("a", 3)


def test_a_finding_may_state_the_requirement_with_the_numbers_of_its_case(world: Candidate) -> None:
    found = Finding("pass", "near", 0.0, 1.0, "mm", comparison=">=", predicate="a touches b within 1 mm")
    row = row_of(world, GAP, ("a", "b"), found)
    assert (row.predicate, row.unit, row.comparison) == ("a touches b within 1 mm", "mm", ">=")


def test_an_answer_without_a_number_has_neither_unit_nor_comparison(world: Candidate) -> None:
    row = row_of(world, GAP, ("a", "b"), Finding("pass", "a joint holds them"))
    assert (row.unit, row.comparison) == ("", "")


def test_the_order_of_an_id_may_differ_from_question_then_subject(world: Candidate) -> None:
    tight = Question("terrain:tight", "closed", order="terrain:{0}:tight")
    row = row_of(world, tight, ("valley",), Finding("pass", "closed"))
    assert (row.id, row.question, row.subject) == ("terrain:valley:tight", "terrain:tight", ("valley",))


def test_a_row_that_needs_frames_not_there_does_not_pass(world: Candidate) -> None:
    last = world.last_frame
    row = row_of(world, GAP, ("a", "b"), Finding("pass", "near", frames=(0, last), needed=(0, last + 5)))
    assert (row.status, row.frames) == ("unverified", (0, last + 5))


def test_missing_evidence_gives_one_unverified_row_and_other_errors_surface(world: Candidate) -> None:
    row = row_of(world, GAP, ("a", "b"), lacking, entities=("a",))
    assert (row.status, row.evidence["missing"], row.entities) == ("unverified", "no channel", ("a",))

    def make() -> list[Row]:
        return [row_of(world, GAP, ("a", "b"), lacking())]

    assert [r.model_dump() for r in rows_of(world, GAP, ("a", "b"), make, entities=("a",))] == [row.model_dump()]
    scene = guarded(Question("support:scene", "all is held"))(lambda c: [row_of(c, GAP, ("a", "b"), lacking())])(world)
    assert [(r.id, r.status) for r in scene] == [("support:scene", "unverified")]
    with pytest.raises(ZeroDivisionError):
        row_of(world, GAP, ("a", "b"), lambda: Finding("pass", "t", 1 / 0))


def test_a_shorter_step_is_half_and_a_move_adds_to_the_pose(world: Candidate) -> None:
    solver, plan = next(iter(world.spec.simulation.rigid.items()))
    hint = halve_step(world, solver, "too long")
    assert hint.patch[0]["path"] == f"/simulation/solvers/{solver}/settings/step"
    assert hint.patch[0]["value"] == pytest.approx(plan.settings.step / 2)
    held = halve_step(world, solver, "too long", in_force=plan.settings.step / 4)
    assert held.patch[0]["value"] == pytest.approx(plan.settings.step / 8), (
        "of the step in force, which is shorter than the declared one"
    )
    name, entity = next((n, e) for n, e in world.spec.entities.items() if e.motion == "dynamic")
    moved = move_by(world, name, (0.1, 0.0, -0.2), "it floats").patch[0]["value"]["position"]
    assert moved == pytest.approx([a + b for a, b in zip(entity.pose.position, (0.1, 0.0, -0.2), strict=True)], abs=1e-5)
    assert move_by(world, name, None, "it floats").patch == ()
