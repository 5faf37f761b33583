"""Claude Code and Codex as they come from npm, without an account: `make clients` installs them and runs this."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import anyio
import pytest
from worldagent.examples.real_clients import ClaudeClient, CodexClient
from worldagent.server.cli import main
from worldagent.tools import TOOLS
from worldagent.worlds.errors import EngineError

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS = ROOT / ".clients" / "node_modules" / ".bin"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not PROGRAMS.is_dir(), reason="`make clients` installs the clients"),
]


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A home folder whose clients were set up by `worldagent setup`."""
    for name in ("XDG_CONFIG_HOME", "CODEX_HOME", "CLAUDE_CONFIG_DIR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("CLAUDE_CODE_DISABLE_NONESSENTIAL_TRAFFIC", "1")
    program = tmp_path / "bin" / "worldagent"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -P -m worldagent.server "$@"\n')
    program.chmod(0o755)
    monkeypatch.setattr(sys, "argv", [str(program)])
    monkeypatch.chdir(tmp_path)
    assert main(["setup", "claude-code", "codex", "--write", "--workspace", str(tmp_path / "worlds")]) == 0
    return tmp_path


def run(*command: str) -> str:
    program = str(PROGRAMS / command[0])
    child = subprocess.run(
        [program, *command[1:]], capture_output=True, text=True, timeout=120, check=False, env=dict(os.environ)
    )
    assert child.returncode == 0, child.stdout + child.stderr
    return child.stdout


def test_claude_code_connects_to_what_setup_wrote(home: Path) -> None:
    assert "Connected" in run("claude", "mcp", "list")


def test_claude_code_accepts_the_plugin(home: Path) -> None:
    assert "worldagent:world-building" in run("claude", "plugin", "validate", "--strict", str(ROOT))


def test_codex_lists_what_setup_wrote(home: Path) -> None:
    assert str(home / "bin" / "worldagent") in run("codex", "mcp", "list")


@pytest.mark.parametrize(("make", "program"), [(CodexClient, "codex"), (ClaudeClient, "claude")])
def test_a_call_a_refusal_and_a_mistake_reach_the_model(make: Any, program: str, home: Path) -> None:
    client = make(str(PROGRAMS / program))
    try:
        assert anyio.run(client.call, "job", {"action": "list"})[0]["jobs"] == []
        with pytest.raises(EngineError, match="there is no world 'nowhere'"):
            anyio.run(client.call, "place_object", {"world": "nowhere"})
        with pytest.raises(EngineError, match="did you mean"):
            anyio.run(client.call, "place_object", {"wold": "nowhere"})
    finally:
        client.close()


def test_codex_sees_every_tool(home: Path) -> None:
    client = CodexClient(str(PROGRAMS / "codex"))
    try:
        (server,) = client._ask("mcpServerStatus/list", {})["data"]
    finally:
        client.close()
    assert set(server["tools"]) == {tool.name for tool in TOOLS}
