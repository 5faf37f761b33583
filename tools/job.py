"""Tool job: look after long work."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from ..worlds.errors import InputError
from .context import ToolContext, ToolReply

if TYPE_CHECKING:
    from ..execution import Job

__all__ = ["job"]

MOST_LISTED = 20


def job(
    context: ToolContext,
    action: Annotated[Literal["status", "wait", "cancel", "list"], Field(description="What to do")],
    job_id: Annotated[str | None, Field(description="For status, wait and cancel")] = None,
    world: Annotated[str | None, Field(description="For list: only jobs of this world")] = None,
    wait_s: Annotated[float, Field(ge=0, le=240, description="For wait: seconds before answering anyway")] = 30.0,
) -> ToolReply:
    """Ask about, wait for, cancel or list the jobs that probe_sim, bake_sim, run_checks and render_shot started.

    Use wait with the job_id of a reply that was not finished; it answers when the job ends or after wait_s, then call it again.
    Jobs live on when the client goes away. A done job's `result` is what the tool would have returned. cancel takes effect
    within 2 s; the same tool call resumes a cancelled bake or film. Returns: state (queued, running, done, failed,
    cancelled, lost), progress 0 to 1, seconds so far, what it is doing and how long it still takes.
    Not for: starting work. Next: the reply's `next`.
    """
    import time

    from .answers import answer, call, paged
    from .waiting import job_data

    if action == "list":
        listed = [job_data(j) for j in context.jobs.list(world, limit=MOST_LISTED)]
        page, place = paged(listed, 0, MOST_LISTED)
        running = [j["job_id"] for j in page if j["state"] in ("queued", "running")]
        then = call("job", action="wait", job_id=running[0]) if running else ""
        return ToolReply(answer({"jobs": page, **place}, f"{len(page)} jobs, newest first, {len(running)} not ended", then))
    if job_id is None:
        raise InputError(f"action {action!r} needs job_id; job(action='list') shows them")
    if action == "cancel":
        context.jobs.request_cancel(job_id)
        return _told(context.jobs.wait(job_id, 3.0))
    found = context.jobs.get(job_id)
    deadline = time.monotonic() + (wait_s if action == "wait" else 0.0)
    while not found.ended and time.monotonic() < deadline and not context.cancelled():
        found = context.jobs.wait(job_id, min(0.5, max(0.0, deadline - time.monotonic())))
        context.progress(found.progress_done, found.progress_total, found.message or found.state)
    return _told(found)


def _told(job: Job) -> ToolReply:
    """A job, with the reply of the tool that started it once it is done."""
    from . import TOOLS
    from .answers import answer, job_answer
    from .waiting import job_data

    data = job_data(job)
    if not job.ended:
        return ToolReply(job_answer(data))
    if job.state != "done":
        then = "" if job.state == "failed" else "the same call again starts or resumes the work"
        error = (job.error or {}).get("message", "")
        return ToolReply(answer(data, f"{job.kind} of {job.world}: {job.state}" + (f"; {error}" if error else ""), then))
    reply_of = next((t.jobs[job.kind] for t in TOOLS if job.kind in t.jobs), None)
    if reply_of is None:
        return ToolReply(answer({**data, "result": job.result or {}}, f"{job.kind} of {job.world} is done", ""))
    reply = reply_of(job)
    result = dict(reply.data)
    head = [result.pop(k) for k in ("summary", "next", "warnings")]
    return ToolReply(answer({**data, "result": result}, *head), links=reply.links)
