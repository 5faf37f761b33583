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

__all__ = ["core_count", "die_with_parent", "end_group", "host_id", "is_alive", "signal_group", "start_time"]


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
    """Whether the very process that had this pid and start time still runs."""
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


def die_with_parent(parent: int) -> None:
    """Have the kernel kill this process when its parent dies. Linux only; elsewhere it lives on."""
    if sys.platform == "linux":
        import ctypes

        pr_set_pdeathsig = 1  # <linux/prctl.h>
        ctypes.CDLL(None, use_errno=True).prctl(pr_set_pdeathsig, signal.SIGKILL)
        if os.getppid() != parent:  # it died before the call
            os._exit(1)
