"""`worldagent setup`: one server more in a client's list, and nothing else changed."""

from __future__ import annotations

import json
import stat
import sys
import tomllib
from pathlib import Path

import pytest
from worldagent.server.cli import main
from worldagent.server.client_files import read_list, with_entry, write_list
from worldagent.server.clients import CLIENTS
from worldagent.server.setup import entry_program, executable, is_temporary, setup
from worldagent.worlds.errors import InputError

WORKSPACE = Path("/worlds of mine")


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A home folder with nothing in it, and an executable outside it."""
    program = tmp_path / "bin" / "worldagent"
    program.parent.mkdir()
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    folder = tmp_path / "home"
    folder.mkdir()
    monkeypatch.setenv("HOME", str(folder))
    for name in ("XDG_CONFIG_HOME", "CODEX_HOME", "CLAUDE_CONFIG_DIR", "WSL_DISTRO_NAME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "argv", [str(program)])
    return folder


def content(name: str) -> dict[str, object]:
    return read_list(CLIENTS[name].user_file(), CLIENTS[name].format)[1]


@pytest.mark.parametrize("name", CLIENTS)
def test_a_client_without_a_list_gets_one_that_starts_the_installed_executable(name: str, home: Path) -> None:
    said = setup([name], WORKSPACE, write=True)
    file = CLIENTS[name].user_file()
    assert str(file) in said
    assert file.is_relative_to(home)
    entry = content(name)[CLIENTS[name].key]["worldagent"]
    assert entry_program(entry) == str(home.parent / "bin" / "worldagent")
    assert "/worlds of mine" in json.dumps(entry)
    assert stat.S_IMODE(file.stat().st_mode) == 0o600


@pytest.mark.parametrize("name", CLIENTS)
def test_writing_twice_changes_nothing(name: str, home: Path) -> None:
    setup([name], WORKSPACE, write=True)
    file = CLIENTS[name].user_file()
    before = (file.read_bytes(), file.stat().st_mtime_ns)
    assert "already" in setup([name], WORKSPACE, write=True)
    assert (file.read_bytes(), file.stat().st_mtime_ns) == before
    assert [p.name for p in file.parent.iterdir()] == [file.name]


@pytest.mark.parametrize("name", CLIENTS)
@pytest.mark.parametrize("options", [{}, {"dry_run": True}, {"dry_run": True, "write": True}])
def test_nothing_is_written_unasked(name: str, options: dict[str, bool], home: Path) -> None:
    assert "worldagent" in setup([name], WORKSPACE, **options)
    assert list(home.iterdir()) == []


def test_other_settings_their_order_and_the_old_file_are_kept(home: Path) -> None:
    file = CLIENTS["claude-desktop"].user_file()
    file.parent.mkdir(parents=True)
    old = '{\n    "theme": "dark",\n    "mcpServers": {\n        "other": {"command": "x", "env": {"KEY": "secret"}}\n    },\n    "ä": [1.5, null]\n}'
    file.write_text(old, encoding="utf-8")
    file.chmod(0o640)
    setup(["claude-desktop"], WORKSPACE, write=True)
    new = json.loads(file.read_text(encoding="utf-8"))
    assert list(new) == ["theme", "mcpServers", "ä"]
    assert list(new["mcpServers"]) == ["other", "worldagent"]
    del new["mcpServers"]["worldagent"]
    assert new == json.loads(old)
    assert '\n    "theme"' in file.read_text(encoding="utf-8")
    assert stat.S_IMODE(file.stat().st_mode) == 0o640
    (kept,) = [p for p in file.parent.iterdir() if p != file]
    assert kept.read_text(encoding="utf-8") == old


def test_toml_keeps_comments_other_servers_and_what_the_user_added(home: Path) -> None:
    file = CLIENTS["codex"].user_file()
    file.parent.mkdir(parents=True)
    file.write_text(
        'model = "x" # mine\n\n[mcp_servers.worldagent]\ncommand = "/gone/worldagent"\n[mcp_servers.worldagent.env]\nA = "1"\n\n'
        '# the other one\n[mcp_servers.other]\ncommand = "y"\n'
    )
    setup(["codex"], WORKSPACE, write=True)
    text = file.read_text()
    assert 'model = "x" # mine' in text
    assert "# the other one\n[mcp_servers.other]" in text
    servers = tomllib.loads(text)["mcp_servers"]
    assert servers["other"] == {"command": "y"}
    assert servers["worldagent"]["env"] == {"A": "1"}
    assert servers["worldagent"]["command"] == str(home.parent / "bin" / "worldagent")
    assert "already" in setup(["codex"], WORKSPACE, write=True)


@pytest.mark.parametrize(
    "text",
    [
        'mcp_servers.worldagent.command = "x"\n',
        'mcp_servers = { worldagent = { command = "x" } }\n',
        '[mcp_servers]\nworldagent = { command = "x" }\n',
        'note = """\n[mcp_servers.worldagent]\n"""\n',
    ],
)
def test_toml_written_in_another_way_is_left_alone(text: str, home: Path) -> None:
    file = CLIENTS["codex"].user_file()
    file.parent.mkdir(parents=True)
    file.write_text(text)
    with pytest.raises(InputError, match="by hand"):
        setup(["codex"], WORKSPACE, write=True)
    assert file.read_text() == text
    assert [p.name for p in file.parent.iterdir()] == [file.name]


@pytest.mark.parametrize(
    "text", ['{"mcpServers": {} // mine\n}', "[]", '{"mcpServers": []}', "{", '{"a": 1, "a": 2}', "\x00", '{"mcpServers": {}}x']
)
def test_a_file_that_is_not_understood_is_left_alone(text: str, home: Path) -> None:
    file = CLIENTS["cursor"].user_file()
    file.parent.mkdir(parents=True)
    file.write_text(text)
    with pytest.raises(InputError, match="left alone"):
        setup(["cursor"], WORKSPACE, write=True)
    assert file.read_text() == text
    assert [p.name for p in file.parent.iterdir()] == [file.name]


def test_a_file_that_changed_meanwhile_is_not_overwritten(tmp_path: Path) -> None:
    file = tmp_path / "list.json"
    file.write_text('{"a": 1}')
    text, found = read_list(file, "json")
    after = with_entry(file, text, found, "json", "mcpServers", "worldagent", {"command": "x"})
    file.write_text('{"a": 2}')
    with pytest.raises(InputError, match="another program"):
        write_list(file, text, after)
    assert json.loads(file.read_text()) == {"a": 2}


def test_a_link_stays_a_link(home: Path, tmp_path: Path) -> None:
    real = tmp_path / "dotfiles.json"
    real.write_text("{}")
    file = CLIENTS["cursor"].user_file()
    file.parent.mkdir(parents=True)
    file.symlink_to(real)
    setup(["cursor"], WORKSPACE, write=True)
    assert file.is_symlink()
    assert "worldagent" in json.loads(real.read_text())["mcpServers"]


def test_half_a_surrogate_in_a_chat_history_survives(home: Path) -> None:
    file = CLIENTS["claude-code"].user_file()
    file.write_text('{"history": ["\\ud83d"]}')
    setup(["claude-code"], WORKSPACE, write=True)
    assert json.loads(file.read_text())["history"] == ["\ud83d"]


def test_a_list_that_can_not_be_written_is_told(home: Path) -> None:
    (home / ".cursor").write_text("a file where the folder should be")
    with pytest.raises(InputError, match=r"can't be (read|written)"):
        setup(["cursor"], WORKSPACE, write=True)
    assert (home / ".cursor").read_text() == "a file where the folder should be"


def test_a_project_has_a_list_of_its_own_where_the_client_knows_such(home: Path, tmp_path: Path) -> None:
    setup(["claude-code", "cursor", "vscode"], WORKSPACE, write=True, project=tmp_path)
    assert (tmp_path / ".mcp.json").is_file()
    assert (tmp_path / ".cursor" / "mcp.json").is_file()
    assert json.loads((tmp_path / ".vscode" / "mcp.json").read_text())["servers"]["worldagent"]["type"] == "stdio"
    assert list(home.iterdir()) == []
    with pytest.raises(InputError, match="leave out --project"):
        setup(["claude-desktop"], WORKSPACE, project=tmp_path)


def test_an_executable_in_a_cache_is_refused(home: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    program = tmp_path / "uv" / "archive-v0" / "abc" / "bin" / "worldagent"
    program.parent.mkdir(parents=True)
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    monkeypatch.setattr(sys, "argv", [str(program)])
    assert executable() == program
    assert is_temporary(program)
    with pytest.raises(InputError, match="uv tool install"):
        setup(["codex"], WORKSPACE, write=True)


def test_windows_programs_reach_into_wsl_or_a_container(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="inside WSL"):
        setup(["claude-desktop"], WORKSPACE, through="wsl")
    monkeypatch.setenv("WSL_DISTRO_NAME", "Debian")
    said = setup(["claude-desktop"], WORKSPACE, through="wsl")
    entry = json.loads(said[said.index("{") :])["mcpServers"]["worldagent"]
    assert entry["command"] == "wsl.exe"
    assert entry["args"][:3] == ["--distribution", "Debian", "--exec"]
    assert entry["args"][3] == str(home.parent / "bin" / "worldagent")
    said = setup(["claude-desktop"], WORKSPACE, through="docker")
    assert json.loads(said[said.index("{") :])["mcpServers"]["worldagent"]["args"][-2:] == ["worldagent", "serve"]


def test_the_command_lists_the_clients_and_refuses_one_it_does_not_know(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["setup", "codex", "--write"]) == 0
    (home / ".claude.json").write_text('{"mcpServers": null}')
    assert main(["setup"]) == 0
    lines = {line.split()[0]: line for line in capsys.readouterr().out.splitlines() if ".toml" in line or ".json" in line}
    assert "set up" in lines["codex"]
    assert "no file" in lines["cursor"]
    assert "not set up" in lines["claude-code"]
    assert main(["setup", "notepad"]) == 2
    assert "claude-desktop" in capsys.readouterr().err


def test_a_changed_line_is_shown_and_the_secrets_beside_it_are_not(home: Path) -> None:
    file = CLIENTS["cursor"].user_file()
    file.parent.mkdir(parents=True)
    file.write_text('{\n  "mcpServers": {\n    "other": {\n      "env": {\n        "KEY": "secret"\n      }\n    }\n  }\n}\n')
    said = setup(["cursor"], WORKSPACE, dry_run=True)
    assert "+" in said
    assert "/worlds of mine" in said
    assert "secret" not in said
