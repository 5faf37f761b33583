"""Server-sent events of the page: what changed among jobs and worlds, looked up only while someone listens."""

from __future__ import annotations

import asyncio
import json
import logging
import secrets
import time
from collections import deque
from collections.abc import AsyncGenerator
from contextlib import suppress
from typing import Any

import anyio
import anyio.to_thread

from ...worlds.errors import WorldAgentError
from ...worlds.folder import WorldFolder
from ...worlds.quoting import shown
from .data import PageData, signature

__all__ = ["MOST_LISTENERS", "EventHub"]

POLL_S = 0.5
"""Least pause between two looks at the workspace [s]."""
REST = 10.0
"""Pause in lengths of the last look, which takes 60 ms of CPU with 500 worlds: looking takes at most a tenth of a core."""
HEARTBEAT_S = 10.0
"""Longest silence of a stream [s]."""
MOST_LISTENERS = 32
KEPT_EVENTS = 512
"""Events that a client which comes back can still be told."""
WAITING_EVENTS = 128
"""Events that a slow listener may leave unread; then it is told to read everything anew."""

logger = logging.getLogger(__name__)

Snapshot = dict[str, dict[str, Any]]


class EventHub:
    """Watches one workspace for all listeners together.

    Events: `hello` (the stream begins; `fresh` says whether the client must read everything anew), `job` (one job),
    `world` (id of a world that changed or is new), `gone` (id of one that is gone), `beat` (the server lives).
    """

    def __init__(self, data: PageData) -> None:
        self._data = data
        self._boot = secrets.token_hex(4)
        self._number = 0
        self._past: deque[tuple[int, bytes]] = deque(maxlen=KEPT_EVENTS)
        self._listeners: set[asyncio.Queue[bytes | None]] = set()
        self._watch: asyncio.Task[None] | None = None
        self._seen: Snapshot | None = None

    @property
    def full(self) -> bool:
        """True if as many listen as are served."""
        return len(self._listeners) >= MOST_LISTENERS

    async def listen(self, last_id: str = "") -> AsyncGenerator[bytes, None]:
        """Events as bytes of the stream, until the client goes.

        Args:
            last_id: `Last-Event-ID` of a client that comes back: it gets what it missed, if that is still known.
        """
        queue: asyncio.Queue[bytes | None] = asyncio.Queue(WAITING_EVENTS)
        self._listeners.add(queue)
        try:
            if self._watch is None or self._watch.done():
                # What changed while nobody listened is not known: all who come back must read anew.
                self._seen, self._boot = None, secrets.token_hex(4)
                self._past.clear()
                self._watch = asyncio.create_task(self._run())
            missed = self._missed(last_id)
            yield self._encoded("hello", {"fresh": missed is None}, self._number)
            for event in missed or ():
                yield event
            while True:
                told = None
                with anyio.move_on_after(HEARTBEAT_S) as patience:
                    told = await queue.get()
                if patience.cancelled_caught:
                    yield b"event: beat\ndata: {}\n\n"
                elif told is None:
                    yield self._encoded("hello", {"fresh": True}, self._number)
                else:
                    yield told
        finally:
            self._leave(queue)

    def _leave(self, queue: asyncio.Queue[bytes | None]) -> None:
        self._listeners.discard(queue)
        if not self._listeners and self._watch is not None:
            self._watch.cancel()
            self._watch = None

    def _missed(self, last_id: str) -> list[bytes] | None:
        """Events after `last_id`; None where they are not known."""
        boot, _, number = last_id.partition("-")
        if boot != self._boot or not number.isdigit():
            return None
        oldest = self._past[0][0] if self._past else self._number + 1
        if not oldest - 1 <= int(number) <= self._number:
            return None
        return [event for n, event in self._past if n > int(number)]

    async def _run(self) -> None:
        while True:
            begun = time.monotonic()
            try:
                found = await anyio.to_thread.run_sync(self._look)
            except (OSError, WorldAgentError):
                logger.debug("the workspace could not be looked at", exc_info=True)
            else:
                if self._seen is not None:
                    for kind, data in _changes(self._seen, found):
                        self._tell(kind, data)
                self._seen = found
            await asyncio.sleep(max(POLL_S, REST * (time.monotonic() - begun)))

    def _look(self) -> Snapshot:
        workspace = self._data.workspace
        worlds = {w: {"signature": signature(WorldFolder(workspace / w))} for w in self._data.ids()}
        store = self._data.store()
        recent = [] if store is None else [*self._data.active(), *self._data.jobs(limit=20)["jobs"]]
        return {"worlds": worlds, "jobs": {j["job_id"]: j for j in recent}}

    def _tell(self, kind: str, data: dict[str, Any]) -> None:
        self._number += 1
        event = self._encoded(kind, data, self._number)
        self._past.append((self._number, event))
        for queue in self._listeners:
            if queue.full():
                with suppress(asyncio.QueueEmpty):
                    while True:
                        queue.get_nowait()
                queue.put_nowait(None)
            else:
                queue.put_nowait(event)

    def _encoded(self, kind: str, data: dict[str, Any], number: int) -> bytes:
        return f"id: {self._boot}-{number}\nevent: {kind}\ndata: {json.dumps(shown(data))}\n\n".encode()


def _changes(before: Snapshot, after: Snapshot) -> list[tuple[str, dict[str, Any]]]:
    """Events that lead from one look to the next."""
    found: list[tuple[str, dict[str, Any]]] = []
    for job_id, job in after["jobs"].items():
        if _news(job) != _news(before["jobs"].get(job_id)):
            found.append(("job", job))
    for world, state in after["worlds"].items():
        if before["worlds"].get(world) != state:
            found.append(("world", {"id": world}))
    found += [("gone", {"id": world}) for world in before["worlds"] if world not in after["worlds"]]
    return found


def _news(job: dict[str, Any] | None) -> dict[str, Any] | None:
    """Fields of a job whose change is news: the passing of time is none."""
    return None if job is None else {k: v for k, v in job.items() if k not in ("seconds", "eta_s")}
