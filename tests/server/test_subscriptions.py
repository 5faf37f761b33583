"""Subscriptions in both eras: a change by another process reaches the subscriber, and nothing runs for nobody."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Hashable, Iterable
from contextlib import suppress
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import anyio
import pytest
from mcp import Client, MCPError
from mcp.client.subscriptions import ResourcesListChanged, ResourceUpdated
from mcp.server.subscriptions import InMemorySubscriptionBus
from worldagent.execution import JobStore
from worldagent.server.app import WorldServer, create_server
from worldagent.server.states import ResourceStates
from worldagent.server.watching import MOST_URIS, ResourceWatch
from worldagent.server.workspace_jobs import WorkspaceJobs
from worldagent.worlds.folder import write_atomically
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.requirements import Row

pytestmark = pytest.mark.anyio

PATIENCE_S = 20.0
SPEC = {"spec_version": "1", "title": "Tiny", "prompt": "A box falls.", "simulation": {"frames": 24}}
MATRIX = "worldagent://worlds/tiny/matrix"
REPORT = "worldagent://worlds/tiny/report"
JOBS = "worldagent://worlds/tiny/jobs"


@pytest.fixture
def server(tmp_path: Path) -> WorldServer:
    (tmp_path / "tiny").mkdir()
    (tmp_path / "tiny" / "world.json").write_text(json.dumps(SPEC))
    Ledger(tmp_path / "tiny" / "ledger.sqlite").add_revision(json.dumps(SPEC), "0" * 64, expected=0)
    made = create_server(tmp_path, tools=[])
    made.watch._interval_s = 0.05
    return made


def judge(server: WorldServer) -> None:
    """Write a row as a worker does, by a connection of its own."""
    row = Row(
        id="scale:box", check="scale", group="spatial", predicate="size", status="pass", measured=1.0, bound=2.0, comparison="<="
    )
    Ledger(server.workspace / "tiny" / "ledger.sqlite").put_rows([row], revision=1, stage="static")


def work(server: WorldServer) -> None:
    """Submit a job as another server does."""
    JobStore(server.workspace).submit(
        "bake", "tiny", {"seconds": 0, "label": "x"}, entry="worldagent.server.conformance.jobs:sleep"
    )


def rewrite(server: WorldServer) -> None:
    """Change the specification as an edit does, with equal length."""
    write_atomically(server.workspace / "tiny" / "world.json", json.dumps(SPEC).encode())


@pytest.mark.parametrize(("uri", "change"), [(MATRIX, judge), (REPORT, judge), (JOBS, work), ("worldagent://jobs", work)])
async def test_a_listener_is_told_what_another_process_changed(
    server: WorldServer, uri: str, change: Callable[[WorldServer], None]
) -> None:
    async with Client(server) as client:
        async with client.listen(resource_subscriptions=[uri]) as stream:
            assert server.watch.running
            await anyio.to_thread.run_sync(change, server)
            with anyio.fail_after(PATIENCE_S):
                event = await anext(aiter(stream))
        assert event == ResourceUpdated(uri=uri)
        with anyio.fail_after(PATIENCE_S):
            while server.watch.running:
                await anyio.sleep(0.01)


@pytest.mark.filterwarnings("ignore:resources/.*subscribe is removed")
async def test_a_subscriber_of_the_handshake_era_is_told_until_it_leaves(server: WorldServer) -> None:
    told: list[str] = []
    news = anyio.Event()

    async def note(message: Any) -> None:
        uri = getattr(getattr(message, "params", None), "uri", None)
        if uri is not None:
            told.append(str(uri))
            news.set()

    async with Client(server, mode="legacy", message_handler=note) as client:
        assert client.server_capabilities.resources is not None
        assert client.server_capabilities.resources.subscribe is True
        await client.session.subscribe_resource(MATRIX)
        await client.session.subscribe_resource(MATRIX)
        await anyio.to_thread.run_sync(judge, server)
        with anyio.fail_after(PATIENCE_S):
            await news.wait()
        await client.session.unsubscribe_resource(MATRIX)
        assert not server.watch.running
        await client.session.subscribe_resource(REPORT)
        assert server.watch.running
    assert set(told) == {MATRIX}
    with anyio.fail_after(PATIENCE_S):
        while server.watch.running:
            await anyio.sleep(0.01)


@pytest.mark.filterwarnings("ignore:resources/.*subscribe is removed")
async def test_who_subscribes_twice_at_once_leaves_at_once(server: WorldServer, monkeypatch: pytest.MonkeyPatch) -> None:
    look = server.watch._states
    both = threading.Barrier(2)

    def looked(uris: Iterable[str]) -> dict[str, Hashable]:
        with suppress(threading.BrokenBarrierError):
            both.wait(2.0)
        return look(uris)

    monkeypatch.setattr(server.watch, "_states", looked)
    async with Client(server, mode="legacy") as client:
        async with anyio.create_task_group() as calls:
            for _ in range(2):
                calls.start_soon(client.session.subscribe_resource, MATRIX)
        await client.session.unsubscribe_resource(MATRIX)
        assert not server.watch.running


async def test_a_second_subscriber_hides_no_change_from_the_first() -> None:
    """Both look before either is noted; the world changes between their looks."""
    noted, is_first = threading.Event(), ContextVar("is_first", default=False)

    def state(uri: str) -> int:
        return 1 if is_first.get() or not noted.wait(PATIENCE_S) else 2

    watch = ResourceWatch(state, InMemorySubscriptionBus(), interval_s=PATIENCE_S)

    async def first() -> None:
        is_first.set(True)
        await watch._start(["u"])
        noted.set()

    async with anyio.create_task_group() as subscribers:
        subscribers.start_soon(first)
        subscribers.start_soon(watch._start, ["u"])
    with watch._watching(["u"]):
        assert watch._seen == {"u": 1}  # the next look finds 2 and tells


async def test_a_change_within_one_tick_of_the_clock_is_a_change(server: WorldServer) -> None:
    states = ResourceStates(server.workspace, WorkspaceJobs(server.workspace))
    for uri, change in ((MATRIX, judge), ("worldagent://worlds/tiny/spec", rewrite)):
        change(server)
        files = [server.workspace / "tiny" / name for name in ("ledger.sqlite", "world.json")]
        times = [path.stat().st_mtime_ns for path in files]
        before = states(uri)
        change(server)
        for path, at in zip(files, times, strict=True):
            os.utime(path, ns=(at, at))
        assert states(uri) != before


async def test_a_matrix_is_told_with_the_revision_that_it_is_of(server: WorldServer, monkeypatch: pytest.MonkeyPatch) -> None:
    judge(server)
    read = Ledger.rows
    path = server.workspace / "tiny" / "ledger.sqlite"
    edit = threading.Thread(target=lambda: Ledger(path).add_revision("{}", "1" * 64, expected=1))

    def read_then_edited(self: Ledger) -> list[Row]:
        rows = read(self)
        edit.start()
        edit.join(0.5)  # it waits for the reader
        return rows

    monkeypatch.setattr(Ledger, "rows", read_then_edited)
    async with Client(server) as client:
        (content,) = (await client.read_resource(MATRIX)).contents
    assert json.loads(content.text)["revision"] == 1
    edit.join()
    assert Ledger(path).revision() == 2


async def test_nothing_is_told_where_nothing_changed_and_to_nobody_else(server: WorldServer) -> None:
    async with Client(server) as client, client.listen(resource_subscriptions=[JOBS]) as jobs:
        async with client.listen(resource_subscriptions=[MATRIX]) as matrix:
            await anyio.to_thread.run_sync(judge, server)
            with anyio.fail_after(PATIENCE_S):
                assert await anext(aiter(matrix)) == ResourceUpdated(uri=MATRIX)
        with anyio.move_on_after(0.3) as waited:
            await anext(aiter(jobs))
        assert waited.cancelled_caught


async def test_watching_makes_no_workspace_and_unknown_uris_never_change(tmp_path: Path) -> None:
    server = create_server(tmp_path / "absent", tools=[])
    uris = [
        MATRIX,
        "worldagent://jobs",
        "worldagent://jobs/job_000000000000",
        "worldagent://worlds/../x/spec",
        "file:///etc/passwd",
    ]
    async with Client(server) as client, client.listen(resource_subscriptions=uris) as stream:
        with anyio.move_on_after(0.2) as waited:
            await anext(aiter(stream))
        assert waited.cancelled_caught
    assert not (tmp_path / "absent").exists()


async def test_more_than_a_few_hundred_resources_are_not_watched(server: WorldServer) -> None:
    uris = [f"worldagent://worlds/w{k}/matrix" for k in range(MOST_URIS + 1)]
    async with Client(server) as client:
        with pytest.raises(MCPError, match=str(MOST_URIS)):
            async with client.listen(resource_subscriptions=uris):
                pass
    assert not server.watch.running


async def test_a_server_process_tells_over_http_what_this_process_changed(server: WorldServer) -> None:
    command = [sys.executable, "-m", "worldagent.server", "serve", "--transport", "http", "--port", "0"]
    with subprocess.Popen([*command, "--workspace", str(server.workspace)], stderr=subprocess.PIPE, text=True) as child:
        try:
            assert child.stderr is not None
            url = child.stderr.readline().rpartition(" ")[2].strip()
            with anyio.fail_after(60):
                async with Client(url) as client, client.listen(resource_subscriptions=[MATRIX]) as stream:
                    await anyio.to_thread.run_sync(judge, server)
                    assert await anext(aiter(stream)) == ResourceUpdated(uri=MATRIX)
        finally:
            child.terminate()


async def test_what_cannot_be_read_for_a_while_has_not_changed(server: WorldServer, monkeypatch: pytest.MonkeyPatch) -> None:
    broken, real = threading.Event(), server.watch._state_of
    looked = threading.Event()

    def state_of(uri: str) -> Any:
        if broken.is_set():
            looked.set()
            raise OSError(28, "No space left on device")
        return real(uri)

    monkeypatch.setattr(server.watch, "_state_of", state_of)
    async with Client(server) as client, client.listen(resource_subscriptions=[MATRIX]) as stream:
        broken.set()
        assert await anyio.to_thread.run_sync(looked.wait, PATIENCE_S)
        broken.clear()
        with anyio.move_on_after(0.3) as waited:
            await anext(aiter(stream))
        assert waited.cancelled_caught
        await anyio.to_thread.run_sync(judge, server)
        with anyio.fail_after(PATIENCE_S):
            assert await anext(aiter(stream)) == ResourceUpdated(uri=MATRIX)


async def test_a_new_world_changes_the_list_of_resources(server: WorldServer) -> None:
    def create() -> None:
        (server.workspace / "second").mkdir()
        (server.workspace / "second" / "world.json").write_text(json.dumps(SPEC))

    async def reports(client: Client) -> list[str]:
        listed = [str(resource.uri) for resource in (await client.list_resources(cache_mode="bypass")).resources]
        return [uri for uri in listed if uri.startswith("worldagent://worlds/")]

    async with Client(server) as client, client.listen(resources_list_changed=True) as stream:
        assert await reports(client) == [REPORT]
        await anyio.to_thread.run_sync(create)
        with anyio.fail_after(PATIENCE_S):
            assert await anext(aiter(stream)) == ResourcesListChanged()
        assert await reports(client) == ["worldagent://worlds/second/report", REPORT]
        assert (await client.read_resource(REPORT)).contents
