"""Both transports behind one rule of what a message is (`messages.py`): bounded in size, and answered if it is none."""

from __future__ import annotations

import os
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import Any

import anyio
import anyio.to_thread
from mcp.server.stdio import stdio_server
from mcp.shared.message import SessionMessage
from mcp.types import JSONRPCError
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from .messages import EDGE, MESSAGE_BYTES, defect_of, too_long

__all__ = ["Lines", "StrictBodies", "stdio_streams"]

_BLOCK = 1 << 16


class Lines:
    """Lines of a file descriptor as text; those that are no message go to `reject` instead."""

    def __init__(self, descriptor: int, reject: Callable[[JSONRPCError], Awaitable[None]]) -> None:
        self._descriptor = descriptor
        self._reject = reject

    async def __aiter__(self) -> AsyncIterator[str]:
        async for line, size in self._raw():
            defect = too_long(line, size) if size > MESSAGE_BYTES else defect_of(line)
            if defect is not None:
                await self._reject(defect)
            elif line and not line.isspace():
                yield line.decode()

    async def _raw(self) -> AsyncIterator[tuple[bytes, int]]:
        """Lines with their length [bytes]; of one that is too long, both ends only."""
        kept, size = bytearray(), 0
        while block := await anyio.to_thread.run_sync(os.read, self._descriptor, _BLOCK, abandon_on_cancel=True):
            *ended, rest = block.split(b"\n")
            for piece in ended:
                size = _extend(kept, piece, size)
                yield bytes(kept), size
                kept, size = bytearray(), 0
            size = _extend(kept, rest, size)
        if size:
            yield bytes(kept), size


def _extend(kept: bytearray, piece: bytes, size: int) -> int:
    kept += piece
    size += len(piece)
    if size > MESSAGE_BYTES and len(kept) > 2 * EDGE:
        del kept[EDGE:-EDGE]
    return size


@asynccontextmanager
async def stdio_streams() -> AsyncIterator[tuple[Any, Any]]:
    """The SDK's streams over `Lines` of stdin; while they are open, children and stray reads find descriptor 0 empty."""
    descriptor = sys.stdin.fileno()
    wire, nothing = os.dup(descriptor), os.open(os.devnull, os.O_RDONLY)
    os.set_inheritable(wire, False)
    os.dup2(nothing, descriptor)
    os.close(nothing)
    answers: list[Any] = []

    async def reject(defect: JSONRPCError) -> None:
        await answers[0].send(SessionMessage(defect))

    lines = Lines(wire, reject)
    try:
        async with stdio_server(stdin=lines) as (read, write):  # type: ignore[arg-type]
            answers.append(write)
            yield read, write
    finally:
        os.dup2(wire, descriptor)


class StrictBodies:
    """ASGI application in front of another: a body posted to `path` that is no message is answered here, with 400.

    It reads the whole body; whoever stands before it bounds that.
    """

    def __init__(self, app: ASGIApp, path: str) -> None:
        self._app = app
        self._path = path

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer the request itself, or pass it on."""
        if scope["type"] != "http" or scope["method"] != "POST" or scope["path"] != self._path:
            await self._app(scope, receive, send)
            return
        body, read, more = bytearray(), list[Message](), True
        while more:
            message = await receive()
            read.append(message)
            body += message.get("body", b"")
            more = message.get("more_body", False)
        defect = defect_of(bytes(body)) if message["type"] == "http.request" else None
        if defect is not None:
            await _send_defect(defect, send)
            return

        async def again() -> Message:
            return read.pop(0) if read else await receive()

        await self._app(scope, again, send)


async def _send_defect(defect: JSONRPCError, send: Send) -> None:
    body = defect.model_dump_json(by_alias=True, exclude_unset=True).encode()
    headers = [(b"content-type", b"application/json"), (b"content-length", b"%d" % len(body))]
    await send({"type": "http.response.start", "status": 400, "headers": headers})
    await send({"type": "http.response.body", "body": body})
