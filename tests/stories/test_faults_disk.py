"""A full disk, a workspace that cannot be written, something in the way: told in words, nothing lost, and work goes on after."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.servers import COMMAND, Remote, pid_file, shimmed, stdio, without_bake

TITLE = [{"op": "add", "path": "/title", "value": "Another title"}]
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")


def _namespaces() -> bool:
    """True if this user may mount a small disk where nobody else sees it."""
    try:
        done = subprocess.run(
            ["unshare", "-rm", "sh", "-c", "mount -t tmpfs -o size=64k tmpfs /mnt"], capture_output=True, timeout=20, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


needs_namespaces = pytest.mark.skipif(
    sys.platform != "linux" or not _namespaces(), reason="needs user and mount namespaces (unshare -rm)"
)


def _told_full(answer: Any) -> None:
    text = answer.content[0].text
    assert answer.is_error, text
    # What is estimated before work is refused as a limit; what meets the end of the disk in mid-work is an engine's error.
    assert text.startswith(("engine: the disk is full", "over the limit: disk")), text
    assert "ree space" in text
    assert "Traceback" not in text


@pytest.fixture
def shim(copy: Path, tmp_path: Path) -> Iterator[tuple[Any, Path]]:
    """A client of a server whose disk is full while the given file is there."""
    workspace = tmp_path / "ws"
    workspace.mkdir()
    shutil.move(copy, workspace / "w")
    full = workspace / "full"
    with Remote(workspace, stdio(workspace, env=shimmed(WORLDAGENT_TEST_FULL=full))) as agent:
        agent.call("inspect_world", world="w")
        yield agent, full


def test_a_full_disk_is_told_and_an_edit_leaves_the_world_as_it_was(shim: tuple[Any, Path]) -> None:
    agent, full = shim
    folder = agent.workspace / "w"
    before = {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    full.touch()
    for tool, arguments in (
        ("edit_spec", {"world": "w", "patch": TITLE}),
        ("edit_spec", {"world": "new", "prompt": "A ball falls.", "spec": {}}),
    ):
        _told_full(agent.result(tool, **arguments))
    assert agent.call("inspect_world", world="w", part="matrix")["revision"] == 1
    assert not agent.result("inspect_world", world="w", part="state").is_error
    full.unlink()
    assert {p: p.read_bytes() for p in before} == before
    assert agent.call("edit_spec", world="w", patch=TITLE)["revision"] == 2
    assert not list(folder.rglob("*.tmp"))


def test_a_job_that_meets_a_full_disk_says_so_and_goes_on_afterwards(accepted_folder: Path, tmp_path: Path) -> None:
    workspace = without_bake(accepted_folder, tmp_path / "ws")
    full = workspace / "w" / "candidates" / "full"  # the workspace's own list of jobs still fits
    env = shimmed(WORLDAGENT_TEST_FULL=full)
    with Remote(workspace, stdio(workspace, env=env)) as agent:
        full.touch()
        answer = agent.result("bake_sim", world="w")
        assert answer.is_error
        assert "disk is full" in answer.content[0].text
        assert not list(workspace.glob("w/candidates/*/bake/**/*.tmp"))
        full.unlink()
        job = agent.call("bake_sim", world="w", wait_s=0)["job_id"]
        agent.call("job", action="cancel", job_id=job)


@contextmanager
def _mounted(workspace: Path, how: str) -> Iterator[Remote]:
    """A client of a server that sees the workspace through a mount of its own."""
    source = shutil.move(workspace, workspace.with_name("source"))
    workspace.mkdir()
    script = f"{how.format(ws=workspace, source=source)} && exec {' '.join(COMMAND)} --workspace {workspace}"
    with Remote(workspace, stdio(workspace, command=("unshare", "-rm", "sh", "-c", script + " #"))) as agent:
        yield agent


@needs_namespaces
def test_a_disk_that_is_really_full_is_told_and_serves_again_when_there_is_room(copy: Path, tmp_path: Path) -> None:
    workspace = tmp_path / "ws"
    workspace.mkdir()
    shutil.move(copy, workspace / "w")
    with _mounted(workspace, "mount -t tmpfs -o size=8m tmpfs {ws} && cp -r {source}/w {ws}/") as agent:
        agent.call("job", action="list")
        inside = Path(f"/proc/{pid_file(workspace).read_text().strip()}/root") / str(workspace).lstrip("/")
        with (inside / "fill").open("wb", buffering=0) as stream, pytest.raises(OSError, match="No space"):
            _fill(stream)
        _told_full(agent.result("edit_spec", world="w", patch=TITLE))
        _told_full(agent.result("edit_spec", world="new", prompt="A ball falls.", spec={}))
        assert agent.call("inspect_world", world="w")["revision"] == 1
        (inside / "fill").unlink()
        assert agent.call("edit_spec", world="w", patch=TITLE)["revision"] == 2
        assert agent.call("inspect_world", world="w")["revision"] == 2


def _fill(stream: Any) -> None:
    while True:
        stream.write(bytes(4096))


@needs_namespaces
def test_a_read_only_workspace_can_be_read_and_says_why_it_cannot_be_written(copy: Path, tmp_path: Path) -> None:
    workspace = tmp_path / "ws"
    workspace.mkdir()
    shutil.move(copy, workspace / "w")
    with _mounted(workspace, "mount --bind {source} {ws} && mount -o remount,bind,ro {ws}") as agent:
        _reads_but_does_not_write(agent)


@pytest.mark.skipif(os.geteuid() == 0, reason="permissions do not bind root")
def test_a_workspace_without_permission_to_write_can_be_read(accepted: Any) -> None:
    folders = [accepted.workspace, *(p for p in accepted.workspace.rglob("*") if p.is_dir())]
    for folder in folders:
        folder.chmod(0o500)
    (accepted.workspace / "w" / "ledger.sqlite").chmod(0o400)
    try:
        _reads_but_does_not_write(accepted)
    finally:
        for folder in folders:
            folder.chmod(0o700)


def _reads_but_does_not_write(agent: Any) -> None:
    for part in ("overview", "spec", "matrix", "state", "events", "acceptance", "revisions"):
        answer = agent.result("inspect_world", world="w", part=part)
        assert not answer.is_error, (part, answer.content[0].text)
    assert "cannot be written" in agent.result("inspect_world", world="w").content[0].text
    for tool, arguments in (
        ("edit_spec", {"world": "w", "patch": TITLE}),
        ("edit_spec", {"world": "new", "prompt": "A ball falls.", "spec": {}}),
        ("bake_sim", {"world": "w"}),
        ("job", {"action": "list"}),
    ):
        text = agent.result(tool, **arguments).content[0].text
        assert text.startswith("engine: "), text
        assert "cannot be written" in text
        assert "--workspace" in text
    assert agent.call("inspect_world", world="w")["revision"] == 1


def test_a_file_in_the_place_of_the_folder_of_jobs_is_told(accepted: Any) -> None:
    place = accepted.workspace / ".worldagent"
    shutil.rmtree(place, ignore_errors=True)
    place.write_text("in the way")
    answer = accepted.result("job", action="list")
    assert answer.is_error
    assert ".worldagent" in answer.content[0].text
    assert "in the way" in answer.content[0].text
    assert not accepted.result("inspect_world", world="w").is_error
    place.unlink()
    assert accepted.call("job", action="list")["jobs"] == []
