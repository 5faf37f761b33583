"""Malformed and hostile messages with what a server owes them."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from worldagent.tests.hostile.wire import LEGACY, MESSAGE_BYTES, request

__all__ = ["PARSE", "Case", "malformed"]

PARSE, INVALID, UNKNOWN, PARAMS = -32700, -32600, -32601, -32602
SILENT: tuple[int, ...] = ()
ANY_ERROR = (INVALID, UNKNOWN, PARAMS, -32022)


@dataclass(frozen=True)
class Case:
    """One line, and what it is owed."""

    name: str
    line: bytes
    codes: tuple[int, ...] = SILENT
    """Codes of which the answer's error has one; none: there is no answer."""
    id: Any = None
    """Id of the answer."""
    tool_error: bool = False
    """The answer is a result that tells the calling model of an error."""
    result: bool = False
    """The answer is a result like any other."""


def _nested(depth: int) -> bytes:
    return b'{"jsonrpc":"2.0","id":1,"method":"ping","params":' + b'{"a":' * depth + b"1" + b"}" * depth + b"}"


def no_json(draw: random.Random, era: str) -> Iterator[Case]:
    """Text that no JSON parser may take."""
    good = json.dumps(request(era, 7, "tools/call", {"name": "job", "arguments": {"action": "list"}})).encode()
    while True:
        yield Case("truncated", good[: draw.randrange(1, len(good) - 1)], (PARSE,))
        noise = bytes(draw.choice([b for b in range(1, 256) if b not in (10, 13)]) for _ in range(draw.randrange(1, 300)))
        yield Case("noise", b"\x80" + noise, (PARSE,))
        at = draw.randrange(1, len(good) - 1)
        yield Case("NUL", good[:at] + b"\0" + good[at:], (PARSE,))
        spot = good.index(b'"list') + 1
        yield Case(
            "invalid UTF-8",
            good[:spot] + draw.choice([b"\xff", b"\xc3\x28", b"\xed\xa0\x80", b"\xf8\x88"]) + good[spot:],
            (PARSE,),
        )
        number = draw.choice([b"NaN", b"Infinity", b"-Infinity", b"1e", b"0x10", b"01", b"+1", b".5", b"1" * 5000])
        yield Case("no number", good.replace(b'"list"', number), (PARSE,))
        yield Case("lone surrogate", good.replace(b"list", draw.choice([b"\\ud800", b"\\udfff", b"\\ud800\\u0041"])), (PARSE,))
        yield Case("control character", good.replace(b"list", bytes([draw.randrange(1, 9)])), (PARSE,))
        yield Case("two at once", good + draw.choice([b"", b" ", b","]) + good, (PARSE,))
        yield Case("byte order mark", b"\xef\xbb\xbf" + good, (PARSE,))
        yield Case("trailing comma", good[:-1] + b",}", (PARSE,))
        yield Case("comment", good + b" // done", (PARSE,))
        yield Case("single quotes", good.replace(b'"', b"'"), (PARSE,))
        depth = draw.choice([250, 1000, 10_000, 100_000])
        yield Case("too deep", _nested(depth), (PARSE,))
        yield Case("open brackets", draw.choice([b"[", b'{"a":', b'[{"a":']) * depth, (PARSE,))
        yield Case("a header of another protocol", b"Content-Length: %d" % len(good), (PARSE,))
        yield Case("a request line", b"GET /mcp HTTP/1.1", (PARSE,))


def no_message(draw: random.Random, era: str) -> Iterator[Case]:
    """JSON that is no JSON-RPC message."""
    while True:
        for value in (draw.randrange(-9, 9), "ping", None, True, 1.5, [], {}, [[]], ""):
            yield Case("no object", json.dumps(value).encode(), (INVALID,))
        batch = [request(era, k, "prompts/list") for k in range(draw.randrange(1, 6))]
        yield Case("batch", json.dumps(batch).encode(), (INVALID,))
        name: Any = draw.choice([3, "n", -1, 2**63, "x" * 1000])
        base = request(era, name, "prompts/list")
        for version in ("1.0", 2.0, 2, None, "2", ["2.0"], {}):
            yield Case("version", json.dumps({**base, "jsonrpc": version}).encode(), (INVALID,), name)
        yield Case("no version", json.dumps({k: v for k, v in base.items() if k != "jsonrpc"}).encode(), (INVALID,), name)
        for method in (None, 5, ["ping"], {"a": 1}, True):
            yield Case("method", json.dumps({**base, "method": method}).encode(), (INVALID,), name)
        yield Case("no method", json.dumps({k: v for k, v in base.items() if k != "method"}).encode(), (INVALID,), name)
        for params in ([], [1], "x", 5, True):
            yield Case("params", json.dumps({**base, "params": params}).encode(), (INVALID,), name)
        for bad in (None, True, 1.5, [1], {"a": 1}, -0.0):
            yield Case("id", json.dumps({**base, "id": bad}).encode(), (INVALID,))


def odd_requests(draw: random.Random, era: str) -> Iterator[Case]:
    """Messages in form, with content that makes no sense."""
    while True:
        name = draw.choice([draw.randrange(10**9), "é" * 9, "", 10**100, -(2**63), str(10**40), "\u0000", "a" * 5000])
        ask = json.dumps(request(era, name, "prompts/list")).encode()
        yield Case("odd id", ask, id=name, result=True)
        yield Case("doubled keys", ask[:-1] + b',"method":"no/such"}', (UNKNOWN,), name)
        for method in (
            "no/such",
            "",
            "__class__",
            "tools/call/../list",
            "x" * 10_000,
            "TOOLS/LIST",
            "tools/list\0",
            "\u202e",
            "rpc.discover",
        ):
            yield Case("method", json.dumps(request(era, name, method)).encode(), ANY_ERROR, name)
        for method, params in (
            ("tools/call", {}),
            ("tools/call", {"name": 5}),
            ("tools/call", {"name": "job", "arguments": [1]}),
            ("tools/call", {"name": "job", "arguments": "list"}),
            ("tools/call", {"name": ["job"]}),
            ("resources/read", {}),
            ("resources/read", {"uri": 5}),
            ("resources/read", {"uri": "worldagent://worlds/no-such/spec"}),
            ("resources/read", {"uri": "\0"}),
            ("resources/read", {"uri": "x" * 10_000}),
            ("resources/read", {"uri": "file:///etc/passwd"}),
            ("prompts/get", {"name": "no_such"}),
            ("prompts/get", {"name": "make_world"}),
            ("prompts/get", {"name": "make_world", "arguments": {"prompt": 5}}),
            ("completion/complete", {"ref": {"type": "ref/none"}, "argument": {"name": "world", "value": ""}}),
            ("completion/complete", {"ref": 5}),
            ("completion/complete", {"argument": {"name": 1, "value": 2}}),
        ):
            yield Case(f"{method} {str(params)[:60]}", json.dumps(request(era, name, method, params)).encode(), ANY_ERROR, name)
        if era == LEGACY:
            yield Case(
                "a version that is no text",
                json.dumps(request(era, name, "initialize", {"protocolVersion": 5})).encode(),
                ANY_ERROR,
                name,
            )
        wrong = {"io.modelcontextprotocol/protocolVersion": draw.choice(["1999-01-01", 5, None, "x" * 1000, ["2026-07-28"]])}
        yield Case(
            "envelope",
            json.dumps({**request(era, name, "prompts/list"), "params": {"_meta": wrong}}).encode(),
            ANY_ERROR,
            name,
            result=era == LEGACY,
        )
        for meta in (5, [], "x"):
            yield Case(
                "meta", json.dumps({**request(era, name, "prompts/list"), "params": {"_meta": meta}}).encode(), ANY_ERROR, name
            )


def odd_calls(draw: random.Random, era: str) -> Iterator[Case]:
    """Calls of tools with arguments that no tool takes."""
    deep: Any = 1
    for _ in range(150):
        deep = {"a": deep}
    brackets = "[" * 100_000
    hostile: tuple[Any, ...] = (
        None, True, -1, 10**400, 1.5, "", "x" * 100_000, "\0", "../../etc/passwd", [], [[]] * 1000, {}, deep, "NaN", brackets,
        {"a" * 10_000: 1}, 2**64, "\u202e\u0000\uffff", "%s%n{0}", {"__proto__": {}}, "; rm -rf /", "<script>",
    )  # fmt: skip
    fields = {
        "edit_spec": ("world", "prompt", "spec", "patch", "hypothesis", "expected_revision", "on_hand_edit"),
        "place_object": ("world", "entity", "on", "at", "yaw_deg", "strict"),
        "job": ("action", "job_id", "wait_s"),
        "inspect_world": ("world", "part"),
        "render_shot": ("world", "kind"),
        "run_checks": ("world", "scope"),
    }
    while True:
        name = draw.randrange(10**6)
        yield Case("no tool", json.dumps(request(era, name, "tools/call", {"name": draw.choice(["", "eval", "x" * 5000, "edit spec"])})).encode(),
                   (PARAMS,), name, tool_error=True)  # fmt: skip
        tool = draw.choice(sorted(fields))
        arguments: dict[str, Any] = {"world": "no_such_world"} if tool != "job" else {"action": "status"}
        arguments[draw.choice(fields[tool])] = draw.choice(hostile)
        yield Case(f"{tool} {str(arguments)[:80]}", json.dumps(request(era, name, "tools/call", {"name": tool, "arguments": arguments})).encode(),
                   tool_error=True, id=name)  # fmt: skip
        call = json.dumps(request(era, name, "tools/call", {"name": "place_object", "arguments": {"world": "w", "at": [0, 7]}}))
        yield Case("a number beyond all numbers", call.replace("7]", "1e999]").encode(), tool_error=True, id=name)


def unanswered(draw: random.Random, era: str) -> Iterator[Case]:
    """Messages that JSON-RPC does not answer: notifications and answers, good and bad; and empty lines."""
    while True:
        yield Case("empty", draw.choice([b"", b" ", b"\t", b"\r"]))
        for method, params in (
            ("no/such", {}),
            ("notifications/cancelled", {}),
            ("notifications/cancelled", {"requestId": [1]}),
            ("notifications/cancelled", {"requestId": 10**30, "reason": 5}),
            ("notifications/progress", {"progressToken": {}, "progress": "x"}),
            ("notifications/initialized", {"x": "y" * 1000}),
            ("tools/call", {"name": "job", "arguments": {"action": "list"}}),
        ):
            yield Case("notification", json.dumps({"jsonrpc": "2.0", "method": method, "params": params}).encode())
        for answer in ({"result": {}}, {"result": 5}, {"error": {"code": 1, "message": "x"}}, {"error": "x"}, {"error": {}}):
            name = draw.choice([1, "none", None, [1], 10**50])
            yield Case("answer to nothing", json.dumps({"jsonrpc": "2.0", "id": name, **answer}).encode())


def too_long(draw: random.Random, era: str) -> Iterator[Case]:
    """Messages over the cap, whose id stands at one end."""
    while True:
        filler = {"a": "x" * (MESSAGE_BYTES + draw.randrange(10**5))}
        name = draw.randrange(10**6)
        ahead = {"jsonrpc": "2.0", "id": name, "method": "tools/call", "params": filler}
        yield Case("too long, id ahead", json.dumps(ahead).encode(), (INVALID,), name)
        behind = {"method": "tools/call", "params": filler, "jsonrpc": "2.0", "id": str(name)}
        yield Case("too long, id behind", json.dumps(behind).encode(), (INVALID,), str(name))
        yield Case("too long, no JSON", b"x" * (MESSAGE_BYTES + 1), (INVALID,))


SHARES = ((no_json, 300), (no_message, 250), (odd_requests, 250), (odd_calls, 90), (unanswered, 100), (too_long, 10))


def malformed(era: str, seed: int) -> list[Case]:
    """1,000 cases in random order."""
    draw = random.Random(seed)
    cases = [case for family, count in SHARES for case, _ in zip(family(draw, era), range(count), strict=False)]
    draw.shuffle(cases)
    return cases
