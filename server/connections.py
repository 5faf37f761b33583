"""Connections of the HTTP server: slow and idle ones are closed, so that they cannot keep others out."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from typing import Any

import h11
import uvicorn
from starlette.types import ASGIApp
from uvicorn.protocols.http.h11_impl import H11Protocol

__all__ = ["HEAD_BYTES", "HEAD_SECONDS", "MOST_CONNECTIONS", "SHUTDOWN_SECONDS", "StrictConnection", "uvicorn_server"]

HEAD_BYTES = 32 * 1024
"""Largest request line with headers [bytes]."""
HEAD_SECONDS = 10.0
"""Longest time that the head of a request may take to arrive, from the first byte or from the connection [s]."""
KEEP_ALIVE_SECONDS = 15
"""Longest rest of a connection between two requests [s]."""
MOST_CONNECTIONS = 256
"""Open connections and running requests; more are answered 503."""
SHUTDOWN_SECONDS = 1
"""Patience with open streams when the server ends [s]."""
ENDLESS = frozenset({"/api/events"})
"""Paths whose responses end only with their client."""
ACCEPTED_BEYOND = 64
"""Connections above the limit that are held long enough to be told 503; still more are closed at once."""

logger = logging.getLogger(__name__)


class StrictConnection(H11Protocol):
    """uvicorn's connection with a deadline for the head of each request, which uvicorn lacks."""

    _deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Start the clock with the connection."""
        super().connection_made(transport)
        limit = self.limit_concurrency
        if limit is not None and len(self.connections) > limit + ACCEPTED_BEYOND:
            transport.abort()
            return
        self._arm()

    def data_received(self, data: bytes) -> None:
        """Stop the clock when a head is whole, start it when the next one begins."""
        super().data_received(data)
        if self.conn.their_state is not h11.IDLE:
            self._disarm()
        elif self._deadline is None and self.conn.trailing_data[0]:
            self._arm()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the clock."""
        self._disarm()
        super().connection_lost(exc)

    def shutdown(self) -> None:
        """Wait for what is under way, but not for a stream that never ends by itself."""
        super().shutdown()
        if self.cycle is not None and self.cycle.scope["path"] in ENDLESS:
            self.transport.close()

    def _arm(self) -> None:
        self._deadline = self.loop.call_later(HEAD_SECONDS, self._late)

    def _disarm(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def _late(self) -> None:
        self._deadline = None
        if self.conn.their_state is h11.IDLE and not self.transport.is_closing():
            logger.debug("closed a connection whose request did not arrive within %g s", HEAD_SECONDS)
            self.transport.abort()


class _AnnouncingServer(uvicorn.Server):
    """Says when connections are accepted."""

    def __init__(self, config: uvicorn.Config, announce: Callable[[], None]) -> None:
        super().__init__(config)
        self._announce = announce

    async def startup(self, sockets: list[Any] | None = None) -> None:
        await super().startup(sockets)
        if self.started:
            self._announce()


def uvicorn_server(app: ASGIApp, announce: Callable[[], None]) -> uvicorn.Server:
    """The server of an application.

    Args:
        app: The application.
        announce: Called once connections are accepted.
    """
    config = uvicorn.Config(
        app,
        http=StrictConnection,
        ws="none",
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        limit_concurrency=MOST_CONNECTIONS,
        backlog=MOST_CONNECTIONS,
        timeout_keep_alive=KEEP_ALIVE_SECONDS,
        h11_max_incomplete_event_size=HEAD_BYTES,
        timeout_graceful_shutdown=SHUTDOWN_SECONDS,
    )
    return _AnnouncingServer(config, announce)
