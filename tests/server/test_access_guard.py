"""Requests that the guard lets through to any route, driven as a server drives it."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable, MutableMapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import anyio
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcp.server.auth.middleware.auth_context import get_access_token
from worldagent.server.guard import SECURITY_HEADERS, Attempts, Guard, GuardRules, same_origin
from worldagent.server.tokens import TokenBook

pytestmark = pytest.mark.anyio
HOST = "127.0.0.1:8931"
SECRET = "a-token-of-32-characters-or-more"
Message = MutableMapping[str, Any]

QUIET = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
"""A busy machine is no finding."""


@dataclass
class Behind:
    """An application that remembers what came through."""

    bodies: list[bytes] = field(default_factory=list)
    clients: list[str | None] = field(default_factory=list)
    headers: list[bytes] = field(default_factory=list)

    async def __call__(self, scope: Message, receive: Callable[[], Awaitable[Message]], send: Any) -> None:
        body, more = b"", True
        while more:
            message = await receive()
            body += message.get("body", b"")
            more = bool(message.get("more_body"))
        access = get_access_token()
        self.bodies.append(body)
        self.clients.append(access.client_id if access else None)
        self.headers += [name for name, _ in scope["headers"]]
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": b"through"})


@dataclass
class Answer:
    status: int
    headers: dict[str, str]
    body: bytes


async def ask(
    guard: Guard,
    path: str = "/mcp",
    *,
    method: str = "POST",
    headers: dict[str, str] | list[tuple[str, str]] | None = None,
    body: list[bytes] | None = None,
    stall: bool = False,
    address: str = "127.0.0.1",
) -> Answer:
    pairs = list(headers.items()) if isinstance(headers, dict) else list(headers or [])
    if not any(name == "host" for name, _ in pairs):
        pairs.append(("host", HOST))
    chunks = [{"type": "http.request", "body": c, "more_body": True} for c in body or []]
    if not stall:
        chunks.append({"type": "http.request", "body": b"", "more_body": False})
    sent: list[Message] = []

    async def receive() -> Message:
        if chunks:
            return chunks.pop(0)
        await anyio.sleep_forever()
        raise AssertionError

    async def send(message: Message) -> None:
        sent.append(message)

    scope = {
        "type": "http", "method": method, "path": path, "raw_path": path.encode(), "query_string": b"", "http_version": "1.1",
        "scheme": "http", "client": (address, 5000), "headers": [(k.encode(), v.encode("latin-1")) for k, v in pairs],
    }  # fmt: skip
    with anyio.fail_after(60):
        await guard(scope, receive, send)
    start = sent[0]
    told = {k.decode().lower(): v.decode() for k, v in start["headers"]}
    return Answer(start["status"], told, b"".join(m.get("body", b"") for m in sent[1:]))


def guarded(tmp_path: Path, *, token: str | None = None, **rules: Any) -> tuple[Guard, Behind]:
    behind = Behind()
    hosts = ("127.0.0.1", "localhost", "::1")
    return Guard(behind, GuardRules(hosts, **rules), TokenBook(tmp_path, given=token)), behind


@pytest.mark.parametrize(
    "hosts",
    [
        ["evil.example"], ["evil.example:8931"], ["127.0.0.1.evil.example"], ["127.0.0.1:evil"], ["127.0.0.1:8931:1"], [""],
        ["127.0.0.1@evil.example"], ["127.0.0.1/evil"], ["127.0.0.1", "evil.example"], ["127.0.0.1", "127.0.0.1"], ["2130706433"],
        ["[::1]evil"], ["127.0.0.1 "], ["127.0.0.1\n"],
    ],
)  # fmt: skip
async def test_a_foreign_host_reaches_no_route(tmp_path: Path, hosts: list[str]) -> None:
    guard, behind = guarded(tmp_path)
    for path in ("/mcp", "/", "/api/worlds", "/static/page.js", "/healthz"):
        pairs = [("host", host) for host in hosts]
        assert (await ask(guard, path, method="GET", headers=pairs)).status == 421
    assert behind.bodies == []


@pytest.mark.parametrize("host", ["127.0.0.1", "127.0.0.1:1", "LOCALHOST:8931", "[::1]:8931"])
async def test_own_names_pass_with_any_port(tmp_path: Path, host: str) -> None:
    guard, _ = guarded(tmp_path)
    assert (await ask(guard, headers={"host": host})).status == 200


@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example", "null", "http://127.0.0.1:3000", "http://localhost:8931", "file://", "http://127.0.0.1:8931.evil.example",
        "http://127.0.0.1:8931@evil.example", "", "chrome-extension://abc", "https://127.0.0.1:8932", "http://127.0.0.1",
    ],
)  # fmt: skip
async def test_a_page_of_another_origin_reaches_no_route(tmp_path: Path, origin: str) -> None:
    """Another port of the same machine is another origin: some other program's page."""
    guard, behind = guarded(tmp_path)
    for method, path in (("POST", "/mcp"), ("GET", "/api/worlds"), ("DELETE", "/mcp"), ("OPTIONS", "/mcp")):
        answer = await ask(guard, path, method=method, headers={"origin": origin})
        assert answer.status == 403
        assert "access-control-allow-origin" not in answer.headers
    assert behind.bodies == []


async def test_what_a_browser_calls_cross_site_is_refused_even_without_origin(tmp_path: Path) -> None:
    """Browsers leave Origin out of images, scripts and plain forms of method GET."""
    guard, _ = guarded(tmp_path)
    for site in ("cross-site", "same-site"):
        headers = {"sec-fetch-site": site, "sec-fetch-mode": "no-cors"}
        assert (await ask(guard, "/api/worlds", method="GET", headers=headers)).status == 403
    assert (await ask(guard, "/api/worlds", method="GET", headers={"sec-fetch-site": "same-origin"})).status == 200
    assert (
        await ask(guard, "/", method="GET", headers={"sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate"})
    ).status == 200


async def test_an_allowed_origin_gets_cors_and_no_other_does(tmp_path: Path) -> None:
    guard, _ = guarded(tmp_path, origins=("https://tools.example",))
    preflight = {
        "origin": "https://tools.example",
        "access-control-request-method": "POST",
        "access-control-request-headers": "authorization, mcp-protocol-version, x-evil",
    }
    answer = await ask(guard, method="OPTIONS", headers=preflight)
    assert answer.status == 204
    assert answer.headers["access-control-allow-origin"] == "https://tools.example"
    assert answer.headers["access-control-allow-headers"] == "authorization, mcp-protocol-version"
    assert "access-control-allow-credentials" not in answer.headers
    assert (await ask(guard, headers={"origin": "https://tools.example"})).headers["vary"] == "Origin"
    assert (await ask(guard, headers={"origin": "https://tools.example.evil"})).status == 403
    assert "access-control-allow-origin" not in (await ask(guard)).headers


@QUIET
@given(st.text(max_size=40), st.text(max_size=40))
def test_same_origin_needs_both_headers_whole(origin: str, host: str) -> None:
    scheme, _, authority = origin.partition("://")
    named = scheme in ("http", "https") and authority.split(":")[0].lower() == host.split(":")[0].lower()
    assert named or not same_origin(origin, host)


async def test_every_response_carries_the_security_headers(tmp_path: Path) -> None:
    guard, _ = guarded(tmp_path, token=SECRET)
    for answer in (
        await ask(guard, "/", method="GET"),
        await ask(guard),
        await ask(guard, headers={"host": "evil.example"}),
        await ask(guard, headers={"authorization": f"Bearer {SECRET}"}),
    ):
        for name, value in SECURITY_HEADERS.items():
            assert answer.headers[name.lower()] == value
    assert "frame-ancestors 'none'" in SECURITY_HEADERS["Content-Security-Policy"]
    assert "unsafe" not in SECURITY_HEADERS["Content-Security-Policy"]


@pytest.mark.parametrize(
    "header", [None, "", SECRET, f"Basic {SECRET}", "Bearer", "Bearer ", f"Bearer {SECRET}x", f"Bearer {SECRET[:-1]}", "Bearer é"]
)
async def test_without_the_token_only_the_empty_page_and_health_answer(tmp_path: Path, header: str | None) -> None:
    guard, behind = guarded(tmp_path, token=SECRET)
    headers = {} if header is None else {"authorization": header}
    for path in ("/", "/healthz", "/static/page.js"):
        assert (await ask(guard, path, method="GET", headers=headers)).status == 200
    through = len(behind.bodies)
    for method, path in (("POST", "/mcp"), ("GET", "/mcp"), ("GET", "/api/worlds"), ("POST", "/"), ("GET", "/staticfoo")):
        answer = await ask(guard, path, method=method, headers=headers)
        assert answer.status == 401
        assert answer.headers["www-authenticate"].startswith("Bearer")
        assert SECRET not in answer.body.decode()
    assert len(behind.bodies) == through


async def test_two_tokens_in_one_request_are_none(tmp_path: Path) -> None:
    guard, _ = guarded(tmp_path, token=SECRET)
    pairs = [("authorization", "Bearer wrong-wrong-wrong-wrong"), ("authorization", f"Bearer {SECRET}")]
    assert (await ask(guard, headers=pairs)).status == 401


async def test_the_clear_token_goes_no_further_than_the_guard(tmp_path: Path) -> None:
    guard, behind = guarded(tmp_path, token=SECRET)
    assert (await ask(guard, headers={"authorization": f"bearer {SECRET}"})).status == 200
    assert behind.clients == ["given"]
    assert b"authorization" not in behind.headers


async def test_guessing_is_stopped_without_looking_at_the_token(tmp_path: Path) -> None:
    guard, _ = guarded(tmp_path, token=SECRET)
    seen = [(await ask(guard, headers={"authorization": f"Bearer guess-number-{k:04d}"})).status for k in range(15)]
    assert seen[:10] == [401] * 10
    assert seen[10:] == [429] * 5
    late = await ask(guard, headers={"authorization": f"Bearer {SECRET}"})
    assert late.status == 429
    assert 1 <= int(late.headers["retry-after"]) <= 4
    assert (await ask(guard, headers={"authorization": f"Bearer {SECRET}"}, address="10.0.0.2")).status == 200
    assert (await ask(guard, "/healthz", method="GET")).status == 200


def test_attempts_come_back_with_time_and_addresses_are_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr("worldagent.server.guard.time.monotonic", lambda: now[0])
    attempts = Attempts(most=3, seconds=2.0)
    for _ in range(3):
        assert attempts.wait("a") == 0.0
        attempts.failed("a")
    assert attempts.wait("a") == pytest.approx(2.0)
    now[0] += 2.0
    assert attempts.wait("a") == 0.0
    for k in range(5000):
        attempts.failed(str(k))
    assert len(attempts._level) == 4096


async def test_bodies_are_capped_by_length_by_count_and_by_time(tmp_path: Path) -> None:
    guard, behind = guarded(tmp_path, body_bytes=100, body_seconds=0.05)
    assert (await ask(guard, headers={"content-length": "101"}, body=[b"x"])).status == 413
    assert (await ask(guard, headers={"content-length": "-1"})).status == 413
    assert (await ask(guard, body=[b"x" * 60, b"x" * 60])).status == 413
    assert (await ask(guard, body=[b"{"], stall=True)).status == 408
    assert behind.bodies == []
    assert (await ask(guard, headers={"content-length": "100"}, body=[b"x" * 50, b"y" * 50])).status == 200
    assert behind.bodies == [b"x" * 50 + b"y" * 50]


async def test_a_damaged_token_file_lets_nobody_in(tmp_path: Path) -> None:
    book = TokenBook(tmp_path)
    token = book.add("laptop", "write")
    guard, _ = guarded(tmp_path)
    assert (await ask(guard, headers={"authorization": f"Bearer {token}"})).status == 200
    book.path.write_text("{}")
    answer = await ask(guard, headers={"authorization": f"Bearer {token}"})
    assert answer.status == 503
    assert str(tmp_path) not in answer.body.decode()


@QUIET
@given(
    st.lists(st.tuples(st.sampled_from(["host", "origin", "authorization", "content-length"]), st.text(max_size=30)), max_size=4)
)
async def test_no_headers_make_the_guard_fail_or_open(pairs: list[tuple[str, str]]) -> None:
    behind = Behind()
    guard = Guard(behind, GuardRules(("127.0.0.1",), body_seconds=0.05), TokenBook(Path("/nonexistent"), given=SECRET))
    encoded = [(name, value.encode("utf-8").decode("latin-1")) for name, value in pairs]
    answer = await ask(guard, headers=encoded)
    assert answer.status in (401, 403, 413, 421, 429)
    assert json.loads(answer.body)["error"]
    assert behind.bodies == []
