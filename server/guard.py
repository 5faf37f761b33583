"""Checks before every route of the HTTP server: Host, Origin, token, size and time of the body; and response headers."""

from __future__ import annotations

import json
import logging
import re
import time
from collections import OrderedDict, deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import anyio
from mcp.server.auth.middleware.auth_context import AuthContextMiddleware
from mcp.server.auth.middleware.bearer_auth import AuthenticatedUser
from mcp.server.auth.provider import AccessToken
from starlette.authentication import AuthCredentials
from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from ..worlds.errors import EvidenceError
from .messages import MESSAGE_BYTES
from .tokens import TokenBook

__all__ = ["BODY_BYTES", "Attempts", "Guard", "GuardRules", "same_origin"]

BODY_BYTES = MESSAGE_BYTES
"""Largest request body [bytes]."""
BODY_SECONDS = 30.0
"""Longest time that a request body may take to arrive [s]."""
ATTEMPTS = 10
"""Wrong tokens that one address may try in a row; one more is allowed every `ATTEMPT_SECONDS`."""
ATTEMPT_SECONDS = 3.0
MOST_ADDRESSES = 4096

OPEN_PATHS: Final = frozenset({"/", "/healthz"})
OPEN_FOLDERS: Final = ("/static/", "/.well-known/")
"""Paths that hold no data of a world: the page without its contents. A client that looks for OAuth gets a plain 404."""

SECURITY_HEADERS: Final[Mapping[str, str]] = {
    "Content-Security-Policy": (
        "default-src 'self'; img-src 'self' blob:; media-src 'self' blob:; object-src 'none'; base-uri 'none'; "
        "form-action 'none'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=()",
}
"""Sent with every response that does not set them itself."""

_CORS_HEADER = re.compile(r"^(authorization|accept|content-type|last-event-id|mcp-[a-z0-9-]{1,64})$")
_AUTHORITY = re.compile(r"^(?P<name>\[[0-9a-fA-F:.]+\]|[A-Za-z0-9._-]+)(?::(?P<port>[0-9]{1,5}))?$")
_ORIGIN = re.compile(r"^(?P<scheme>https?)://(?P<authority>.+)$")
_DEFAULT_PORTS = {"http": "80", "https": "443"}

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class GuardRules:
    """Whom the guard lets in."""

    hosts: Sequence[str]
    """Names and addresses that a Host header may carry, any port."""
    origins: Sequence[str] = ()
    """Origins other than the server's own whose scripts may call it, e.g. `https://tools.example`."""
    body_bytes: int = BODY_BYTES
    body_seconds: float = BODY_SECONDS


@dataclass
class Attempts:
    """Wrong tokens by address: a bucket that fills with each and empties with time."""

    most: int = ATTEMPTS
    seconds: float = ATTEMPT_SECONDS
    _level: OrderedDict[str, tuple[float, float]] = field(default_factory=OrderedDict)

    def wait(self, address: str) -> float:
        """Seconds until this address may try again; 0 when it may now."""
        level = self._now(address)
        return 0.0 if level <= self.most - 1 else (level - self.most + 1) * self.seconds

    def failed(self, address: str) -> None:
        """Count one wrong token."""
        self._level[address] = (self._now(address) + 1.0, time.monotonic())
        self._level.move_to_end(address)
        while len(self._level) > MOST_ADDRESSES:
            self._level.popitem(last=False)

    def _now(self, address: str) -> float:
        level, at = self._level.get(address, (0.0, 0.0))
        return max(0.0, level - (time.monotonic() - at) / self.seconds)


class Guard:
    """ASGI middleware around the whole application; nothing reaches a route before all of it holds."""

    def __init__(self, app: ASGIApp, rules: GuardRules, tokens: TokenBook) -> None:
        self._app = AuthContextMiddleware(app)
        self._rules = rules
        self._hosts = frozenset(_bracketed(name).lower() for name in rules.hosts)
        self._origins = frozenset(origin.lower().rstrip("/") for origin in rules.origins)
        self._tokens = tokens
        self.attempts = Attempts()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer the request itself, or pass it on."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if scope["type"] != "http":
            await send({"type": "websocket.close", "code": 1008})
            return
        headers = Headers(scope=scope)
        origin = headers.get("origin", "").lower()
        send = _with_headers(send, origin if origin in self._origins else None)
        answer = self._stopped(scope, headers) or self._authenticated(scope, headers)
        if answer is None:
            answer, receive = await self._whole_body(headers, receive)
        if answer is None:
            await self._app(scope, receive, send)
        else:
            await answer(scope, receive, send)

    def _stopped(self, scope: Scope, headers: Headers) -> Response | None:
        """Host, Origin and preflight."""
        host = _authority(headers.getlist("host"))
        if host is None or host[0] not in self._hosts:
            return _refusal(421, "misdirected", "the Host header names another server; --allow-host adds a name")
        foreign = _foreign(headers, self._origins)
        if foreign:
            return _refusal(403, "forbidden_origin", f"{foreign} may not call this server; --allow-origin adds an origin")
        if scope["method"] == "OPTIONS" and "access-control-request-method" in headers:
            asked = [name.strip().lower() for name in headers.get("access-control-request-headers", "").split(",")]
            allowed = ", ".join(name for name in asked if _CORS_HEADER.fullmatch(name))
            return Response(
                status_code=204,
                headers={
                    "Access-Control-Allow-Methods": "GET, POST, DELETE",
                    "Access-Control-Allow-Headers": allowed,
                    "Access-Control-Max-Age": "600",
                },
            )
        return None

    def _authenticated(self, scope: Scope, headers: Headers) -> Response | None:
        """Judge the token; the request carries its grant from here on."""
        path = str(scope["path"])
        open_path = path in OPEN_PATHS or path.startswith(OPEN_FOLDERS)
        if (open_path and scope["method"] in ("GET", "HEAD")) or not self._tokens.required():
            return None
        address = str(scope["client"][0]) if scope.get("client") else ""
        wait = self.attempts.wait(address)
        if wait > 0:
            told = "too many wrong tokens from this address; wait"
            return _refusal(429, "too_many_attempts", told, {"Retry-After": str(int(wait) + 1)})
        given = headers.getlist("authorization")
        scheme, _, token = given[0].partition(" ") if len(given) == 1 else ("", "", "")
        if scheme.lower() != "bearer" or not token:
            return _refusal(401, "token_required", "send Authorization: Bearer TOKEN", {"WWW-Authenticate": "Bearer"})
        try:
            grant = self._tokens.check(token.strip())
        except EvidenceError as error:
            logger.error("%s", error)
            return _refusal(503, "tokens_unreadable", "the server cannot read its tokens; its log says why")
        if grant is None:
            self.attempts.failed(address)
            logger.warning("a wrong token from %s", address)
            told = "the token is unknown, revoked or expired"
            return _refusal(401, "invalid_token", told, {"WWW-Authenticate": 'Bearer error="invalid_token"'})
        # The clear token goes no further than this line.
        scope["user"] = AuthenticatedUser(AccessToken(token=grant.id, client_id=grant.id, scopes=list(grant.scopes)))
        scope["auth"] = AuthCredentials(grant.scopes)
        scope["headers"] = [(name, value) for name, value in scope["headers"] if name.lower() != b"authorization"]
        return None

    async def _whole_body(self, headers: Headers, receive: Receive) -> tuple[Response | None, Receive]:
        """Wait for the body, at most so long and so much, and replay it."""
        most = self._rules.body_bytes
        too_large = _refusal(413, "too_large", f"a request body has at most {most} bytes", {"Connection": "close"})
        declared = headers.get("content-length", "0")
        if not declared.isdigit() or int(declared) > most:
            return too_large, receive
        body = bytearray()
        kept: deque[Message] = deque()
        with anyio.move_on_after(self._rules.body_seconds) as patience:
            while True:
                message = await receive()
                if message["type"] != "http.request":
                    kept.append(message)
                    break
                body.extend(message.get("body", b""))
                if len(body) > most:
                    return too_large, receive
                if not message.get("more_body", False):
                    break
        if patience.cancelled_caught:
            told = f"the request body did not arrive within {self._rules.body_seconds:g} s"
            return _refusal(408, "too_slow", told, {"Connection": "close"}), receive
        kept.appendleft({"type": "http.request", "body": bytes(body), "more_body": bool(kept)})

        async def replay() -> Message:
            return kept.popleft() if kept else await receive()

        return None, replay


def same_origin(origin: str, host: str) -> bool:
    """True if an Origin header names the server that a Host header names."""
    parts = _ORIGIN.fullmatch(origin)
    here, there = _authority([host]), _authority([parts["authority"]]) if parts else None
    if parts is None or here is None or there is None:
        return False
    port = _DEFAULT_PORTS[parts["scheme"]]
    return here[0] == there[0] and (here[1] or port) == (there[1] or port)


def _foreign(headers: Headers, allowed: frozenset[str]) -> str:
    """Origin of a request that a page of another origin makes a browser send; else empty."""
    origins = headers.getlist("origin")
    if len(origins) > 1:
        return "a request with several Origin headers"
    if origins:
        origin = origins[0].lower()
        return "" if origin in allowed or same_origin(origin, headers.get("host", "")) else "this origin"
    # Browsers leave Origin out of plain GET requests, but say where those come from.
    navigation = headers.get("sec-fetch-mode") == "navigate"
    return "another site" if headers.get("sec-fetch-site") in ("cross-site", "same-site") and not navigation else ""


def _authority(values: Sequence[str]) -> tuple[str, str | None] | None:
    """Name and port of a Host header; None unless there is exactly one, well formed."""
    found = _AUTHORITY.fullmatch(values[0]) if len(values) == 1 else None
    return (found["name"].lower(), found["port"]) if found else None


def _bracketed(name: str) -> str:
    return f"[{name}]" if ":" in name and not name.startswith("[") else name


def _refusal(status: int, error: str, told: str, headers: Mapping[str, str] | None = None) -> Response:
    body = json.dumps({"error": error, "error_description": told})
    return Response(body, status, {"Cache-Control": "no-store", **(headers or {})}, "application/json")


def _with_headers(send: Send, origin: str | None) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            message.setdefault("headers", [])
            headers = MutableHeaders(scope=message)
            for name, value in SECURITY_HEADERS.items():
                headers.setdefault(name, value)
            if origin is not None:
                headers["Access-Control-Allow-Origin"] = origin
                headers["Access-Control-Expose-Headers"] = "Mcp-Session-Id, WWW-Authenticate, Retry-After"
                headers["Cross-Origin-Resource-Policy"] = "cross-origin"
                headers.add_vary_header("Origin")
        await send(message)

    return sending
