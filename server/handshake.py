"""Start a stdio server as a client does and take the time until it has named its tools."""

from __future__ import annotations

import contextlib
import json
import subprocess
import threading
import time
from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["seconds_to_tools"]

END_SECONDS = 5.0
"""A server whose client is gone gets this long to end by itself [s]."""
_HANDSHAKE: tuple[dict[str, Any], ...] = (
    {
        "jsonrpc": "2.0",
        "id": 1,
        "method": "initialize",
        "params": {"protocolVersion": "2025-11-25", "capabilities": {}, "clientInfo": {"name": "worldagent", "version": "1"}},
    },
    {"jsonrpc": "2.0", "method": "notifications/initialized"},
    {"jsonrpc": "2.0", "id": 2, "method": "tools/list"},
)


def seconds_to_tools(
    command: Sequence[str], *, environment: Mapping[str, str] | None = None, patience_s: float = 120.0
) -> tuple[float, int]:
    """Time from the start of a stdio server to its answer to `tools/list` [s], and how many tools it named.

    Args:
        command: Program and arguments.
        environment: Environment of the server; default: that of this process.
        patience_s: The server is ended after this time [s].

    Raises:
        OSError: The program can't be started.
        RuntimeError: It ended, or fell silent, without an answer; the text holds its last words.
    """
    begin = time.perf_counter()
    with subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=None if environment is None else dict(environment),
    ) as child:
        assert child.stdin is not None
        assert child.stdout is not None
        assert child.stderr is not None
        words: list[bytes] = []
        listener = threading.Thread(target=lambda errors=child.stderr: words.extend(errors), daemon=True)
        listener.start()
        alarm = threading.Timer(patience_s, child.kill)
        alarm.start()
        try:
            child.stdin.write("".join(json.dumps(message) + "\n" for message in _HANDSHAKE).encode())
            child.stdin.flush()
            for line in child.stdout:
                answer = json.loads(line)
                if answer.get("id") == 2:
                    seconds = time.perf_counter() - begin
                    return seconds, len(answer["result"]["tools"])
        except (BrokenPipeError, ValueError):
            pass
        finally:
            alarm.cancel()
            with contextlib.suppress(BrokenPipeError):
                child.stdin.close()
            try:
                child.wait(END_SECONDS)
            except subprocess.TimeoutExpired:
                child.kill()
        listener.join(2.0)
    said = b"".join(words).decode(errors="replace").strip().splitlines() or ["it said nothing"]
    raise RuntimeError(f"{list(command)[:4]} gave no answer to tools/list within {patience_s:g} s: {said[-1][:300]}")
