"""Streamable HTTP: loopback by default, a bearer token elsewhere, Host and Origin checked always."""

from __future__ import annotations

import hmac
import socket
from collections.abc import Callable, Sequence
from pathlib import Path

from mcp.server.auth.provider import AccessToken
from mcp.server.auth.settings import AuthSettings
from mcp.server.transport_security import TransportSecuritySettings
from pydantic import AnyHttpUrl

from ..tools.context import ToolBinding
from ..worlds.errors import InputError
from .app import create_server

__all__ = ["LOOPBACK", "StaticToken", "check_binding", "serve_http"]

LOOPBACK = ("127.0.0.1", "localhost", "::1")
MAX_SESSIONS = 64
SHORTEST_TOKEN = 16


class StaticToken:
    """Accepts one bearer token, compared in constant time."""

    def __init__(self, token: str) -> None:
        self._token = token.encode()

    async def verify_token(self, token: str) -> AccessToken | None:
        """Access for the token, None for any other."""
        if not hmac.compare_digest(token.encode(), self._token):
            return None
        return AccessToken(token=token, client_id="worldagent", scopes=[])


def check_binding(host: str, token: str | None, allowed_hosts: Sequence[str]) -> None:
    """Refuse to listen where others could reach the server unasked.

    Raises:
        InputError: The host is not loopback and there is no token, or no name to check the Host header against; or
            the token is too short.
    """
    if token is not None and len(token) < SHORTEST_TOKEN:
        raise InputError(f"the token has {len(token)} characters, it needs at least {SHORTEST_TOKEN}")
    if host in LOOPBACK:
        return
    if token is None:
        raise InputError(
            f"host {host!r} is reachable by others: give --token (or WORLDAGENT_TOKEN), or bind one of {', '.join(LOOPBACK)}"
        )
    if host in ("0.0.0.0", "::", "") and not allowed_hosts:  # noqa: S104 - compared, not bound
        raise InputError(f"host {host!r} means all interfaces: name with --allow-host how clients call this machine")


def transport_security(host: str, allowed_hosts: Sequence[str]) -> TransportSecuritySettings:
    """Hosts and origins that requests may name."""
    names = list(dict.fromkeys([*(LOOPBACK if host in LOOPBACK else (host,)), *allowed_hosts]))
    hosts = [f"[{name}]" if ":" in name else name for name in names]
    return TransportSecuritySettings(
        enable_dns_rebinding_protection=True,
        allowed_hosts=[entry for name in hosts for entry in (name, f"{name}:*")],
        allowed_origins=[
            entry for name in hosts for scheme in ("http", "https") for entry in (f"{scheme}://{name}", f"{scheme}://{name}:*")
        ],
    )


def serve_http(
    workspace: Path,
    *,
    host: str,
    port: int,
    token: str | None,
    allowed_hosts: Sequence[str] = (),
    tools: Sequence[ToolBinding] | None = None,
    announce: Callable[[str], None],
) -> None:
    """Serve until interrupted.

    Args:
        workspace: Root of all worlds.
        host: Address to bind.
        port: Port to bind; 0 takes a free one.
        token: Bearer token that every request must carry; None only on loopback.
        allowed_hosts: Further names that the Host and Origin headers may carry.
        tools: Tools to serve; default all.
        announce: Gets the URL as soon as connections are accepted.
    """
    import uvicorn

    check_binding(host, token, allowed_hosts)
    server = create_server(
        workspace,
        tools=tools,
        auth=None if token is None else AuthSettings(issuer_url=AnyHttpUrl("http://localhost"), resource_server_url=None),
        token_verifier=None if token is None else StaticToken(token),
    )
    app = server.streamable_http_app(
        host=host, max_sessions=MAX_SESSIONS, transport_security=transport_security(host, allowed_hosts)
    )
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((host, port))
        except OSError as error:
            raise InputError(
                f"cannot listen on {host} port {port}: {error.strerror}; choose another --port, or 0 for a free one"
            ) from error
        listener.listen(128)
        bound = listener.getsockname()[1]
        shown = f"[{host}]" if ":" in host else host
        announce(f"http://{shown}:{bound}/mcp")
        uvicorn.Server(uvicorn.Config(app, log_level="warning", timeout_graceful_shutdown=3)).run(sockets=[listener])
