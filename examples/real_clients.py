"""Real MCP clients that a script can drive without an account: the SDK's, Codex's and Claude Code's.

Codex lets a program call tools through its own client (`codex app-server`). Claude Code only calls what its model asks
for, so a stand-in for the model answers on the loopback address with the calls of the script; nothing else is asked.
"""

from __future__ import annotations

import json
import os
import queue
import subprocess
import threading
from collections.abc import Sequence
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, Protocol

from ..worlds.errors import EngineError

__all__ = ["ClaudeClient", "CodexClient", "Reply", "SdkClient", "ToolClient"]

SERVER = "worldagent"
PATIENCE_S = 300.0
"""Time that a client may take to bring the result of one call [s]."""
Reply = tuple[dict[str, Any], int]
"""Data of a tool's reply and how many pictures came along."""


class ToolClient(Protocol):
    """Something that calls tools of one server."""

    async def call(self, tool: str, arguments: dict[str, Any]) -> Reply:
        """The reply of a tool.

        Raises:
            EngineError: The call was refused, or the client failed.
        """
        ...

    def close(self) -> None:
        """End the client; jobs live on."""
        ...


class SdkClient:
    """The MCP SDK's client, over stdio to a program."""

    def __init__(self, client: Any) -> None:
        self._client = client

    async def call(self, tool: str, arguments: dict[str, Any]) -> Reply:
        """See `ToolClient`."""
        result = await self._client.call_tool(tool, arguments)
        return _reply(tool, [block.model_dump() for block in result.content], result.structured_content, result.is_error)

    def close(self) -> None:
        """Nothing: whoever made the SDK's client ends it."""


class CodexClient:
    """Codex's client, with the servers that stand in its list."""

    def __init__(self, program: str) -> None:
        self._process = subprocess.Popen(
            [program, "app-server"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        self._count = 0
        self._ask("initialize", {"clientInfo": {"name": "worldagent", "version": "1"}, "capabilities": {"experimentalApi": True}})
        self._send({"method": "initialized"})
        self._thread = self._ask("thread/start", {"cwd": str(Path.cwd())})["thread"]["id"]

    async def call(self, tool: str, arguments: dict[str, Any]) -> Reply:
        """See `ToolClient`."""
        where = {"threadId": self._thread, "server": SERVER}
        found = self._ask("mcpServer/tool/call", {**where, "tool": tool, "arguments": arguments})
        return _reply(tool, found["content"], found.get("structuredContent"), bool(found.get("isError")))

    def close(self) -> None:
        """End Codex, and with it the server; jobs live on."""
        self._process.terminate()
        self._process.communicate(timeout=10.0)

    def _send(self, message: dict[str, Any]) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(message) + "\n")
        self._process.stdin.flush()

    def _ask(self, method: str, parameters: dict[str, Any]) -> dict[str, Any]:
        self._count += 1
        self._send({"id": self._count, "method": method, "params": parameters})
        assert self._process.stdout is not None
        for line in self._process.stdout:
            answer = json.loads(line)
            if answer.get("id") == self._count and "method" not in answer:
                if "error" in answer:
                    raise EngineError(f"codex {method}: {answer['error'].get('message')}")
                result: dict[str, Any] = answer["result"]
                return result
        raise EngineError(f"codex ended during {method}")


class ClaudeClient:
    """Claude Code with the servers that stand in its list, and this script in the place of its model."""

    def __init__(self, program: str) -> None:
        self._calls: queue.Queue[dict[str, Any] | None] = queue.Queue()
        self._results: queue.Queue[dict[str, Any]] = queue.Queue()
        self._given: dict[str, Any] | None = None
        self._count = 0
        self._model = ThreadingHTTPServer(("127.0.0.1", 0), _handler(self._turn))
        self._thread = threading.Thread(target=self._model.serve_forever, daemon=True)
        self._thread.start()
        environment = os.environ | {
            "ANTHROPIC_BASE_URL": f"http://127.0.0.1:{self._model.server_address[1]}",
            "ANTHROPIC_API_KEY": "stand-in",
            "CLAUDE_CODE_DISABLE_NONESSENTIAL_TRAFFIC": "1",
            "ENABLE_TOOL_SEARCH": "false",
        }
        self._process = subprocess.Popen(
            [program, "--print", "Build the first world.", "--allowedTools", f"mcp__{SERVER}", "--output-format", "json"],
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )

    async def call(self, tool: str, arguments: dict[str, Any]) -> Reply:
        """See `ToolClient`."""
        self._count += 1
        self._calls.put({"type": "tool_use", "id": f"toolu_{self._count}", "name": f"mcp__{SERVER}__{tool}", "input": arguments})
        try:
            result = self._results.get(timeout=PATIENCE_S)
        except queue.Empty:
            raise EngineError(f"claude brought no result of {tool} within {PATIENCE_S:.0f} s") from None
        content = result.get("content") or []
        blocks = [{"type": "text", "text": content}] if isinstance(content, str) else content
        return _reply(tool, blocks, None, bool(result.get("is_error")))

    def close(self) -> None:
        """Have the model say that it is done, and end Claude Code; jobs live on."""
        self._calls.put(None)
        try:
            self._process.communicate(timeout=20.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.communicate()
        self._model.shutdown()
        self._model.server_close()

    def _turn(self, messages: Sequence[dict[str, Any]]) -> dict[str, Any]:
        """The model's next block: the next call of the script, or a last word."""
        if self._given is not None:
            blocks = [b for m in messages if m["role"] == "user" and isinstance(m["content"], list) for b in m["content"]]
            brought = [b for b in blocks if b.get("type") == "tool_result" and b["tool_use_id"] == self._given["id"]]
            if not brought:  # asked again
                return self._given
            self._results.put(brought[0])
        self._given = self._calls.get()
        return self._given or {"type": "text", "text": "done"}


def _handler(turn: Any) -> type[BaseHTTPRequestHandler]:
    class Model(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def log_message(self, *_: Any) -> None:
            """Say nothing."""

        def do_GET(self) -> None:
            self._answer(404, "application/json", b"{}")

        def do_HEAD(self) -> None:
            self._answer(404, "application/json", b"")

        def do_POST(self) -> None:
            asked = json.loads(self.rfile.read(int(self.headers.get("content-length") or 0)) or b"{}")
            if not self.path.split("?")[0].endswith("/messages"):
                self._answer(404, "application/json", b"{}")
                return
            block = turn(asked["messages"]) if asked.get("tools") else {"type": "text", "text": "done"}
            self._answer(200, "text/event-stream", _stream(block, asked["model"]))

        def _answer(self, status: int, kind: str, body: bytes) -> None:
            self.send_response(status)
            self.send_header("content-type", kind)
            self.send_header("content-length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

    return Model


def _stream(block: dict[str, Any], model: str) -> bytes:
    """One block as the server-sent events of a model's answer."""
    call = block["type"] == "tool_use"
    usage = {"input_tokens": 1, "output_tokens": 1}
    head = {"id": "msg_1", "type": "message", "role": "assistant", "model": model, "content": [], "usage": usage}
    start = {**block, "input": {}} if call else {"type": "text", "text": ""}
    part = (
        {"type": "input_json_delta", "partial_json": json.dumps(block["input"])}
        if call
        else {"type": "text_delta", "text": block["text"]}
    )
    events: list[dict[str, Any]] = [
        {"type": "message_start", "message": {**head, "stop_reason": None, "stop_sequence": None}},
        {"type": "content_block_start", "index": 0, "content_block": start},
        {"type": "content_block_delta", "index": 0, "delta": part},
        {"type": "content_block_stop", "index": 0},
        {
            "type": "message_delta",
            "delta": {"stop_reason": "tool_use" if call else "end_turn", "stop_sequence": None},
            "usage": {"output_tokens": 1},
        },
        {"type": "message_stop"},
    ]
    return "".join(f"event: {event['type']}\ndata: {json.dumps(event)}\n\n" for event in events).encode()


def _reply(tool: str, content: Sequence[dict[str, Any]], structured: dict[str, Any] | None, is_error: bool) -> Reply:
    texts = [block["text"] for block in content if block["type"] == "text"]
    if is_error:
        raise EngineError(f"{tool}: {' '.join(texts)}")
    pictures = sum(block["type"] == "image" for block in content)
    data = structured if structured is not None else next((found for text in texts if (found := _object(text)) is not None), None)
    if data is None:
        raise EngineError(f"{tool}: the client brought no data: {' '.join(texts)[:300]}")
    return data, pictures


def _object(text: str) -> dict[str, Any] | None:
    """The JSON object that a text is; clients put links into words and the data into a text of its own."""
    try:
        found = json.loads(text)
    except ValueError:
        return None
    return found if isinstance(found, dict) else None
