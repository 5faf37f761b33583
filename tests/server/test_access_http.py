"""The HTTP server as a process: who comes in, what scopes allow, and that slow or many connections keep nobody out."""

from __future__ import annotations

import json
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import AsyncIterator, Iterator
from contextlib import ExitStack, asynccontextmanager, contextmanager, suppress
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import anyio
import httpx2
import pytest
from mcp import Client
from mcp.client.streamable_http import streamable_http_client
from mcp.shared.exceptions import MCPError
from mcp.types import EmptyResult, Request, RequestParams
from worldagent.server.scopes import INSUFFICIENT_SCOPE, reads_only
from worldagent.server.tokens import TokenBook
from worldagent.tools import TOOLS

INITIALIZE = {
    "jsonrpc": "2.0",
    "id": 1,
    "method": "initialize",
    "params": {"protocolVersion": "2025-11-25", "capabilities": {}, "clientInfo": {"name": "test", "version": "1"}},
}


@contextmanager
def served(command: list[str], log: Path) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """URL and process of a server on a free port; its log goes to a file."""
    with log.open("wb") as file, subprocess.Popen(command, stderr=file) as child:
        try:
            deadline = time.monotonic() + 120
            while "http://" not in (text := log.read_text()):
                assert child.poll() is None, text
                assert time.monotonic() < deadline, text
                time.sleep(0.02)
            yield text[text.index("http://") :].split()[0], child
        finally:
            child.kill()


@asynccontextmanager
async def client_of(url: str, token: str, era: str) -> AsyncIterator[Client]:
    headers = {"Authorization": f"Bearer {token}"}
    async with (
        httpx2.AsyncClient(headers=headers, timeout=20) as http,
        Client(streamable_http_client(url, http_client=http), mode=era) as client,
    ):
        yield client


def connect(url: str) -> socket.socket:
    parts = urlsplit(url)
    return socket.create_connection((parts.hostname, parts.port), timeout=15)


def get(url: str, path: str, **headers: str) -> tuple[int, dict[str, str], bytes]:
    request = urllib.request.Request(url.removesuffix("/mcp") + path, headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=15) as answer:
            return answer.status, dict(answer.headers), answer.read()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, dict(error.headers), error.read()


@pytest.fixture
def book(tmp_path: Path) -> TokenBook:
    return TokenBook(tmp_path / "ws")


@pytest.fixture
def server(tmp_path: Path, fake_process: list[str], book: TokenBook) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    book.add("first", "read")
    with served([*fake_process, "http", str(tmp_path / "ws")], tmp_path / "log") as running:
        yield running


@pytest.mark.anyio
async def test_a_read_token_reads_and_a_write_token_writes(
    server: tuple[str, Any], book: TokenBook, era: str, tmp_path: Path
) -> None:
    url, _ = server
    reader, writer = book.add("reader", "read"), book.add("writer", "write")
    with anyio.fail_after(30):
        async with client_of(url, reader, era) as client:
            assert (await client.call_tool("measure", {"frames": 5})).is_error is False
            assert json.loads((await client.read_resource("worldagent://worlds")).contents[0].text)  # type: ignore[union-attr]
            refused = await client.call_tool("fail", {"kind": "refused"})
            assert refused.is_error
            told = refused.content[0].text  # type: ignore[union-attr]
            assert told.startswith("insufficient_scope: fail")
            assert "'write'" in told
            assert (await client.call_tool("measure", {"frames": 6})).is_error is False, "the connection lives on"
        async with client_of(url, writer, era) as client:
            allowed = await client.call_tool("fail", {"kind": "refused"})
            assert allowed.content[0].text.startswith("refused: no passing probe")  # type: ignore[union-attr]
    log = (tmp_path / "log").read_text()
    assert reader not in log
    assert writer not in log


@pytest.mark.anyio
async def test_a_session_of_one_token_is_closed_to_another(server: tuple[str, Any], book: TokenBook) -> None:
    url, _ = server
    tokens = [book.add(name, "write") for name in ("mine", "theirs")]
    accept = {"Accept": "application/json, text/event-stream", "Content-Type": "application/json"}
    async with httpx2.AsyncClient(timeout=20) as http:
        mine, theirs = ({**accept, "Authorization": f"Bearer {token}"} for token in tokens)
        began = await http.post(url, json=INITIALIZE, headers=mine)
        session = {"Mcp-Session-Id": began.headers["mcp-session-id"], "Mcp-Protocol-Version": "2025-11-25"}
        call = {"jsonrpc": "2.0", "id": 2, "method": "tools/list", "params": {}}
        assert (await http.post(url, json=call, headers={**mine, **session})).status_code == 200
        assert (await http.post(url, json=call, headers={**theirs, **session})).status_code == 404
        assert (await http.delete(url, headers={**theirs, **session})).status_code == 404
        book.revoke("mine")
        assert (await http.post(url, json=call, headers={**mine, **session})).status_code == 401


@pytest.mark.anyio
async def test_methods_that_change_tasks_need_write(server: tuple[str, Any], book: TokenBook) -> None:
    url, _ = server
    async with client_of(url, book.add("reader", "read"), "auto") as client:
        with pytest.raises(MCPError) as caught:
            await client.session.send_request(Request(method="tasks/cancel", params=RequestParams()), EmptyResult)
    assert caught.value.code == INSUFFICIENT_SCOPE


def test_every_tool_is_sorted_into_reading_and_writing() -> None:
    reading = {t.name for t in TOOLS if reads_only(t, {})}
    assert reading == {"inspect_world"}
    (job,) = [t for t in TOOLS if t.name == "job"]
    assert all(reads_only(job, {"action": action}) for action in ("status", "wait", "list"))
    assert not reads_only(job, {"action": "cancel"})
    assert not reads_only(job, {"action": "CANCEL"})
    assert not reads_only(job, {})


def test_sessions_are_counted(tmp_path: Path, fake_process: list[str]) -> None:
    script = tmp_path / "few.py"
    script.write_text(
        "import runpy, sys\nfrom worldagent.server import http\nhttp.MAX_SESSIONS = 2\n"
        f"sys.argv = sys.argv[1:]\nrunpy.run_path({fake_process[1]!r}, run_name='__main__')\n"
    )
    headers = {"Accept": "application/json, text/event-stream", "Content-Type": "application/json"}
    command = [fake_process[0], str(script), fake_process[1], "http", str(tmp_path / "ws")]
    with served(command, tmp_path / "log") as (url, _), httpx2.Client(timeout=20) as http:
        answers = [http.post(url, json=INITIALIZE, headers=headers) for _ in range(3)]
        assert [answer.status_code for answer in answers] == [200, 200, 503]
        session = {"Mcp-Session-Id": answers[0].headers["mcp-session-id"], "Mcp-Protocol-Version": "2025-11-25"}
        assert http.delete(url, headers=headers | session).status_code == 200
        assert http.post(url, json=INITIALIZE, headers=headers).status_code == 200


def test_health_tells_nothing_but_that_it_lives(server: tuple[str, Any]) -> None:
    url, _ = server
    status, headers, body = get(url, "/healthz")
    assert status == 200
    assert set(json.loads(body)) == {"ok", "version"}
    assert "server" not in {name.lower() for name in headers}
    assert headers["x-content-type-options"] == "nosniff"
    assert get(url, "/healthz", Host="evil.example")[0] == 421
    assert get(url, "/api/anything")[0] == 401
    assert get(url, "/.well-known/oauth-protected-resource")[0] == 404


def test_a_head_too_large_and_nonsense_are_refused(server: tuple[str, Any]) -> None:
    url, _ = server
    for sent in (b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\nX: " + b"a" * 40_000, b"\x16\x03\x01" * 100 + b"\r\n\r\n"):
        with connect(url) as wire:
            wire.sendall(sent)
            assert b" 400 " in wire.recv(100)
    assert get(url, "/healthz")[0] == 200


def test_slow_and_idle_connections_are_closed_and_keep_nobody_out(tmp_path: Path, fake_process: list[str]) -> None:
    """The deadline is shortened for the test, the code is the same."""
    script = tmp_path / "quick.py"
    script.write_text(
        "import runpy, sys\nfrom worldagent.server import connections\n"
        "connections.HEAD_SECONDS, connections.MOST_CONNECTIONS, connections.ACCEPTED_BEYOND = 1.0, 6, 4\n"
        f"sys.argv = sys.argv[1:]\nrunpy.run_path({fake_process[1]!r}, run_name='__main__')\n"
    )
    command = [fake_process[0], str(script), fake_process[1], "http", str(tmp_path / "ws")]
    with served(command, tmp_path / "log") as (url, child):
        with ExitStack() as opened:
            slow = [opened.enter_context(connect(url)) for _ in range(6)]
            for wire in slow[::2]:
                wire.sendall(b"GET /healthz HTTP/1.1\r\nHost: 127")
            assert get(url, "/healthz")[0] == 503, "more than the limit are told to come back"
            beyond = [opened.enter_context(connect(url)) for _ in range(8)]
            for wire in [*slow, *beyond]:
                wire.settimeout(10)
                with suppress(ConnectionResetError):
                    assert wire.recv(10) == b"", "closed by the server"
            assert get(url, "/healthz")[0] == 200
        assert child.poll() is None


def test_a_second_request_that_stalls_is_closed_too(tmp_path: Path, fake_process: list[str]) -> None:
    script = tmp_path / "quick.py"
    script.write_text(
        "import runpy, sys\nfrom worldagent.server import connections\nconnections.HEAD_SECONDS = 0.5\n"
        "connections.KEEP_ALIVE_SECONDS = 600\n"
        f"sys.argv = sys.argv[1:]\nrunpy.run_path({fake_process[1]!r}, run_name='__main__')\n"
    )
    command = [fake_process[0], str(script), fake_process[1], "http", str(tmp_path / "ws")]
    with served(command, tmp_path / "log") as (url, _), connect(url) as wire:
        wire.settimeout(60)
        wire.sendall(b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
        assert b"200 OK" in wire.recv(4000)
        wire.sendall(b"GET /healthz HT")
        began = time.monotonic()
        with suppress(ConnectionResetError):
            while wire.recv(4000):
                pass
        assert time.monotonic() - began < 30, "well below the keep-alive time of a connection that asks nothing"


def test_the_server_ends_within_three_seconds_although_streams_are_open(server: tuple[str, Any], book: TokenBook) -> None:
    url, child = server
    token = book.add("listener", "read")
    headers = f"Host: 127.0.0.1\r\nAuthorization: Bearer {token}\r\nContent-Type: application/json\r\n"
    headers += "Accept: application/json, text/event-stream\r\n"
    body = json.dumps(INITIALIZE)
    with connect(url) as first, connect(url) as stream, connect(url) as call:
        first.sendall(f"POST /mcp HTTP/1.1\r\n{headers}Content-Length: {len(body)}\r\n\r\n{body}".encode())
        answer = first.recv(10_000).decode()
        (session,) = [line.split(": ")[1] for line in answer.split("\r\n") if line.lower().startswith("mcp-session-id")]
        headers += f"Mcp-Session-Id: {session}\r\nMcp-Protocol-Version: 2025-11-25\r\n"
        stream.sendall(f"GET /mcp HTTP/1.1\r\n{headers}\r\n".encode())
        assert b"text/event-stream" in stream.recv(4000)
        body = json.dumps(
            {
                "jsonrpc": "2.0",
                "id": 2,
                "method": "tools/call",
                "params": {"name": "stick", "arguments": {}, "_meta": {"progressToken": "p"}},
            }
        )
        call.sendall(f"POST /mcp HTTP/1.1\r\n{headers}Content-Length: {len(body)}\r\n\r\n{body}".encode())
        heard = b""
        while b"stuck" not in heard:
            heard += call.recv(4000)
        began = time.monotonic()
        child.send_signal(signal.SIGTERM)
        child.wait(timeout=120)
        took = time.monotonic() - began
    # How long the least process takes now says how busy this machine is.
    began = time.monotonic()
    subprocess.run([sys.executable, "-S", "-c", "pass"], check=True)
    assert took < 3.0 + 10 * (time.monotonic() - began)
