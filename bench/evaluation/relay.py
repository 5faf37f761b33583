"""A process between an agent and its stdio server: it passes every line on, writes the calls down, and keeps the limits.

`python -m worldagent.bench.evaluation.relay --record DIR [limits] -- COMMAND...`. Because it speaks the protocol of both sides, the
same limits and the same transcript hold for a loop of Inspect, a coding agent's own client, and a session driven by hand:

- a call without an answer within `--call-timeout` gets an error from here, and after `MOST_SILENT` in a row the server is lost;
- calls past `--calls` never reach the server;
- a message over `MOST_BYTES`, or `MOST_UNASKED` messages that answer nothing between two answers, is a flood: the server is ended;
- a server that dies, or has not answered its first request within `--start` seconds, is lost.

What ended it stands in `end.json` of the record; the harness ends the sample for it.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import os
import signal
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from .records import Ending, EndKind, Record

__all__ = ["MOST_BYTES", "MOST_SILENT", "MOST_UNASKED", "main", "relay_command"]

MOST_BYTES = 32 * 2**20
"""Longest message of a server [bytes]; a reply of worldagent is bounded by 20,000 characters and its pictures."""
MOST_UNASKED = 20_000
"""Messages in a row that answer nothing; a long job tells its progress a few times a second."""
MOST_SILENT = 3
"""Calls in a row without an answer."""
STDERR_BYTES = 2**20
"""Kept of what the server writes to its standard error."""
PATIENCE_S = 5.0
"""Time that a server gets to end once nobody speaks to it."""


def relay_command(record: Path, command: Sequence[str], *, calls: int, call_timeout_s: float, start_s: float) -> list[str]:
    """Command line of a relay before a server."""
    limits = ["--calls", str(calls), "--call-timeout", str(call_timeout_s), "--start", str(start_s)]
    module = [sys.executable, "-P", "-m", "worldagent.bench.evaluation.relay"]
    return [*module, "--record", str(record), *limits, "--", *command]


class _Pending(NamedTuple):
    number: int
    tool: str
    arguments: dict[str, Any]
    at: float
    began: float
    timer: asyncio.TimerHandle


class _Relay:
    """State between both sides; every method runs in the one event loop."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.record = Record(options.record)
        self.options = options
        self.pending: dict[Any, _Pending] = {}
        self.given_up: set[Any] = set()
        self.counted = len(self.record.calls())
        self.silent = self.unasked = 0
        self.left = False
        """True once the client has gone: what the server does then is no loss."""
        self.child: asyncio.subprocess.Process
        self.starting: asyncio.TimerHandle | None = None

    # ---------------------------------------------------------------- life

    async def run(self) -> int:
        loop = asyncio.get_running_loop()
        pipe = asyncio.subprocess.PIPE
        self.child = await asyncio.create_subprocess_exec(
            *self.options.command, stdin=pipe, stdout=pipe, stderr=pipe, limit=MOST_BYTES
        )
        for number in (signal.SIGTERM, signal.SIGINT):
            loop.add_signal_handler(number, self.leave)
        words = f"the server had not answered within {self.options.start:g} s of its start"
        self.starting = loop.call_later(self.options.start, self.lose, "start", words)
        upward = asyncio.create_task(self.upward(await _reader_of(sys.stdin.buffer)))
        kept = asyncio.create_task(self.keep_errors())
        await self.downward()
        upward.cancel()
        if not self.left:
            code = await self.child.wait()
            self.end("lost", "died", f"the server ended with code {code} while its client was there")
        self.leave()
        for key in list(self.pending):
            self.write(key, "lost", {"content": [{"type": "text", "text": "no answer"}], "isError": True})
        await self.child.wait()
        with contextlib.suppress(asyncio.TimeoutError, asyncio.CancelledError):
            await asyncio.wait_for(kept, 1.0)
        return 0 if self.record.ending() is None else 1

    def leave(self) -> None:
        """The client is gone, or was told so: let the server end, and see that it does."""
        if self.left:
            return
        self.left = True
        assert self.child.stdin is not None
        self.child.stdin.close()
        asyncio.get_running_loop().call_later(PATIENCE_S, self.kill)

    def kill(self) -> None:
        with contextlib.suppress(ProcessLookupError):
            self.child.kill()

    def end(self, kind: EndKind, type_: str, reason: str, value: float = 0.0, limit: float = 0.0) -> None:
        self.record.end(Ending(kind, type_, reason, value, limit))

    def lose(self, type_: str, reason: str) -> None:
        """The server is of no use any more: end it."""
        self.end("lost", type_, reason)
        self.kill()

    async def keep_errors(self) -> None:
        """The first part of the server's standard error, in a file; the rest is read and dropped."""
        assert self.child.stderr is not None
        room = STDERR_BYTES
        with (self.record.folder / "server.stderr").open("ab") as kept:
            while chunk := await self.child.stderr.read(65536):
                kept.write(chunk[:room])
                kept.flush()
                room = max(0, room - len(chunk))

    # ---------------------------------------------------------------- from the client

    async def upward(self, client: asyncio.StreamReader) -> None:
        while line := await client.readline():
            message = _parsed(line)
            if message.get("method") == "tools/call" and not self.take(message):
                continue
            assert self.child.stdin is not None
            self.child.stdin.write(line)
            with contextlib.suppress(ConnectionError):
                await self.child.stdin.drain()
        self.leave()

    def take(self, message: dict[str, Any]) -> bool:
        """Count a call; False where it is not passed on."""
        parameters = message.get("params") or {}
        number, limit = self.counted + 1, self.options.calls
        self.counted = number
        loop, key = asyncio.get_running_loop(), message.get("id")
        timer = loop.call_later(self.options.call_timeout, self.give_up, key)
        tool, arguments = str(parameters.get("name")), parameters.get("arguments") or {}
        self.pending[key] = _Pending(number, tool, arguments, time.time(), time.monotonic(), timer)
        if number <= limit:
            return True
        text = f"the budget of {limit} calls is used up"
        self.end("limit", "calls", f"{number} calls, of which {limit} are allowed", number, limit)
        self.write(key, "refused", {"content": [{"type": "text", "text": text}], "isError": True})
        self.say_error(key, text)
        return False

    def give_up(self, key: Any) -> None:
        """A call has had its time."""
        seconds = self.options.call_timeout
        text = f"no answer in {seconds:g} s; the server may still be at work"
        tool = self.pending[key].tool
        self.write(key, "silent", {"content": [{"type": "text", "text": text}], "isError": True})
        self.given_up.add(key)
        self.say_error(key, text)
        self.silent += 1
        if self.silent >= MOST_SILENT:
            self.lose("silent", f"{self.silent} calls in a row had no answer within {seconds:g} s, the last one of {tool}")

    # ---------------------------------------------------------------- from the server

    async def downward(self) -> None:
        assert self.child.stdout is not None
        while True:
            try:
                line = await self.child.stdout.readline()
            except ValueError:  # longer than the limit of the stream
                self.lose("flood", f"one message of the server has more than {MOST_BYTES} bytes")
                return
            if not line:
                return
            if self.seen(_parsed(line)):
                sys.stdout.buffer.write(line)
                sys.stdout.buffer.flush()

    def seen(self, message: dict[str, Any]) -> bool:
        """Write an answer down; False where it is not passed on."""
        key = message.get("id")
        if "method" in message or ("result" not in message and "error" not in message):
            self.unasked += 1
            if self.unasked == MOST_UNASKED:
                self.lose("flood", f"the server sent {MOST_UNASKED} messages in a row that answer nothing")
            return self.unasked < MOST_UNASKED
        if self.starting is not None:
            self.starting.cancel()
            self.starting = None
        self.unasked = 0
        if key in self.given_up:
            self.given_up.discard(key)
            return False
        if key in self.pending:
            self.silent = 0
            error = message.get("error")
            told = (
                {"content": [{"type": "text", "text": str(error.get("message"))}], "isError": True}
                if error
                else message["result"]
            )
            self.write(key, "answered", told)
        return True

    def write(self, key: Any, ended: str, result: dict[str, Any]) -> None:
        """One line of the transcript."""
        call = self.pending.pop(key)
        call.timer.cancel()
        content = result.get("content") or []
        data = result.get("structuredContent")
        texts = [str(c.get("text")) for c in content if c.get("type") == "text"]
        line = {
            "n": call.number,
            "tool": call.tool,
            "arguments": call.arguments,
            "at": call.at,
            "seconds": round(time.monotonic() - call.began, 3),
            "ended": ended,
            "error": bool(result.get("isError")),
            "data": _told(texts) if data is None else data,
            "pictures": sum(c.get("type") == "image" for c in content),
        }
        with self.record.calls_file.open("a") as stream:
            stream.write(json.dumps(line) + "\n")

    def say_error(self, key: Any, text: str) -> None:
        """Answer a call in the server's place."""
        result = {"content": [{"type": "text", "text": text}], "isError": True}
        sys.stdout.buffer.write(json.dumps({"jsonrpc": "2.0", "id": key, "result": result}).encode() + b"\n")
        sys.stdout.buffer.flush()


def _told(texts: list[str]) -> Any:
    """Content of a reply without structured content: its first text, as data where it is JSON."""
    first = texts[0] if texts else ""
    try:
        return json.loads(first)
    except ValueError:
        return first[:20_000]


def _parsed(line: bytes) -> dict[str, Any]:
    try:
        found = json.loads(line)
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


async def _reader_of(stream: Any) -> asyncio.StreamReader:
    reader = asyncio.StreamReader(limit=MOST_BYTES)
    await asyncio.get_running_loop().connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), stream)
    return reader


def main(argv: Sequence[str] | None = None) -> int:
    """Run the relay until its client or its server ends; 1 where something outside the agent ended it."""
    parser = argparse.ArgumentParser(prog="relay", description="Passes the lines of an MCP server on, and keeps limits.")
    parser.add_argument("--record", type=Path, required=True, help="folder of the transcript")
    parser.add_argument("--calls", type=int, default=sys.maxsize, help="tool calls that reach the server")
    parser.add_argument("--call-timeout", type=float, default=600.0, help="longest wait for one answer [s]")
    parser.add_argument("--start", type=float, default=120.0, help="longest wait for the first answer [s]")
    parser.add_argument("command", nargs="+", help="the server, after --")
    code = asyncio.run(_Relay(parser.parse_args(argv)).run())
    sys.stdout.flush()
    os._exit(code)  # a read of standard input that nobody answers would keep the process


if __name__ == "__main__":
    main()
