"""Use by the processes of a job: resident memory now and at most, and CPU time. Exact on Linux."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import time
from pathlib import Path

from .processes import descendants

__all__ = ["Meter", "machine_memory", "resident_bytes"]

_PAGE = os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else 4096


def machine_memory() -> int:
    """Memory that this machine, or the container that holds this process, has [bytes]."""
    total = _PAGE * os.sysconf("SC_PHYS_PAGES")
    for path in ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"):
        with contextlib.suppress(OSError, ValueError):
            total = min(total, int(Path(path).read_text(encoding="ascii")))
    return total


def resident_bytes(pid: int) -> int:
    """Resident memory of a process; a page that n processes share counts 1/n, as for forks of a warm process."""
    with contextlib.suppress(OSError, ValueError):
        for line in Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="ascii", errors="replace").splitlines():
            if line.startswith("Pss:"):
                return int(line.split()[1]) * 1024
    with contextlib.suppress(OSError, ValueError, IndexError):
        return int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1]) * _PAGE
    return 0


def _group_bytes(group: int) -> int:
    """Resident memory of a process group, by `ps`: for systems without /proc."""
    listed = subprocess.run(["/bin/ps", "-A", "-o", "pgid=,rss="], capture_output=True, text=True, check=False).stdout
    rows = (line.split() for line in listed.splitlines())
    return sum(int(row[1]) * 1024 for row in rows if len(row) == 2 and row[0] == str(group))


class Meter:
    """Resident memory of everything below a worker, measured as often as is cheap."""

    INTERVAL_S = 0.25
    SHARE = 0.02
    """Largest part of the time that measuring may take: reading the account of 10 GB takes some 30 ms."""

    def __init__(self, worker: int, task: int) -> None:
        self._worker, self._task = worker, task
        self._next = 0.0
        self.peak = 0
        """Largest sum so far [bytes]."""

    def look(self) -> int | None:
        """The sum now [bytes], or None if it is not time yet."""
        began = time.monotonic()
        if began < self._next:
            return None
        if sys.platform == "linux":
            now = sum(resident_bytes(pid) for pid in descendants(self._worker))
        else:
            now = _group_bytes(self._task)
        self.peak = max(self.peak, now)
        ended = time.monotonic()
        self._next = ended + max(self.INTERVAL_S, (ended - began) / self.SHARE)
        return now
