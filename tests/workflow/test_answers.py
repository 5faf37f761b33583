"""First sentences of replies."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.workflow.answers import job_answer

JOB: dict[str, Any] = {"job_id": "job_1", "kind": "probe", "world": "w", "state": "running", "seconds": 3.0, "estimate_s": 6.0}


def test_an_estimate_made_beforehand_is_told_while_nothing_is_measured() -> None:
    assert "all of it was estimated at about 6 s beforehand" in job_answer({**JOB, "progress": None})["summary"]
    part = job_answer({**JOB, "progress": None, "estimate_of": "moving its liquids"})
    assert "moving its liquids was estimated at about 6 s" in part["summary"]


@pytest.mark.parametrize(
    "later", [{"seconds": 30.0, "progress": None}, {"progress": 0.02, "message": "frame 3 (this part: about 5 min more)"}]
)
def test_an_estimate_that_time_or_progress_has_overtaken_is_not_told(later: dict[str, Any]) -> None:
    assert "6 s" not in job_answer({**JOB, **later})["summary"]


def test_where_nothing_is_estimated_nothing_is_said_of_it() -> None:
    told = job_answer({**JOB, "progress": None, "estimate_s": None, "estimate_of": "moving its liquids"})
    assert not {"estimate_s", "estimate_of"} & set(told)
    assert "estimated" not in told["summary"]
    assert job_answer({**JOB, "progress": None})["estimate_s"] == 6.0
