"""Processes that are killed: workers, tasks, servers, clients. Work that was done stays, and the next one goes on with it."""

from __future__ import annotations

import os
import signal
import threading
import time
from pathlib import Path
from typing import Any

import pytest
from worldagent.execution import JobStore
from worldagent.tests.stories.servers import Remote, bake_folder, baked, content, http, served, stdio, until, without_bake

FRAMES = 6
"""Frames of the bake that are there when something is killed: of 36, with a checkpoint at frame 0."""
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")


@pytest.fixture
def bakeable(accepted_folder: Path, tmp_path: Path) -> Path:
    """A workspace whose world `w` is probed and not baked."""
    return without_bake(accepted_folder, tmp_path / "ws")


def _same_bake(workspace: Path, accepted_folder: Path) -> bool:
    return content(bake_folder(workspace)) == content(bake_folder(accepted_folder.parent))


@pytest.mark.parametrize("victim", [pytest.param("worker", marks=pytest.mark.slow), "task"])
def test_a_bake_whose_processes_are_killed_is_told_and_resumed(
    victim: str, bakeable: Path, accepted_folder: Path, agent_of: Any
) -> None:
    store = JobStore(bakeable)
    with agent_of(bakeable) as agent:
        job = agent.call("bake_sim", world="w", wait_s=0)["job_id"]
        baked(bakeable, FRAMES)
        row = store.get(job)
        os.kill(row.pid if victim == "worker" else row.task_pid, signal.SIGKILL)
        told = agent.call("job", action="wait", job_id=job, wait_s=240)
        assert told["state"] == "lost"
        assert told["error"]["type"] == "EngineError"
        assert ("gone" if victim == "worker" else "SIGKILL") in told["error"]["message"]
        written = len(list(bake_folder(bakeable).glob("rigid/frame_*.npz")))
        assert written >= FRAMES
        assert "complete bake" in agent.refused("run_checks", world="w", scope="acceptance")
        again = agent.call("bake_sim", world="w")
        assert again["passed"]
        assert again["job_id"] != job
    assert _same_bake(bakeable, accepted_folder)


@pytest.mark.parametrize("transport", ["stdio", pytest.param("http", marks=pytest.mark.slow)])
def test_a_bake_outlives_a_killed_server_and_the_next_one_joins_it(
    transport: str, bakeable: Path, accepted_folder: Path, agent_of: Any
) -> None:
    answers: list[Any] = []
    with served(transport, bakeable) as (agent, kill):

        def call() -> None:
            try:
                answers.append(agent.result("bake_sim", world="w", wait_s=200))
            except Exception as error:
                answers.append(error)

        thread = threading.Thread(target=call)
        thread.start()
        baked(bakeable, FRAMES)
        kill()
        thread.join(timeout=240)
        assert not thread.is_alive()  # its client is not left waiting
        assert isinstance(answers[0], Exception) or answers[0].is_error
    (job,) = JobStore(bakeable).list("w")
    assert job.state in ("running", "done")
    with agent_of(bakeable) as later:
        joined = later.call("bake_sim", world="w")
        assert joined["job_id"] == job.id
        assert joined["passed"]
        assert not [r for r in later.call("inspect_world", world="w")["open_rows"] if not r.startswith("delivery:")]
    assert _same_bake(bakeable, accepted_folder)


@pytest.mark.parametrize("ahead", ["ledger.sqlite", "world.json"])
def test_a_server_killed_between_ledger_and_world_json_leaves_a_world_that_can_be_restored(accepted: Any, ahead: str) -> None:
    """Two files cannot change at one moment: what a kill between them (or one by an earlier version) leaves is told and mended."""
    folder = accepted.workspace / "w"
    behind = "world.json" if ahead == "ledger.sqlite" else "ledger.sqlite"
    before = {name: (folder / name).read_bytes() for name in (ahead, behind)}
    accepted.edit(("/title", "Later"))
    after = (folder / "world.json").read_bytes() if ahead == "ledger.sqlite" else before["world.json"]
    (folder / behind).write_bytes(before[behind])
    told = accepted.result("inspect_world", world="w").content[0].text
    assert "cut short" in told
    assert "restore" in told
    accepted.call("edit_spec", world="w", on_hand_edit="restore")
    assert (folder / "world.json").read_bytes() == after


def test_a_creation_that_was_cut_short_can_be_finished(accepted: Any) -> None:
    folder = accepted.workspace / "w"
    spec, prompt = (folder / "world.json").read_bytes(), accepted.call("inspect_world", world="w")["prompt"]
    (folder / "world.json").unlink()
    assert "restore" in accepted.result("inspect_world", world="w").content[0].text
    assert "restore" in accepted.refused("edit_spec", world="w", prompt=prompt, spec={})
    assert accepted.call("edit_spec", world="w", on_hand_edit="restore")["restored"]
    assert (folder / "world.json").read_bytes() == spec


@pytest.mark.parametrize(
    ("transport", "era"), [("stdio", "auto"), ("http", "auto"), pytest.param("http", "legacy", marks=pytest.mark.slow)]
)
def test_a_client_that_goes_away_in_mid_call_leaves_the_job_and_the_server_alone(
    transport: str, era: str, bakeable: Path
) -> None:
    def leave(target: Any) -> None:
        """A client process that calls and is killed while it waits."""
        code = (
            "import sys, anyio\n"
            "from mcp import Client\n"
            "from worldagent.tests.stories.servers import stdio\n"
            "from pathlib import Path\n"
            "async def main():\n"
            f"    target = {target!r} or stdio(Path({str(bakeable)!r}))\n"
            f"    async with Client(target, mode={era!r}) as client:\n"
            "        await client.call_tool('bake_sim', {'world': 'w', 'wait_s': 200})\n"
            "anyio.run(main)\n"
        )
        import subprocess
        import sys

        with subprocess.Popen([sys.executable, "-P", "-c", code], stderr=subprocess.DEVNULL) as child:
            baked(bakeable, FRAMES)
            child.kill()

    if transport == "stdio":
        from worldagent.tests.stories.servers import pid_file

        leave(None)
        server = int(pid_file(bakeable).read_text())
        until(
            lambda: not Path(f"/proc/{server}/stat").exists() or " Z " in Path(f"/proc/{server}/stat").read_text(), timeout_s=240
        )
        with Remote(bakeable, stdio(bakeable)) as later:
            _ends_well(later)
    else:
        with http(bakeable) as (url, child):
            leave(url)
            assert child.poll() is None
            with Remote(bakeable, url, era=era) as later:
                begin = time.monotonic()
                later.call("inspect_world", world="w")
                assert time.monotonic() - begin < 100  # no thread of the call that was given up holds it
                _ends_well(later)


def _ends_well(agent: Any) -> None:
    (job,) = agent.call("job", action="list")["jobs"]
    assert job["state"] in ("running", "done")
    if job["state"] == "running":
        assert agent.call("job", action="cancel", job_id=job["job_id"])["state"] == "cancelled"


@pytest.mark.slow
def test_two_servers_on_one_workspace_share_one_bake_and_lose_no_edit(bakeable: Path, accepted_folder: Path) -> None:
    with Remote(bakeable, stdio(bakeable)) as one, http(bakeable) as (url, _), Remote(bakeable, url) as two:
        answers: list[dict[str, Any]] = []
        threads = [threading.Thread(target=lambda a=a: answers.append(a.call("bake_sim", world="w"))) for a in (one, two)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len({a["job_id"] for a in answers}) == 1
        assert all(a["passed"] for a in answers)
        edits: list[Any] = []

        def edit(agent: Any, name: str) -> None:
            change = [{"op": "add", "path": f"/story/requirements/{name}", "value": REQUIREMENT}]
            edits.append(agent.result("edit_spec", world="w", patch=change, expected_revision=1))

        threads = [threading.Thread(target=edit, args=pair) for pair in ((one, "one"), (two, "two"))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert sorted(e.is_error for e in edits) == [False, True]
        assert one.call("inspect_world", world="w")["revision"] == two.call("inspect_world", world="w")["revision"] == 2
    assert _same_bake(bakeable, accepted_folder)


REQUIREMENT = {"text": "t", "predicate": {"kind": "speed", "entity": "ball", "max": 50, "when": "always"}}
