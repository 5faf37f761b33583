"""The `worldagent` command: exit codes and what it prints."""

from __future__ import annotations

import importlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from worldagent.bench.machine import run_benchmark
from worldagent.server import doctor
from worldagent.server.bench_commands import BENCHMARKS
from worldagent.server.check import Check
from worldagent.server.cli import main
from worldagent.server.default_workspace import default_workspace
from worldagent.server.health import PROOFS
from worldagent.worlds.errors import RefusedError


def test_help_and_version_load_nothing_heavy() -> None:
    code = (
        "import sys\nfrom worldagent.server.cli import main\n"
        "try: main(['--version'])\nexcept SystemExit: pass\nprint(sorted(sys.modules))"
    )
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=30, check=True)
    assert child.stdout.startswith("worldagent 0.")
    for name in ("'mcp'", "'pydantic'", "'numpy'"):
        assert name not in child.stdout


def test_the_module_is_the_command() -> None:
    child = subprocess.run(
        [sys.executable, "-m", "worldagent.server", "bench", "list"], capture_output=True, text=True, timeout=30, check=True
    )
    assert child.stdout.split() == list(BENCHMARKS)


def test_the_workspace_comes_from_the_environment_or_the_home_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("WORLDAGENT_WORKSPACE", str(tmp_path))
    assert default_workspace() == tmp_path
    monkeypatch.delenv("WORLDAGENT_WORKSPACE")
    assert default_workspace() == Path.home() / "worldagent"


@pytest.mark.parametrize(("verdict", "code"), [("accepted", 0), ("incomplete", 1)])
@pytest.mark.parametrize("command", [["verify"], ["verify", "--replay"], ["recompute"]])
def test_only_an_accepted_folder_exits_with_zero(
    command: list[str],
    verdict: str,
    code: int,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
) -> None:
    asked: list[Any] = []

    def judge(folder: Path, **options: Any) -> dict[str, Any]:
        asked.append((folder, options))
        return {"verdict": verdict, "rows": {"pass": 3}, "failing": []}

    monkeypatch.setattr("worldagent.workflow.verify_folder.verify_folder", judge)
    monkeypatch.setattr("worldagent.workflow.verify_folder.recompute_folder", judge)
    assert main([*command, str(tmp_path)]) == code
    assert json.loads(capsys.readouterr().out)["verdict"] == verdict
    options = {"replay": "--replay" in command, "seed": None, "intervals": None, "report": None}
    assert asked == [(tmp_path, options if command[0] == "verify" else {})]


@pytest.mark.parametrize(("verdict", "code"), [("accepted", 0), ("incomplete", 1)])
def test_a_report_exits_by_its_verdict(
    verdict: str, code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr(
        "worldagent.workflow.matrix_report.report_world", lambda root, out: {"verdict": verdict, "report": str(out)}
    )
    assert main(["report", str(tmp_path), "--out", str(tmp_path / "a.html")]) == code
    assert json.loads(capsys.readouterr().out)["report"] == str(tmp_path / "a.html")


def test_a_world_without_ledger_has_no_bundle_and_no_report(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "world.json").write_text("{}")
    assert main(["bundle", str(tmp_path)]) == 2
    assert "no ledger.sqlite" in capsys.readouterr().err
    assert main(["report", str(tmp_path), "--out", str(tmp_path / "a.html")]) == 2
    assert "verify FOLDER --report" in capsys.readouterr().err
    assert [p.name for p in tmp_path.iterdir()] == ["world.json"]


def test_an_error_of_the_package_is_told_without_a_trace(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    def refuse(folder: Path, **options: Any) -> dict[str, Any]:
        raise RefusedError("no complete bake")

    monkeypatch.setattr("worldagent.workflow.verify_folder.verify_folder", refuse)
    assert main(["verify", str(tmp_path)]) == 2
    assert capsys.readouterr().err == "worldagent: no complete bake\n"


@pytest.mark.parametrize(
    "arguments",
    [
        ["bench", "nothing"],
        ["serve", "--port", "70000"],
        ["serve", "--transport", "smoke"],
        ["verify", ".", "--intervals", "0"],
        ["verify"],
        [],
    ],
)
def test_misuse_exits_with_two(arguments: list[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2


WINDOWS = """
import sys
for name in ("fcntl", "resource", "pwd", "grp", "termios"):
    sys.modules[name] = None
from worldagent.server.cli import main
sys.platform = "win32"
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize("command", [["serve"], ["demo"], ["recompute", "w"], ["doctor"], ["warm"], ["verify", "w"]])
def test_windows_is_told_where_the_server_runs_instead(command: list[str]) -> None:
    child = subprocess.run([sys.executable, "-c", WINDOWS, *command], capture_output=True, text=True, timeout=30, check=False)
    assert child.returncode == 2
    assert "WSL2" in child.stderr
    assert "--through docker" in child.stderr
    assert "Traceback" not in child.stderr


def test_windows_gets_the_entries_for_its_clients(tmp_path: Path) -> None:
    command = [sys.executable, "-c", WINDOWS, "setup", "claude-desktop", "--through", "docker", "--write"]
    environment = {**os.environ, "APPDATA": str(tmp_path)}
    subprocess.run(command, env=environment, timeout=30, check=True)
    written = json.loads((tmp_path / "Claude" / "claude_desktop_config.json").read_text())
    assert "exec" in written["mcpServers"]["worldagent"]["args"]


def test_a_workspace_that_is_a_file_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("")
    assert main(["serve", "--workspace", str(tmp_path / "file")]) == 2
    assert "is a file" in capsys.readouterr().err


def _proof(name: str) -> Check:
    return Check(f"{name} works", name != "libllvm", "shown", name not in doctor.OPTIONAL, "speed", "install it")


def test_doctor_passes_without_what_is_optional(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(doctor, "_proof", _proof)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(doctor, "CLIENT_CHECKS", ())
    workspace = tmp_path / "absent"
    assert main(["doctor", "--json", "--workspace", str(workspace)]) == 0
    report = json.loads(capsys.readouterr().out)
    checks = {check["name"]: check for check in report["checks"]}
    assert "3.11" in checks["python"]["detail"]
    assert checks["mujoco"]["detail"] == "4.0.0, Apache-2.0"
    assert not checks["libllvm works"]["ok"]
    assert not checks["libllvm works"]["required"]
    assert not workspace.exists()


def test_doctor_fails_when_something_required_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(doctor, "_proof", _proof)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(doctor, "CLIENT_CHECKS", ())
    (tmp_path / "file").write_text("")
    assert main(["doctor", "--workspace", str(tmp_path / "file")]) == 1
    assert re.search(r"^FAIL +workspace ", capsys.readouterr().out, re.MULTILINE)


def test_a_proof_that_ends_its_process_fails_and_nothing_else(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", "/bin/false")
    (found,) = doctor._prove(["mujoco"])
    assert not found.ok
    assert "ended with code 1" in found.detail


def test_doctor_runs_every_proof_and_one_of_them_for_real() -> None:
    assert tuple(PROOFS) == doctor._PROOF_NAMES
    (found,) = doctor._prove(["python-fcl"])
    assert found.ok
    assert found.detail == "distance 2.0000 m"


def test_a_benchmark_is_joined_with_what_it_was_measured_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("worldagent.bench.startup.run", lambda: {"tools_list_s": 0.6, "versions": {"peer": "1"}})
    found = run_benchmark("startup", BENCHMARKS["startup"])
    assert found["name"] == "startup"
    assert found["tools_list_s"] == 0.6
    assert found["versions"]["mcp"]
    assert found["versions"]["peer"] == "1"
    assert found["machine"]["cores"] >= 1
    assert {"commit", "date", "wall_s"} <= set(found)


@pytest.mark.parametrize("name", BENCHMARKS)
def test_every_listed_benchmark_exists(name: str) -> None:
    module, function = BENCHMARKS[name].split(":")
    assert callable(getattr(importlib.import_module(module), function))
