"""No network, no code of the client, no telemetry: watched by an audit hook in every Python process of a run.

The hook sees what Python does (PEP 578), not what native libraries do by themselves.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import sysconfig
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import pytest
import worldagent
from worldagent.server.cli import main
from worldagent.server.handshake import seconds_to_tools
from worldagent.server.quiet import silence_telemetry

HERE = Path(__file__).parent
MARKER = "zq7marker"
NETWORK = (
    "socket.sendto", "socket.sendmsg", "socket.getaddrinfo", "socket.gethostbyname", "ftplib.connect", "http.client.connect",
    "urllib.Request", "smtplib.connect", "webbrowser.open",
)  # fmt: skip
OWN = (
    "worldagent.execution.worker",
    "worldagent.execution.nursery",
    "worldagent.verifiers.acceptance",
    "worldagent.construction.file_worker",
)
"""Modules that the package starts as processes."""


@dataclass
class Watched:
    """Actions of all processes of a run."""

    processes: int = 0
    seen: list[tuple[str, list[str]]] = field(default_factory=list)

    def of(self, *events: str) -> list[list[str]]:
        return [arguments for event, arguments in self.seen if event in events]


def watch(script: list[str], tmp_path: Path, *, timeout_s: float) -> Watched:
    log = tmp_path / "watched.log"
    paths = [str(HERE / "watch_site"), str(Path(worldagent.__file__).parents[1])]
    environment = {
        **os.environ, "PYTHONPATH": os.pathsep.join(paths), "WATCH_LOG": str(log), "WATCH_MARKER": MARKER, "PYTHONSAFEPATH": "1",
        "WORLDAGENT_TOKEN": f"{MARKER}-token-of-the-server", "OTEL_EXPORTER_OTLP_ENDPOINT": "http://127.0.0.1:9",
    }  # fmt: skip
    done = subprocess.run(
        [sys.executable, *script], env=environment, capture_output=True, text=True, timeout=timeout_s, check=False, cwd=tmp_path
    )
    assert done.returncode == 0, done.stdout + done.stderr
    found = Watched()
    for line in log.read_text().splitlines():
        _, event, arguments = json.loads(line)
        found.processes += event == "process"
        found.seen.append((event, arguments))
    return found


def check_run(found: Watched, workspace: Path) -> None:
    assert found.processes >= 2, "worker processes are watched too"
    assert found.of(*NETWORK) == []
    local = [arguments for arguments in found.of("socket.connect", "socket.bind") if "'" not in arguments[1][:2]]
    assert local == [], "only sockets of the workspace, by path"
    assert found.of("os.system", "os.exec", "os.posix_spawn", "os.spawn", "os.startfile", "pty.spawn") == []
    for program, arguments, *_ in found.of("subprocess.Popen"):
        own = any(f"'-P', '-m', '{module}'" in arguments for module in OWN)
        # The package glfw, which mujoco imports, asks libraries for their version in a process of its own.
        version_probe = "glfwGetVersion" in arguments
        assert Path(program.strip("'")).name.startswith("python"), program
        assert own or version_probe, arguments
        assert MARKER not in arguments, "nothing that the client wrote, and no token, is an argument of a process"
    assert found.of("compile") == [], "no text of the client is compiled"
    allowed = (str(workspace.resolve()), "/dev/", os.path.realpath(tempfile.gettempdir()), str(Path.home() / ".cache"))
    for (path,) in found.of("write"):
        assert path.strip("'").startswith(allowed), path
    library = [sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")]
    known = tuple(os.path.realpath(p) for p in (*library, str(Path(worldagent.__file__).parent)))
    for name, path in found.of("import"):
        assert os.path.realpath(path.strip("'")).startswith(known), f"{name} from {path}"
    assert not list(Path(tempfile.gettempdir()).glob(f"{MARKER}*"))


def test_a_probe_uses_no_network_and_runs_nothing_that_the_client_wrote(tmp_path: Path) -> None:
    check_run(watch([str(HERE / "watched_run.py"), str(tmp_path / "ws"), "part"], tmp_path, timeout_s=280), tmp_path / "ws")


@pytest.mark.slow
def test_a_whole_loop_uses_no_network_and_runs_nothing_that_the_client_wrote(tmp_path: Path) -> None:
    check_run(watch([str(HERE / "watched_run.py"), str(tmp_path / "ws"), "whole"], tmp_path, timeout_s=1200), tmp_path / "ws")


def test_the_watch_sees_what_it_shall(tmp_path: Path) -> None:
    """The control: each thing that must not happen is noticed where it does."""
    script = tmp_path / "bad.py"
    script.write_text(
        "import os, socket, subprocess, sys\n"
        f"compile('x = 1 # {MARKER}', 'there', 'exec')\n"
        "s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); s.sendto(b'x', ('127.0.0.1', 9))\n"
        "subprocess.run(['true'])\nos.system('true')\nopen(os.path.expanduser('~/../x'), 'a') if False else None\n"
        "subprocess.run([sys.executable, '-c', 'import socket; socket.getaddrinfo(\"127.0.0.1\", 9)'])\n"
    )
    found = watch([str(script)], tmp_path, timeout_s=60)
    assert found.processes == 2
    for event in ("compile", "socket.sendto", "subprocess.Popen", "os.system", "socket.getaddrinfo"):
        assert found.of(event), event
    with pytest.raises(AssertionError):
        check_run(found, tmp_path)


_SPY = """
import pathlib
pathlib.Path({target!r}).write_text("loaded")
class Spy:
    def get_tracer(self, *args, **kwargs):
        raise RuntimeError("a tracer was asked for")
"""


@pytest.fixture
def spy(tmp_path: Path) -> tuple[dict[str, str], Path]:
    """Environment that names a plugin of OpenTelemetry, and the file that it writes when it is loaded."""
    site, target = tmp_path / "site", tmp_path / "spied"
    (site / "spy-1.dist-info").mkdir(parents=True)
    (site / "spy-1.dist-info" / "METADATA").write_text("Metadata-Version: 2.1\nName: spy\nVersion: 1\n")
    (site / "spy-1.dist-info" / "entry_points.txt").write_text("[opentelemetry_tracer_provider]\nspy = spy_provider:Spy\n")
    (site / "spy_provider.py").write_text(_SPY.format(target=str(target)))
    paths = os.pathsep.join([str(site), str(Path(worldagent.__file__).parents[1])])
    return {**os.environ, "PYTHONPATH": paths, "OTEL_PYTHON_TRACER_PROVIDER": "spy"}, target


def test_the_server_loads_no_telemetry_that_the_environment_asks_for(tmp_path: Path, spy: tuple[dict[str, str], Path]) -> None:
    environment, target = spy
    control = subprocess.run(
        [sys.executable, "-c", "from opentelemetry.trace import get_tracer_provider as g; g()"], env=environment, check=False
    )
    assert control.returncode == 0
    assert target.exists(), "the API alone would load it"
    target.unlink()
    command = [sys.executable, "-m", "worldagent.server", "serve", "--workspace", str(tmp_path / "ws")]
    _, tools = seconds_to_tools(command, environment=environment)
    assert tools > 5
    assert not target.exists()


def test_every_variable_of_telemetry_is_dropped_and_others_stay() -> None:
    variables = {"OTEL_EXPORTER_OTLP_ENDPOINT": "x", "OTEL_SDK_DISABLED": "false", "PATH": "p", "HOTEL_": "h"}
    assert silence_telemetry(variables) == ["OTEL_EXPORTER_OTLP_ENDPOINT", "OTEL_SDK_DISABLED"]
    assert variables == {"OTEL_SDK_DISABLED": "true", "PATH": "p", "HOTEL_": "h"}


def test_the_token_of_the_environment_is_gone_before_any_worker_starts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[object] = []

    def serve(*args: object, token: str, **kwargs: object) -> None:
        seen.extend([token, os.environ.get("WORLDAGENT_TOKEN")])

    monkeypatch.setenv("WORLDAGENT_TOKEN", "a-token-of-32-characters-or-more")
    monkeypatch.setenv("OTEL_SDK_DISABLED", "true")  # restored afterwards
    monkeypatch.setattr("worldagent.server.http.serve_http", serve)
    monkeypatch.setattr("worldagent.server.cli.leave", lambda: None)
    assert main(["serve", "--transport", "http", "--workspace", str(tmp_path)]) == 0
    assert seen == ["a-token-of-32-characters-or-more", None]
