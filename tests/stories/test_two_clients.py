"""Two clients with servers of their own, over stdio, on one world: edits and bakes race, and nothing is lost."""

from __future__ import annotations

import json
import os
import shutil
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Self

import pytest
from anyio.from_thread import start_blocking_portal
from mcp import Client, StdioServerParameters
from worldagent.execution import JobStore
from worldagent.tests.stories.conftest import patch_of

EDITS = 6
"""Edits that each client makes."""
TRIES = 60


class Process:
    """A client with its own server process, as a desktop application has."""

    def __init__(self, workspace: Path) -> None:
        self._workspace = workspace
        self._stack = ExitStack()

    def __enter__(self) -> Self:
        arguments = ["-m", "worldagent.server", "serve", "--workspace", str(self._workspace)]
        command = StdioServerParameters(command=sys.executable, args=arguments, env=dict(os.environ))
        self._portal = self._stack.enter_context(start_blocking_portal("asyncio"))
        self._client = self._stack.enter_context(self._portal.wrap_async_context_manager(Client(command)))
        return self

    def __exit__(self, *error: object) -> None:
        self._stack.close()

    def call(self, tool: str, **arguments: Any) -> tuple[dict[str, Any], str]:
        """Data of an answer, or the text of a refusal."""
        answer = self._portal.call(self._client.call_tool, tool, arguments)
        text = answer.content[0].text
        return ({}, text) if answer.is_error else (json.loads(text), "")


@pytest.fixture
def pair(accepted_folder: Path, tmp_path: Path) -> Iterator[tuple[Process, Process]]:
    """Two clients of a workspace that holds a copy of the accepted world `w`."""
    shutil.copytree(accepted_folder, tmp_path / "w")
    with Process(tmp_path) as one, Process(tmp_path) as two:
        yield one, two


def _together(*works: Callable[[], None]) -> None:
    """Run all at the same time; the first error of any is raised."""
    errors: list[BaseException] = []

    def run(work: Callable[[], None]) -> None:
        try:
            work()
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=run, args=(work,)) for work in works]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(240)
    if errors:
        raise errors[0]


def _title(client: Process) -> tuple[str, int]:
    data, refusal = client.call("inspect_world", world="w", part="spec", pointer="/title")
    assert not refusal, refusal
    return data["value"], data["revision"]


def _append(client: Process, letter: str, refusals: list[str]) -> None:
    """Read the title, write it with one letter more; again from the start where somebody was faster."""
    for _ in range(TRIES):
        title, revision = _title(client)
        patch = patch_of(("/title", title + letter))
        _, refusal = client.call("edit_spec", world="w", patch=patch, expected_revision=revision)
        if not refusal:
            return
        refusals.append(refusal)
    raise AssertionError(f"no edit came through in {TRIES} tries: {refusals[-1]}")


def test_edits_that_race_lose_no_update(pair: tuple[Process, Process]) -> None:
    """Each edit builds on what it read: an edit on a revision that is not the latest is refused, and tells so."""
    one, two = pair
    before, revision = _title(one)
    refusals: list[str] = []
    _together(
        lambda: [_append(one, "a", refusals) for _ in range(EDITS)] and None,
        lambda: [_append(two, "b", refusals) for _ in range(EDITS)] and None,
    )
    after, last = _title(two)
    assert after.startswith(before)
    added = after[len(before) :]
    assert (added.count("a"), added.count("b"), len(added)) == (EDITS, EDITS, 2 * EDITS)
    assert last == revision + 2 * EDITS
    assert all("revision" in text and ("another client" in text or "read it again" in text) for text in refusals), refusals
    history, _ = one.call("inspect_world", world="w", part="revisions", limit=30)
    assert json.dumps(history).count("/title") >= 2 * EDITS


def test_bakes_that_race_are_one_job_and_an_edit_meanwhile_stays(pair: tuple[Process, Process], tmp_path: Path) -> None:
    one, two = pair
    started: dict[str, str] = {}

    def bake(name: str, client: Process) -> None:
        data, refusal = client.call("bake_sim", world="w", wait_s=0)
        assert not refusal, refusal
        started[name] = data["job_id"]

    _together(lambda: bake("one", one), lambda: bake("two", two))
    assert started["one"] == started["two"]
    _, revision = _title(one)
    edited, refusal = two.call("edit_spec", world="w", patch=patch_of(("/look/samples", 3)), expected_revision=revision)
    assert not refusal, refusal
    ended, refusal = one.call("job", action="wait", job_id=started["one"], wait_s=240)
    assert not refusal, refusal
    assert ended["state"] == "done", ended
    value, _ = one.call("inspect_world", world="w", part="spec", pointer="/look/samples")
    assert (value["value"], value["revision"]) == (3, edited["revision"])
    again, refusal = two.call("bake_sim", world="w", wait_s=0)
    assert not refusal, refusal
    store = JobStore(tmp_path)
    assert store.get(again["job_id"]).kind == "bake"
    store.request_cancel(again["job_id"])
    assert store.wait(again["job_id"], 240).ended
