"""A client that takes tasks gets what every other client gets, only later and by another call."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import partial
from typing import Any, Literal

import anyio
import pytest
from mcp import Client
from mcp.client.extension import ClaimContext, ClientExtension, ResultClaim
from mcp.types import CallToolResult, Request, Result
from pydantic import TypeAdapter
from worldagent.server.app import create_server
from worldagent.server.extensions import tasks
from worldagent.server.extensions.tasks import TASKS
from worldagent.workflow.context import Handover

pytestmark = pytest.mark.anyio


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


class Task(Result):
    result_type: Literal["task"] = "task"
    taskId: str


class AboutTask(Request[dict[str, Any], str]):
    name_param = "taskId"
    method: str
    params: dict[str, Any]


async def finished(session: Any, task_id: str) -> dict[str, Any]:
    """The task, once it has ended."""
    request = AboutTask(method="tasks/get", params={"taskId": task_id})
    while True:
        task = await session.send_request(request, TypeAdapter(dict[str, Any]))
        if task["status"] != "working":
            return dict(task)
        await anyio.sleep(0.1)


class Patient(ClientExtension):
    """Follows tasks to their end, as a client with the extension does."""

    identifier = TASKS

    def __init__(self) -> None:
        self.followed: list[str] = []

    def claims(self) -> Sequence[ResultClaim[Any]]:
        async def resolve(task: Task, context: ClaimContext) -> CallToolResult:
            self.followed.append(task.taskId)
            return CallToolResult.model_validate((await finished(context.session, task.taskId))["result"])

        return (ResultClaim(result_type="task", model=Task, resolve=resolve),)


def comparable(result: Any) -> dict[str, Any]:
    """An answer without what belongs to the call alone."""
    plain: dict[str, Any] = (
        result if isinstance(result, dict) else result.model_dump(mode="json", by_alias=True, exclude_none=True)
    )
    return {key: value for key, value in plain.items() if key != "_meta"}


@pytest.mark.parametrize("step", ["probe", "bake", "accept"])
async def test_the_task_of_an_earlier_call_holds_exactly_its_answer(loop: Any, step: str) -> None:
    """Another server, another connection, long after: the jobs and the world are all that it needs."""
    answer = loop.answers[step]
    async with Client(create_server(loop.workspace), extensions=[Patient()]) as client:
        task = await finished(client.session, answer.structured_content["job_id"])
    assert task["status"] == "completed"
    assert comparable(task["result"]) == comparable(answer)


@pytest.mark.parametrize("step", ["probe", "bake", "accept"])
async def test_the_result_of_a_job_is_the_whole_reply_of_its_tool(loop: Any, step: str) -> None:
    direct = loop.answers[step].structured_content
    async with Client(create_server(loop.workspace)) as client:
        told = await client.call_tool("job", {"action": "wait", "job_id": direct["job_id"]})
    assert told.structured_content is not None, told.content
    assert told.structured_content["result"] == direct
    head = ("summary", "warnings", "next")
    assert set(head) < set(direct)
    assert [told.structured_content[k] for k in head] == [direct[k] for k in head]


async def test_checks_as_a_task_answer_as_they_do_without(accepted: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tasks, "Handover", partial(Handover, patience_s=0.0))  # a warm worker may be done in a moment
    patient = Patient()
    async with Client(create_server(accepted.workspace), extensions=[patient]) as client:
        with anyio.fail_after(120):
            by_task = await client.call_tool("run_checks", {"world": "w", "scope": "full", "only": ["scale"], "wait_s": 240})
    assert len(patient.followed) == 1, "the call becomes a task, however long it would have waited"
    assert by_task.structured_content is not None
    assert by_task.structured_content.pop("job_id") == patient.followed[0]
    directly = accepted.result("run_checks", world="w", scope="full", only=["scale"])
    directly.structured_content.pop("job_id")
    assert by_task.structured_content == directly.structured_content


@pytest.mark.slow
async def test_a_film_as_a_task_comes_with_its_pictures_and_links(accepted: Any) -> None:
    patient = Patient()
    async with Client(create_server(accepted.workspace), extensions=[patient]) as client:
        with anyio.fail_after(300):
            film = await client.call_tool("render_shot", {"world": "w", "kind": "final"})
    assert len(patient.followed) == 1
    assert [block.type for block in film.content] == ["text", "image", "resource_link", "resource_link"]
    again = accepted.result("render_shot", world="w", kind="final")
    note = f"nothing changed since job {patient.followed[0]}: this is its result; nothing was run again"
    first, second = (json.loads(answer.content.pop(0).text) for answer in (film, again))
    assert second.pop("warnings") == [*first.pop("warnings"), note]
    assert first == second
    assert comparable(film) == comparable(again)


async def test_a_refusal_is_no_task(failed: Any) -> None:
    patient = Patient()
    async with Client(create_server(failed.workspace), extensions=[patient]) as client:
        refused = await client.call_tool("bake_sim", {"world": "w"})
    assert refused.is_error
    assert patient.followed == []
    assert "passing probe" in refused.content[0].text
