"""Logs of jobs, kept small: what a task prints goes straight to its file, so the file is cut afterwards."""

from __future__ import annotations

import contextlib
from pathlib import Path

__all__ = ["LOG_BYTES_MAX", "trim_log"]

LOG_BYTES_MAX = 4_000_000
"""A log that grows beyond this is cut [bytes]."""
KEPT_HEAD = 500_000
KEPT_TAIL = 1_000_000


def trim_log(path: Path) -> bool:
    """Cut the middle out of a log that has grown too large; True if it was cut.

    Its writers append, so they go on behind the new end. What they write while this runs may be cut as well.
    """
    with contextlib.suppress(FileNotFoundError):
        size = path.stat().st_size
        if size <= LOG_BYTES_MAX:
            return False
        with path.open("r+b") as log:
            log.seek(size - KEPT_TAIL)
            tail = log.read(KEPT_TAIL)
            log.seek(KEPT_HEAD)
            log.truncate()
            cut = size - KEPT_HEAD - KEPT_TAIL
            log.write(f"\n... {cut} bytes cut: a log keeps at most {LOG_BYTES_MAX} bytes ...\n".encode() + tail)
        return True
    return False
