"""Benchmark `startup`: time from starting a server to its first `tools/list`, against a server of the SDK with nothing in it.

Both are started as a client starts them (`python -m ...` over stdio) and asked for their tools by the raw protocol,
so that the client's own start does not count. Target: at most 0.5 s above the bare SDK.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from typing import Any

__all__ = ["BARE_SERVER", "run", "seconds_to_tools"]

ROUNDS = 9
BARE_SERVER = """
from mcp.server import MCPServer
server = MCPServer("bare")

@server.tool()
def add(a: int, b: int) -> int:
    "Add two numbers."
    return a + b

server.run()
"""
_HANDSHAKE: tuple[dict[str, Any], ...] = (
    {
        "jsonrpc": "2.0",
        "id": 1,
        "method": "initialize",
        "params": {"protocolVersion": "2025-11-25", "capabilities": {}, "clientInfo": {"name": "bench", "version": "1"}},
    },
    {"jsonrpc": "2.0", "method": "notifications/initialized"},
    {"jsonrpc": "2.0", "id": 2, "method": "tools/list"},
)


def seconds_to_tools(command: Sequence[str]) -> tuple[float, int]:
    """Time from the start of a stdio server to its answer to `tools/list` [s], and how many tools it named."""
    begin = time.perf_counter()
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as child:
        assert child.stdin is not None
        assert child.stdout is not None
        child.stdin.write("".join(json.dumps(message) + "\n" for message in _HANDSHAKE).encode())
        child.stdin.flush()
        for line in child.stdout:
            answer = json.loads(line)
            if answer.get("id") == 2:
                seconds = time.perf_counter() - begin
                child.stdin.close()
                return seconds, len(answer["result"]["tools"])
    raise RuntimeError(f"{command[:4]} ended without an answer to tools/list")


def run() -> dict[str, Any]:
    """Medians of alternated starts; the first start of each only fills the file cache."""
    ours: list[float] = []
    bare: list[float] = []
    count = 0
    with tempfile.TemporaryDirectory() as workspace:
        serve = [sys.executable, "-m", "worldagent.server", "serve", "--workspace", workspace]
        for number in range(ROUNDS + 1):
            seconds, count = seconds_to_tools(serve)
            other, _ = seconds_to_tools([sys.executable, "-c", BARE_SERVER])
            print(f"start {number}: worldagent {seconds:.3f} s, bare SDK {other:.3f} s", file=sys.stderr)
            if number:
                ours.append(seconds)
                bare.append(other)
    return {
        "tools_list_s": round(statistics.median(ours), 3),
        "bare_sdk_s": round(statistics.median(bare), 3),
        "above_bare_s": round(statistics.median(ours) - statistics.median(bare), 3),
        "slowest_s": round(max(ours), 3),
        "tools": count,
        "starts": ROUNDS,
    }
