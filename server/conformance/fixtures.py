"""Fixtures of the core scenarios: tools, resources and prompts with the names and answers that the suite expects.

References:
    https://github.com/modelcontextprotocol/conformance
"""

from __future__ import annotations

import base64
import json
from typing import Any

from mcp.server import MCPServer, ServerRequestContext
from mcp.server.mcpserver.prompts.base import UserMessage
from mcp.types import (
    AudioContent,
    CallToolResult,
    EmbeddedResource,
    EmptyResult,
    ImageContent,
    SetLevelRequestParams,
    TextContent,
    TextResourceContents,
)

from .input_tools import add_input_tools
from .talking_tools import add_talking_tools

__all__ = ["add_fixtures"]

PNG = base64.b64encode(
    bytes.fromhex(
        "89504e470d0a1a0a0000000d4948445200000001000000010806000000"
        "1f15c4890000000d49444154789c6360606060000000050001a5f645400000000049454e44ae426082"
    )
).decode()
"""One transparent pixel."""
WAV = base64.b64encode(
    b"RIFF&\x00\x00\x00WAVEfmt \x10\x00\x00\x00\x01\x00\x01\x00@\x1f\x00\x00\x80>\x00\x00\x02\x00\x10\x00data\x02\x00\x00\x00\x00\x00"
).decode()
"""One silent sample."""
SCHEMA_2020_12: dict[str, Any] = {
    "$schema": "https://json-schema.org/draft/2020-12/schema",
    "type": "object",
    "$defs": {
        "address": {
            "$anchor": "addressDef",
            "type": "object",
            "properties": {"street": {"type": "string"}, "city": {"type": "string"}},
        }
    },
    "properties": {
        "name": {"type": "string"},
        "address": {"$ref": "#/$defs/address"},
        "contactMethod": {"type": "string", "enum": ["phone", "email"]},
        "phone": {"type": "string"},
        "email": {"type": "string"},
    },
    "allOf": [{"anyOf": [{"required": ["phone"]}, {"required": ["email"]}]}],
    "if": {"properties": {"contactMethod": {"const": "phone"}}, "required": ["contactMethod"]},
    "then": {"required": ["phone"]},
    "else": {"required": ["email"]},
    "additionalProperties": False,
}


def add_fixtures(server: MCPServer[Any]) -> None:
    """Register the suite's fixtures on a server."""
    _add_content_tools(server)
    add_talking_tools(server)
    add_input_tools(server)
    _add_resources(server)
    _add_prompts(server)

    async def set_level(ctx: ServerRequestContext[Any, Any], params: SetLevelRequestParams) -> EmptyResult:
        return EmptyResult()

    # The handshake era has this method, and the SDK leaves it to the server.
    server._lowlevel_server.add_request_handler("logging/setLevel", SetLevelRequestParams, set_level)


def _resource(uri: str, kind: str, text: str) -> EmbeddedResource:
    return EmbeddedResource(type="resource", resource=TextResourceContents(uri=uri, mime_type=kind, text=text))


def _text(text: str) -> TextContent:
    return TextContent(type="text", text=text)


def _add_content_tools(server: MCPServer[Any]) -> None:
    image = ImageContent(type="image", data=PNG, mime_type="image/png")

    @server.tool(structured_output=False)
    def greet(name: str = "World") -> str:
        """Conformance fixture: answer at once."""
        return f"Hello, {name}!"

    @server.tool(structured_output=False)
    def test_simple_text() -> str:
        """Conformance fixture: text."""
        return "This is a simple text response for testing."

    @server.tool(structured_output=False)
    def test_image_content() -> CallToolResult:
        """Conformance fixture: an image."""
        return CallToolResult(content=[image])

    @server.tool(structured_output=False)
    def test_audio_content() -> CallToolResult:
        """Conformance fixture: a sound."""
        return CallToolResult(content=[AudioContent(type="audio", data=WAV, mime_type="audio/wav")])

    @server.tool(structured_output=False)
    def test_embedded_resource() -> CallToolResult:
        """Conformance fixture: an embedded resource."""
        return CallToolResult(
            content=[_resource("test://embedded-resource", "text/plain", "This is an embedded resource content.")]
        )

    @server.tool(structured_output=False)
    def test_multiple_content_types() -> CallToolResult:
        """Conformance fixture: text, an image and a resource."""
        mixed = _resource("test://mixed-content-resource", "application/json", json.dumps({"test": "data", "value": 123}))
        return CallToolResult(content=[_text("Multiple content types test:"), image, mixed])

    @server.tool(structured_output=False)
    def test_error_handling() -> CallToolResult:
        """Conformance fixture: an error of the tool."""
        return CallToolResult(content=[_text("This tool intentionally returns an error for testing")], is_error=True)

    @server.tool(structured_output=False)
    def json_schema_2020_12_tool(name: str = "") -> str:
        """Conformance fixture: a schema with everything that JSON Schema 2020-12 offers."""
        return name

    described = server._tool_manager.get_tool("json_schema_2020_12_tool")
    assert described is not None
    described.parameters = SCHEMA_2020_12  # no signature gives such a schema


def _add_resources(server: MCPServer[Any]) -> None:
    @server.resource("test://static-text", name="static-text", mime_type="text/plain")
    def static_text() -> str:
        """Conformance fixture: text."""
        return "This is the content of the static text resource."

    @server.resource("test://static-binary", name="static-binary", mime_type="image/png")
    def static_binary() -> bytes:
        """Conformance fixture: bytes."""
        return base64.b64decode(PNG)

    @server.resource("test://template/{id}/data", name="template", mime_type="application/json")
    def template(id: str) -> str:  # noqa: A002 - the suite's name
        """Conformance fixture: a template."""
        return json.dumps({"id": id, "templateTest": True, "data": f"Data for ID: {id}"})

    @server.resource("test://watched-resource", name="watched-resource", mime_type="text/plain")
    def watched_resource() -> str:
        """Conformance fixture: something to subscribe to."""
        return "Watched resource content"


def _add_prompts(server: MCPServer[Any]) -> None:
    @server.prompt()
    def test_simple_prompt() -> list[UserMessage]:
        """Conformance fixture: one message."""
        return [UserMessage(_text("This is a simple prompt for testing."))]

    @server.prompt()
    def test_prompt_with_arguments(arg1: str, arg2: str) -> list[UserMessage]:
        """Conformance fixture: two arguments."""
        return [UserMessage(_text(f"Prompt with arguments: arg1='{arg1}', arg2='{arg2}'"))]

    @server.prompt()
    def test_prompt_with_embedded_resource(resourceUri: str) -> list[UserMessage]:  # noqa: N803 - the suite's name
        """Conformance fixture: an embedded resource."""
        embedded = _resource(resourceUri, "text/plain", "Embedded resource content for testing.")
        return [UserMessage(embedded), UserMessage(_text("Please process the embedded resource above."))]

    @server.prompt()
    def test_prompt_with_image() -> list[UserMessage]:
        """Conformance fixture: an image."""
        image = ImageContent(type="image", data=PNG, mime_type="image/png")
        return [UserMessage(image), UserMessage(_text("Please analyze the image above."))]
