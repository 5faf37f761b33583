"""Jobs of a sample that has ended: a job outlives its server, and would take the cores of the next sample."""

from __future__ import annotations

from pathlib import Path

from ...execution import JobStore

__all__ = ["cancel_jobs"]

PATIENCE_S = 15.0
"""Longest wait for a cancelled job to end [s]; its process group is killed after two."""


def cancel_jobs(workspace: Path) -> list[str]:
    """Cancel whatever is queued or runs in a workspace, and wait for its end; ids of the jobs."""
    if not (workspace / ".worldagent" / "jobs.db").is_file():
        return []
    store = JobStore(workspace)
    # Those that wait go first, so that none of them takes the place of one that was ended.
    waiting = [job.id for job in store.list(state="queued", limit=1000, pump=False)]
    running = [job.id for job in store.list(state="running", limit=1000, pump=False)]
    for job_id in (*waiting, *running):
        store.request_cancel(job_id)
    for job_id in running:
        store.wait(job_id, PATIENCE_S)
    return [*waiting, *running]
