"""The nursery: a process of a workspace that has loaded the engines and forks warm workers on request.

    python -P -m worldagent.execution.nursery WORKSPACE MODULE [PROCESS]

It imports MODULE and the modules that MODULE names in its tuple `WARM`, and nothing else: no engine is initialised,
there is no thread, no GPU context, no compiler. It makes sure of that before it serves, and ends where it is not so.
Requests come over a Unix socket from processes of the same user. It serves only processes with surroundings like its
own (`fingerprint.py`), ends when source changed, when nobody asked for IDLE_S, when the workspace is gone, or when the last
of those who asked has ended, killed or not: PROCESS, which started it, and whoever sent a request. One per workspace, by a
lock. Workers that it forked go on: a job outlives its server. A job needs no nursery: whoever gets no answer starts a cold worker.
"""

from __future__ import annotations

import contextlib
import fcntl
import gc
import importlib
import json
import os
import select
import signal
import socket
import struct
import sys
import time
import traceback
from pathlib import Path
from typing import IO, Any, NoReturn

from .entries import check_module
from .fingerprint import source_stamp, surroundings
from .processes import OWN_NAMES, call_myself
from .schema import FOLDER
from .warm import LOCK, LOG, SOCKET, listening_socket
from .worker import serve

__all__ = ["main"]

IDLE_S = 300.0
"""It ends when nobody asked for so long [s]: it holds some 250 MB."""
LOOK_S = 10.0
"""Time between two looks whether it should end [s]."""
READ_S = 1.0
LOCK_TRIES = 5
REQUEST_BYTES_MAX = 1 << 20


class Unfit(Exception):  # noqa: N818 - told in the log, no error of a caller
    """This process may not fork workers."""


def _say(text: str) -> None:
    sys.stderr.write(f"{time.strftime('%Y-%m-%d %H:%M:%S')} nursery {os.getpid()}: {text}\n")
    sys.stderr.flush()


def load(module: str) -> list[str]:
    """Import a module and what its `WARM` names; the names that are not installed here.

    Raises:
        Unfit: The module declares no `WARM`.
    """
    check_module(module)
    wanted = getattr(importlib.import_module(module), "WARM", None)
    if not isinstance(wanted, tuple):
        raise Unfit(f"{module} names no modules in WARM")
    missing = []
    for name in wanted:
        try:
            importlib.import_module(name)
        except ImportError as error:
            missing.append(f"{name} ({error})")
    return missing


def make_sure() -> None:
    """Check that forks of this process are whole.

    OpenBLAS starts threads while it loads and ends them in every fork, of the parent too; nothing else may have any.

    Raises:
        Unfit: A thread other than this one is left, or a GPU is in use.
    """
    gc.collect()
    gc.freeze()  # so that a collection in a child does not copy every page
    if (child := os.fork()) == 0:
        os._exit(0)
    os.waitpid(child, 0)
    threads = len(list(Path("/proc/self/task").iterdir()))
    if threads != 1:
        raise Unfit(f"{threads - 1} threads are left after loading")
    for entry in Path("/proc/self/fd").iterdir():
        with contextlib.suppress(OSError):
            if str(entry.readlink()).startswith(("/dev/nvidia", "/dev/dri", "/dev/kfd")):
                raise Unfit(f"a GPU is in use: {entry.readlink()}")


class Nursery:
    """Serves requests one after another until it should end."""

    def __init__(self, workspace: Path, module: str, lock: IO[bytes], owner: int = 0) -> None:
        self._workspace, self._module, self._lock = workspace, module, lock
        self._stamp = source_stamp()
        self._surroundings = surroundings()
        self._owners: dict[int, int] = {}
        """By process that asked: a descriptor that is readable once it has ended."""
        self._owned = self._own(owner)
        missing = load(module)
        make_sure()
        self._listening = listening_socket(workspace)
        self._idle_since = time.monotonic()
        _say(f"loaded {module}" + (f", without {', '.join(missing)}" if missing else ""))

    def run(self) -> str:
        """Serve; why it ended."""
        while True:
            watched: list[Any] = [self._listening, *self._owners.values()]
            ready = select.select(watched, [], [], LOOK_S)[0]
            if not self._owner_lives():
                return "all who asked have ended"
            if self._listening in ready:
                line, _ = self._listening.accept()
                with line:
                    self._answer(line)
            if source_stamp() != self._stamp:
                return "source changed"
            if not self._is_in_place():
                return "the workspace is gone"
            if time.monotonic() - self._idle_since > IDLE_S:
                return f"idle for {IDLE_S:.0f} s"

    def _own(self, process: int) -> bool:
        """Count a process among those that asked, until it ends; False where it cannot be watched."""
        if process <= 0 or process == os.getpid() or process in self._owners:
            return process in self._owners
        try:
            self._owners[process] = os.pidfd_open(process)
        except ProcessLookupError:  # it has ended already
            return True
        except OSError:
            return False
        return True

    def _owner_lives(self) -> bool:
        """False once there were processes that asked, and all have ended."""
        for process, descriptor in list(self._owners.items()):
            if select.select([descriptor], [], [], 0.0)[0]:
                os.close(self._owners.pop(process))
        return bool(self._owners) or not self._owned

    def close(self) -> None:
        """Take the socket away."""
        self._listening.close()
        if self._is_in_place():
            (self._workspace / FOLDER / SOCKET).unlink(missing_ok=True)

    def _is_in_place(self) -> bool:
        try:
            return os.path.samestat((self._workspace / FOLDER / LOCK).stat(), os.fstat(self._lock.fileno()))
        except OSError:
            return False

    def _answer(self, line: socket.socket) -> None:
        with contextlib.suppress(OSError, ValueError, KeyError, TypeError):  # whoever asks badly gets no answer, and starts cold
            line.settimeout(READ_S)
            process, user, _ = struct.unpack("3i", line.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, struct.calcsize("3i")))
            if user != os.getuid():
                return
            request = json.loads(_read(line))
            reason = self._objection(request)
            if reason is None and request["do"] == "start":
                self._fork(request, line)
            self._idle_since = time.monotonic()
            self._owned |= reason is None and self._own(process)
            line.sendall(json.dumps({"served": reason is None, "reason": reason}).encode())

    def _objection(self, request: dict[str, Any]) -> str | None:
        if request["module"] != self._module:
            return f"{self._module} is loaded, not {request['module']}"
        if request["surroundings"] != self._surroundings:
            return "environment, limits or interpreter differ from those that the engines were loaded with"
        if source_stamp() != self._stamp:
            return "source changed"
        return None

    def _fork(self, request: dict[str, Any], line: socket.socket) -> None:
        child = os.fork()
        if child == 0:
            line.close()
            self._become_worker(request)
        os.waitpid(child, 0)  # it forks the worker and ends

    def _become_worker(self, request: dict[str, Any]) -> NoReturn:
        try:
            self._listening.close()
            self._lock.close()  # a worker must not hold the lock of a nursery that ended
            for descriptor in self._owners.values():
                os.close(descriptor)
            os.environ.clear()
            os.environ.update(request["environment"])
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                signal.signal(number, signal.SIG_DFL)
            os.chdir(self._workspace)
            log = os.open(self._workspace / FOLDER / "logs" / f"{request['job']}.log", os.O_WRONLY | os.O_CREAT | os.O_APPEND)
            for descriptor in (1, 2):
                os.dup2(log, descriptor)
            os.close(log)
            serve(self._workspace, request["job"], request["slots"])
        except BaseException:
            traceback.print_exc()
            sys.stderr.flush()
            os._exit(1)
        os._exit(0)


def _read(line: socket.socket) -> bytes:
    data = b""
    while part := line.recv(1 << 16):
        data += part
        if len(data) > REQUEST_BYTES_MAX:
            raise ValueError("the request is too long")
    return data


def _is_first(lock: IO[bytes]) -> bool:
    """Take the lock, unless another nursery has it. Whoever looks whether there is one holds it for a moment, too."""
    for _ in range(LOCK_TRIES):
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            time.sleep(0.02)
        else:
            return True
    return False


def main(arguments: list[str]) -> None:
    """Detach, take the lock, load, serve."""
    workspace, module, owner = Path(arguments[0]), arguments[1], int(arguments[2]) if len(arguments) > 2 else 0
    if os.fork() != 0:
        os._exit(0)
    os.setsid()
    call_myself(OWN_NAMES[1])
    lock = (workspace / FOLDER / LOCK).open("ab")
    if not _is_first(lock):
        return
    (workspace / FOLDER / LOG).open("w").close()
    try:
        nursery = Nursery(workspace, module, lock, owner)
    except Unfit as reason:
        _say(f"jobs start cold: {reason}")
        return
    try:
        _say(f"ends: {nursery.run()}")
    finally:
        nursery.close()


if __name__ == "__main__":
    main(sys.argv[1:])
