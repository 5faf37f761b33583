"""A client that writes raw bytes to a server process, and reads what comes back."""

from __future__ import annotations

import http.client
import json
import queue
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Self

from mcp.shared.inbound import encode_header_value
from worldagent.server.messages import MESSAGE_BYTES

MODERN, LEGACY = "2026-07-28", "2025-11-25"
ERAS = (LEGACY, MODERN)
PATIENCE_S = 90.0
"""A server that says nothing for so long hangs [s]; on a machine with ten times the work of its cores, a start takes 20 s."""
ENVELOPE = {
    "io.modelcontextprotocol/protocolVersion": MODERN,
    "io.modelcontextprotocol/clientCapabilities": {},
    "io.modelcontextprotocol/clientInfo": {"name": "hostile", "version": "1"},
}
INITIALIZE = {"protocolVersion": LEGACY, "capabilities": {}, "clientInfo": {"name": "hostile", "version": "1"}}
HEADERS = {"Content-Type": "application/json", "Accept": "application/json, text/event-stream"}

__all__ = ["ERAS", "INITIALIZE", "LEGACY", "MESSAGE_BYTES", "MODERN", "Http", "Stdio", "request", "served"]


def request(era: str, name: Any, method: str, params: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """A request as a client of that era sends it."""
    given = dict(params or {})
    if era == MODERN:
        given["_meta"] = ENVELOPE
    return {"jsonrpc": "2.0", "id": name, "method": method, "params": given}


def memory(pid: int, field: str = "VmRSS") -> int:
    """Memory of a process [bytes]; `VmHWM` is its peak."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return 1024 * int(next(line for line in lines if line.startswith(field)).split()[1])


class Stdio:
    """A stdio server process."""

    def __init__(self, workspace: Path, era: str) -> None:
        command = [sys.executable, "-m", "worldagent.server", "serve", "--workspace", str(workspace)]
        self.era = era
        self.child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.log: list[str] = []
        self._answers: queue.Queue[dict[str, Any] | None] = queue.Queue()
        self._threads = [threading.Thread(target=reader) for reader in (self._read_answers, self._read_log)]
        for thread in self._threads:
            thread.start()
        self._count = 0

    def _read_answers(self) -> None:
        assert self.child.stdout is not None
        for line in self.child.stdout:
            self._answers.put(json.loads(line))
        self._answers.put(None)

    def _read_log(self) -> None:
        assert self.child.stderr is not None
        self.log.extend(line.decode(errors="replace") for line in self.child.stderr)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        assert self.child.stdin is not None
        with suppress(BrokenPipeError):
            self.child.stdin.close()
        try:
            self.child.wait(10)
        finally:
            self.child.kill()
            self.child.wait()
            for thread in self._threads:
                thread.join()
            for stream in (self.child.stdout, self.child.stderr):
                assert stream is not None
                stream.close()

    def write(self, line: bytes, *, end: bytes = b"\n") -> None:
        """Send raw bytes."""
        assert self.child.stdin is not None
        self.child.stdin.write(line + end)
        self.child.stdin.flush()

    def answer(self, patience_s: float = PATIENCE_S) -> dict[str, Any]:
        """The next answer that is no notification.

        Raises:
            AssertionError: the process ended, or nothing came.
        """
        while True:
            try:
                found = self._answers.get(timeout=patience_s)
            except queue.Empty:
                raise AssertionError(f"no answer within {patience_s} s") from None
            assert found is not None, f"the server ended with {self.child.poll()}: {''.join(self.log)[-2000:]}"
            if "id" in found:
                return found

    def open(self) -> dict[str, Any]:
        """Open the connection as the era has it."""
        if self.era == LEGACY:
            self.write(json.dumps(request(LEGACY, "open", "initialize", INITIALIZE)).encode())
            found = self.answer()
            self.write(b'{"jsonrpc":"2.0","method":"notifications/initialized"}')
            return found
        self.write(json.dumps(request(MODERN, "open", "server/discover")).encode())
        return self.answer()

    def until_good(self) -> list[dict[str, Any]]:
        """Answers before the one to a good call, which must be right."""
        self._count += 1
        name = f"good-{self._count}"
        self.write(json.dumps(request(self.era, name, "prompts/list")).encode())
        before = []
        while (found := self.answer())["id"] != name:
            before.append(found)
        assert len(found["result"]["prompts"]) == 3
        return before


@contextmanager
def served(workspace: Path) -> Iterator[tuple[subprocess.Popen[bytes], int]]:
    """An HTTP server process on a free port of loopback."""
    command = [sys.executable, "-m", "worldagent.server", "serve", "--workspace", str(workspace), "--transport", "http"]
    with subprocess.Popen([*command, "--port", "0"], stderr=subprocess.PIPE) as child:
        try:
            assert child.stderr is not None
            while b"http://" not in (line := child.stderr.readline()):
                assert line, "the server ended"
            drain = threading.Thread(target=lambda: [None for _ in iter(child.stderr.readline, b"")], daemon=True)  # type: ignore[union-attr]
            drain.start()
            yield child, int(line.split(b"http://", 1)[1].split(b"/")[0].rsplit(b":", 1)[1])
        finally:
            child.terminate()
            child.wait(10)


class Http:
    """A client of an HTTP server process, of one era."""

    def __init__(self, port: int, era: str) -> None:
        self.port, self.era, self.session = port, era, ""
        self._count = 0

    def headers(self, body: Mapping[str, Any] | None = None) -> dict[str, str]:
        """Headers that a good client sends with a message."""
        found = dict(HEADERS)
        found["MCP-Protocol-Version"] = self.era
        if self.era == LEGACY and self.session:
            found["Mcp-Session-Id"] = self.session
        if self.era == MODERN and body is not None:
            params = body.get("params")
            found["Mcp-Method"] = encode_header_value(str(body.get("method")))
            name = (params.get("name") or params.get("uri")) if isinstance(params, dict) else None
            if name is not None:
                found["Mcp-Name"] = encode_header_value(str(name))
        return found

    def post(
        self, body: bytes, headers: Mapping[str, str] | None = None, *, method: str = "POST", path: str = "/mcp"
    ) -> tuple[int, dict[str, str], bytes]:
        """Status, headers and body of the answer."""
        link = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_S)
        try:
            link.request(method, path, body, dict(headers if headers is not None else self.headers()))
            found = link.getresponse()
            return found.status, {k.lower(): v for k, v in found.getheaders()}, found.read()
        finally:
            link.close()

    def call(self, body: Mapping[str, Any]) -> dict[str, Any]:
        """The JSON-RPC answer to a good message."""
        status, headers, found = self.post(json.dumps(body).encode(), self.headers(body))
        if "mcp-session-id" in headers:
            self.session = headers["mcp-session-id"]
        assert status in (200, 202), (status, found)
        return decoded(found) if found else {}

    def open(self) -> None:
        """Open a session where the era has one."""
        if self.era == LEGACY:
            self.call(request(LEGACY, "open", "initialize", INITIALIZE))
            self.call({"jsonrpc": "2.0", "method": "notifications/initialized"})

    def good(self) -> None:
        """A good call, which must be answered rightly."""
        self._count += 1
        found = self.call(request(self.era, self._count, "prompts/list"))
        assert found["id"] == self._count
        assert len(found["result"]["prompts"]) == 3


def decoded(body: bytes) -> dict[str, Any]:
    """The last JSON-RPC message of a body, plain or as server-sent events."""
    text = body.decode()
    if not text.startswith("{"):
        data = [line[6:] for line in text.splitlines() if line.startswith("data: {")]
        text = data[-1]
    found: dict[str, Any] = json.loads(text)
    return found


def descriptors(pid: int) -> int:
    """Open file descriptors of a process."""
    return sum(1 for _ in Path(f"/proc/{pid}/fd").iterdir())
