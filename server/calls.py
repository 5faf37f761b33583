"""One tool call: the function in a worker thread, its progress on the wire, its reply or error as an MCP result."""

from __future__ import annotations

import asyncio
import base64
import logging
import math
import secrets
import threading
import time
from collections.abc import Awaitable, Callable
from contextlib import suppress
from functools import partial
from typing import Any

import anyio
import anyio.to_thread
import pydantic_core
from mcp.shared.exceptions import MCPError
from mcp.types import CallToolResult, ContentBlock, ImageContent, ResourceLink, TextContent

from ..workflow.answers import fitted
from ..workflow.context import Link, ToolBinding, ToolContext, ToolReply
from ..workflow.left_behind import UNKNOWN, left_behind
from ..worlds.ablation import ablation, ablation_words
from ..worlds.errors import EngineError, EvidenceError, InputError, LimitError, RefusedError, SpecError, WorldAgentError
from ..worlds.quoting import shown, visible
from ..worlds.storage import storage_failure

__all__ = ["Progress", "error_result", "error_text", "reply_result", "result_of_reply", "run_in_thread"]

HEARTBEAT_S = 4.0
"""Longest silence of a running call [s]; clients cut calls that stay silent for minutes."""
PROGRESS_CHARACTERS = 400
ERROR_CHARACTERS = 8000
"""Clients cut longer error texts."""
_SHOWN_PROBLEMS = 20
_KINDS: tuple[tuple[type[WorldAgentError], str], ...] = (
    (LimitError, "over the limit"),
    (InputError, "invalid"),
    (RefusedError, "refused"),
    (EvidenceError, "evidence"),
    (EngineError, "engine"),
    (WorldAgentError, "stopped"),
)

logger = logging.getLogger(__name__)


class Progress:
    """Carries a tool's reports from its thread to the client; the latest wins where they come too fast.

    What is sent strictly increases, as the protocol demands.
    """

    def __init__(self, tool: str, send: Callable[[float, float | None, str | None], Awaitable[None]]) -> None:
        self._send = send
        self._loop = asyncio.get_running_loop()
        self._news = asyncio.Event()
        self._latest: tuple[float, float | None, str] = (0.0, None, f"{tool} is running")
        self._last = 0.0

    def report(self, done: float, total: float | None = None, message: str = "") -> None:
        """Take a report, from any thread; never raises."""
        with suppress(Exception):
            finite = total is not None and math.isfinite(total)
            self._latest = (
                float(done) if math.isfinite(done) else self._last,
                float(total) if finite and total is not None else None,
                visible(str(message)[:PROGRESS_CHARACTERS]),
            )
            self._loop.call_soon_threadsafe(self._news.set)

    async def forward(self) -> None:
        """Send reports as they come, and a sign of life where none come, until cancelled."""
        while True:
            with anyio.move_on_after(HEARTBEAT_S):
                await self._news.wait()
            self._news.clear()
            await self._pass_on()

    async def finish(self) -> None:
        """Send the last report if it has not been sent."""
        if self._news.is_set():
            self._news.clear()
            await self._pass_on()

    async def _pass_on(self) -> None:
        done, total, message = self._latest
        step = 1e-6 * max(1.0, abs(self._last))
        self._last = done if done > self._last else self._last + step
        try:
            await self._send(self._last, None if total is None else max(total, self._last), message or None)
        except Exception:
            logger.debug("progress could not be sent", exc_info=True)
        except BaseException:  # the tool ended meanwhile, and nobody knows whether it went out
            self._news.set()
            raise


async def run_in_thread(
    binding: ToolBinding,
    arguments: dict[str, Any],
    context_of: Callable[[Callable[[float, float | None, str], None], Callable[[], bool]], ToolContext],
    send: Callable[[float, float | None, str | None], Awaitable[None]],
    limiter: anyio.CapacityLimiter,
) -> CallToolResult:
    """Result of a tool whose arguments are valid.

    The event loop stays free. When the client gives up, the thread is left to end by itself: its context's
    `cancelled()` becomes true.

    Args:
        binding: The tool.
        arguments: Validated keyword arguments.
        context_of: Makes the call's context from its `progress` and `cancelled`.
        send: Sends one progress notification (done, total, message).
        limiter: Bounds how many tools run at a time.
    """
    gone = threading.Event()
    progress = Progress(binding.name, send)
    began = time.time()

    def work() -> CallToolResult | MCPError:
        context = context_of(progress.report, gone.is_set)
        kept = partial(left_behind, context, arguments, began)
        try:
            return result_of_reply(binding, lambda: binding.function(context, **arguments), kept)
        except MCPError as error:  # raised below, since a task group would wrap it
            return error

    try:
        async with anyio.create_task_group() as group:
            group.start_soon(progress.forward)
            result = await anyio.to_thread.run_sync(work, abandon_on_cancel=True, limiter=limiter)
            group.cancel_scope.cancel()
    finally:
        gone.set()
    await progress.finish()
    if isinstance(result, MCPError):
        raise result
    return result


def result_of_reply(binding: ToolBinding, make: Callable[[], ToolReply], kept: Callable[[], str] | None = None) -> CallToolResult:
    """Reply of `make` as content; an exception of it as an error that the calling model reads.

    Args:
        binding: The tool.
        make: Gives the reply.
        kept: Tells what the call stored, should a defect end it.

    Raises:
        MCPError: `make` raised it: an error of the protocol, which no model could avoid.
    """
    try:
        return reply_result(binding, make())
    except MCPError:
        raise
    except WorldAgentError as error:
        return error_result(error_text(error))
    except (Exception, SystemExit) as error:
        told = storage_failure(error)
        return _unexpected(binding.name, error, kept) if told is None else error_result(error_text(told))


def reply_result(binding: ToolBinding, reply: ToolReply) -> CallToolResult:
    """A reply as content: compact JSON, pictures, links; structured content unless the tool is one for pictures.

    NaN and infinities become null, since JSON has no such numbers.
    """
    if reply.pictures and not binding.pictures:
        raise TypeError(f"tool {binding.name} returned pictures but is not declared to")
    marks = {"ablation": ablation_words(name)} if (name := ablation()) else {}
    encoded = pydantic_core.to_json(shown(fitted({**reply.data, **marks})), inf_nan_mode="null")
    content: list[ContentBlock] = [TextContent(type="text", text=encoded.decode())]
    content += [
        ImageContent(type="image", data=base64.b64encode(picture.data).decode(), mime_type=f"image/{picture.format}")
        for picture in reply.pictures
    ]
    links = [Link(*link) for link in reply.links]
    content += [ResourceLink(type="resource_link", **link._replace(name=visible(link.name))._asdict()) for link in links]
    if binding.pictures:
        return CallToolResult(content=content)
    return CallToolResult(content=content, structured_content=pydantic_core.from_json(encoded))


def error_text(error: WorldAgentError) -> str:
    """Text of an error for the caller: its kind, its message, and problems of a specification that the message leaves out."""
    kind = next(word for base, word in _KINDS if isinstance(error, base))
    lines = [f"{kind}: {error}"]
    if isinstance(error, SpecError):
        untold = [(pointer, message) for pointer, message in error.problems if message not in lines[0]]
        lines += [f"- {pointer or '/'}: {message}" for pointer, message in untold[:_SHOWN_PROBLEMS]]
        if len(untold) > _SHOWN_PROBLEMS:
            lines.append(f"... and {len(untold) - _SHOWN_PROBLEMS} more")
    text = "\n".join(lines)
    return text if len(text) <= ERROR_CHARACTERS else text[:ERROR_CHARACTERS] + " ... (cut)"


def error_result(text: str) -> CallToolResult:
    """An error that the calling model reads."""
    return CallToolResult(content=[TextContent(type="text", text=visible(text))], is_error=True)


def _unexpected(tool: str, error: BaseException, kept: Callable[[], str] | None) -> CallToolResult:
    """A defect: the trace goes to the log, the caller gets its number and what was stored all the same."""
    number = secrets.token_hex(4)
    logger.error("error %s in tool %s", number, tool, exc_info=error)
    return error_result(
        f"internal error {number} in {tool}: a defect of the server, not of your arguments; the trace is in the "
        f"server's log. {kept() if kept is not None else UNKNOWN}"
    )
