"""Tool calls through the SDK's in-memory client, in both protocol eras."""

from __future__ import annotations

import json
import logging
import threading
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any

import anyio
import pytest
from mcp import Client
from pydantic import Field
from worldagent.server.app import INSTRUCTIONS, TOOLS_AT_A_TIME, WAITING_AT_A_TIME, create_server
from worldagent.server.calls import Progress
from worldagent.workflow.context import ToolBinding, ToolContext, ToolReply

pytestmark = pytest.mark.anyio


def text(result: Any) -> str:
    return str(result.content[0].text)


async def test_data_tool_returns_the_same_json_as_structure_and_as_one_compact_text(
    tmp_path: Path, fakes: ModuleType, era: str
) -> None:
    async with Client(create_server(tmp_path, tools=fakes.TOOLS), mode=era) as client:
        result = await client.call_tool("measure", {"frames": 24})
    assert not result.is_error
    assert result.structured_content == {"frames": 24, "mode": "fast", "patch": None}
    assert text(result) == '{"frames":24,"mode":"fast","patch":null}'
    assert [block.type for block in result.content] == ["text", "resource_link"]


async def test_schema_is_closed_described_and_annotated(tmp_path: Path, fakes: ModuleType, era: str) -> None:
    async with Client(create_server(tmp_path, tools=fakes.TOOLS), mode=era) as client:
        tools = {tool.name: tool for tool in (await client.list_tools()).tools}
    assert list(tools) == [binding.name for binding in fakes.TOOLS]
    measure = tools["measure"]
    assert measure.input_schema["additionalProperties"] is False
    assert measure.input_schema["required"] == ["frames"]
    assert measure.input_schema["properties"]["frames"] == {
        "type": "integer",
        "minimum": 2,
        "maximum": 240,
        "description": "Number of frames",
    }
    assert "context" not in measure.input_schema["properties"]
    assert measure.output_schema is not None
    assert measure.output_schema["type"] == "object"
    assert measure.annotations is not None
    assert measure.annotations.read_only_hint is True
    assert measure.annotations.idempotent_hint is True
    assert measure.annotations.open_world_hint is False
    assert tools["fail"].annotations is not None
    assert tools["fail"].annotations.destructive_hint is True
    assert tools["show"].output_schema is None


async def test_unknown_argument_is_refused_with_the_closest_name(tmp_path: Path, fakes: ModuleType, era: str) -> None:
    async with Client(create_server(tmp_path, tools=fakes.TOOLS), mode=era) as client:
        result = await client.call_tool("measure", {"frames": 24, "moode": "exact"})
    assert result.is_error
    assert text(result).startswith("invalid: ")
    assert "'moode'" in text(result)
    assert "did you mean 'mode'" in text(result)


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ({"frames": 1}, ("frames = 1", ">= 2", "<= 240")),
        ({"frames": 24, "mode": "slow"}, ("mode = 'slow'", "'fast'", "'exact'")),
        ({}, ("frames is missing", "Number of frames")),
        ({"frames": 24, "patch": [3]}, ("patch.0", "= 3")),
        ({"frames": "many"}, ("frames = 'many'", "integer")),
    ],
)
async def test_bad_argument_names_argument_value_and_range(
    tmp_path: Path, fakes: ModuleType, arguments: dict[str, Any], parts: tuple[str, ...]
) -> None:
    async with Client(create_server(tmp_path, tools=fakes.TOOLS)) as client:
        result = await client.call_tool("measure", arguments)
    assert result.is_error
    assert text(result).startswith("invalid: arguments of measure: ")
    for part in parts:
        assert part in text(result)


@pytest.mark.parametrize(
    ("tool", "arguments", "told"),
    [
        (
            "place_object",
            {"array": {"kind": "scatter", "sizes": [1, 2]}},
            "there is no 'sizes' here; did you mean 'size'? allowed: arc_deg, center",
        ),
        ("place_object", {"array": {"count": 1}}, "array.kind is missing; array.count = 1"),
        ("place_object", {"array": {"kind": "grid", "count": 900}}, "(allowed: integer >= 2 and <= 500)"),
        ("probe_sim", {"sketch": {"until": 3, "coarser": 9}}, "(allowed: number >= 1 and <= 4)"),
        ("edit_spec", {"repairs": [{"row": "a"}, {"rw": 1}]}, "repairs.1.rw: there is no 'rw' here; did you mean 'row'?"),
    ],
)
async def test_what_is_wrong_within_an_argument_is_told_with_what_is_allowed_there(
    tmp_path: Path, tool: str, arguments: dict[str, Any], told: str
) -> None:
    async with Client(create_server(tmp_path)) as client:
        result = await client.call_tool(tool, {"world": "w", **arguments})
    assert result.is_error
    assert told in text(result)


async def test_json_in_a_string_is_read_as_json(tmp_path: Path, fakes: ModuleType) -> None:
    """Some clients send objects and arrays as strings."""
    async with Client(create_server(tmp_path, tools=fakes.TOOLS)) as client:
        result = await client.call_tool("measure", {"frames": 24, "patch": '[{"op": "add"}]'})
    assert result.structured_content is not None
    assert result.structured_content["patch"] == [{"op": "add"}]


async def test_unknown_tool_is_named_with_the_closest_one(tmp_path: Path, fakes: ModuleType) -> None:
    async with Client(create_server(tmp_path, tools=fakes.TOOLS)) as client:
        result = await client.call_tool("mesure", {})
    assert result.is_error
    assert "did you mean 'measure'" in text(result)


@pytest.mark.parametrize(
    ("kind", "start"),
    [
        ("refused", "refused: no passing probe; call probe_sim"),
        ("input", "invalid: step 0.1 s must be <= 0.005 s"),
        ("limit", "over the limit: bodies: estimated 3,000, cap 2,000"),
        ("spec", "invalid: 2 problems\n- /entities/a: no parts\n- /title: missing"),
    ],
)
async def test_errors_for_the_caller_keep_their_text(tmp_path: Path, fakes: ModuleType, era: str, kind: str, start: str) -> None:
    async with Client(create_server(tmp_path, tools=fakes.TOOLS), mode=era) as client:
        result = await client.call_tool("fail", {"kind": kind})
    assert result.is_error
    assert text(result) == start


@pytest.mark.parametrize("kind", ["crash", "exit"])
async def test_a_defect_is_masked_and_logged_under_the_same_number(
    tmp_path: Path, fakes: ModuleType, kind: str, caplog: pytest.LogCaptureFixture
) -> None:
    async with Client(create_server(tmp_path, tools=fakes.TOOLS)) as client:
        with caplog.at_level(logging.ERROR):
            result = await client.call_tool("fail", {"kind": kind})
        assert (await client.call_tool("measure", {"frames": 3})).is_error is False
    assert result.is_error
    assert "secret detail" not in text(result)
    number = text(result).split()[2]
    assert any(number in record.getMessage() and record.exc_info for record in caplog.records)


async def test_nan_and_infinity_become_null(tmp_path: Path, fakes: ModuleType, era: str) -> None:
    async with Client(create_server(tmp_path, tools=fakes.TOOLS), mode=era) as client:
        result = await client.call_tool("diverge", {})
    assert result.structured_content == {"energy": None, "list": [1.0, None], "nested": {"low": None}}
    assert json.loads(text(result)) == result.structured_content


async def test_pictures_come_without_structured_content(tmp_path: Path, fakes: ModuleType, era: str) -> None:
    """Codex and Claude Code drop pictures or texts beside structured content."""
    async with Client(create_server(tmp_path, tools=fakes.TOOLS), mode=era) as client:
        shown = await client.call_tool("show", {})
        plain = await client.call_tool("show", {"with_picture": False})
    assert shown.structured_content is None
    assert [block.type for block in shown.content] == ["text", "image"]
    assert shown.content[1].mime_type == "image/png"
    assert json.loads(text(shown)) == {"mean": 0.5}
    assert plain.structured_content is None
    assert json.loads(text(plain)) == {"mean": 0.5}


async def test_progress_strictly_increases(tmp_path: Path, fakes: ModuleType, era: str) -> None:
    seen: list[tuple[float, str | None]] = []

    async def note(done: float, total: float | None, message: str | None) -> None:
        seen.append((done, message))
        fakes.STATE["go"].set()

    async with Client(create_server(tmp_path, tools=fakes.TOOLS), mode=era) as client:
        result = await client.call_tool("climb", {}, progress_callback=note)
    assert not result.is_error
    values = [done for done, _ in seen]
    assert values == sorted(set(values))
    assert [message for _, message in seen] == ["at 1.0", "at 2.0", "at 2.0", "at 1.5", "at nan", "at 4.0"]
    assert values[-1] == 4.0


async def test_a_last_report_whose_sending_the_end_cuts_off_is_sent(tmp_path: Path) -> None:
    begun, sent = anyio.Event(), []

    async def send(done: float, total: float | None, message: str | None) -> None:
        if not begun.is_set():
            begun.set()
            await anyio.sleep_forever()
        sent.append(message)

    progress = Progress("bake_sim", send)
    async with anyio.create_task_group() as group:
        group.start_soon(progress.forward)
        progress.report(2, 2, "done")
        await begun.wait()
        group.cancel_scope.cancel()
    await progress.finish()
    assert sent == ["done"]


async def test_a_call_that_is_given_up_tells_its_tool_and_leaves_the_server_alive(
    tmp_path: Path, fakes: ModuleType, era: str
) -> None:
    fakes.STATE["started"].clear()
    fakes.STATE["cancelled"].clear()
    async with Client(create_server(tmp_path, tools=fakes.TOOLS), mode=era) as client:
        async with anyio.create_task_group() as group:
            group.start_soon(client.call_tool, "linger", {})
            await anyio.to_thread.run_sync(fakes.STATE["started"].wait, 60)
            assert (await client.call_tool("measure", {"frames": 3})).is_error is False, "the loop is free while a tool runs"
            group.cancel_scope.cancel()
        await anyio.to_thread.run_sync(fakes.STATE["cancelled"].wait, 60)
        assert fakes.STATE["cancelled"].is_set()
        assert (await client.call_tool("measure", {"frames": 3})).is_error is False


async def test_the_workspace_appears_with_the_first_call_that_needs_it(tmp_path: Path, fakes: ModuleType) -> None:
    workspace = tmp_path / "deep" / "workspace"
    async with Client(create_server(workspace, tools=fakes.TOOLS)) as client:
        await client.list_tools()
        assert not workspace.exists()
        result = await client.call_tool("enqueue", {})
    assert result.structured_content == {"jobs": 0, "workspace": str(workspace)}
    assert workspace.is_dir()


async def test_instructions_fit_what_clients_show(tmp_path: Path, fakes: ModuleType, era: str) -> None:
    async with Client(create_server(tmp_path, tools=fakes.TOOLS), mode=era) as client:
        assert client.instructions == INSTRUCTIONS
    assert len(INSTRUCTIONS.encode()) < 2048


async def test_calls_that_wait_leave_threads_for_those_that_do_not(tmp_path: Path) -> None:
    """More calls wait than there are threads for them: a quick one is answered all the same."""
    gone = threading.Event()

    def linger(context: ToolContext, wait_s: Annotated[float, Field(description="Seconds")] = 600.0) -> ToolReply:
        """Wait for a job."""
        gone.wait(wait_s)
        return ToolReply({})

    def glance(context: ToolContext) -> ToolReply:
        """Look."""
        return ToolReply({"seen": True})

    tools = [ToolBinding(linger, "Linger", read_only=True), ToolBinding(glance, "Glance", read_only=True)]
    async with Client(create_server(tmp_path, tools=tools)) as client, anyio.create_task_group() as group:
        for _ in range(WAITING_AT_A_TIME + TOOLS_AT_A_TIME + 4):
            group.start_soon(client.call_tool, "linger", {})
        await anyio.sleep(0.2)
        with anyio.fail_after(60):
            answer = await client.call_tool("glance", {})
        gone.set()
    assert answer.structured_content == {"seen": True}


def test_two_tools_of_one_name_are_a_defect(tmp_path: Path, fakes: ModuleType) -> None:
    with pytest.raises(ValueError, match="measure"):
        create_server(tmp_path, tools=[fakes.TOOLS[0], fakes.TOOLS[0]])


def test_a_tool_without_docstring_is_a_defect(tmp_path: Path) -> None:
    def silent(context: ToolContext) -> ToolReply:
        return ToolReply({})

    with pytest.raises(ValueError, match="docstring"):
        create_server(tmp_path, tools=[ToolBinding(silent, "Silent", read_only=True)])
