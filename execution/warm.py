"""Asking the nursery of a workspace for a warm worker, and starting a nursery. See `nursery.py`.

Nothing here is needed for a job to run: whoever gets no answer starts a cold worker.
"""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .fingerprint import surroundings
from .schema import FOLDER

__all__ = ["ENV_WARM", "LOCK", "LOG", "SOCKET", "ask", "is_on", "is_there", "keep", "listening_socket", "send", "start_nursery"]

ENV_WARM = "WORLDAGENT_WARM"
"""`0` switches warm workers off."""
SOCKET, LOCK, LOG = "warm.sock", "warm.lock", "warm.log"
"""Files of the nursery in `.worldagent/`."""
ANSWER_S = 3.0
"""Longest wait for a nursery's answer [s]; it takes some milliseconds to fork."""


def is_on() -> bool:
    """True if this system and user want warm workers. Linux: elsewhere libraries do not promise to survive a fork."""
    return sys.platform == "linux" and os.environ.get(ENV_WARM, "1") != "0"


@contextlib.contextmanager
def _short_path(workspace: Path) -> Iterator[str]:
    """Path of the socket in few letters: a socket's path may have 107 at most."""
    folder = os.open(workspace / FOLDER, os.O_RDONLY | os.O_DIRECTORY)
    try:
        yield f"/proc/self/fd/{folder}/{SOCKET}"
    finally:
        os.close(folder)


def listening_socket(workspace: Path) -> socket.socket:
    """The nursery's end; open to the user of this process only."""
    listening = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    with _short_path(workspace) as path:
        Path(path).unlink(missing_ok=True)
        listening.bind(path)
        Path(path).chmod(0o600)
    listening.listen(16)
    return listening


def send(workspace: Path, request: dict[str, Any]) -> dict[str, Any] | None:
    """Answer of the nursery, or None if none answers."""
    with contextlib.suppress(OSError, ValueError), socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as line:
        line.settimeout(ANSWER_S)
        with _short_path(workspace) as path:
            line.connect(path)
        line.sendall(json.dumps(request).encode() + b"\n")
        line.shutdown(socket.SHUT_WR)
        data = b""
        while part := line.recv(1 << 16):
            data += part
        answer: dict[str, Any] = json.loads(data)
        return answer
    return None


def ask(workspace: Path, module: str, job_id: str, slots: int) -> bool:
    """Have the nursery fork a worker for a job; False if there is none that is as good as a new process."""
    request = {"do": "start", "module": module, "job": job_id, "slots": slots, "environment": dict(os.environ)}
    answer = send(workspace, {**request, "surroundings": surroundings()})
    return answer is not None and answer["served"] is True


def keep(workspace: Path, module: str) -> None:
    """Tell the nursery that jobs may follow: its idle time starts anew."""
    send(workspace, {"do": "keep", "module": module, "surroundings": surroundings()})


def is_there(workspace: Path) -> bool:
    """True if a nursery of the workspace waits or loads."""
    with contextlib.suppress(FileNotFoundError), (workspace / FOLDER / LOCK).open("rb") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False


def start_nursery(workspace: Path, module: str) -> subprocess.Popen[bytes]:
    """Start one; the process that forks it and ends at once. Of several that start only one stays."""
    command = [sys.executable, "-P", "-m", f"{__package__}.nursery", str(workspace), module, str(os.getpid())]
    with (workspace / FOLDER / LOG).open("ab") as log:
        return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, cwd=workspace, start_new_session=True)
