"""The server as clients start it: a stdio process, and HTTP on loopback."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import anyio
import pytest
from mcp import Client, StdioServerParameters
from worldagent.server.cli import main
from worldagent.server.http import check_binding, transport_security
from worldagent.server.tokens import TokenBook
from worldagent.worlds.errors import InputError

TOKEN = "a-token-of-32-characters-or-more"
INITIALIZE = {
    "jsonrpc": "2.0",
    "id": 1,
    "method": "initialize",
    "params": {"protocolVersion": "2025-11-25", "capabilities": {}, "clientInfo": {"name": "test", "version": "1"}},
}


@pytest.mark.anyio
async def test_stdio_process_serves_both_eras(tmp_path: Path, fake_process: list[str], era: str) -> None:
    command = StdioServerParameters(command=fake_process[0], args=[*fake_process[1:], "stdio", str(tmp_path)])
    with anyio.fail_after(30):
        async with Client(command, mode=era) as client:
            assert "measure" in [tool.name for tool in (await client.list_tools()).tools]
            result = await client.call_tool("measure", {"frames": 5})
            assert result.structured_content is not None
            assert result.structured_content["frames"] == 5
            assert (await client.call_tool("show", {})).content[1].type == "image"


def test_a_stdio_process_ends_with_its_client_even_if_a_tool_is_stuck(tmp_path: Path, fake_process: list[str]) -> None:
    call = {
        "jsonrpc": "2.0",
        "id": 2,
        "method": "tools/call",
        "params": {"name": "stick", "arguments": {}, "_meta": {"progressToken": "p"}},
    }
    messages = (INITIALIZE, {"jsonrpc": "2.0", "method": "notifications/initialized"}, call)
    with subprocess.Popen([*fake_process, "stdio", str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as child:
        assert child.stdin is not None
        assert child.stdout is not None
        try:
            child.stdin.write("".join(json.dumps(message) + "\n" for message in messages).encode())
            child.stdin.flush()
            while b"stuck" not in child.stdout.readline():
                pass
            child.stdin.close()
            assert child.wait(timeout=20) == 0
        finally:
            child.kill()


def test_an_interrupt_ends_a_stdio_process_that_waits_for_its_client(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "worldagent.server", "serve", "--workspace", str(tmp_path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as child:
        assert child.stdin is not None
        assert child.stdout is not None
        try:
            child.stdin.write(json.dumps(INITIALIZE).encode() + b"\n")
            child.stdin.flush()
            assert json.loads(child.stdout.readline())["result"]["serverInfo"]["name"] == "worldagent"
            child.send_signal(signal.SIGINT)
            assert child.wait(timeout=20) == -signal.SIGINT
        finally:
            child.kill()


@contextmanager
def served(command: list[str]) -> Iterator[str]:
    """URL of a server process on a free port."""
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as child:
        try:
            assert child.stderr is not None
            line = child.stderr.readline()
            assert "http://" in line, line + child.stderr.read()
            yield line[line.index("http://") :].strip()
        finally:
            child.terminate()


def status(url: str, **headers: str) -> int:
    """HTTP status of an initialize request."""
    request = urllib.request.Request(
        url,
        json.dumps(INITIALIZE).encode(),
        {"Content-Type": "application/json", "Accept": "application/json, text/event-stream"}
        | {k.title(): v for k, v in headers.items()},
    )
    try:
        with urllib.request.urlopen(request, timeout=20) as answer:
            return int(answer.status)
    except urllib.error.HTTPError as error:
        with error:
            return error.code


@pytest.mark.anyio
async def test_http_without_token_serves_loopback_and_checks_host_and_origin(tmp_path: Path, fake_process: list[str]) -> None:
    with served([*fake_process, "http", str(tmp_path)]) as url:
        with anyio.fail_after(30):
            for era in ("auto", "legacy"):
                async with Client(url, mode=era) as client:
                    assert (await client.call_tool("measure", {"frames": 5})).is_error is False
        assert status(url) == 200
        assert status(url, host="evil.example") == 421
        assert status(url, origin="http://evil.example") == 403
        assert status(url, origin=url.removesuffix("/mcp")) == 200


def test_http_with_token_refuses_all_others(tmp_path: Path, fake_process: list[str]) -> None:
    with served([*fake_process, "http", str(tmp_path), TOKEN]) as url:
        assert status(url) == 401
        assert status(url, authorization="Bearer wrong") == 401
        assert status(url, authorization=f"Basic {TOKEN}") == 401
        assert status(url, authorization=f"Bearer {TOKEN}") == 200
        assert status(url, authorization=f"Bearer {TOKEN}", host="evil.example") == 421


@pytest.mark.parametrize(
    ("host", "token", "names", "told"),
    [
        ("192.168.1.5", None, [], "token"),
        ("0.0.0.0", None, [], "token"),
        ("0.0.0.0", TOKEN, [], "allow-host"),
        ("127.0.0.1", "short", [], "at least 16"),
    ],
)
def test_open_bindings_are_refused(tmp_path: Path, host: str, token: str | None, names: list[str], told: str) -> None:
    with pytest.raises(InputError, match=told):
        check_binding(host, TokenBook(tmp_path, given=token), names)


@pytest.mark.parametrize(
    ("host", "token", "names"), [("127.0.0.1", None, []), ("::1", None, []), ("0.0.0.0", TOKEN, ["render.lan"])]
)
def test_other_bindings_are_allowed(tmp_path: Path, host: str, token: str | None, names: list[str]) -> None:
    check_binding(host, TokenBook(tmp_path, given=token), names)
    settings = transport_security(host, names)
    assert settings.enable_dns_rebinding_protection
    assert all(f"{name}:*" in settings.allowed_hosts for name in names)


def test_the_command_refuses_an_open_host_with_a_text(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("WORLDAGENT_TOKEN", raising=False)
    assert main(["serve", "--transport", "http", "--host", "0.0.0.0", "--port", "0"]) == 2
    assert "--token" in capsys.readouterr().err


def test_a_port_in_use_is_told(tmp_path: Path, fake_process: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with served([*fake_process, "http", str(tmp_path)]) as url:
        port = url.split(":")[2].split("/")[0]
        child = subprocess.run(
            [sys.executable, "-c", "import sys; from worldagent.server.http import serve_http; from pathlib import Path\n"
             f"serve_http(Path('.'), host='127.0.0.1', port={port}, token=None, tools=(), announce=print)"],
            capture_output=True, text=True, timeout=30, check=False,
        )  # fmt: skip
    assert child.returncode != 0
    assert "choose another --port" in child.stderr
