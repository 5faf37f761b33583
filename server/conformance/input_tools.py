"""Fixtures that answer with what they still need to know (multi-round-trip requests, SEP-2322)."""

from __future__ import annotations

import json
from typing import Any

from mcp.server import MCPServer
from mcp.server.mcpserver import Context
from mcp.server.mcpserver.prompts.base import UserMessage
from mcp.types import (
    CallToolResult,
    CreateMessageRequest,
    CreateMessageRequestParams,
    CreateMessageResult,
    ElicitRequest,
    ElicitRequestFormParams,
    ElicitResult,
    InputRequiredResult,
    ListRootsRequest,
    ListRootsResult,
    SamplingMessage,
    TextContent,
)

__all__ = ["add_input_tools"]


def add_input_tools(server: MCPServer[Any]) -> None:
    """Register them."""
    _add_single(server)
    _add_stateful(server)
    _add_composed(server)


def _form(message: str, field: str, kind: str = "string") -> ElicitRequest:
    schema = {"type": "object", "properties": {field: {"type": kind}}, "required": [field]}
    return ElicitRequest(params=ElicitRequestFormParams(message=message, requested_schema=schema))


def _question(text: str) -> CreateMessageRequest:
    message = SamplingMessage(role="user", content=TextContent(type="text", text=text))
    return CreateMessageRequest(params=CreateMessageRequestParams(messages=[message], max_tokens=100))


def _answer(ctx: Context[Any, Any], key: str, kind: type[Any]) -> Any:
    """The client's answer to one question, if it has given one of this kind."""
    found = (ctx.input_responses or {}).get(key)
    return found if isinstance(found, kind) else None


def _accepted(ctx: Context[Any, Any], key: str) -> dict[str, Any] | None:
    """Content that the user filled in, if they did."""
    found = _answer(ctx, key, ElicitResult)
    return dict(found.content or {}) if found is not None and found.action == "accept" else None


def _text(text: str) -> CallToolResult:
    return CallToolResult(content=[TextContent(type="text", text=text)])


def _add_single(server: MCPServer[Any]) -> None:
    @server.tool(structured_output=False)
    def test_input_required_result_elicitation(ctx: Context[Any, Any]) -> CallToolResult | InputRequiredResult:
        """Conformance fixture: asks for a name."""
        given = _accepted(ctx, "user_name")
        if given is None or "name" not in given:
            return InputRequiredResult(input_requests={"user_name": _form("What is your name?", "name")})
        return _text(f"Hello, {given['name']}!")

    @server.tool(structured_output=False)
    def test_input_required_result_sampling(ctx: Context[Any, Any]) -> CallToolResult | InputRequiredResult:
        """Conformance fixture: asks the client's model."""
        given = _answer(ctx, "capital_question", CreateMessageResult)
        if given is None:
            return InputRequiredResult(input_requests={"capital_question": _question("What is the capital of France?")})
        return _text(given.content.text if isinstance(given.content, TextContent) else "")

    @server.tool(structured_output=False)
    def test_input_required_result_list_roots(ctx: Context[Any, Any]) -> CallToolResult | InputRequiredResult:
        """Conformance fixture: asks for the client's roots."""
        given = _answer(ctx, "client_roots", ListRootsResult)
        if given is None:
            return InputRequiredResult(input_requests={"client_roots": ListRootsRequest()})
        return _text(", ".join(str(root.uri) for root in given.roots))

    @server.tool(structured_output=False)
    def test_input_required_result_capabilities(ctx: Context[Any, Any]) -> CallToolResult | InputRequiredResult:
        """Conformance fixture: asks only what the client can answer."""
        able = ctx.client_capabilities
        requests: dict[str, Any] = {}
        if able is not None and able.sampling is not None:
            requests["question"] = _question("What is the capital of France?")
        if able is not None and able.elicitation is not None:
            requests["user_name"] = _form("What is your name?", "name")
        if not requests or any(key in (ctx.input_responses or {}) for key in requests):
            return _text("nothing left to ask")
        return InputRequiredResult(input_requests=requests)

    @server.tool(structured_output=False)
    def test_streaming_elicitation(ctx: Context[Any, Any]) -> CallToolResult | InputRequiredResult:
        """Conformance fixture: asks in its answer, never by a request of its own."""
        given = _accepted(ctx, "confirm")
        return (
            _text("confirmed") if given else InputRequiredResult(input_requests={"confirm": _form("Confirm?", "ok", "boolean")})
        )

    @server.prompt()
    def test_input_required_result_prompt(ctx: Context[Any, Any]) -> list[UserMessage] | InputRequiredResult:
        """Conformance fixture: a prompt that asks for its context."""
        given = _accepted(ctx, "user_context")
        if given is None:
            return InputRequiredResult(input_requests={"user_context": _form("What context should the prompt use?", "context")})
        return [UserMessage(TextContent(type="text", text=f"Use this context: {given.get('context')}"))]


def _add_stateful(server: MCPServer[Any]) -> None:
    def confirmed(ctx: Context[Any, Any]) -> CallToolResult | InputRequiredResult:
        if _accepted(ctx, "confirm") is None or ctx.request_state != "asked":
            return InputRequiredResult(
                input_requests={"confirm": _form("Please confirm", "ok", "boolean")}, request_state="asked"
            )
        return _text("state-ok")

    @server.tool(structured_output=False)
    def test_input_required_result_request_state(ctx: Context[Any, Any]) -> CallToolResult | InputRequiredResult:
        """Conformance fixture: state that the client carries."""
        return confirmed(ctx)

    @server.tool(structured_output=False)
    def test_input_required_result_tampered_state(ctx: Context[Any, Any]) -> CallToolResult | InputRequiredResult:
        """Conformance fixture: state that the client must not change; the server seals it."""
        return confirmed(ctx)

    @server.tool(structured_output=False)
    def test_input_required_result_multiple_inputs(ctx: Context[Any, Any]) -> CallToolResult | InputRequiredResult:
        """Conformance fixture: three questions of three kinds."""
        requests = {
            "user_name": _form("What is your name?", "name"),
            "greeting": _question("Generate a greeting"),
            "client_roots": ListRootsRequest(),
        }
        if all(key in (ctx.input_responses or {}) for key in requests):
            return _text("all three answered")
        return InputRequiredResult(input_requests=requests, request_state="three asked")

    @server.tool(structured_output=False)
    def test_input_required_result_multi_round(ctx: Context[Any, Any]) -> CallToolResult | InputRequiredResult:
        """Conformance fixture: a second question after the first answer."""
        state = json.loads(ctx.request_state) if ctx.request_state else {}
        name, colour = _accepted(ctx, "step1"), _accepted(ctx, "step2")
        if colour is not None and "name" in state:
            return _text(f"{state['name']} likes {colour.get('color')}")
        if name is not None and "name" in name:
            return InputRequiredResult(
                input_requests={"step2": _form("Step 2: What is your favorite color?", "color")},
                request_state=json.dumps({"name": name["name"]}),
            )
        return InputRequiredResult(
            input_requests={"step1": _form("Step 1: What is your name?", "name")}, request_state=json.dumps({"round": 1})
        )


def _add_composed(server: MCPServer[Any]) -> None:
    @server.tool(structured_output=False)
    async def test_tool_with_task(ctx: Context[Any, Any]) -> CallToolResult | InputRequiredResult:
        """Conformance fixture: asks for a name first, and then works as a task."""
        given = _accepted(ctx, "user_name")
        if given is None:
            return InputRequiredResult(input_requests={"user_name": _form("What is your name?", "name")}, request_state="asked")
        return await server.call_tool("greet_later", {"name": str(given.get("name"))}, ctx)
