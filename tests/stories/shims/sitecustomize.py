"""Faults of a machine for processes that have this folder on PYTHONPATH: a full disk, a clock that jumps.

WORLDAGENT_TEST_FULL names a file: while it exists, nothing can be written below its folder.
WORLDAGENT_TEST_CLOCK names a file that holds seconds: the wall clock is off by so many.
"""

import errno
import io
import os
import sqlite3
import time
from pathlib import Path

FULL = os.environ.get("WORLDAGENT_TEST_FULL")
CLOCK = os.environ.get("WORLDAGENT_TEST_CLOCK")


def _is_full(path):
    return Path(FULL).exists() and str(path).startswith(str(Path(FULL).parent)) and Path(FULL) != Path(path)


class _FullFile(io.FileIO):
    def write(self, data):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), self.name)


def _fill_the_disk():
    true_open, true_connect = io.open, sqlite3.connect

    def opened(file, mode="r", *args, **kwargs):
        found = true_open(file, mode, *args, **kwargs)
        if isinstance(file, str | Path) and set(mode) & set("wax+") and _is_full(file):
            found.close()
            raw = _FullFile(str(file), mode.replace("b", "").replace("t", ""))
            # Unbuffered, so that the fault comes with the write.
            return raw if "b" in mode else io.TextIOWrapper(io.BufferedWriter(raw), write_through=True)
        return found

    def connected(database, *args, **kwargs):
        connection = true_connect(database, *args, **kwargs)
        if Path(FULL).exists():
            connection.execute("PRAGMA max_page_count = 1")  # clamped to the present size: no page more
        return connection

    import builtins

    io.open = builtins.open = opened
    sqlite3.connect = connected


def _shift_the_clock():
    true_time = time.time

    def shifted():
        try:
            return true_time() + float(Path(CLOCK).read_text())
        except (OSError, ValueError):
            return true_time()

    time.time = shifted


if FULL:
    _fill_the_disk()
if CLOCK:
    _shift_the_clock()
