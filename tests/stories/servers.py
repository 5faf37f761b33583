"""Real server processes over stdio and HTTP, their clients, and what they did to a world."""

from __future__ import annotations

import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any, Self

from anyio.from_thread import start_blocking_portal
from mcp import Client, StdioServerParameters
from worldagent.tests.stories.conftest import Agent

SHIMS = Path(__file__).with_name("shims")
COMMAND = (sys.executable, "-P", "-m", "worldagent.server", "serve")


class Remote(Agent):
    """A client of a server process."""

    def __init__(self, workspace: Path, target: Any, *, era: str = "auto") -> None:
        super().__init__(workspace)
        self._target, self._era = target, era

    def __enter__(self) -> Self:
        portal = self._stack.enter_context(start_blocking_portal("asyncio"))
        made = Client(self._target, mode=self._era)  # type: ignore[arg-type]
        self._client = self._stack.enter_context(portal.wrap_async_context_manager(made))
        self._portal = portal
        return self


def shimmed(**variables: Any) -> dict[str, str]:
    """Environment of a process in which the shims act."""
    paths = [str(SHIMS), *filter(None, [os.environ.get("PYTHONPATH")])]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(paths), **{k: str(v) for k, v in variables.items()}}


def stdio(workspace: Path, *, env: dict[str, str] | None = None, command: Sequence[str] = COMMAND) -> StdioServerParameters:
    """A stdio server that writes its process id to `server.pid` beside the workspace before it starts."""
    words = " ".join(f"'{word}'" for word in (*command, "--workspace", str(workspace)))
    script = f"echo $$ > '{pid_file(workspace)}'; exec {words}"
    return StdioServerParameters(command="/bin/sh", args=["-c", script], env=env or dict(os.environ))


def pid_file(workspace: Path) -> Path:
    """Where `stdio` leaves the process id."""
    return workspace.with_name(f"{workspace.name}.pid")


@contextmanager
def http(workspace: Path, *, env: dict[str, str] | None = None) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """URL and process of an HTTP server on a free port."""
    command = [*COMMAND, "--workspace", str(workspace), "--transport", "http", "--port", "0"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=env) as child:
        try:
            assert child.stderr is not None
            line = child.stderr.readline()
            assert "http://" in line, line + child.stderr.read()
            yield line[line.index("http://") :].strip(), child
        finally:
            child.kill()


@contextmanager
def served(
    transport: str, workspace: Path, *, env: dict[str, str] | None = None, era: str = "auto"
) -> Iterator[tuple[Remote, Any]]:
    """A client of a server process, and a function that kills that process with SIGKILL."""
    with ExitStack() as stack:
        if transport == "http":
            url, child = stack.enter_context(http(workspace, env=env))
            target: Any = url
            pid: Callable[[], int] = lambda: child.pid  # noqa: E731
        else:
            target = stdio(workspace, env=env)
            pid = lambda: int(pid_file(workspace).read_text())  # noqa: E731
        client = Remote(workspace, target, era=era)
        # A client whose server was killed may end with an error of its own.
        stack.callback(_closed, client)
        client.__enter__()
        yield client, lambda: os.kill(pid(), signal.SIGKILL)


def _closed(client: Remote) -> None:
    with suppress(Exception):
        client.__exit__(None, None, None)


def content(folder: Path) -> dict[str, bytes]:
    """Every file below a folder."""
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def bake_folder(workspace: Path) -> Path:
    """Caches of the bake of world `w`."""
    (candidate,) = (workspace / "w" / "candidates").glob("*")
    return candidate / "bake"


def without_bake(accepted: Path, workspace: Path) -> Path:
    """A workspace with the accepted world as it stood before its bake."""
    shutil.copytree(accepted, workspace / "w")
    shutil.rmtree(bake_folder(workspace))
    with sqlite3.connect(workspace / "w" / "ledger.sqlite") as db:
        db.execute("DELETE FROM bakes")
        db.execute("DELETE FROM acceptances")
    db.close()
    return workspace


def until(condition: Callable[[], Any], *, timeout_s: float = 60.0) -> Any:
    """First value of `condition` that is true, asked for every 5 ms."""
    deadline = time.monotonic() + timeout_s
    while not (value := condition()):
        assert time.monotonic() < deadline, "the condition never came true"
        time.sleep(0.005)
    return value


def baked(workspace: Path, frames: int) -> None:
    """Wait until a bake of world `w` has written some frames."""
    until(lambda: len(list(workspace.glob("w/candidates/*/bake/rigid/frame_*.npz"))) >= frames)
