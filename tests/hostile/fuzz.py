"""Fuzzing of specifications, patches, arguments and messages through the real server: `make fuzz`.

    python -m worldagent.tests.hostile.fuzz [--seconds 600] [--seed N]

One half of the time goes to a server in memory, one to a stdio process. What counts as a find: an answer that speaks of an
internal error, a call that takes longer than `SLOW_SECONDS` of processor time, a server that dies, an answer with another
id, a file opened outside the workspace, or an accepted revision that cannot be read back. Every find is printed with the
call that made it; the exit code is 1 if there was one. The same seed draws the same calls.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import random
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from worldagent.tests.hostile.messages import malformed
from worldagent.tests.hostile.specs import NUMBERS, PATHS, broken, full_spec, patch, sentence
from worldagent.tests.hostile.watch import Watch
from worldagent.tests.hostile.wire import ERAS, Stdio, request
from worldagent.tests.stories.small_run import PROMPT

__all__ = ["fuzz_calls", "fuzz_messages", "main"]

SLOW_SECONDS = 5.0
"""Longest that a cheap call may take [s]."""
ENDLESS = 10**9
WORLD_CALLS = 200
"""Calls of one world until the next is made."""
SHOWN = 1500


class Finds:
    """Failures, by how they look."""

    def __init__(self) -> None:
        self.kinds: dict[str, str] = {}

    def add(self, kind: str, call: Any, text: str) -> None:
        """Keep the first example of each kind."""
        if kind not in self.kinds:
            self.kinds[kind] = f"{json.dumps(call, default=str)[:SHOWN]}\n    -> {text[:SHOWN]}"
            print(f"FOUND {kind}: {self.kinds[kind]}", flush=True)  # noqa: T201


def draw_call(draw: random.Random, world: str, document: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """A tool and its arguments."""
    whole = {k: v for k, v in document.items() if k != "prompt"}
    makers: list[Callable[[], tuple[str, dict[str, Any]]]] = [
        lambda: ("edit_spec", {"world": f"n{draw.randrange(10**9)}", "prompt": PROMPT, "spec": broken(draw, whole)}),
        lambda: ("edit_spec", {"world": f"n{draw.randrange(10**9)}", "prompt": PROMPT, "spec": sentence(draw)}),
        lambda: ("edit_spec", {"world": world, "patch": patch(draw, document), "hypothesis": "because it may be so", "weakening_reason": "fuzzing needs no reason"}),
        lambda: ("edit_spec", broken(draw, {"world": world, "patch": patch(draw, document), "expected_revision": 1, "on_hand_edit": "restore"})),
        lambda: ("place_object", broken(draw, {"world": world, "entity": "b1", "on": "shelf", "at": [0.1, 0.2], "yaw_deg": 5, "strict": False})),
        lambda: ("place_object", {"world": world}),
        lambda: ("inspect_world", broken(draw, {"world": world, "part": draw.choice(["matrix", "spec", "revisions", "costs", "measurements"]), "limit": 5})),
        lambda: ("job", broken(draw, {"action": draw.choice(["status", "wait", "cancel", "list"]), "job_id": "x", "wait_s": 0.0})),
        lambda: ("run_checks", broken(draw, {"world": world, "scope": draw.choice(["audit", "static"])})),
    ]  # fmt: skip
    weights = [6, 3, 8, 2, 2, 0.3, 2, 2, 0.5]
    return draw.choices(makers, weights)[0]()


class Caller:
    """Calls of a server in memory, each looked at for finds."""

    def __init__(self, client: Any, finds: Finds) -> None:
        self._client, self._finds = client, finds
        self.count = 0
        self.watch: Watch | None = None

    async def call(self, tool: str, arguments: dict[str, Any]) -> Any:
        """Call a tool; the answer, or None."""
        start = time.process_time()
        answer, text = await self._answered(f"call of {tool}", arguments, self._client.call_tool(tool, arguments))
        if answer is not None:
            text = answer.content[0].text if answer.content else ""
            if answer.is_error and text.startswith("internal error"):
                self._finds.add(f"internal error in {tool}", arguments, text)
        if time.process_time() - start > SLOW_SECONDS:
            self._finds.add(f"slow {tool}", arguments, f"{time.process_time() - start:.1f} s")
        if self.watch is not None and self.watch.outside:
            self._finds.add(f"opened {self.watch.outside[0]}", arguments, text)
            self.watch.outside.clear()
        return answer

    async def read(self, uri: str) -> None:
        """Read a resource."""
        await self._answered("resource", uri, self._client.read_resource(uri))

    async def _answered(self, what: str, given: Any, call: Any) -> tuple[Any, str]:
        from mcp.shared.exceptions import MCPError

        self.count += 1
        try:
            return await call, ""
        except MCPError as error:
            text = str(error)
            if "nternal" in text:
                self._finds.add(f"protocol error of a {what}: {text[:80]}", given, text)
        except Exception as error:
            text = repr(error)
            self._finds.add(f"client error of a {what}: {text[:80]}", given, text)
        return None, text


async def fuzz_calls(workspace: Path, seed: int, seconds: float, finds: Finds, most: int = ENDLESS) -> int:
    """Calls of a server in memory for so long, or at most so many; returns how many."""
    from mcp import Client
    from worldagent.server.app import create_server

    draw, end, world, left, document = random.Random(seed), time.monotonic() + seconds, "", 0, full_spec()
    async with Client(create_server(workspace)) as client:
        caller = Caller(client, finds)
        while time.monotonic() < end and caller.count < most:
            if left == 0:
                world, left, document = f"w{caller.count}", WORLD_CALLS, full_spec()
                whole = {k: v for k, v in document.items() if k != "prompt"}
                await caller.call("edit_spec", {"world": world, "prompt": PROMPT, "spec": whole})
                await caller.call("inspect_world", {"world": world, "part": "matrix"})
                caller.watch = caller.watch or Watch(workspace)
            left -= 1
            tool, arguments = draw_call(draw, world, document)
            answer = await caller.call(tool, arguments)
            if answer is not None and not answer.is_error and tool == "edit_spec" and arguments.get("world") == world:
                document = json.loads((workspace / world / "world.json").read_text())
            if draw.random() < 0.05:
                part = draw.choice(["spec", "matrix", "report", "revisions"])
                await caller.read(f"worldagent://worlds/{draw.choice([world, draw.choice(PATHS)])}/{part}")
        return caller.count


def fuzz_messages(workspace: Path, seed: int, seconds: float, finds: Finds, most: int = ENDLESS) -> int:
    """Messages to stdio processes of both eras for so long, or at most so many; returns how many."""
    end, count, era_at = time.monotonic() + seconds, 0, 0
    while time.monotonic() < end and count < most:
        era, era_at = ERAS[era_at % 2], era_at + 1
        draw = random.Random(seed + era_at)
        with Stdio(workspace, era) as server:
            server.open()
            stop, most_now = min(end, time.monotonic() + seconds / 4), count + most // 2
            try:
                while time.monotonic() < stop and count < most_now:
                    cases = malformed(era, draw.randrange(2**31))
                    draw.shuffle(cases)
                    for case in cases[:200]:
                        line = bytearray(case.line)
                        for _ in range(draw.choice([0, 1, 1, 4]) if len(line) < 10**5 else 0):
                            at = draw.randrange(len(line) + 1)
                            line[at : at + draw.choice([0, 1, 3])] = draw.choice(
                                [b'"', b"{", b"\\u", b"9" * 30, b"null", bytes([draw.randrange(256)])]
                            )
                        server.write(bytes(line).replace(b"\n", b" "))
                        count += 1
                        if time.monotonic() > stop or count >= most_now:
                            break
                    arguments: dict[str, Any] = {"world": draw.choice(PATHS), "at": [draw.choice(NUMBERS), draw.choice(NUMBERS)]}
                    server.write(
                        json.dumps(
                            request(era, f"c{count}", "tools/call", {"name": "place_object", "arguments": arguments})
                        ).encode()
                    )
                    for answer in server.until_good():
                        text = json.dumps(answer)
                        if "nternal" in text:
                            finds.add(f"message: {text[-200:]}", era, text)
            except AssertionError as error:
                finds.add(
                    f"{era} server: {str(error)[:80]}",
                    [case.line[:200].decode(errors="replace") for case in cases[:3]],
                    str(error),
                )
    return count


def main(arguments: list[str] | None = None) -> int:
    """Fuzz for so long; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--seed", type=int, default=None)
    options = parser.parse_args(arguments)
    seed = random.SystemRandom().randrange(2**31) if options.seed is None else options.seed
    finds = Finds()
    with tempfile.TemporaryDirectory() as first, tempfile.TemporaryDirectory() as second:
        messages = fuzz_messages(Path(first), seed, options.seconds / 2, finds)
        calls = asyncio.run(fuzz_calls(Path(second), seed, options.seconds / 2, finds))
    told = {"seed": seed, "seconds": options.seconds, "messages": messages, "calls": calls, "finds": sorted(finds.kinds)}
    print(json.dumps(told))  # noqa: T201
    return 1 if finds.kinds else 0


if __name__ == "__main__":
    sys.exit(main())
