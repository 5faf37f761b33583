"""Processes of this machine: who lives, since when, and how to end them. POSIX; exact on Linux."""

from __future__ import annotations

import contextlib
import os
import platform
import signal
import subprocess
import sys
import time
from functools import lru_cache
from pathlib import Path

__all__ = [
    "TAG",
    "adopt_orphans",
    "call_myself",
    "core_count",
    "descendants",
    "die_with_parent",
    "end_group",
    "end_stragglers",
    "host_id",
    "in_task",
    "is_alive",
    "signal_group",
    "start_time",
]

TAG = "WORLDAGENT_JOB"
"""Environment variable that names the job in its task and in whatever the task starts."""
OWN_NAMES = ("worldagent-jobs", "worldagent-warm")
"""Names of workers and nurseries; they belong to no task even where one started them."""


def core_count() -> int:
    """Cores this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@lru_cache(maxsize=1)
def host_id() -> str:
    """Where process ids have a meaning: this boot of this machine and this pid namespace."""
    try:
        boot = Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
        return f"{boot}/{Path('/proc/self/ns/pid').readlink()}"
    except OSError:
        return platform.node()


def start_time(pid: int) -> str | None:
    """When the process started, in the kernel's own words; None if it is gone or only a zombie is left."""
    if sys.platform == "linux":
        try:
            stat = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace")
        except (FileNotFoundError, ProcessLookupError):
            return None
        # Field 2, the name, may hold blanks and brackets; state is field 3, the start time in clock ticks field 22.
        fields = stat.rpartition(")")[2].split()
        return None if fields[0] in "ZX" else fields[19]
    ps = ["/bin/ps", "-o", "stat=,lstart=", "-p", str(pid)]
    state, _, started = subprocess.run(ps, capture_output=True, text=True, check=False).stdout.strip().partition(" ")
    return None if not state or state.startswith("Z") else started.strip()


def is_alive(pid: int, started: str | None) -> bool:
    """True if the very process that had this pid and start time still runs."""
    now = start_time(pid)
    return now is not None and now == started


def signal_group(group: int, number: int) -> None:
    """Send a signal to every process of a group; a group that is gone is no error."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(group, number)


def end_group(leader: int, started: str | None, *, patience_s: float = 1.0) -> None:
    """Kill the group of a leader that still lives, and wait until the leader is gone [s]."""
    deadline = time.monotonic() + patience_s
    if is_alive(leader, started):
        signal_group(leader, signal.SIGKILL)
    while is_alive(leader, started) and time.monotonic() < deadline:
        time.sleep(0.005)


def _prctl(option: int, argument: int | bytes) -> None:
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None, use_errno=True).prctl(option, argument)


def in_task() -> bool:
    """True in the process of a job and in those below it."""
    return TAG in os.environ


def die_with_parent(parent: int) -> None:
    """Have the kernel kill this process when its parent dies. Linux only; elsewhere it lives on."""
    pr_set_pdeathsig = 1  # <linux/prctl.h>
    _prctl(pr_set_pdeathsig, signal.SIGKILL)
    if sys.platform == "linux" and os.getppid() != parent:  # it died before the call
        os._exit(1)


def adopt_orphans() -> None:
    """Become the parent of descendants whose parents die, so that none gets out of sight. Linux only."""
    pr_set_child_subreaper = 36
    _prctl(pr_set_child_subreaper, 1)


def call_myself(name: str) -> None:
    """Name of this process in `ps` and `top`, at most 15 characters; forks inherit it. Linux only."""
    pr_set_name = 15
    _prctl(pr_set_name, name.encode())


def _children(pid: int) -> list[int]:
    found: list[int] = []
    with contextlib.suppress(OSError):  # it may end at any moment
        for thread in Path(f"/proc/{pid}/task").iterdir():
            with contextlib.suppress(OSError):
                found += map(int, (thread / "children").read_text(encoding="ascii").split())
    return found


def _is_our_own(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/comm").read_text(encoding="utf-8", errors="replace").strip() in OWN_NAMES
    except OSError:
        return False


def descendants(pid: int) -> list[int]:
    """Children of a process and their children, whatever group or session they made; without workers of other jobs.

    Linux; elsewhere an empty list.
    """
    found: list[int] = []
    waiting = _children(pid)
    while waiting:
        child = waiting.pop()
        if not _is_our_own(child):
            found.append(child)
            waiting += _children(child)
    return found


def end_stragglers(job_id: str, *, session: int | None, group: int | None) -> None:
    """Kill what a task left behind whose worker is gone: its process group, and what it started with the job's tag.

    The numbers of session and group stay taken while one of their processes lives, so that the two together cannot
    mean anybody else's. Linux; elsewhere nothing happens.
    """
    if sys.platform != "linux":
        return
    tag = f"{TAG}={job_id}".encode()
    for folder in Path("/proc").iterdir():
        if not folder.name.isdigit() or int(folder.name) == os.getpid():
            continue
        pid = int(folder.name)
        with contextlib.suppress(OSError, IndexError, ValueError):  # not ours to read, or gone
            fields = (folder / "stat").read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
            same = session is not None and group is not None and (int(fields[2]), int(fields[3])) == (group, session)
            if same or (tag in (folder / "environ").read_bytes().split(b"\0") and not _is_our_own(pid)):
                os.kill(pid, signal.SIGKILL)
