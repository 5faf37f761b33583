"""Fixtures that talk to the client while they run: progress, log messages, questions, news of lists."""

from __future__ import annotations

import asyncio
import json
import warnings
from typing import Annotated, Any

from mcp.server import MCPServer
from mcp.server.mcpserver import Context
from mcp.shared.exceptions import MCPDeprecationWarning, MCPError
from mcp.types import ClientCapabilities, SamplingCapability, SamplingMessage, TextContent
from mcp_types import MISSING_REQUIRED_CLIENT_CAPABILITY, MissingRequiredClientCapabilityErrorData
from pydantic import BaseModel, Field

__all__ = ["add_talking_tools"]

_PAUSE_S = 0.05


class Account(BaseModel):
    """Answers that `test_elicitation` asks for."""

    username: str = Field(description="User's response")
    email: str = Field(description="User's email address")


class Defaults(BaseModel):
    """A default of every primitive type."""

    name: str = Field(default="John Doe", description="User name")
    age: int = Field(default=30, description="User age")
    score: float = Field(default=95.5, description="User score")
    status: str = Field(
        default="active", description="User status", json_schema_extra={"enum": ["active", "inactive", "pending"]}
    )
    verified: bool = Field(default=True, description="Verification status")


class Choices(BaseModel):
    """Every way to offer choices."""

    untitledSingle: str = Field(json_schema_extra={"enum": ["option1", "option2", "option3"]})  # noqa: N815 - the suite's name
    titledSingle: str = Field(  # noqa: N815
        json_schema_extra={
            "oneOf": [
                {"const": "value1", "title": "First Option"},
                {"const": "value2", "title": "Second Option"},
                {"const": "value3", "title": "Third Option"},
            ]
        }
    )
    untitledMulti: list[str] = Field(  # noqa: N815
        json_schema_extra={"items": {"type": "string", "enum": ["option1", "option2", "option3"]}}
    )
    titledMulti: list[str] = Field(  # noqa: N815
        json_schema_extra={
            "items": {
                "anyOf": [
                    {"const": "value1", "title": "First Choice"},
                    {"const": "value2", "title": "Second Choice"},
                    {"const": "value3", "title": "Third Choice"},
                ]
            }
        }
    )
    legacyEnum: str = Field(  # noqa: N815
        json_schema_extra={"enum": ["opt1", "opt2", "opt3"], "enumNames": ["Option One", "Option Two", "Option Three"]}
    )


def add_talking_tools(server: MCPServer[Any]) -> None:
    """Register them."""
    _add_reports(server)
    _add_questions(server)
    _add_news(server)


async def _log(context: Context[Any, Any], text: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MCPDeprecationWarning)  # the scenario is about what is deprecated
        await context.info(text)


def _add_reports(server: MCPServer[Any]) -> None:
    @server.tool(structured_output=False)
    async def test_tool_with_logging(ctx: Context[Any, Any]) -> str:
        """Conformance fixture: log messages."""
        for text in ("Tool execution started", "Tool processing data", "Tool execution completed"):
            await _log(ctx, text)
            await asyncio.sleep(_PAUSE_S)
        return "Tool with logging executed successfully"

    @server.tool(structured_output=False)
    async def test_logging_tool(ctx: Context[Any, Any]) -> str:
        """Conformance fixture: a log message that only those get who asked."""
        await _log(ctx, "only for those who asked")
        return "logged"

    @server.tool(structured_output=False)
    async def test_tool_with_progress(ctx: Context[Any, Any]) -> str:
        """Conformance fixture: progress."""
        for done in (0, 50, 100):
            await ctx.report_progress(done, 100, f"Completed step {done} of 100")
            await asyncio.sleep(_PAUSE_S)
        return "progress reported"

    @server.tool(structured_output=False)
    def test_custom_headers(
        region: Annotated[str, Field(description="A region", json_schema_extra={"x-mcp-header": "Region"})] = "",
    ) -> str:
        """Conformance fixture: an argument that travels as a header too."""
        return region


def _add_questions(server: MCPServer[Any]) -> None:
    async def asked(ctx: Context[Any, Any], message: str, schema: type[BaseModel]) -> str:
        result = await ctx.elicit(message=message, schema=schema)
        content = result.data.model_dump() if result.action == "accept" else {}
        return f"action={result.action}, content={json.dumps(content)}"

    @server.tool(structured_output=False)
    async def test_elicitation(message: str, ctx: Context[Any, Any]) -> str:
        """Conformance fixture: ask the user."""
        return f"User response: {await asked(ctx, message, Account)}"

    @server.tool(structured_output=False)
    async def test_elicitation_sep1034_defaults(ctx: Context[Any, Any]) -> str:
        """Conformance fixture: ask with defaults."""
        return f"Elicitation completed: {await asked(ctx, 'Please provide user information', Defaults)}"

    @server.tool(structured_output=False)
    async def test_elicitation_sep1330_enums(ctx: Context[Any, Any]) -> str:
        """Conformance fixture: ask with choices."""
        return f"Elicitation completed: {await asked(ctx, 'Please select', Choices)}"

    @server.tool(structured_output=False)
    async def test_sampling(prompt: str, ctx: Context[Any, Any]) -> str:
        """Conformance fixture: ask the client's model."""
        message = SamplingMessage(role="user", content=TextContent(type="text", text=prompt))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MCPDeprecationWarning)
            result = await ctx.session.create_message(messages=[message], max_tokens=100, related_request_id=ctx.request_id)
        return f"LLM response: {result.content.text if isinstance(result.content, TextContent) else 'no text'}"

    @server.tool(structured_output=False)
    def test_missing_capability(ctx: Context[Any, Any]) -> str:
        """Conformance fixture: needs a client that lends its model."""
        if ctx.client_capabilities is None or ctx.client_capabilities.sampling is None:
            needed = MissingRequiredClientCapabilityErrorData(
                required_capabilities=ClientCapabilities(sampling=SamplingCapability())
            )
            data = needed.model_dump(by_alias=True, mode="json", exclude_none=True)
            raise MCPError(MISSING_REQUIRED_CLIENT_CAPABILITY, "this tool needs the client capability 'sampling'", data)
        return "the client lends its model"


def _add_news(server: MCPServer[Any]) -> None:
    @server.tool(structured_output=False)
    async def test_trigger_tool_change(ctx: Context[Any, Any]) -> str:
        """Conformance fixture: tell that the tools changed."""
        await ctx.notify_tools_changed()
        return "told"

    @server.tool(structured_output=False)
    async def test_trigger_prompt_change(ctx: Context[Any, Any]) -> str:
        """Conformance fixture: tell that the prompts changed."""
        await ctx.notify_prompts_changed()
        return "told"
