"""Equal specifications give equal bytes, also through a kill, a cancel, and a client that goes away."""

from __future__ import annotations

import os
import shutil
import signal
import sqlite3
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from worldagent.execution import JobStore, run_inline
from worldagent.tests.stories.small_run import PROMPT, small_spec

LONG = 240
"""Frames of a world long enough to be interrupted."""
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")


def _bake(workspace: Path) -> Path:
    (found,) = (workspace / "w" / "candidates").glob("*/bake")
    return found


def _content(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


@pytest.fixture(scope="session")
def long_probed(tmp_path_factory: pytest.TempPathFactory, agent_of: Any) -> Path:
    """Workspace of a probed world of ten seconds, not baked; the frames of the probe, which a bake would take, are gone."""
    workspace = tmp_path_factory.mktemp("long")
    spec = small_spec()
    spec["simulation"]["frames"] = LONG
    spec["simulation"]["solvers"]["rigid"]["settings"]["sleep"] = False
    spec["shots"]["only"]["frames"] = [0, LONG - 1]
    with agent_of(workspace) as agent:
        agent.call("edit_spec", world="w", prompt=PROMPT, spec=spec)
        agent.call("probe_sim", world="w")
    with sqlite3.connect(workspace / "w" / "ledger.sqlite") as db:
        db.execute("UPDATE freezes SET passed=1")  # whether it passes is not what these tests are about
        db.execute("DELETE FROM meta")
    db.close()
    (probe,) = (workspace / "w" / "candidates").glob("*/probe")
    shutil.rmtree(probe)
    return workspace


@pytest.fixture(scope="session")
def unbroken(long_probed: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Caches and checkpoints of its uninterrupted bake."""
    workspace = shutil.copytree(long_probed, tmp_path_factory.mktemp("unbroken") / "copy")
    _bake_only(workspace)
    return _content(_bake(workspace))


def _bake_only(workspace: Path) -> None:
    """Bake without the checks."""
    from worldagent.simulation.bake import run_bake
    from worldagent.worlds.folder import WorldFolder

    run_bake(WorldFolder(workspace / "w"), _freeze(workspace))


def _freeze(workspace: Path) -> str:
    import json

    (record,) = (workspace / "w" / "candidates").glob("*/candidate.json")
    return str(json.loads(record.read_text())["freeze"])


def _started(agent: Any, workspace: Path, frames: int) -> str:
    """Start a bake and wait until it has written some frames."""
    job = agent.call("bake_sim", world="w", wait_s=0)["job_id"]
    deadline = time.monotonic() + 240
    while len(list(workspace.glob("w/candidates/*/bake/rigid/frame_*.npz"))) < frames:
        assert time.monotonic() < deadline
        time.sleep(0.005)
    return str(job)


def test_the_same_specification_gives_the_same_bytes_in_two_workspaces(loop: Any, tmp_path: Path, agent_of: Any) -> None:
    with agent_of(tmp_path) as agent:
        agent.call("edit_spec", world="w", prompt=PROMPT, spec=small_spec())
        agent.call("place_object", world="w")
    with sqlite3.connect(loop.workspace / "w" / "ledger.sqlite") as db:
        freezes = db.execute("SELECT * FROM freezes").fetchall()
    db.close()
    with sqlite3.connect(tmp_path / "w" / "ledger.sqlite") as db:
        db.executemany("INSERT INTO freezes VALUES (?,?,?,?,?)", freezes)
        db.execute("DELETE FROM meta WHERE key='seals'")  # the seals of these are in the other ledger
    db.close()
    run_inline("worldagent.workflow.jobs:bake", {"folder": str(tmp_path / "w")})
    there = _content(_bake(loop.workspace))
    assert there.pop("taken.json")  # that one has the frames of its probe, this one simulated all
    assert _content(_bake(tmp_path)) == there
    built = _content(tmp_path / "w" / "built")
    assert built == {k: v for k, v in _content(loop.workspace / "w" / "built").items() if k in built}


@pytest.mark.slow
def test_a_bake_whose_worker_is_killed_resumes_to_the_same_bytes(
    long_probed: Path, unbroken: dict[str, bytes], tmp_path: Path, agent_of: Any
) -> None:
    workspace = shutil.copytree(long_probed, tmp_path / "ws")
    store = JobStore(workspace)
    with agent_of(workspace) as agent:
        job = _started(agent, workspace, 40)
        with sqlite3.connect(workspace / ".worldagent" / "jobs.db") as db:
            db.row_factory = sqlite3.Row
            row = dict(db.execute("SELECT * FROM jobs WHERE id=?", (job,)).fetchone())
        db.close()
        for pid in _processes_of(row):
            os.kill(pid, signal.SIGKILL)
        ended = store.wait(job, 240)
        assert ended.state == "lost"
        written = len(list(workspace.glob("w/candidates/*/bake/rigid/frame_*.npz")))
        assert 40 <= written < LONG
        assert "complete bake" in agent.refused("run_checks", world="w", scope="acceptance")
        _bake_only(workspace)
    assert _content(_bake(workspace)) == unbroken


def _processes_of(row: dict[str, Any]) -> list[int]:
    """Worker and task of a job, the worker first."""
    return [int(row[k]) for k in ("pid", "task_pid") if row.get(k)]


@pytest.mark.slow
def test_a_cancelled_bake_resumes_to_the_same_bytes(
    long_probed: Path, unbroken: dict[str, bytes], tmp_path: Path, agent_of: Any
) -> None:
    workspace = shutil.copytree(long_probed, tmp_path / "ws")
    with agent_of(workspace) as agent:
        job = _started(agent, workspace, 30)
        assert agent.call("job", action="cancel", job_id=job)["state"] == "cancelled"
        assert len(list(workspace.glob("w/candidates/*/bake/rigid/frame_*.npz"))) < LONG
        again = agent.call("bake_sim", world="w", wait_s=0)["job_id"]
        assert again != job
        while len(list(workspace.glob("w/candidates/*/bake/rigid/frame_*.npz"))) < LONG:
            time.sleep(0.02)
        agent.call("job", action="cancel", job_id=again)
    _bake_only(workspace)
    assert _content(_bake(workspace)) == unbroken


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="warm workers are for Linux")
def test_a_bake_in_a_warm_worker_gives_the_same_bytes(
    long_probed: Path, unbroken: dict[str, bytes], tmp_path: Path, agent_of: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Forked by a process that has loaded the engines, against one that loads them itself."""
    monkeypatch.setenv("WORLDAGENT_WARM", "1")
    workspace = shutil.copytree(long_probed, tmp_path / "ws")
    store = JobStore(workspace)
    assert store.warm_up("worldagent.workflow.jobs")
    folder = workspace / ".worldagent"
    deadline = time.monotonic() + 240
    while not (folder / "warm.sock").exists():
        assert time.monotonic() < deadline
        time.sleep(0.05)
    nursery = int((folder / "warm.log").read_text().split(" nursery ")[1].split(":")[0])
    try:
        with agent_of(workspace) as agent:
            job = _started(agent, workspace, LONG)
            ancestors = Path(f"/proc/{store.get(job).pid}/cmdline").read_bytes()
            assert b"execution.nursery" in ancestors
            agent.call("job", action="cancel", job_id=job)
    finally:
        os.kill(nursery, signal.SIGKILL)
    _bake_only(workspace)
    assert _content(_bake(workspace)) == unbroken


@pytest.mark.slow
def test_a_job_outlives_its_client_and_its_server(long_probed: Path, tmp_path: Path, agent_of: Any) -> None:
    workspace = shutil.copytree(long_probed, tmp_path / "ws")
    with agent_of(workspace) as agent:
        job = _started(agent, workspace, 5)
    with agent_of(workspace) as later:
        seen = later.call("job", action="status", job_id=job)
        assert seen["state"] in ("running", "done")
        assert later.call("bake_sim", world="w", wait_s=0)["job_id"] == job
        while len(list(workspace.glob("w/candidates/*/bake/rigid/frame_*.npz"))) < LONG:
            time.sleep(0.02)
        later.call("job", action="cancel", job_id=job)


@pytest.mark.slow
def test_a_torn_tail_is_not_trusted(long_probed: Path, unbroken: dict[str, bytes], tmp_path: Path) -> None:
    """Half a frame, a digest without a frame, and a frame that no digest knows."""
    workspace = shutil.copytree(long_probed, tmp_path / "ws")
    bake = workspace / "w" / "candidates" / _freeze(workspace)[:16] / "bake"
    for name, data in unbroken.items():
        (bake / name).parent.mkdir(parents=True, exist_ok=True)
        (bake / name).write_bytes(data)
    rigid = bake / "rigid"
    half = rigid / "frame_000200.npz"
    half.write_bytes(half.read_bytes()[:300])
    (rigid / "frame_000210.npz").unlink()
    for mark in rigid.glob("checkpoints/*.bin"):
        if int(mark.stem) > 190:
            mark.unlink()
    _bake_only(workspace)
    assert _content(bake) == unbroken
