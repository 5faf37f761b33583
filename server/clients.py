"""The clients that `worldagent setup` knows: where each keeps its list of servers, and how an entry looks there.

Paths and keys are those of the clients' own documentation of November 2026; `docs/clients/` tells which were tried.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from ..worlds.errors import InputError

__all__ = ["CLIENTS", "SERVER_NAME", "Client", "Command", "client"]

SERVER_NAME = "worldagent"
"""The server's name in every list."""
START_SECONDS = 30
"""Time that a client should grant the server to start [s]; it needs 1-2 s."""
CALL_SECONDS = 300
"""Time that a client should grant a call [s]; tools answer within `wait_s` (30 s) with a result or a job."""

Format = Literal["json", "toml"]


@dataclass(frozen=True)
class Command:
    """Command that a client starts."""

    program: str
    """An executable: absolute, so that it does not hang on a PATH that programs with a window do not see."""
    arguments: tuple[str, ...]


@dataclass(frozen=True)
class Client:
    """A program that starts MCP servers from a list in a file."""

    name: str
    title: str
    key: str
    """Member of the file that holds the servers by name."""
    user_file: Callable[[], Path]
    """The list of this user, on this system."""
    project_file: str | None
    """The list of one project, relative to its folder; None where the client has none."""
    entry: Callable[[Command], dict[str, Any]]
    """The server as this client writes it down."""
    after: str
    """Action of the user after which the client sees a changed list."""
    format: Format = "json"

    def file(self, project: Path | None) -> Path:
        """The list to change.

        Raises:
            InputError: A project was named and the client has no lists of projects.
        """
        if project is None:
            return self.user_file()
        if self.project_file is None:
            raise InputError(f"{self.title} has one list of servers per user and none per project; leave out --project")
        return project / self.project_file


def _settings_folder() -> Path:
    """Where programs with a window keep their settings."""
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support"
    if sys.platform == "win32":
        return Path(os.environ.get("APPDATA") or Path.home() / "AppData" / "Roaming")
    return Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config")


def _home(*parts: str, variable: str | None = None) -> Callable[[], Path]:
    """A file below the home folder, or below the folder that an environment variable names instead of the first part."""

    def find() -> Path:
        named = os.environ.get(variable) if variable else None
        if named:
            return Path(named).joinpath(*parts[1:])
        return Path.home().joinpath(*parts)

    return find


def _claude_code_file() -> Path:
    """`.claude.json` lies beside the folder `.claude`, or in the folder that `$CLAUDE_CONFIG_DIR` names."""
    return Path(os.environ.get("CLAUDE_CONFIG_DIR") or Path.home()) / ".claude.json"


def _opencode_file() -> Path:
    folder = Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config") / "opencode"
    return next(
        (folder / name for name in ("opencode.jsonc", "config.json") if (folder / name).is_file()), folder / "opencode.json"
    )


def _plain(command: Command) -> dict[str, Any]:
    return {"command": command.program, "args": list(command.arguments)}


def _typed(command: Command) -> dict[str, Any]:
    return {"type": "stdio", **_plain(command)}


def _codex(command: Command) -> dict[str, Any]:
    return {**_plain(command), "startup_timeout_sec": START_SECONDS, "tool_timeout_sec": CALL_SECONDS}


def _gemini(command: Command) -> dict[str, Any]:
    return {**_plain(command), "timeout": CALL_SECONDS * 1000}


def _opencode(command: Command) -> dict[str, Any]:
    return {
        "type": "local",
        "command": [command.program, *command.arguments],
        "enabled": True,
        "timeout": CALL_SECONDS * 1000,
    }


_REOPEN = "quit {0} fully and open it again"
_ALL: Sequence[Client] = (
    Client("claude-desktop", "Claude Desktop", "mcpServers", lambda: _settings_folder() / "Claude" / "claude_desktop_config.json", None,
           _plain, _REOPEN.format("Claude Desktop")),
    Client("claude-code", "Claude Code", "mcpServers", _claude_code_file, ".mcp.json",
           _typed, "start a new session of claude; `claude mcp list` shows the server"),
    Client("codex", "Codex", "mcp_servers", _home(".codex", "config.toml", variable="CODEX_HOME"), ".codex/config.toml",
           _codex, "start a new session of codex; `codex mcp list` shows the server", "toml"),
    Client("cursor", "Cursor", "mcpServers", _home(".cursor", "mcp.json"), ".cursor/mcp.json",
           _plain, "switch the server on in Cursor's settings under MCP"),
    Client("vscode", "VS Code", "servers", lambda: _settings_folder() / "Code" / "User" / "mcp.json", ".vscode/mcp.json",
           _typed, "run 'MCP: List Servers' in VS Code and start the server"),
    Client("windsurf", "Windsurf", "mcpServers", _home(".codeium", "windsurf", "mcp_config.json"), None,
           _plain, "refresh the list of MCP servers in Windsurf's settings"),
    Client("gemini", "Gemini CLI", "mcpServers", _home(".gemini", "settings.json"), ".gemini/settings.json",
           _gemini, "start a new session of gemini; `gemini mcp list` shows the server"),
    Client("opencode", "opencode", "mcp", _opencode_file, "opencode.json",
           _opencode, "start a new session of opencode; `opencode mcp list` shows the server"),
)  # fmt: skip
CLIENTS: dict[str, Client] = {entry.name: entry for entry in _ALL}
"""Clients by the name that the command line takes."""


def client(name: str) -> Client:
    """The client of that name.

    Raises:
        InputError: It is not known here.
    """
    if name not in CLIENTS:
        raise InputError(f"client {name!r} is none of {', '.join(CLIENTS)}")
    return CLIENTS[name]
