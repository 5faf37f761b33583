"""The stream of changes: what is told, to whom, and that nobody looks while nobody listens."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from typing import Any

import anyio
import pytest
from worldagent.server.page import events
from worldagent.server.page.data import PageData
from worldagent.server.page.events import EventHub
from worldagent.tests.page.conftest import Made

pytestmark = pytest.mark.anyio


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture
def hub(made: Made, monkeypatch: pytest.MonkeyPatch) -> EventHub:
    monkeypatch.setattr(events, "POLL_S", 0.01)
    return EventHub(PageData(made.root, lambda: made.jobs))


async def upcoming(stream: AsyncIterator[bytes], *kinds: str) -> tuple[str, str, dict[str, Any]]:
    """Id, kind and data of the next event of one of these kinds."""
    with anyio.fail_after(30):
        while True:
            lines = dict(line.split(": ", 1) for line in (await anext(stream)).decode().strip().split("\n"))
            if lines["event"] in kinds:
                return lines.get("id", ""), lines["event"], json.loads(lines["data"])


async def seen(hub: EventHub) -> None:
    """Until the hub has looked once."""
    with anyio.fail_after(30):
        while hub._seen is None:
            await anyio.sleep(0.01)


async def test_worlds_and_jobs_are_told_as_they_change(made: Made, hub: EventHub) -> None:
    stream = hub.listen()
    assert (await upcoming(stream, "hello"))[2] == {"fresh": True}
    await seen(hub)
    await anyio.to_thread.run_sync(made.world, "w")
    assert (await upcoming(stream, "world"))[2] == {"id": "w"}
    job = await anyio.to_thread.run_sync(made.job, "w")
    made.advance(4)
    found: dict[str, Any] = {}
    while found.get("progress") != 0.4:
        found = (await upcoming(stream, "job"))[2]
    assert (found["job_id"], found["state"], found["message"]) == (job, "running", "step 4 of 10")
    (made.root / "w").rename(made.root / ".w")
    assert (await upcoming(stream, "gone"))[2] == {"id": "w"}
    await stream.aclose()


async def test_a_client_that_comes_back_gets_what_it_missed(made: Made, hub: EventHub) -> None:
    keeper, stream = hub.listen(), hub.listen()
    await upcoming(keeper, "hello")
    last = (await upcoming(stream, "hello"))[0]
    await seen(hub)
    await stream.aclose()
    await anyio.to_thread.run_sync(made.world, "w")
    assert (await upcoming(keeper, "world"))[2] == {"id": "w"}
    again = hub.listen(last)
    assert (await upcoming(again, "hello"))[2] == {"fresh": False}
    assert (await upcoming(again, "world"))[2] == {"id": "w"}
    for stranger in ("", "other-3", f"{last.partition('-')[0]}-999", "x"):
        other = hub.listen(stranger)
        assert (await upcoming(other, "hello"))[2] == {"fresh": True}
        await other.aclose()
    for stream in (again, keeper):
        await stream.aclose()


async def test_nobody_looks_while_nobody_listens(hub: EventHub) -> None:
    first, second = hub.listen(), hub.listen()
    await upcoming(first, "hello")
    await upcoming(second, "hello")
    watch = hub._watch
    assert watch is not None
    await first.aclose()
    assert not watch.cancelled()
    await second.aclose()
    with anyio.fail_after(10):
        while not watch.done():
            await anyio.sleep(0.01)
    assert hub._watch is None


async def test_a_slow_listener_is_told_to_read_anew_and_holds_nobody_up(hub: EventHub, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(events, "WAITING_EVENTS", 4)
    slow = hub.listen()
    await upcoming(slow, "hello")
    for k in range(9):
        hub._tell("world", {"id": f"w{k}"})
    assert (await upcoming(slow, "hello", "world"))[1:] == ("hello", {"fresh": True})
    await slow.aclose()


async def test_listeners_are_bounded(hub: EventHub, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(events, "MOST_LISTENERS", 1)
    only = hub.listen()
    assert not hub.full
    await upcoming(only, "hello")
    assert hub.full
    await only.aclose()
    assert not hub.full


async def test_a_silent_stream_shows_that_it_lives(hub: EventHub, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(events, "HEARTBEAT_S", 0.02)
    stream = hub.listen()
    assert (await upcoming(stream, "beat"))[2] == {}
    await stream.aclose()
