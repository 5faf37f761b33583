"""A reader on this machine that answers what a test tells it to: plumbing alone, no judgement."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, NamedTuple

__all__ = ["Answer", "Call", "Fake", "anthropic", "openai", "serving"]


class Call(NamedTuple):
    """One request as it came."""

    path: str
    headers: dict[str, str]
    body: dict[str, Any]

    @property
    def text(self) -> str:
        """The text of its message."""
        return str(self.body["messages"][0]["content"][-1]["text"])


class Fake(NamedTuple):
    """Where it listens and what it was asked."""

    url: str
    calls: list[Call]


Answer = Callable[[Call, int], tuple[int, dict[str, str], bytes]]


def openai(text: Any, **more: Any) -> tuple[int, dict[str, str], bytes]:
    """A reply of a chat completion."""
    content = text if isinstance(text, str) or text is None else json.dumps(text)
    return 200, {}, json.dumps({"choices": [{"message": {"role": "assistant", "content": content, **more}}]}).encode()


def anthropic(text: Any, stop: str = "end_turn") -> tuple[int, dict[str, str], bytes]:
    """A reply of the Messages API."""
    return 200, {}, json.dumps({"stop_reason": stop, "content": [{"type": "text", "text": json.dumps(text)}]}).encode()


@contextmanager
def serving(answer: Answer) -> Iterator[Fake]:
    """A server on a free port of loopback, until the end of the block."""
    calls: list[Call] = []

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            raw = self.rfile.read(int(self.headers["Content-Length"]))
            call = Call(self.path, {k.lower(): v for k, v in self.headers.items()}, json.loads(raw))
            calls.append(call)
            status, headers, body = answer(call, len(calls))
            self.send_response(status)
            for name, value in headers.items():
                self.send_header(name, value)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            try:
                self.wfile.write(body)
            except OSError:  # the reader of a huge answer has hung up
                return

        def log_message(self, *_: Any) -> None:
            """Nothing on stderr."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True)
    thread.start()
    try:
        yield Fake(f"http://127.0.0.1:{server.server_address[1]}/v1", calls)
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
