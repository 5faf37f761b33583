"""Tasks on the job engine: real jobs in worker processes, in memory and over HTTP, across servers."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Literal

import anyio
import pytest
from mcp import Client, MCPError, StdioServerParameters
from mcp.client.extension import ClaimContext, ClientExtension, ResultClaim
from mcp.types import CallToolResult, Request, Result
from pydantic import TypeAdapter
from worldagent.execution import JobStore
from worldagent.server.app import WorldServer, create_server
from worldagent.server.extensions.tasks import TASKS, Tasks
from worldagent.tools import TOOLS
from worldagent.workflow.context import ToolBinding, ToolContext, ToolReply

pytestmark = pytest.mark.anyio

ENTRIES = "worldagent.server.conformance.jobs"
PATIENCE_S = 30.0


class Task(Result):
    """A call that became a task."""

    result_type: Literal["task"] = "task"
    taskId: str
    status: str


class AboutTask(Request[dict[str, Any], str]):
    """A request about a task; the SDK sends its id in the header Mcp-Name."""

    name_param = "taskId"
    method: str
    params: dict[str, Any]


class Polling(ClientExtension):
    """The tasks extension of a client that leaves every task to the test."""

    identifier = TASKS

    def claims(self) -> Sequence[ResultClaim[Any]]:
        async def resolve(task: Task, context: ClaimContext) -> CallToolResult:
            raise AssertionError("tests take tasks as they are")

        return (ResultClaim(result_type="task", model=Task, resolve=resolve),)


def serving(workspace: Path, **options: Any) -> WorldServer:
    return create_server(workspace, conformance=True, **options)


async def call(client: Client, name: str, arguments: dict[str, Any]) -> Any:
    return await client.session.call_tool(name, arguments, allow_claimed=True)


async def about(client: Client, method: str, task_id: str, **params: Any) -> dict[str, Any]:
    request = AboutTask(method=method, params={"taskId": task_id, **params})
    return await client.session.send_request(request, TypeAdapter(dict[str, Any]))


async def until(client: Client, task_id: str, *statuses: str) -> dict[str, Any]:
    with anyio.fail_after(PATIENCE_S):
        while True:
            task = await about(client, "tasks/get", task_id)
            if task["status"] in statuses:
                return task
            await anyio.sleep(0.05)


async def test_a_long_call_becomes_a_task_with_progress_and_the_result_of_the_tool(tmp_path: Path) -> None:
    async with Client(serving(tmp_path), extensions=[Polling()]) as client:
        task = await call(client, "slow_compute", {"seconds": 2, "label": "bake"})
        assert isinstance(task, Task)
        assert task.status == "working"
        with anyio.fail_after(PATIENCE_S):
            while "bake: " not in (seen := await about(client, "tasks/get", task.taskId)).get("statusMessage", ""):
                await anyio.sleep(0.05)
        assert re.fullmatch(r"\d+%, bake: \d\.\d of 2 s(, about \d s left)?", seen["statusMessage"])
        done = await until(client, task.taskId, "completed")
    assert done["taskId"] == task.taskId
    assert done["ttlMs"] > 3_600_000, "kept for an hour after its end"
    assert done["pollIntervalMs"] >= 100
    assert done["createdAt"] < done["lastUpdatedAt"]
    assert done["result"]["structuredContent"] == {"label": "bake", "seconds": 2.0}
    assert json.loads(done["result"]["content"][0]["text"]) == {"label": "bake", "seconds": 2.0}


async def test_a_call_that_ends_within_a_moment_is_answered_directly(tmp_path: Path) -> None:
    """A job that has ended already needs no task."""

    def quick(context: ToolContext) -> ToolReply:
        """Answer at once."""
        return ToolReply({"ok": True})

    binding = ToolBinding(quick, "Quick", read_only=True, jobs={"quick": lambda job: ToolReply({})})
    async with Client(create_server(tmp_path, tools=[binding]), extensions=[Polling()]) as client:
        result = await call(client, "quick", {})
    assert isinstance(result, CallToolResult)
    assert result.structured_content == {"ok": True}


@pytest.mark.parametrize("mode", ["auto", "legacy"])
async def test_clients_without_the_extension_wait_for_the_result(tmp_path: Path, mode: str) -> None:
    async with Client(serving(tmp_path), mode=mode) as client:
        result = await client.call_tool("slow_compute", {"seconds": 1})
    assert result.structured_content == {"label": "slow_compute", "seconds": 1.0}


async def test_the_handshake_era_gets_no_task_whatever_it_declares(tmp_path: Path) -> None:
    async with Client(serving(tmp_path), mode="legacy", extensions=[Polling()]) as client:
        assert isinstance(await call(client, "slow_compute", {"seconds": 1}), CallToolResult)
        with pytest.raises(MCPError) as caught:
            await about(client, "tasks/get", "job_000000000000")
    assert caught.value.code in (-32601, -32602)


async def test_a_task_outlives_its_server_and_its_connection(tmp_path: Path) -> None:
    async with Client(serving(tmp_path), extensions=[Polling()]) as first:
        task = await call(first, "slow_compute", {"seconds": 2})
    async with Client(serving(tmp_path), extensions=[Polling()]) as second:
        done = await until(second, task.taskId, "completed")
    assert done["result"]["structuredContent"]["seconds"] == 2.0


async def test_an_error_of_the_tool_completes_its_task(tmp_path: Path) -> None:
    async with Client(serving(tmp_path), extensions=[Polling()]) as client:
        task = await call(client, "failing_job", {})
        done = await until(client, task.taskId, "completed", "failed")
    assert done["status"] == "completed"
    assert done["result"]["isError"] is True
    assert done["result"]["content"][0]["text"].startswith("refused: this job always fails")


async def test_an_error_of_the_protocol_fails_its_task(tmp_path: Path) -> None:
    async with Client(serving(tmp_path), extensions=[Polling()]) as client:
        task = await call(client, "protocol_error_job", {})
        done = await until(client, task.taskId, "completed", "failed")
    assert done["status"] == "failed"
    assert done["error"]["code"] == -32603
    assert done["statusMessage"] == done["error"]["message"]
    assert "result" not in done


async def test_a_cancelled_task_says_so_and_may_be_cancelled_again(tmp_path: Path) -> None:
    async with Client(serving(tmp_path), extensions=[Polling()]) as client:
        task = await call(client, "slow_compute", {"seconds": 60})
        assert set(await about(client, "tasks/cancel", task.taskId)) <= {"resultType", "_meta"}
        done = await until(client, task.taskId, "cancelled", "completed")
        await about(client, "tasks/cancel", task.taskId)
    assert done["status"] == "cancelled"
    assert "result" not in done


async def test_a_task_asks_and_goes_on_when_it_is_answered_even_by_another_server(tmp_path: Path) -> None:
    async with Client(serving(tmp_path), extensions=[Polling()]) as client:
        task = await call(client, "multi_input", {})
        asked = await until(client, task.taskId, "input_required", "completed")
        first, second = sorted(asked["inputRequests"])
        assert (first.partition("-")[0], second.partition("-")[0]) == ("first", "second")
        assert asked["inputRequests"][first]["method"] == "elicitation/create"
        answer = {"action": "accept", "content": {"name": "Ada"}}
        await about(client, "tasks/update", task.taskId, inputResponses={first: answer, "unknown": {}})
        assert set((await about(client, "tasks/get", task.taskId))["inputRequests"]) == {second}
    async with Client(serving(tmp_path), extensions=[Polling()]) as other:
        answer = {"action": "accept", "content": {"name": "Bob"}}
        await about(other, "tasks/update", task.taskId, inputResponses={second: answer})
        done = await until(other, task.taskId, "completed")
    assert done["result"]["structuredContent"] == {"names": ["Ada", "Bob"]}
    assert not list((tmp_path / ".worldagent" / "inputs").iterdir())


@pytest.mark.parametrize("method", ["tasks/get", "tasks/update", "tasks/cancel"])
async def test_what_is_no_task_is_refused(tmp_path: Path, method: str) -> None:
    params = {"inputResponses": {}} if method == "tasks/update" else {}
    store = JobStore(tmp_path)
    foreign = store.submit("index", None, {"seconds": 0, "label": "x"}, entry=f"{ENTRIES}:sleep")
    async with Client(serving(tmp_path, store=store), extensions=[Polling()]) as client:
        for unknown in ("job_000000000000", "../../etc", foreign.id):
            with pytest.raises(MCPError) as caught:
                await about(client, method, unknown, **params)
            assert caught.value.code == -32602
    async with Client(serving(tmp_path)) as client:
        with pytest.raises(MCPError) as caught:
            await about(client, method, foreign.id, **params)
        assert caught.value.code == -32021
        assert caught.value.data == {"requiredCapabilities": {"extensions": {TASKS: {}}}}


async def test_a_tool_that_needs_tasks_refuses_clients_without_them(tmp_path: Path) -> None:
    async with Client(serving(tmp_path)) as client:
        with pytest.raises(MCPError) as caught:
            await client.call_tool("failing_job", {})
    assert caught.value.code == -32021


async def test_news_of_tasks_are_refused_to_clients_without_tasks_and_promised_to_none(tmp_path: Path) -> None:
    class Listen(Request[dict[str, Any], Literal["subscriptions/listen"]]):
        method: Literal["subscriptions/listen"] = "subscriptions/listen"
        params: dict[str, Any]

    asked = Listen(params={"notifications": {"taskIds": ["job_000000000000"]}})
    async with Client(serving(tmp_path)) as client:
        with pytest.raises(MCPError) as caught:
            await client.session.send_request(asked, TypeAdapter(dict[str, Any]))
    assert caught.value.code == -32021
    async with Client(serving(tmp_path), extensions=[Polling()]) as client:
        with anyio.move_on_after(0.3) as waited:
            await client.session.send_request(asked, TypeAdapter(dict[str, Any]))
    assert waited.cancelled_caught, "the stream is open"


def test_every_job_of_a_tool_belongs_to_one_tool(tmp_path: Path) -> None:
    kinds = [kind for binding in TOOLS for kind in binding.jobs]
    assert sorted(kinds) == [
        "accept",
        "bake",
        "check",
        "final",
        "interior",
        "picture",
        "placing",
        "probe",
        "review",
        "sketch",
        "terrain",
    ]
    twice = ToolBinding(TOOLS[0].function, "Twice", read_only=True, jobs={"bake": lambda job: ToolReply({})})
    with pytest.raises(ValueError, match="bake"):
        Tasks(lambda: JobStore(tmp_path), [*TOOLS, twice])


def test_the_kinds_of_jobs_are_the_entries_of_the_workers() -> None:
    from worldagent.workflow import jobs

    assert {kind for binding in TOOLS for kind in binding.jobs} == set(jobs.__all__) - {
        "require_acceptance",
        "require_true_geometry",
    }


@pytest.fixture(params=["stdio", "http"])
def process(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Any]:
    """A server process with the fixtures: what to give to `Client`."""
    command = [sys.executable, "-m", "worldagent.server", "serve", "--workspace", str(tmp_path), "--conformance"]
    if request.param == "stdio":
        yield StdioServerParameters(command=command[0], args=command[1:])
        return
    with subprocess.Popen([*command, "--transport", "http", "--port", "0"], stderr=subprocess.PIPE, text=True) as child:
        try:
            assert child.stderr is not None
            yield child.stderr.readline().rpartition(" ")[2].strip()
        finally:
            child.terminate()


async def test_tasks_work_over_both_transports(process: Any) -> None:
    with anyio.fail_after(60):
        async with Client(process, extensions=[Polling()]) as client:
            task = await call(client, "slow_compute", {"seconds": 1, "label": "far"})
            assert isinstance(task, Task)
            done = await until(client, task.taskId, "completed")
            assert done["result"]["structuredContent"]["label"] == "far"
            if isinstance(process, str):
                with pytest.raises(MCPError, match="Mcp-Name") as caught:
                    await client.session.send_request(Nameless(params={"taskId": task.taskId}), TypeAdapter(dict[str, Any]))
                assert caught.value.code == -32020


class Nameless(Request[dict[str, Any], Literal["tasks/get"]]):
    """A request without the header that names its task."""

    method: Literal["tasks/get"] = "tasks/get"
    params: dict[str, Any]
