"""`worldagent doctor` in broken surroundings: what is wrong, what it costs, what mends it, and `--repair`."""

from __future__ import annotations

import contextlib
import json
import os
import resource
import shutil
import sqlite3
import stat
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import pytest
from worldagent.execution import JobStore
from worldagent.server import client_checks, doctor, machine_checks, workspace_checks
from worldagent.server.capabilities import package_version
from worldagent.server.check import Check
from worldagent.server.cli import main
from worldagent.server.clients import CLIENTS
from worldagent.server.handshake import seconds_to_tools

LONG_AGO = time.time() - 7 * 86_400


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A home folder with nothing in it, an executable outside it, and engines that are taken on trust."""
    program = tmp_path / "bin" / "worldagent"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -P -m worldagent.server "$@"\n')
    program.chmod(0o755)
    folder = tmp_path / "home"
    folder.mkdir()
    for name in ("XDG_CONFIG_HOME", "XDG_CACHE_HOME", "CODEX_HOME", "CLAUDE_CONFIG_DIR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(folder))
    monkeypatch.setattr(sys, "argv", [str(program)])
    monkeypatch.setattr(doctor, "_proof", lambda name: Check(f"{name} works", True, "shown"))
    return folder


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    folder = tmp_path / "worlds"
    folder.mkdir()
    return folder


def only(checks: list[Check]) -> Check:
    (check,) = checks
    return check


def failing(check: Check) -> Check:
    """A failure that tells what it costs and what to do."""
    assert not check.ok
    assert check.cost
    assert check.remedy
    return check


def make_jobs(workspace: Path) -> Path:
    """A list with one job that has ended, and no process that looks at it."""
    JobStore(workspace).list()
    path = workspace / ".worldagent" / "jobs.db"
    with contextlib.closing(sqlite3.connect(path)) as connection, connection:
        connection.execute(
            "INSERT INTO jobs (id, kind, entry, payload, state, exclusive, priority, created, log)"
            " VALUES ('job_0123456789ab', 'work', 'worldagent.nothing:run', '{}', 'done', 0, 0, ?, 'x')",
            (LONG_AGO,),
        )
    return path


# Lists of clients


def write_list(name: str, entry: dict[str, Any]) -> Path:
    file = CLIENTS[name].user_file()
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps({CLIENTS[name].key: {"worldagent": entry, "other": {"command": "/bin/true"}}}))
    return file


@pytest.mark.parametrize(
    ("command", "word"),
    [
        ("/nowhere/worldagent", "not there"),
        ("worldagent", "bare name"),
        ("uvx", "download"),
        (__file__, "may not be executed"),
    ],
)
def test_an_entry_that_can_not_start_the_server_is_told_and_mended(command: str, word: str, home: Path, workspace: Path) -> None:
    file = write_list("cursor", {"command": command, "args": ["worldagent", "serve", "--workspace", "/w"], "env": {"A": "1"}})
    check = failing(only(client_checks.client_lists()))
    assert word in check.detail
    assert check.mend is not None
    assert str(home.parent / "bin" / "worldagent") in check.mend()
    servers = json.loads(file.read_text())["mcpServers"]
    assert servers["worldagent"] == {
        "command": str(home.parent / "bin" / "worldagent"),
        "args": ["serve", "--workspace", "/w"],
        "env": {"A": "1"},
    }
    assert servers["other"] == {"command": "/bin/true"}
    assert only(client_checks.client_lists()).ok


def test_servers_of_others_and_servers_behind_a_url_are_none_of_its_business(home: Path) -> None:
    file = CLIENTS["cursor"].user_file()
    file.parent.mkdir()
    file.write_text(
        '{"mcpServers": {"other": {"command": "/nowhere/other"}, "worldagent": {"url": "http://127.0.0.1:8931/mcp"}}}'
    )
    assert client_checks.client_lists() == []


def test_a_list_that_is_no_json_is_told_and_left_alone(home: Path) -> None:
    file = CLIENTS["claude-desktop"].user_file()
    file.parent.mkdir(parents=True)
    file.write_text('{"mcpServers": {,}}')
    check = failing(only(client_checks.client_lists()))
    assert str(file) in check.detail
    assert check.mend is None


def test_an_executable_in_the_cache_of_uvx_is_told(home: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    program = tmp_path / "archive-v0" / "x" / "worldagent"
    program.parent.mkdir(parents=True)
    shutil.copy(home.parent / "bin" / "worldagent", program)
    monkeypatch.setattr(sys, "argv", [str(program)])
    assert "uv tool install" in failing(only(client_checks.installed_executable())).remedy
    write_list("cursor", {"command": "/nowhere/worldagent"})
    assert failing(only(client_checks.client_lists())).mend is None


def test_the_server_is_really_started(home: Path) -> None:
    check = only(client_checks.start())
    assert check.ok
    assert check.detail.split()[1] == "tools"


def test_a_server_that_does_not_start_is_told_with_its_last_words(home: Path) -> None:
    (home.parent / "bin" / "worldagent").write_text("#!/bin/sh\necho 'no such library' >&2\nexit 3\n")
    check = failing(only(client_checks.start()))
    assert check.required
    assert "no such library" in check.detail


def test_a_server_that_says_nothing_is_ended(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match=r"no answer to tools/list within 0\.5 s"):
        seconds_to_tools([sys.executable, "-c", "import time; time.sleep(60)"], patience_s=0.5)


# Workspace


def test_a_running_job_without_worker_is_told_and_mended(workspace: Path) -> None:
    path = make_jobs(workspace)
    gone = subprocess.run([sys.executable, "-c", "import os; print(os.getpid())"], capture_output=True, text=True, check=True)
    with sqlite3.connect(path) as connection:
        connection.execute(
            "UPDATE jobs SET state = 'running', pid = ?, pid_started = '1', heartbeat = ?, started = ?, heartbeat_clock = 0, host = 'elsewhere'",
            (int(gone.stdout), LONG_AGO, LONG_AGO),
        )
    connection.close()
    check = failing(only(workspace_checks.jobs(workspace)))
    assert "no sign of life" in check.detail
    assert check.mend is not None
    assert "lost" in check.mend()
    assert only(workspace_checks.jobs(workspace)).ok


@pytest.mark.parametrize("damage", ["garbage", "truncated", "flipped"])
def test_a_damaged_list_of_jobs_is_set_aside_and_work_goes_on(damage: str, workspace: Path) -> None:
    path = make_jobs(workspace)
    data = path.read_bytes()
    flipped = bytearray(data)
    flipped[100:400] = bytes(300)
    path.write_bytes({"garbage": b"no database " * 500, "truncated": data[: len(data) // 2], "flipped": bytes(flipped)}[damage])
    check = failing(only(workspace_checks.jobs(workspace)))
    assert check.required
    assert check.mend is not None
    check.mend()
    assert workspace_checks.jobs(workspace) == []
    assert JobStore(workspace).list() == ()
    assert [p for p in path.parent.iterdir() if "damaged" in p.name]


def test_a_job_from_the_future_tells_of_the_clock(workspace: Path) -> None:
    path = make_jobs(workspace)
    with sqlite3.connect(path) as connection:
        connection.execute("UPDATE jobs SET created = ?, state = 'done'", (time.time() + 7200,))
    connection.close()
    assert "future" in failing(workspace_checks.jobs(workspace)[1]).detail


def test_remains_of_dead_processes_are_removed_and_nothing_else(workspace: Path) -> None:
    world = workspace / "w"
    world.mkdir()
    names = {
        ".world.json.999999999.1.tmp": LONG_AGO,
        f".world.json.{os.getpid()}.1.tmp": LONG_AGO,
        ".fresh.999999999.1.tmp": time.time(),
        ".kept": LONG_AGO,
        "world.json": LONG_AGO,
    }
    for name, age in names.items():
        (world / name).write_text("x")
        os.utime(world / name, (age, age))
    check = failing(only(workspace_checks.leftovers(workspace)))
    assert check.mend is not None
    assert "1 temporary file" in check.mend()
    assert {p.name for p in world.iterdir()} == set(names) - {".world.json.999999999.1.tmp"}


def test_files_of_tokens_that_others_can_read_are_closed(workspace: Path) -> None:
    assert workspace_checks.private_files(workspace) == []
    assert main(["token", "add", "laptop", "--scope", "read", "--workspace", str(workspace)]) == 0
    file = workspace / ".worldagent" / "tokens.json"
    assert only(workspace_checks.private_files(workspace)).ok
    file.chmod(0o644)
    check = failing(only(workspace_checks.private_files(workspace)))
    assert check.mend is not None
    check.mend()
    assert stat.S_IMODE(file.stat().st_mode) == 0o600


def test_a_full_disk_and_a_share_are_told(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    usage = shutil.disk_usage(workspace)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: usage._replace(free=10**6))
    assert "stop in the middle" in failing(only(workspace_checks.disk(workspace))).cost
    monkeypatch.setattr(workspace_checks, "_kind_of_mount", lambda path: "nfs4")
    assert "locks" in failing(only(workspace_checks.file_system(workspace))).cost


def test_a_workspace_that_is_a_file_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    check = failing(only(workspace_checks.writable(tmp_path / "file" / "below")))
    assert "is a file" in check.detail
    assert check.mend is None


# Machine


def test_low_limits_of_a_process_are_told_with_the_command_that_raises_them() -> None:
    code = "from worldagent.server.machine_checks import limits; (c,) = limits(); print(c.ok, c.detail, c.remedy)"
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    child = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (64, hard)),
    )
    assert child.stdout.split()[0] == "False"
    assert "ulimit -n is 64" in child.stdout
    assert "ulimit -n 1024" in child.stdout


def test_a_library_that_small_images_leave_out_is_told_with_its_package(monkeypatch: pytest.MonkeyPatch) -> None:
    assert only(machine_checks.libraries()).ok
    monkeypatch.setattr(machine_checks, "SYSTEM_LIBRARIES", {"libnowhere.so.1": "libnowhere1"})
    assert "apt-get install libnowhere1" in failing(only(machine_checks.libraries())).remedy


def test_a_small_container_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "memory.max"
    file.write_text("1000000000\n")
    monkeypatch.setattr(machine_checks, "_CGROUP_LIMITS", (str(file),))
    assert "this container may use 1.0 GB" in failing(only(machine_checks.memory())).detail
    file.write_text("max\n")
    assert only(machine_checks.memory()).ok == (machine_checks._physical_bytes() >= machine_checks.LEAST_MEMORY_BYTES)


def test_a_clock_before_the_installation_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    assert only(machine_checks.clock()).ok
    monkeypatch.setattr(time, "time", lambda: 1_500_000_000.0)
    assert "2017" in failing(only(machine_checks.clock())).detail


def test_a_cache_folder_that_can_not_be_written_is_told(home: Path) -> None:
    (home / ".cache").write_text("a file")
    assert "XDG_CACHE_HOME" in failing(only(machine_checks.caches())).remedy


def test_temporary_files_without_a_folder_are_told(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(home / "nowhere"))
    assert failing(only(machine_checks.temporary_files())).required


def test_a_missing_package_and_one_of_another_version_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    true = package_version
    wrong = {"mujoco": "3.9.0", "trimesh": None}
    monkeypatch.setattr(machine_checks, "package_version", lambda name: wrong.get(name, true(name)))
    monkeypatch.setattr(machine_checks, "requires", lambda name: ["mujoco==4.0.0", "numpy<3,>=2.0"])
    found = {c.name: c for c in machine_checks.packages()}
    assert "needs 4.0.0" in failing(found["mujoco"]).detail
    assert "not installed" in failing(found["trimesh"]).detail
    assert found["numpy"].ok


# All together


def test_repair_mends_all_it_can_and_reports_the_rest(
    home: Path, workspace: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor, "CLIENT_CHECKS", (client_checks.installed_executable, client_checks.client_lists))
    make_jobs(workspace).write_bytes(b"no database " * 500)
    write_list("cursor", {"command": "/nowhere/worldagent", "args": ["serve"]})
    assert main(["doctor", "--json", "--workspace", str(workspace)]) == 1
    before = {c["name"]: c for c in json.loads(capsys.readouterr().out)["checks"]}
    assert before["jobs"]["repairable"]
    assert main(["doctor", "--json", "--repair", "--workspace", str(workspace)]) == 0
    printed = capsys.readouterr()
    report = json.loads(printed.out)
    assert {r["name"] for r in report["repaired"] if r["ok"]} == {"jobs", "Cursor list"}
    assert "mended: jobs" in printed.err
    assert all(c["ok"] for c in report["checks"] if c["name"] == "Cursor list")
    assert main(["doctor", "--repair", "--workspace", str(workspace)]) == 0
    assert "everything required works" in capsys.readouterr().out


def test_every_failure_in_the_table_says_what_it_costs_and_what_mends_it() -> None:
    checks = [Check("a", False, "broken", cost="much", remedy="do this", mend=lambda: "done"), Check("b", True, "fine")]
    text = doctor.table(doctor._report(Path("/w"), checks))
    assert "FAIL  a  broken" in text
    assert "costs: much" in text
    assert "mend:  do this" in text
    assert "--repair" in text
    assert "something required does not work" in text
