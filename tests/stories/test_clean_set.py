"""Accepted worlds join the clean set: kept as specifications, built and judged anew."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from worldagent.testing.defects.accepted import adopt, recorded, rejudge, showcases, specifications
from worldagent.tests.slow.test_slices import EXAMPLES, entry_of
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


SHAPED = {
    "stream": "its bridge, log and beams stand where the land that was built has them; taken to acceptance by the slice showcases-stream",
    "volcanic_island": "mended by what the rows say of the land that was built; taken to acceptance by the slice showcases-island",
}
"""Showcases that follow from answers of the server, so that no specification of them is written down, and what judges them instead."""
KEPT_AS = {"domino_run": "domino_run", "first_world": "two_blocks"}
"""Showcases whose world stands in `accepted/`, by its name there."""


def test_every_showcase_is_in_the_clean_set_or_says_why_not() -> None:
    written = {name.removeprefix("examples/") for name, _ in showcases()}
    assert written | SHAPED.keys() | KEPT_AS.keys() == {p.stem for p in EXAMPLES if p.stem != "client_run" and entry_of(p)}
    assert not written & (SHAPED.keys() | KEPT_AS.keys())
    assert set(KEPT_AS.values()) <= set(dict(specifications()))


def test_kept_worlds_are_specifications_of_this_version() -> None:
    assert len(dict(specifications())) >= 5


def test_every_world_that_a_skill_records_is_taken_to_acceptance() -> None:
    assert {name for name, _ in recorded()} == set(JUDGED)


def test_recorded_worlds_and_showcases_of_the_clean_set_pass_the_audit() -> None:
    """As they are judged: with the materials that they name and do not declare."""
    assert len(dict(showcases())) == 5
    for name, spec in (*recorded(), *showcases()):
        report = audit(spec)
        assert report.passed, (name, [r.evidence for r in report.rows if r.status == "fail"])
