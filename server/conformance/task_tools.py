"""Fixtures of the tasks scenarios, on the real job engine and the real tool path.

`worldagent.server.extensions.tasks` treats them as it treats `bake_sim`: jobs in worker processes, replies made from jobs
that have ended.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Annotated, Any

from mcp.shared.exceptions import MCPError
from pydantic import Field

from ...execution import Job, result_of
from ...workflow.context import ToolBinding, ToolContext, ToolReply

__all__ = ["FIXTURE_TOOLS", "REQUIRE_TASKS"]

_MODULE = __package__ + ".jobs"


def _start(
    context: ToolContext, kind: str, entry: str, payload: Mapping[str, Any], reply: Callable[[Job], ToolReply]
) -> ToolReply:
    """Run a fixture's job, and answer with its end or hand it over."""
    job = context.jobs.submit(kind, None, dict(payload), entry=f"{_MODULE}:{entry}")
    deadline = None if context.handover is None else time.monotonic() + context.handover.patience_s
    while not job.ended and not context.cancelled() and (deadline is None or time.monotonic() < deadline):
        job = context.jobs.wait(job.id, 0.25)
    if job.ended:
        return reply(job)
    if context.handover is not None:
        context.handover.job_id = job.id
    return ToolReply({"job_id": job.id})


def job_reply(job: Job) -> ToolReply:
    """Reply with the result of a fixture's job."""
    return ToolReply(result_of(job))


def protocol_reply(job: Job) -> ToolReply:
    """Raise the protocol error that a job returned."""
    found = result_of(job)
    raise MCPError(int(found["code"]), str(found["message"]))


def slow_compute(
    context: ToolContext,
    seconds: Annotated[float, Field(ge=0, le=120, description="How long to take [s]")] = 1.0,
    label: Annotated[str, Field(description="Shown in the progress")] = "slow_compute",
) -> ToolReply:
    """Conformance fixture: take some seconds in a job."""
    return _start(context, "fixture_slow_compute", "sleep", {"seconds": seconds, "label": label}, job_reply)


def failing_job(context: ToolContext) -> ToolReply:
    """Conformance fixture: a job that ends with an error of the tool."""
    return _start(context, "fixture_failing_job", "fail", {}, job_reply)


def protocol_error_job(context: ToolContext) -> ToolReply:
    """Conformance fixture: a job that ends with an error of the protocol."""
    return _start(context, "fixture_protocol_error_job", "break_protocol", {}, protocol_reply)


def confirm_delete(
    context: ToolContext, filename: Annotated[str, Field(description="What would be deleted")] = "nothing.txt"
) -> ToolReply:
    """Conformance fixture: a job that asks one question."""
    return _start(context, "fixture_confirm_delete", "confirm", {"filename": filename}, job_reply)


def multi_input(context: ToolContext) -> ToolReply:
    """Conformance fixture: a job that asks two questions at a time."""
    return _start(context, "fixture_multi_input", "multiply", {}, job_reply)


def greet_later(context: ToolContext, name: Annotated[str, Field(description="Whom to greet")]) -> ToolReply:
    """Conformance fixture: greet in a job; `test_tool_with_task` calls it once it knows the name."""
    return _start(context, "fixture_greet_later", "greet_later", {"name": name}, job_reply)


FIXTURE_TOOLS = (
    ToolBinding(slow_compute, "Fixture: slow", read_only=True, jobs={"fixture_slow_compute": job_reply}),
    ToolBinding(failing_job, "Fixture: fails", read_only=True, jobs={"fixture_failing_job": job_reply}),
    ToolBinding(protocol_error_job, "Fixture: breaks", read_only=True, jobs={"fixture_protocol_error_job": protocol_reply}),
    ToolBinding(confirm_delete, "Fixture: asks", read_only=True, jobs={"fixture_confirm_delete": job_reply}),
    ToolBinding(multi_input, "Fixture: asks twice", read_only=True, jobs={"fixture_multi_input": job_reply}),
    ToolBinding(greet_later, "Fixture: greets later", read_only=True, jobs={"fixture_greet_later": job_reply}),
)
REQUIRE_TASKS = ("failing_job", "protocol_error_job", "confirm_delete", "multi_input", "greet_later", "test_tool_with_task")
"""Fixtures that no client without tasks can call."""
