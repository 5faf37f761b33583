"""Failing rows carry the diagnosis of the skills; passing ones are left alone."""

from __future__ import annotations

from worldagent.verifiers.diagnosis import diagnose
from worldagent.worlds.groups import GROUPS
from worldagent.worlds.requirements import Row


def _row(row_id: str, status: str) -> Row:
    return Row.model_validate(
        {"id": row_id, "check": "contact", "group": "physical", "predicate": "p", "status": status, "artifact": "a"}
    )


def test_a_failing_row_gains_ranked_causes_that_cite_their_skill() -> None:
    row = diagnose(_row("contact:ball:floor", "fail"))
    assert row.corrections
    assert all(c.skill.startswith("skill://rigid-bodies/diagnosis.json#") for c in row.corrections)
    assert all(GROUPS[c.group].edit_class == c.edit_class for c in row.corrections)
    assert row.evidence["diagnosis"]["cheapest_probe"]


def test_a_passing_row_is_left_alone() -> None:
    row = _row("contact:ball:floor", "pass")
    assert diagnose(row) is row


def test_an_unknown_row_is_left_alone() -> None:
    row = _row("elsewhere:x", "fail")
    assert diagnose(row) is row
