"""Subscriptions: tell clients when a resource that they watch has changed, whichever process changed it.

Worlds are changed by workers and by other servers too, so the state of what is watched is looked up once a second. While
nobody watches, nothing runs.
"""

from __future__ import annotations

import asyncio
import logging
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, Final

import anyio.to_thread
from mcp.server import ServerRequestContext
from mcp.server.context import CallNext, HandlerResult
from mcp.server.lowlevel import Server
from mcp.server.session import ServerSession
from mcp.server.subscriptions import ResourcesListChanged, ResourceUpdated, SubscriptionBus
from mcp.shared.exceptions import MCPError
from mcp.types import EmptyResult, SubscribeRequestParams, UnsubscribeRequestParams
from mcp_types import INVALID_PARAMS

__all__ = ["ResourceWatch"]

WORLDS: Final = "worldagent://worlds"
INTERVAL_S: Final = 1.0
MOST_URIS: Final = 256
"""Resources that may be watched at a time; each is looked at every `INTERVAL_S`."""

logger = logging.getLogger(__name__)


class ResourceWatch:
    """Watches resources for the subscribers of both eras."""

    def __init__(self, state_of: Callable[[str], Hashable], bus: SubscriptionBus, *, interval_s: float = INTERVAL_S) -> None:
        """
        Args:
            state_of: State of a resource by its URI: changes with what the resource says; called in a thread.
            bus: Carries news to streams of `subscriptions/listen`.
            interval_s: Pause between two looks [s].
        """
        self._state_of = state_of
        self._bus = bus
        self._interval_s = interval_s
        self._watched: Counter[str] = Counter()
        self._seen: dict[str, Hashable] = {}
        self._sessions: dict[tuple[int, str], ServerSession] = {}
        self._task: asyncio.Task[None] | None = None

    @property
    def running(self) -> bool:
        """True if anything is watched now."""
        return self._task is not None and not self._task.done()

    async def __call__(self, ctx: ServerRequestContext[Any, Any], call_next: CallNext) -> HandlerResult:
        """Server middleware: watch what a `subscriptions/listen` stream asks for, as long as it lasts."""
        uris = _listened(ctx) if ctx.method == "subscriptions/listen" else []
        if not uris:
            return await call_next(ctx)
        await self._start(uris)
        with self._watching(uris):
            return await call_next(ctx)

    def serve_handshake_era(self, server: Server[Any]) -> None:
        """Serve `resources/subscribe` and `resources/unsubscribe`, which the era before 2026-07-28 has."""
        server.add_request_handler("resources/subscribe", SubscribeRequestParams, self._subscribe)
        server.add_request_handler("resources/unsubscribe", UnsubscribeRequestParams, self._unsubscribe)

    async def _subscribe(self, ctx: ServerRequestContext[Any, Any], params: SubscribeRequestParams) -> EmptyResult:
        uri = str(params.uri)
        connection = ctx.session._connection
        await self._start([uri])
        if (id(connection), uri) not in self._sessions:
            self._watched[uri] += 1
            self._sessions[id(connection), uri] = ctx.session
            connection.exit_stack.callback(self._forget, id(connection), uri)
        return EmptyResult()

    async def _unsubscribe(self, ctx: ServerRequestContext[Any, Any], params: UnsubscribeRequestParams) -> EmptyResult:
        self._forget(id(ctx.session._connection), str(params.uri))
        return EmptyResult()

    def _forget(self, connection: int, uri: str) -> None:
        if self._sessions.pop((connection, uri), None) is not None:
            self._leave([uri])

    @contextmanager
    def _watching(self, uris: list[str]) -> Iterator[None]:
        self._watched.update(uris)
        try:
            yield
        finally:
            self._leave(uris)

    def _leave(self, uris: Iterable[str]) -> None:
        self._watched.subtract(uris)
        for uri in [uri for uri, count in self._watched.items() if count <= 0]:
            del self._watched[uri]
            self._seen.pop(uri, None)
        if not self._watched and self._task is not None:
            self._task.cancel()
            self._task = None

    async def _start(self, uris: Iterable[str]) -> None:
        """Note how things stand before the subscriber is told that it is one, and begin to look."""
        new = {uri for uri in uris if uri not in self._seen}
        if len(self._seen) + len(new) > MOST_URIS:
            raise MCPError(INVALID_PARAMS, f"{len(self._seen) + len(new)} resources would be watched, at most {MOST_URIS} can be")
        for uri, state in (await anyio.to_thread.run_sync(self._states, new)).items():
            self._seen.setdefault(uri, state)  # another subscriber, who came first, must hear of what changed since
        if not self.running:
            self._task = asyncio.create_task(self._look())

    async def _look(self) -> None:
        while True:
            await asyncio.sleep(self._interval_s)
            now = await anyio.to_thread.run_sync(self._states, set(self._watched))
            changed = [uri for uri, state in now.items() if uri in self._seen and self._seen[uri] != state]
            self._seen.update({uri: state for uri, state in now.items() if uri in self._watched})
            for uri in changed:
                await self._tell(uri)

    async def _tell(self, uri: str) -> None:
        await self._bus.publish(ResourceUpdated(uri=uri))
        if uri == WORLDS:
            await self._bus.publish(ResourcesListChanged())  # each world's report is in the list
        for (_, watched), session in list(self._sessions.items()):
            if watched == uri:
                try:
                    await session.send_resource_updated(uri)
                except Exception:
                    logger.debug("a subscriber of %s could not be told", uri, exc_info=True)

    def _states(self, uris: Iterable[str]) -> dict[str, Hashable]:
        """States by URI; what cannot be read now (a busy database, a full disk) is left out and counts as unchanged."""
        found: dict[str, Hashable] = {}
        for uri in uris:
            try:
                found[uri] = self._state_of(uri)
            except Exception:
                logger.debug("the state of %s could not be read", uri, exc_info=True)
        return found


def _listened(ctx: ServerRequestContext[Any, Any]) -> list[str]:
    """URIs to watch for a `subscriptions/listen` request; malformed ones are the SDK's to refuse."""
    notifications = (ctx.params or {}).get("notifications")
    if not isinstance(notifications, dict):
        return []
    uris = notifications.get("resourceSubscriptions")
    listed = [WORLDS] if notifications.get("resourcesListChanged") is True else []
    return listed + ([uri for uri in uris if isinstance(uri, str)] if isinstance(uris, list) else [])
