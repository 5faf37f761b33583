"""Tasks (extension `io.modelcontextprotocol/tasks`, SEP-2663): long tool calls as handles that the client polls.

A task is a job of the one job engine and its id is the job's id, so a task can be asked for from another connection and
after a restart of the server. Only calls whose job does not end within a moment become tasks, and only where the client
declared the extension in the request; every other client waits, sees progress, and looks after jobs with the tool `job`.

References:
    https://modelcontextprotocol.io/seps/2663-tasks-extension
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Mapping, Sequence
from contextvars import ContextVar
from datetime import UTC, datetime
from typing import Any, Final

import anyio.to_thread
from mcp.server.context import CallNext, HandlerResult, ServerRequestContext
from mcp.server.extension import Extension, MethodBinding
from mcp.server.mcpserver.server import require_client_extension
from mcp.shared.exceptions import MCPError
from mcp.shared.inbound import MCP_NAME_HEADER, decode_header_value
from mcp.types import CallToolRequestParams, CallToolResult, RequestParams
from mcp_types import HEADER_MISMATCH, INVALID_PARAMS
from pydantic import ConfigDict
from pydantic.alias_generators import to_camel

from ...execution import Job, JobStore
from ...execution.pruning import SPARED_S
from ...workflow.context import Handover, ToolBinding
from ...worlds.errors import InputError
from ...worlds.quoting import visible
from ..calls import result_of_reply
from .inputs import give_answers, open_questions

__all__ = ["HANDOVER", "TASKS", "Tasks"]

TASKS: Final = "io.modelcontextprotocol/tasks"
MODERN: Final = frozenset({"2026-07-28"})
"""Protocol versions that know extensions of results."""
POLL_MS = 1000
STATUS_CHARACTERS = 2000
HANDOVER: ContextVar[Handover | None] = ContextVar("HANDOVER", default=None)
"""Set while a tool runs whose client takes a running job as a task."""


class TaskParams(RequestParams):
    """Names a task."""

    model_config = ConfigDict(alias_generator=to_camel, populate_by_name=True)

    task_id: str


class UpdateParams(TaskParams):
    """Answers to what a task asked."""

    input_responses: dict[str, Any]


class Tasks(Extension):
    """Answers slow tools with tasks, and looks after them."""

    identifier = TASKS

    def __init__(self, jobs: Callable[[], JobStore], tools: Sequence[ToolBinding], *, required: Collection[str] = ()) -> None:
        """
        Args:
            jobs: The job store of the workspace.
            tools: Tools whose `jobs` say what a job's end means for its caller.
            required: Tools that can only be called by clients that take tasks; they answer with one at once.
        """
        self._jobs = jobs
        self._slow = frozenset(binding.name for binding in tools if binding.jobs)
        self._required = frozenset(required)
        self._bindings: dict[str, ToolBinding] = {}
        for binding in tools:
            for kind in binding.jobs:
                if kind in self._bindings:
                    raise ValueError(f"jobs of kind {kind!r} belong to {self._bindings[kind].name!r} and {binding.name!r}")
                self._bindings[kind] = binding

    def methods(self) -> Sequence[MethodBinding]:
        """The three methods of the extension."""
        return (
            MethodBinding("tasks/get", TaskParams, self._get, MODERN),
            MethodBinding("tasks/update", UpdateParams, self._update, MODERN),
            MethodBinding("tasks/cancel", TaskParams, self._cancel, MODERN),
        )

    async def intercept_tool_call(
        self, params: CallToolRequestParams, ctx: ServerRequestContext[Any, Any], call_next: CallNext
    ) -> HandlerResult:
        """Run a tool; the job that it handed over, if it did, becomes the answer."""
        if params.name in self._required:
            require_client_extension(ctx, TASKS)
        elif params.name not in self._slow or not _declared(ctx):
            return await call_next(ctx)
        handover = Handover(patience_s=0.0) if params.name in self._required else Handover()
        token = HANDOVER.set(handover)
        try:
            result = await call_next(ctx)
        finally:
            HANDOVER.reset(token)
        if handover.job_id is None:
            return result
        return {"resultType": "task", **await anyio.to_thread.run_sync(self._created, handover.job_id)}

    async def check_listening(self, ctx: ServerRequestContext[Any, Any], call_next: CallNext) -> HandlerResult:
        """Server middleware: who asks for news of tasks must have declared the extension. None are sent: clients poll."""
        notifications = (ctx.params or {}).get("notifications") if ctx.method == "subscriptions/listen" else None
        if isinstance(notifications, Mapping) and notifications.get("taskIds"):
            require_client_extension(ctx, TASKS)
        return await call_next(ctx)

    async def _get(self, ctx: ServerRequestContext[Any, Any], params: TaskParams) -> HandlerResult:
        _check(ctx, params)
        return await anyio.to_thread.run_sync(self._detailed, params.task_id)

    async def _update(self, ctx: ServerRequestContext[Any, Any], params: UpdateParams) -> HandlerResult:
        _check(ctx, params)

        def work() -> None:
            give_answers(self._jobs().workspace, self._job(params.task_id).id, params.input_responses)

        await anyio.to_thread.run_sync(work)
        return {}

    async def _cancel(self, ctx: ServerRequestContext[Any, Any], params: TaskParams) -> HandlerResult:
        _check(ctx, params)

        def work() -> None:
            self._jobs().request_cancel(self._job(params.task_id).id)

        await anyio.to_thread.run_sync(work)
        return {}

    def _job(self, task_id: str) -> Job:
        """The job of a task.

        Raises:
            MCPError: There is none.
        """
        try:
            job = self._jobs().get(task_id)
        except InputError as error:
            raise MCPError(INVALID_PARAMS, f"unknown task: {error}") from error
        if job.kind not in self._bindings:
            raise MCPError(INVALID_PARAMS, f"unknown task: job {task_id!r} of kind {job.kind!r} was not started by a tool")
        return job

    def _created(self, task_id: str) -> dict[str, Any]:
        return _task(self._job(task_id), "working", self._jobs())

    def _detailed(self, task_id: str) -> dict[str, Any]:
        job, store = self._job(task_id), self._jobs()
        if job.state == "cancelled":
            return _task(job, "cancelled", store)
        if not job.ended:
            questions = open_questions(store.workspace, job.id)
            asks = {"inputRequests": questions} if questions else {}
            return _task(job, "input_required" if asks else "working", store) | asks
        binding = self._bindings[job.kind]
        try:
            result = result_of_reply(binding, lambda: binding.jobs[job.kind](job))
        except MCPError as error:
            described = error.error.model_dump(mode="json", exclude_none=True)
            return _task(job, "failed", store) | {"statusMessage": described["message"], "error": described}
        return _task(job, "completed", store) | {"result": _plain(result)}


def _declared(ctx: ServerRequestContext[Any, Any]) -> bool:
    """True if this request's client takes tasks."""
    capabilities = ctx.session.client_capabilities
    return ctx.protocol_version in MODERN and TASKS in ((capabilities and capabilities.extensions) or {})


def _check(ctx: ServerRequestContext[Any, Any], params: TaskParams) -> None:
    """Refuse a client that did not declare the extension, and an HTTP header that names another task.

    Raises:
        MCPError: -32021 or -32020.
    """
    require_client_extension(ctx, TASKS)
    headers: Mapping[str, str] | None = getattr(ctx.request, "headers", None)
    if headers is None:
        return
    named = decode_header_value(headers.get(MCP_NAME_HEADER))
    if named != params.task_id:
        raise MCPError(HEADER_MISMATCH, f"header Mcp-Name must name the task of the body, {params.task_id!r}; it is {named!r}")


def _task(job: Job, status: str, store: JobStore) -> dict[str, Any]:
    """The fields that every answer about a task has. An ended job is kept for an hour at least, a running one for good."""
    task: dict[str, Any] = {
        "taskId": job.id,
        "status": status,
        "createdAt": _iso(job.created),
        "lastUpdatedAt": _iso(max(t for t in (job.created, job.started, job.heartbeat, job.finished) if t is not None)),
        "ttlMs": round(1000 * ((job.finished or time.time()) - job.created + SPARED_S)),
        "pollIntervalMs": POLL_MS,
    }
    message = visible(_message(job, store)[:STATUS_CHARACTERS])
    return task | {"statusMessage": message} if message else task


def _message(job: Job, store: JobStore) -> str:
    """Status of a running task for the user: how far it is, what it does, how long it will take."""
    from ...workflow.waiting import progress_text

    if job.ended:
        return job.error["message"] if job.error else ""
    part = f"{min(1.0, job.progress_done / job.progress_total):.0%}, " if job.progress_total else ""
    return f"{part}{progress_text(job, store) or job.state}"


def _iso(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")


def _plain(result: CallToolResult) -> dict[str, Any]:
    return result.model_dump(mode="json", by_alias=True, exclude_none=True)
