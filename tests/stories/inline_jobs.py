"""Jobs that run within the call that submits them: the same entries, rows and answers, without a process each."""

from __future__ import annotations

import json
import os
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest
from worldagent.execution import Cancelled, Job, run_inline
from worldagent.execution.queue import claim
from worldagent.execution.table import JobTable
from worldagent.verifiers import acceptance
from worldagent.worlds.errors import WorldAgentError

__all__ = ["run_jobs_inline"]


def _pump(table: JobTable, *, slots: int | None = None) -> int:
    done = 0
    while claimed := claim(table, slots or 1):
        for job_id in claimed:
            table.register(job_id, os.getpid())
            job, done = table.read(job_id), done + 1
            try:
                result = run_inline(job.entry, json.loads(job.payload) if isinstance(job.payload, str) else job.payload)
            except Cancelled:
                table.finish(job_id, os.getpid(), "cancelled")
            except WorldAgentError as error:
                table.finish(job_id, os.getpid(), "failed", error={"type": type(error).__name__, "message": str(error)})
            else:
                table.finish(job_id, os.getpid(), "done", result=json.dumps(result))
    return done


def _start(table: JobTable, job: Job, *, slots: int | None = None) -> Job:
    _pump(table, slots=slots)
    return table.read(job.id)


def _judge(root: Path, *, waiting: None = None, **options: Any) -> dict[str, Any]:
    """The verdict of this process; JSON forth and back as between processes."""
    found: dict[str, Any] = json.loads(json.dumps(acceptance.judge(root, **options)))
    return found


def run_jobs_inline(monkeypatch: pytest.MonkeyPatch) -> None:
    """Run jobs and the acceptance process of all servers of this process within the call."""
    monkeypatch.setattr("worldagent.execution.jobs.pump", _pump)
    monkeypatch.setattr("worldagent.execution.jobs.start", _start)
    monkeypatch.setattr("worldagent.verifiers.acceptance.judge_fresh", _judge)
    monkeypatch.setattr("worldagent.verifiers.acceptance.WaitingJudge", nullcontext)
