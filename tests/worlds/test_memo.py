"""Values that are worked out once per candidate."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from worldagent.tests.verifiers.categories.test_category import falling


def test_a_value_is_made_once_per_candidate_and_key(tmp_path: Path) -> None:
    candidate = falling(tmp_path)
    made: list[str] = []

    def make() -> list[str]:
        made.append("made")
        return made

    assert candidate.memo("one", make) is candidate.memo("one", make)
    assert made == ["made"]
    candidate.memo(("one", "two"), make)
    changed = dataclasses.replace(candidate, stage="probe")
    changed.memo("one", make)
    assert made == ["made"] * 3
