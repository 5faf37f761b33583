"""`worldagent setup`: write this server into a client's list, started by an installed executable.

A client gives a server some seconds to start. An executable that is installed answers in 1-2 s; a launcher that
downloads first may take minutes, and a bare name is not found by programs that do not see the shell's PATH.
"""

from __future__ import annotations

import difflib
import os
import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from ..worlds.errors import InputError
from .client_files import read_list, render, with_entry, write_list
from .clients import CLIENTS, SERVER_NAME, Client, Command, client

__all__ = [
    "Plan",
    "Through",
    "container_command",
    "entry_program",
    "executable",
    "is_temporary",
    "plan",
    "serve_command",
    "setup",
    "wsl_command",
]

Through = Literal["wsl", "docker"]
CONTAINER = "worldagent"
"""Name of the container that `docs/install.md` starts."""
_CACHES = ("archive-v", "environments-v", "builds-v")
"""Folders in uv's cache that `uvx` runs from; what lies there is deleted sooner or later."""


@dataclass(frozen=True)
class Plan:
    """One change of one client's list."""

    client: Client
    file: Path
    before: str
    after: str
    entry: dict[str, Any]

    @property
    def changed(self) -> bool:
        """True if the list does not say this already."""
        return self.before != self.after

    def difference(self) -> str:
        """Changed lines only: what else the file holds may be secret."""
        pair = (self.before.splitlines(), self.after.splitlines())
        lines = list(difflib.unified_diff(*pair, lineterm="", n=0))[2:]
        return "\n".join(line for line in lines if not line.startswith("@@"))


def executable() -> Path:
    """The installed `worldagent` that is running now, as an absolute path.

    A link to it (as `uv tool` and `pipx` make) is kept: it stays where it is when the tool is upgraded.

    Raises:
        InputError: There is none.
    """
    suffix = ".exe" if sys.platform == "win32" else ""
    begun = Path(sys.argv[0])
    found = [begun] if begun.name in (f"worldagent{suffix}", "worldagent") else []
    found.append(Path(sys.executable).with_name(f"worldagent{suffix}"))
    known = shutil.which("worldagent")
    found.extend([Path(known)] if known else [])
    for path in found:
        if path.is_file() and os.access(path, os.X_OK):
            return path.absolute()
    raise InputError("no executable worldagent beside this Python; install the package: uv tool install worldagent")


def is_temporary(path: Path) -> bool:
    """True if an executable lies in the cache of `uvx` or `pipx run`."""
    parts = path.resolve().parts
    return any(part.startswith(_CACHES) for part in parts) or ("pipx" in parts and ".cache" in parts)


def serve_command(workspace: Path, program: Path | None = None) -> Command:
    """Command with which a client starts this installation.

    Raises:
        InputError: It runs from a cache, so that its path will not last.
    """
    found = program or executable()
    if is_temporary(found):
        raise InputError(
            f"{found} lies in a cache and will not last: run `uv tool install worldagent`, then `worldagent setup` again"
        )
    return Command(str(found), ("serve", "--workspace", str(workspace)))


def wsl_command(workspace: Path) -> Command:
    """Command with which a client on Windows starts this installation inside WSL.

    Raises:
        InputError: This is no WSL.
    """
    distribution = os.environ.get("WSL_DISTRO_NAME")
    if not distribution:
        raise InputError("--through wsl is for a shell inside WSL ($WSL_DISTRO_NAME is not set here)")
    inner = serve_command(workspace)
    return Command("wsl.exe", ("--distribution", distribution, "--exec", inner.program, *inner.arguments))


def container_command() -> Command:
    """Command with which a client starts a server inside the running container; bakes outlive the client there."""
    program = shutil.which("docker") or "docker"
    return Command(program, ("exec", "--interactive", CONTAINER, "worldagent", "serve"))


def plan(name: str, command: Command, *, project: Path | None = None, file: Path | None = None) -> Plan:
    """Planned change of the list of the client `name`.

    Raises:
        InputError: The client is unknown, or its file is not understood.
    """
    found = client(name)
    path = file or found.file(project)
    before, content = read_list(path, found.format)
    servers = content.get(found.key)
    present = servers.get(SERVER_NAME) if isinstance(servers, dict) else None
    # What the user added to the entry (environment, permissions) stays; an entry that names a URL is another kind.
    added = present if isinstance(present, dict) and "command" in present else {}
    entry = {**added, **found.entry(command)}
    said = present == entry
    after = before if said else with_entry(path, before, content, found.format, found.key, SERVER_NAME, entry)
    return Plan(found, path, before, after, entry)


def setup(
    names: Sequence[str],
    workspace: Path,
    *,
    write: bool = False,
    dry_run: bool = False,
    project: Path | None = None,
    file: Path | None = None,
    through: Through | None = None,
) -> str:
    """Show or make the change for each client; what to print.

    Raises:
        InputError: A client is unknown, a file is not understood or can't be written; changes made before stand.
    """
    if not names:
        return known_clients()
    if file is not None and len(names) > 1:
        raise InputError("--file belongs to one client; name one")
    command = {None: lambda: serve_command(workspace), "wsl": lambda: wsl_command(workspace), "docker": container_command}[
        through
    ]()
    plans = [plan(name, command, project=project, file=file) for name in names]
    return "\n\n".join(_written(p) if write and not dry_run else _shown(p, difference=dry_run) for p in plans)


def known_clients() -> str:
    """One line for each client: its name, its file and whether this server is in it."""
    lines = [f"{'client':<16}{'state':<14}file"]
    for found in CLIENTS.values():
        path = found.user_file()
        try:
            servers = read_list(path, found.format)[1].get(found.key, {})
            there = isinstance(servers, dict) and SERVER_NAME in servers
            state = "set up" if there else "not set up" if path.exists() else "no file"
        except InputError:
            state = "unreadable"
        lines.append(f"{found.name:<16}{state:<14}{path}")
    return "\n".join([*lines, "", "worldagent setup CLIENT shows the entry, --write puts it in."])


def _written(made: Plan) -> str:
    if not made.changed:
        return f"{made.client.title}: {made.file} says this already; nothing was written."
    kept = write_list(made.file, made.before, made.after)
    copy = f" The old file is {kept}." if kept is not None else ""
    return f"{made.client.title}: wrote {made.file}.{copy}\nNow {made.client.after}."


def _shown(made: Plan, *, difference: bool) -> str:
    if not made.changed:
        return f"{made.client.title}: {made.file} says this already."
    if difference:
        return f"{made.client.title}: {made.file} would change (lines - before, + after):\n{made.difference()}"
    entry = render(made.client.format, made.client.key, SERVER_NAME, made.entry).rstrip()
    return f"{made.client.title}: put this into {made.file}, or run again with --write:\n\n{entry}"


def entry_program(entry: Any) -> str | None:
    """The program that an entry of any client starts; None where it is reached by a URL or not understood."""
    if not isinstance(entry, dict):
        return None
    command = entry.get("command")
    if isinstance(command, list):
        command = command[0] if command else None
    return command if isinstance(command, str) and command else None
