"""Start a job and answer within the client's patience: with its result, or with its id and progress."""

from __future__ import annotations

import time
from typing import Any

from ..execution import Job, result_of
from ..worlds.limits import CAPS
from .context import ToolContext
from .session import Session

__all__ = ["ended_data", "job_data", "start_and_wait"]

POLL_SECONDS = 0.5
MOST_JOBS = 1000


def job_data(job: Job) -> dict[str, Any]:
    """A job for the model."""
    total = job.progress_total or 0.0
    data: dict[str, Any] = {
        "job_id": job.id,
        "kind": job.kind,
        "world": job.world,
        "state": job.state,
        "progress": 1.0 if job.state == "done" else round(job.progress_done / total, 3) if total else None,
        "message": "" if job.state == "done" else job.message,
        "seconds": round((job.finished or time.time()) - job.started, 1) if job.started else 0.0,
    }
    if job.error:
        data["error"] = job.error
    return data


def ended_data(job: Job) -> dict[str, Any]:
    """What `start_and_wait` returns for a job that has ended.

    Raises:
        WorldAgentError: The job failed with it, or was cancelled.
    """
    return {"job_id": job.id, **result_of(job)}


def _turn(context: ToolContext, session: Session, kind: str, key: str, *, reuse: bool) -> str:
    """The key of the latest such job where it counts, else the next free one."""
    jobs = context.jobs.list(session.folder.id, limit=MOST_JOBS)
    same = [j for j in jobs if j.kind == kind and j.key is not None and j.key.rpartition("#")[0] == key]
    if not same:
        return f"{key}#1"
    latest = max(same, key=lambda j: int(str(j.key).rpartition("#")[2]))
    done = latest.state == "done" and not reuse
    return f"{key}#{int(str(latest.key).rpartition('#')[2]) + done}"


def start_and_wait(
    context: ToolContext,
    session: Session,
    kind: str,
    payload: dict[str, Any],
    *,
    wait_s: float,
    key: str,
    reuse: bool = True,
) -> dict[str, Any]:
    """Submit `worldagent.tools.jobs:<kind>` and wait at most `wait_s` seconds.

    A running job of the same key is joined; the result of a done one is given again only with `reuse`.

    Returns the result (with `job_id`), or the job's state when it takes longer. The job goes on either way.

    Raises:
        WorldAgentError: the job failed with it.
    """
    job = context.jobs.submit(
        kind,
        session.folder.id,
        {"folder": str(session.folder.root), **payload},
        entry=f"worldagent.tools.jobs:{kind}",
        # The stamp tells a world from an earlier one of the same name whose jobs the workspace still remembers.
        key=_turn(context, session, kind, f"{key}:{session.stamp()}", reuse=reuse),
        exclusive=True,
        wall_s=CAPS["job_seconds"].value,
        memory_bytes=CAPS["job_memory_bytes"].value,
    )
    if context.handover is not None:
        wait_s = min(wait_s, context.handover.patience_s)
    deadline = time.monotonic() + wait_s
    while not job.ended and time.monotonic() < deadline and not context.cancelled():
        job = context.jobs.wait(job.id, min(POLL_SECONDS, max(0.0, deadline - time.monotonic())))
        context.progress(job.progress_done, job.progress_total, job.message or f"{kind}: {job.state}")
    if not job.ended:
        if context.handover is not None:
            context.handover.job_id = job.id
        return {**job_data(job), "next": f"job(action='wait', job_id='{job.id}') until it is done"}
    return ended_data(job)
