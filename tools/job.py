"""Tool job: look after long work."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ..worlds.errors import InputError
from .context import ToolContext, ToolReply

__all__ = ["job"]


def job(
    context: ToolContext,
    action: Annotated[Literal["status", "wait", "cancel", "list"], Field(description="What to do")],
    job_id: Annotated[str | None, Field(description="For status, wait and cancel")] = None,
    world: Annotated[str | None, Field(description="For list: only jobs of this world")] = None,
    wait_s: Annotated[float, Field(ge=0, le=240, description="For wait: seconds before answering anyway")] = 30.0,
) -> ToolReply:
    """Ask about, wait for, cancel or list the jobs that probe_sim, bake_sim, run_checks and render_shot started.

    Jobs live on when the client goes away. wait answers when the job ends or after wait_s; then call it again. A done
    job's result is what the tool would have returned. Cancel takes effect within 2 s; a cancelled bake can be resumed.
    """
    import time

    from ..execution import result_of
    from .waiting import job_data

    if action == "list":
        return ToolReply({"jobs": [job_data(j) for j in context.jobs.list(world, limit=20)]})
    if job_id is None:
        raise InputError(f"action {action!r} needs job_id; job(action='list') shows them")
    if action == "cancel":
        context.jobs.request_cancel(job_id)
        return ToolReply(job_data(context.jobs.wait(job_id, 3.0)))
    found = context.jobs.get(job_id)
    deadline = time.monotonic() + (wait_s if action == "wait" else 0.0)
    while not found.ended and time.monotonic() < deadline and not context.cancelled():
        found = context.jobs.wait(job_id, min(0.5, max(0.0, deadline - time.monotonic())))
        context.progress(found.progress_done, found.progress_total, found.message or found.state)
    data = job_data(found)
    if found.state == "done":
        data["result"] = result_of(found)
    return ToolReply(data)
