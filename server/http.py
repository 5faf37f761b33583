"""The HTTP server: MCP, the web page and a health answer in one application behind one guard."""

from __future__ import annotations

import socket
from collections.abc import Callable, Sequence
from pathlib import Path

from mcp.server.transport_security import TransportSecuritySettings
from starlette.requests import Request
from starlette.responses import JSONResponse
from starlette.routing import Route
from starlette.types import ASGIApp

from .. import __version__
from ..workflow.context import ToolBinding
from ..worlds.errors import InputError
from .app import create_server
from .guard import BODY_BYTES, Guard, GuardRules
from .limits import MAX_SESSIONS
from .scopes import ScopeCheck
from .tokens import TokenBook
from .wire import StrictBodies

__all__ = ["LOOPBACK", "check_binding", "http_app", "serve_http", "transport_security"]

LOOPBACK = ("127.0.0.1", "localhost", "::1")
SESSION_IDLE_SECONDS = 1800.0


def check_binding(host: str, tokens: TokenBook, allowed_hosts: Sequence[str]) -> None:
    """Refuse to listen where others could reach the server unasked.

    Raises:
        InputError: The host is not loopback and there is no token, or no name to check the Host header against.
    """
    if host in LOOPBACK:
        return
    if not tokens.required():
        raise InputError(
            f"host {host!r} is reachable by others: issue a token (worldagent token add NAME) or give one by "
            f"WORLDAGENT_TOKEN or --token, or bind one of {', '.join(LOOPBACK)}"
        )
    if host in ("0.0.0.0", "::", "") and not allowed_hosts:  # noqa: S104 - compared, not bound
        raise InputError(f"host {host!r} means all interfaces: name with --allow-host how clients call this machine")


def host_names(host: str, allowed_hosts: Sequence[str]) -> list[str]:
    """Names that a Host header may carry."""
    return list(dict.fromkeys([*(LOOPBACK if host in LOOPBACK else (host,)), *allowed_hosts]))


def transport_security(host: str, allowed_hosts: Sequence[str], origins: Sequence[str] = ()) -> TransportSecuritySettings:
    """The SDK's own check of Host and Origin, behind the guard's, which is stricter."""
    hosts = [f"[{name}]" if ":" in name else name for name in host_names(host, allowed_hosts)]
    return TransportSecuritySettings(
        enable_dns_rebinding_protection=True,
        allowed_hosts=[entry for name in hosts for entry in (name, f"{name}:*")],
        allowed_origins=[
            entry for name in hosts for scheme in ("http", "https") for entry in (f"{scheme}://{name}", f"{scheme}://{name}:*")
        ]
        + list(origins),
    )


def http_app(
    workspace: Path,
    *,
    host: str = "127.0.0.1",
    tokens: TokenBook,
    allowed_hosts: Sequence[str] = (),
    allowed_origins: Sequence[str] = (),
    tools: Sequence[ToolBinding] | None = None,
    conformance: bool = False,
) -> ASGIApp:
    """One application: `/mcp`, the page at `/` with `/api/...`, and `/healthz`.

    Args:
        workspace: Root of all worlds.
        host: Address that the server binds.
        tokens: Who may come in.
        allowed_hosts: Further names that the Host header may carry.
        allowed_origins: Origins other than the server's own whose pages may call it.
        tools: Tools to serve; default all.
        conformance: Whether to serve the fixtures of the official conformance suite too.
    """
    from .page.routes import page_routes

    if tools is None:
        from ..tools import TOOLS

        tools = TOOLS
    server = create_server(workspace, tools=tools, conformance=conformance)
    server.middleware.append(ScopeCheck(tools))
    app = server.streamable_http_app(
        host=host,
        max_sessions=MAX_SESSIONS,
        session_idle_timeout=SESSION_IDLE_SECONDS,
        max_request_body_size=BODY_BYTES,
        transport_security=transport_security(host, allowed_hosts, allowed_origins),
    )
    app.router.routes.append(Route("/healthz", _healthz, methods=["GET"]))
    app.router.routes.extend(page_routes(server.workspace, lambda: server.jobs))
    return Guard(StrictBodies(app, "/mcp"), GuardRules(host_names(host, allowed_hosts), allowed_origins), tokens)


def serve_http(
    workspace: Path,
    *,
    host: str,
    port: int,
    token: str | None,
    allowed_hosts: Sequence[str] = (),
    allowed_origins: Sequence[str] = (),
    tools: Sequence[ToolBinding] | None = None,
    conformance: bool = False,
    announce: Callable[[str], None],
) -> None:
    """Serve until interrupted.

    Args:
        workspace: Root of all worlds.
        host: Address to bind.
        port: Port to bind; 0 takes a free one.
        token: A write token besides those of the workspace; without any, only loopback is served, to everyone on it.
        allowed_hosts: Further names that the Host header may carry.
        allowed_origins: Origins other than the server's own whose pages may call it.
        tools: Tools to serve; default all.
        conformance: Whether to serve the fixtures of the official conformance suite too.
        announce: Gets the URL as soon as connections are accepted.
    """
    from .connections import uvicorn_server

    tokens = TokenBook(workspace.expanduser().absolute(), given=token)
    check_binding(host, tokens, allowed_hosts)
    app = http_app(
        workspace,
        host=host,
        tokens=tokens,
        allowed_hosts=allowed_hosts,
        allowed_origins=allowed_origins,
        tools=tools,
        conformance=conformance,
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
        uvicorn_server(app, lambda: announce(f"http://{shown}:{bound}/mcp")).run(sockets=[listener])


async def _healthz(request: Request) -> JSONResponse:
    return JSONResponse({"ok": True, "version": __version__}, headers={"Cache-Control": "no-store"})
