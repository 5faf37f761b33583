"""Checks that clients can start this server: the executable, the time it takes, and what stands in the clients' lists."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from ..worlds.errors import InputError
from .check import Check, reinstall
from .client_files import read_list, with_entry, write_list
from .clients import CLIENTS, SERVER_NAME, Client, Command
from .handshake import seconds_to_tools
from .setup import entry_program, executable, is_temporary

__all__ = ["CLIENT_CHECKS", "client_lists", "installed_executable", "start"]

LONGEST_START_S = 10.0
"""The shortest limit of a client's documentation [s]; others wait 30 s."""
BARE_PATH = "/usr/bin:/bin:/usr/sbin:/sbin"
"""The PATH of programs that are not started from a shell."""
_LAUNCHERS = ("uvx", "uv", "pipx", "npx")


def installed_executable() -> list[Check]:
    """The file that clients are pointed at."""
    try:
        path = executable()
    except InputError as error:
        return [Check("executable", False, str(error), required=False, cost="clients have nothing to start", remedy=reinstall())]
    if is_temporary(path):
        return [
            Check(
                "executable",
                False,
                f"{path} lies in a cache that is emptied sooner or later",
                required=False,
                cost="a client that starts it may have to wait for a download, longer than it is willing to",
                remedy="uv tool install worldagent",
            )
        ]
    seen = shutil.which("worldagent", path=BARE_PATH) is not None
    return [
        Check(
            "executable",
            True,
            f"{path}{'' if seen else '; give clients this full path, as `worldagent setup` does'}",
            required=False,
        )
    ]


def start() -> list[Check]:
    """The server, started as a program with a window would start it."""
    if sys.platform == "win32":
        return []
    try:
        program = [str(executable())]
    except InputError:
        program = [sys.executable, "-P", "-m", "worldagent.server"]
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON") or k == "PYTHONPATH"} | {"PATH": BARE_PATH}
    try:
        with tempfile.TemporaryDirectory() as folder:
            command = [*program, "serve", "--workspace", f"{folder}/worlds"]
            seconds, count = seconds_to_tools(command, environment=environment)
    except (OSError, RuntimeError) as error:
        return [Check("server starts", False, str(error), cost="clients show the server as failed", remedy=reinstall())]
    return [
        Check(
            "server starts",
            seconds <= LONGEST_START_S,
            f"{count} tools after {seconds:.1f} s ({LONGEST_START_S:.0f} s or less)",
            required=False,
            cost="clients that wait no longer show the server as failed",
            remedy="start it a second time (the first fills the file cache); keep it on a fast disk",
        )
    ]


def client_lists() -> list[Check]:
    """Entries of this server in the lists of clients that are on this machine."""
    found = []
    for known in CLIENTS.values():
        path = known.user_file()
        if not path.is_file():
            continue
        try:
            text, content = read_list(path, known.format)
        except InputError as error:
            found.append(
                Check(
                    f"{known.title} list", False, str(error), required=False,
                    cost=f"{known.title} itself may not read it; worldagent setup can't write there",
                    remedy=f"mend {path}, then worldagent setup {known.name} --write",
                )
            )  # fmt: skip
            continue
        servers = content.get(known.key)
        for name, entry in servers.items() if isinstance(servers, dict) else ():
            if _is_ours(name, entry):
                found.append(_judged(known, path, text, content, name, entry))
    return found


def _is_ours(name: str, entry: Any) -> bool:
    program = entry_program(entry)
    return program is not None and (name == SERVER_NAME or Path(program).name in ("worldagent", "worldagent.exe"))


def _judged(known: Client, path: Path, text: str, content: dict[str, Any], name: str, entry: dict[str, Any]) -> Check:
    program = entry_program(entry)
    assert program is not None
    problem, cost = _problem(program)

    def mend() -> str:
        kept = write_list(path, text, with_entry(path, text, content, known.format, known.key, name, _mended(known, entry)))
        return f"{known.title} now starts {executable()}; the old list is {kept}"

    return Check(
        f"{known.title} list",
        not problem,
        problem or f"starts {program}",
        required=False,
        cost=cost,
        remedy=f"worldagent setup {known.name} --write",
        mend=mend if problem and _can_mend() else None,
    )


def _problem(program: str) -> tuple[str, str]:
    """Fault of the program that an entry starts, and its consequence; empty where there is none."""
    path = Path(program)
    if path.name in _LAUNCHERS:
        return f"starts {program}, which may download first", "a cold start may take longer than the client waits"
    if program.endswith(("wsl.exe", "docker", "docker.exe")):
        return "", ""
    if not path.is_absolute():
        return f"starts {program!r} by its bare name", "programs with a window do not see the shell's PATH: spawn ENOENT"
    if not path.is_file():
        return f"starts {program}, which is not there", "the client can't start the server"
    if not os.access(path, os.X_OK):
        return f"starts {program}, which may not be executed", "the client can't start the server"
    if is_temporary(path):
        return f"starts {program} in a cache that is emptied sooner or later", "one day the client can't start the server"
    return "", ""


def _can_mend() -> bool:
    try:
        return not is_temporary(executable())
    except InputError:
        return False


def _mended(known: Client, entry: dict[str, Any]) -> dict[str, Any]:
    """The entry with this executable; its arguments from `serve` on stay, and so does what the user added."""
    listed = entry.get("command")
    words = [str(w) for w in (listed[1:] if isinstance(listed, list) else entry.get("args") or [])]
    kept = tuple(words[words.index("serve") :]) if "serve" in words else ("serve",)
    return {**entry, **known.entry(Command(str(executable()), kept))}


CLIENT_CHECKS = (installed_executable, start, client_lists)
"""In the order of the report."""
