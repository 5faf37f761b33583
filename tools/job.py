"""Tool job: look after long work."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field

from ..workflow.context import ToolContext, ToolReply
from ..worlds.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..execution import Job

__all__ = ["job"]

State = Literal["queued", "running", "done", "failed", "cancelled", "lost"]
CANCEL_S = 3.0
"""A cancel ends a job within 2 s; so long the call waits to see it [s]."""


def job(
    context: ToolContext,
    action: Annotated[Literal["status", "wait", "cancel", "list"], Field(description="What to do")],
    job_id: Annotated[str | None, Field(description="For status, wait and cancel")] = None,
    world: Annotated[str | None, Field(description="For list: only jobs of this world")] = None,
    wait_s: Annotated[
        float,
        Field(ge=0, le=240, description="For wait: seconds before answering anyway; at most 50 unless the server allows more"),
    ] = 30.0,
    states: Annotated[list[State] | None, Field(description="For list: only jobs in these states")] = None,
    limit: Annotated[int, Field(ge=1, le=100, description="For list: jobs at a time, the newest first")] = 20,
    offset: Annotated[int, Field(ge=0, le=100_000, description="For list: how many of the newest to skip")] = 0,
    detail: Annotated[bool, Field(description="Also times, caps, memory and CPU time used, and where the log is")] = False,
) -> ToolReply:
    """Ask about, wait for, cancel or list the jobs that place_object, probe_sim, bake_sim, run_checks and render_shot started.

    Use wait with the job_id of a reply that was not finished; it answers when the job ends or after wait_s, then call it again.
    Jobs live on when the client goes away. A done job's `result` is what the tool would have returned. cancel takes effect
    within 2 s; the same tool call resumes a cancelled or lost bake or film, and `next` names it. Returns: state (queued,
    running, done, failed, cancelled, lost), progress 0 to 1, seconds so far, what it does and about how long it still takes,
    or what it waits for. Not for: starting work. Next: the reply's `next`.
    """
    from ..workflow.waiting import cut_short, follow, patience

    if action == "list":
        return _listed(context, world, states, limit, offset, detail=detail)
    if job_id is None:
        known = ", ".join(f"{j.id} ({j.kind}, {j.state})" for j in context.jobs.list(world, limit=5))
        raise InputError(f"action {action!r} needs job_id; the newest are {known or 'none'}. job(action='list') shows more")
    if action == "cancel":
        context.jobs.request_cancel(job_id)
        return _told(context, context.jobs.wait(job_id, CANCEL_S), detail=detail)
    found = context.jobs.get(job_id)
    waited = action == "wait"
    ended = follow(context, found, patience(wait_s) if waited else 0.0)
    return _told(context, ended, detail=detail, warnings=cut_short(wait_s) if waited else ())


def _listed(
    context: ToolContext, world: str | None, states: list[State] | None, limit: int, offset: int, *, detail: bool
) -> ToolReply:
    from ..workflow.answers import PAGE_CHARACTERS, answer, call, paged
    from ..workflow.waiting import job_data

    total = context.jobs.count(world, states)
    if offset and offset >= total:
        raise InputError(f"offset {offset} is past the end: there are {total} such jobs, so offset is 0 to {max(0, total - 1)}")
    found = [job_data(j, context.jobs, detail=detail) for j in context.jobs.list(world, states, limit=limit, offset=offset)]
    page, _ = paged(found, 0, limit, room=PAGE_CHARACTERS)
    end = offset + len(page)
    data: dict[str, Any] = {"jobs": page, "total": total, **({"next_offset": end} if end < total else {})}
    unended = [j["job_id"] for j in page if j["state"] in ("queued", "running")]
    then = call("job", action="wait", job_id=unended[-1]) if unended else ""
    return ToolReply(answer(data, f"{len(page)} of {total} jobs, newest first, {len(unended)} of them not ended", then))


def _told(context: ToolContext, job: Job, *, detail: bool, warnings: Sequence[str] = ()) -> ToolReply:
    """A job, with the reply of the tool that started it once it is done."""
    from ..workflow.answers import answer, job_answer
    from ..workflow.job_kinds import again
    from ..workflow.waiting import job_data

    data = job_data(job, context.jobs, detail=detail)
    if not job.ended:
        return ToolReply(job_answer({**data, "warnings": list(warnings)}))
    if job.state != "done":
        error = f"; {job.error['message']}" if job.error else ""
        what = again(job)
        keeps = f"; the next call {what.keeps}" if what.keeps else ""
        return ToolReply(answer(data, f"{job.kind} of {job.world}: {job.state}{error}{keeps}", what.call))
    reply_of = context.replies.get(job.kind)
    if reply_of is None:
        return ToolReply(answer({**data, "result": job.result or {}}, f"{job.kind} of {job.world} is done", ""))
    reply = reply_of(job)
    warnings_now = context.heard.without_repeats(job.world or "", reply.data["warnings"])
    result = {**reply.data, "warnings": warnings_now}
    return ToolReply(
        answer({**data, "result": result}, reply.data["summary"], reply.data["next"], warnings_now), links=reply.links
    )
