"""1,000 malformed messages on each transport in each era: answered as JSON-RPC has it, and the server lives on."""

from __future__ import annotations

import json
import socket
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.hostile.messages import Case, malformed
from worldagent.tests.hostile.wire import (
    ERAS,
    INITIALIZE,
    LEGACY,
    MESSAGE_BYTES,
    MODERN,
    Http,
    Stdio,
    decoded,
    descriptors,
    memory,
    request,
    served,
)

SEED = 20261121
GROWTH = 64_000_000
"""Memory that a server may gain over 1,000 malformed messages [bytes]: a few of the largest messages at a time."""


def owed(case: Case) -> bool:
    """True if an answer is due."""
    return bool(case.codes or case.tool_error or case.result)


def check(case: Case, found: list[dict[str, Any]]) -> None:
    """Check that the answers are what the case is owed."""
    shown = (case.name, case.line[:200], found)
    if not owed(case):
        assert not found, shown
        return
    assert len(found) == 1, shown
    [answer] = found
    assert answer["id"] == case.id, shown
    if "error" in answer:
        assert answer["error"]["code"] in case.codes, shown
        assert answer["error"]["message"], shown
        return
    assert case.result or case.tool_error, shown
    if case.tool_error:
        assert answer["result"]["isError"], shown
        text = answer["result"]["content"][0]["text"]
        assert not text.startswith("internal error"), shown
        assert len(text) < 10_000


@pytest.mark.parametrize("era", ERAS)
def test_stdio_survives_a_thousand_malformed_messages(tmp_path: Path, era: str) -> None:
    cases = malformed(era, SEED)
    assert len(cases) == 1000
    with Stdio(tmp_path, era) as server:
        assert "result" in server.open()
        server.until_good()
        before = memory(server.child.pid)
        for case in cases:
            server.write(case.line)
            found = server.until_good()
            if not found and owed(case):
                found = [server.answer()]
            check(case, found)
        assert memory(server.child.pid) - before < GROWTH
    assert server.child.returncode == 0
    assert "Traceback" not in "".join(server.log)


HEADER_MISMATCH = -32020
"""Code of 2026-07-28 for headers that do not say what the body says."""


def check_http(case: Case, status: int, body: bytes) -> None:
    """Check that an HTTP answer is what the case is owed."""
    shown = (case.name, case.line[:200], status, body[:500])
    assert status < 500, shown
    if not owed(case):
        # Every request of HTTP has a status, and says more than silence where it is no message at all.
        assert status in (202, 400), shown
    elif len(case.line) > MESSAGE_BYTES:
        assert status == 413, shown
    else:
        # What headers and body do not both say is refused before the message is looked at.
        check(replace(case, codes=(*case.codes, HEADER_MISMATCH)), [decoded(body)])


@pytest.mark.parametrize("era", ERAS)
def test_http_survives_a_thousand_malformed_messages(tmp_path: Path, era: str) -> None:
    with served(tmp_path) as (child, port):
        client = Http(port, era)
        client.open()
        client.good()
        before = memory(child.pid)
        for k, case in enumerate(malformed(era, SEED)):
            try:
                body = json.loads(case.line)
            except (ValueError, RecursionError):
                body = None
            try:
                status, _, answer = client.post(case.line, client.headers(body if isinstance(body, dict) else None))
            except ConnectionError:
                assert len(case.line) > MESSAGE_BYTES
            else:
                check_http(case, status, answer)
            if k % 25 == 0:
                client.good()
        client.good()
        assert memory(child.pid) - before < GROWTH
        assert descriptors(child.pid) < 40


WRONG_HEADERS: tuple[dict[str, str], ...] = (
    {"Content-Type": "text/plain"},
    {"Content-Type": "application/json; charset=utf-16"},
    {"Content-Type": "x" * 5000},
    {"Accept": "text/html"},
    {"Accept": ""},
    {"Accept": "*/*;q=0"},
    {"MCP-Protocol-Version": "1999-01-01"},
    {"MCP-Protocol-Version": ""},
    {"MCP-Protocol-Version": "2026-07-28, 2025-11-25"},
    {"MCP-Protocol-Version": "../../etc/passwd"},
    {"Mcp-Session-Id": "no-such-session"},
    {"Mcp-Session-Id": "../../etc/passwd"},
    {"Mcp-Session-Id": "x" * 10_000},
    {"Mcp-Method": "tools/call"},
    {"Mcp-Method": "=?base64?!!!?="},
    {"Mcp-Name": "job"},
    {"Host": "evil.example"},
    {"Host": ""},
    {"Origin": "http://evil.example"},
    {"Origin": "null"},
    {"Origin": "file://"},
    {"Content-Encoding": "gzip"},
    {"Last-Event-ID": "9" * 1000},
    {"X-Forwarded-Host": "evil.example"},
)


@pytest.mark.parametrize("era", ERAS)
def test_wrong_headers_paths_and_methods_are_refused_and_do_no_harm(tmp_path: Path, era: str) -> None:
    ask = json.dumps(request(era, 1, "prompts/list")).encode()
    with served(tmp_path) as (_, port):
        client = Http(port, era)
        client.open()
        for wrong in WRONG_HEADERS:
            status, _, answer = client.post(ask, client.headers(json.loads(ask)) | wrong)
            assert status < 500, (wrong, status, answer)
            client.good()
        for method in ("GET", "PUT", "PATCH", "TRACE", "HEAD", "OPTIONS", "CONNECT", "BREW"):
            headers = {k: v for k, v in client.headers().items() if k != "Accept"}
            status, _, answer = client.post(ask, headers, method=method)
            assert 400 <= status < 500, (method, status, answer)
        for path in (
            "/",
            "/mcp/../etc/passwd",
            "/mcp/..%2f..%2fetc%2fpasswd",
            "//etc/passwd",
            "/mcp%00",
            "/" + "x" * 20_000,
            "/.git/config",
        ):
            status, _, answer = client.post(ask, path=path)
            assert 400 <= status < 500, (path, status, answer)
            assert b"root:" not in answer
        client.good()


BROKEN_FRAMES: tuple[bytes, ...] = (
    b"POST /mcp HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\nContent-Length: 500\r\n\r\n{",
    b"POST /mcp HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: -5\r\n\r\n{}",
    b"POST /mcp HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 99999999999999999999\r\n\r\n{}",
    b"POST /mcp HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 2\r\nContent-Length: 9\r\n\r\n{}",
    b"POST /mcp HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n\r\nFFFFFFFFFFFFFFFFF\r\n{}",
    b"POST /mcp HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n{}\r\n0\r\n\r\n",
    b"POST /mcp HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\nContent-Length: 3\r\n\r\n0\r\n\r\nGET / HTTP/1.1\r\n\r\n",
    b"POST /mcp HTTP/9.9\r\n\r\n",
    b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
    b"GET /mcp\r\n\r\n",
    b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n" + b"X: y\r\n" * 20_000 + b"\r\n",
    b"GET / HTTP/1.1\r\n" + b"A" * 1_000_000,
    b"\0" * 10_000,
    b"{}\n",
    b"",
)


def test_broken_frames_end_their_own_connection_only(tmp_path: Path) -> None:
    with served(tmp_path) as (child, port):
        client = Http(port, MODERN)
        client.good()
        before = descriptors(child.pid)
        for frame in BROKEN_FRAMES * 3:
            with socket.create_connection(("127.0.0.1", port), timeout=10) as link:
                try:
                    link.sendall(frame)
                    link.shutdown(socket.SHUT_WR)
                    answer = link.recv(4096)
                except OSError:
                    answer = b""
                assert not answer.startswith(b"HTTP/1.1 5"), (frame[:80], answer)
                assert b"200 OK" not in answer
            client.good()
        assert descriptors(child.pid) <= before + 2


def test_requests_before_initialize_and_a_second_initialize_do_no_harm(tmp_path: Path) -> None:
    with Stdio(tmp_path, LEGACY) as server:
        for method in ("tools/list", "tools/call", "resources/read", "no/such"):
            server.write(
                json.dumps(
                    request(LEGACY, method, method, {"name": "job", "uri": "worldagent://worlds", "arguments": {}})
                ).encode()
            )
            found = server.answer()
            assert found["id"] == method
            assert found["error"]["code"] in (-32600, -32601, -32602)
        for _ in range(3):
            assert server.open()["result"]["protocolVersion"] == LEGACY
        server.until_good()
        modern = request(MODERN, "modern", "tools/list")
        server.write(json.dumps(modern).encode())
        assert server.answer()["error"]["code"] == -32600
        server.until_good()
    with Stdio(tmp_path, MODERN) as server:
        server.open()
        server.write(json.dumps(request(LEGACY, 1, "initialize", INITIALIZE)).encode())
        assert server.answer()["error"]["code"] == -32022
        server.write(json.dumps(request(LEGACY, 2, "tools/list")).encode())
        assert server.answer()["error"]["code"] == -32602
        server.until_good()


def test_one_id_for_two_requests_in_flight_gets_two_answers(tmp_path: Path) -> None:
    with Stdio(tmp_path, LEGACY) as server:
        server.open()
        for _ in range(50):
            server.write(json.dumps(request(LEGACY, 1, "tools/list")).encode())
        assert all(server.answer()["id"] == 1 for _ in range(50))
        server.until_good()


def test_a_line_of_a_hundred_megabytes_is_refused_without_keeping_it(tmp_path: Path) -> None:
    with Stdio(tmp_path, LEGACY) as server:
        server.open()
        server.until_good()
        before = memory(server.child.pid, "VmHWM")
        server.write(b'{"jsonrpc":"2.0","id":77,"method":"tools/call","params":{"a":"', end=b"")
        for _ in range(100):
            server.write(b"x" * 1_000_000, end=b"")
        server.write(b'"}}')
        answer = server.answer()
        assert answer["id"] == 77
        assert answer["error"]["code"] == -32600
        assert str(MESSAGE_BYTES) in answer["error"]["message"]
        server.until_good()
        assert memory(server.child.pid, "VmHWM") - before < 4 * MESSAGE_BYTES


def test_a_frame_cut_off_by_the_end_of_the_client_ends_the_server_quietly(tmp_path: Path) -> None:
    server = Stdio(tmp_path, LEGACY)
    with server:
        server.open()
        server.write(json.dumps(request(LEGACY, 1, "tools/list")).encode()[:-9], end=b"")
    assert server.child.returncode == 0
    assert "Traceback" not in "".join(server.log)
