"""Benchmark `startup`: time from starting a server to its first `tools/list`, against a server of the SDK with nothing in it.

Both are started as a client starts them (`python -m ...` over stdio) and asked for their tools by the raw protocol,
so that the client's own start does not count. Target: at most 0.5 s above the bare SDK.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
from typing import Any

from ..server.handshake import seconds_to_tools

__all__ = ["BARE_SERVER", "run"]

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
