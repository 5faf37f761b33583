"""Connections that say half of something and no more: the server goes on for all others."""

from __future__ import annotations

import json
import socket
import time
from contextlib import ExitStack
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from worldagent.tests.stories.servers import Remote, http

HALF_OPEN = 24
PATIENCE_S = 20.0
"""For a call beside half-open connections on a loaded machine [s]; it takes some milliseconds on an idle one."""
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")


def _initialize() -> bytes:
    return json.dumps(
        {
            "jsonrpc": "2.0",
            "id": 1,
            "method": "initialize",
            "params": {"protocolVersion": "2025-11-25", "capabilities": {}, "clientInfo": {"name": "half", "version": "1"}},
        }
    ).encode()


def _half(kind: str, place: str) -> bytes:
    """The beginning of a request."""
    head = f"POST /mcp HTTP/1.1\r\nHost: {place}\r\nContent-Type: application/json\r\nAccept: application/json, text/event-stream\r\n"
    if kind == "nothing":
        return b""
    if kind == "half a head":
        return head.encode()[:60]
    body = _initialize()
    whole = f"{head}Content-Length: {len(body)}\r\n\r\n".encode() + body
    return whole[:-20] if kind == "half a body" else whole


@pytest.mark.parametrize("kind", ["nothing", "half a head", "half a body", "an answer that nobody reads"])
def test_half_open_connections_hold_up_nobody_else(kind: str, accepted_folder: Path) -> None:
    with http(accepted_folder.parent) as (url, child), ExitStack() as stack:
        place = urlsplit(url).netloc
        name, _, port = place.partition(":")
        sockets = [stack.enter_context(socket.create_connection((name, int(port)), timeout=10)) for _ in range(HALF_OPEN)]
        for half_open in sockets:
            half_open.sendall(_half(kind, place))
        for era in ("auto", "legacy"):
            with Remote(accepted_folder.parent, url, era=era) as agent:
                begin = time.monotonic()
                assert agent.call("inspect_world", part="worlds")["worlds"] == ["w"]
                assert time.monotonic() - begin < PATIENCE_S
        for half_open in sockets[::2]:
            half_open.close()
        with Remote(accepted_folder.parent, url) as agent:
            assert agent.call("inspect_world", part="worlds")["worlds"] == ["w"]
        assert child.poll() is None
