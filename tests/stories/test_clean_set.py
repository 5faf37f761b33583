"""Accepted worlds join the clean set: kept as specifications, built and judged anew."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from worldagent.testing.defects.accepted import adopt, recorded, rejudge, showcases, specifications
from worldagent.tests.stories.test_recorded_worlds import JUDGED
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.errors import WorldAgentError
from worldagent.worlds.patch import parse_spec


@pytest.mark.slow
def test_an_accepted_world_is_kept_and_passes_again(copy: Path, tmp_path: Path) -> None:
    path = adopt(copy, tmp_path)
    found = rejudge("again", parse_spec(json.loads(path.read_text())))
    assert found.alarms == ()
    assert {"contact", "causal", "support", "shots"} <= found.checks


def test_a_world_that_is_not_accepted_does_not_join(failed_folder: Path, tmp_path: Path) -> None:
    with pytest.raises(WorldAgentError):
        adopt(failed_folder, tmp_path)


def test_kept_worlds_are_specifications_of_this_version() -> None:
    assert len(dict(specifications())) >= 5


def test_every_world_that_a_skill_records_is_taken_to_acceptance() -> None:
    assert {name for name, _ in recorded()} == set(JUDGED)


def test_recorded_worlds_and_showcases_of_the_clean_set_pass_the_audit() -> None:
    """As they are judged: with the materials that they name and do not declare."""
    assert len(dict(showcases())) == 4
    for name, spec in (*recorded(), *showcases()):
        report = audit(spec)
        assert report.passed, (name, [r.evidence for r in report.rows if r.status == "fail"])
