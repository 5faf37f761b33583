"""A stdio server that misbehaves on demand: `python fake_server.py MODE`, and each call says what to `do`."""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path
from typing import Any

TOOLS = ("edit_spec", "place_object", "probe_sim", "bake_sim", "run_checks", "render_shot", "inspect_world", "job")
SCHEMA = {
    "type": "object",
    "properties": {
        "world": {"type": "string"},
        "do": {"type": "string"},
        "prompt": {"type": "string"},
        "count": {"type": "integer", "minimum": 1, "maximum": 9},
    },
    "required": ["world"],
}


def say(message: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps({"jsonrpc": "2.0", **message}) + "\n")
    sys.stdout.flush()


def acted(do: str, arguments: dict[str, Any]) -> dict[str, Any]:
    if do == "crash" or (do == "crash_once" and not _marked(Path(arguments["marker"]))):
        sys.stderr.write("the fake server falls over\n")
        sys.stderr.flush()
        os._exit(7)
    if do == "hang":
        time.sleep(600)
    if do == "wait":
        gate = Path(arguments["marker"])
        gate.with_suffix(".there").touch()
        while not gate.exists():
            time.sleep(0.01)
    if do == "flood_bytes":
        sys.stdout.write('{"x": "' + "y" * int(arguments["count"]) + '"}\n')
        sys.stdout.flush()
    if do == "flood_messages":
        for k in range(int(arguments["count"])):
            say({"method": "notifications/message", "params": {"level": "info", "data": str(k)}})
    told = {"summary": f"did {do}", "passed": True, "counts": {"pass": 1}}
    text = "refused: as asked" if do == "refuse" else json.dumps(told)
    content = [{"type": "text", "text": text}]
    return {"content": content, "isError": do == "refuse", **({} if do == "refuse" else {"structuredContent": told})}


def _marked(path: Path) -> bool:
    there = path.exists()
    path.touch()
    return there


def main(mode: str) -> None:
    if mode == "dead":
        sys.exit(3)
    for line in sys.stdin:
        message = json.loads(line)
        method, key = message.get("method"), message.get("id")
        if key is None or mode == "mute":
            continue
        if method == "initialize":
            info = {"name": "fake", "version": "1"}
            say(
                {
                    "id": key,
                    "result": {
                        "protocolVersion": "2025-11-25",
                        "capabilities": {"tools": {}},
                        "serverInfo": info,
                        "instructions": "Be fake.",
                    },
                }
            )
        elif method == "tools/list":
            names = TOOLS[:3] if mode == "poor" else TOOLS
            say({"id": key, "result": {"tools": [{"name": n, "description": n, "inputSchema": SCHEMA} for n in names]}})
        elif method == "tools/call":
            arguments = message["params"].get("arguments") or {}
            say({"id": key, "result": acted("refuse" if mode == "strict" else arguments.get("do", "answer"), arguments)})
        else:
            say({"id": key, "result": {}})


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "")
