"""Line from an entry to its caller: it reports progress and learns that it should stop."""

from __future__ import annotations

import math
import mmap
import struct
from collections.abc import Callable

from .job import Cancelled, Progress

__all__ = ["Board", "JobContext"]


class JobContext:
    """The line from an entry to whoever waits for it. Calls cost microseconds and never block."""

    def __init__(
        self, *, job_id: str, report: Callable[[Progress], None], cancel_asked: Callable[[], bool], workspace: str | None = None
    ) -> None:
        self.job_id = job_id
        self.workspace = workspace
        """Absolute path of the workspace; None when run inline without one."""
        self._report = report
        self._cancel_asked = cancel_asked
        self._done = 0.0

    def progress(self, done: float, total: float | None = None, message: str = "", ends: float | None = None) -> None:
        """Say how far the work is; see `Progress`. `done` never falls: a lower or non-finite number counts as the last one."""
        if math.isfinite(done):
            self._done = max(self._done, float(done))
        known = total is not None and math.isfinite(total)
        self._report(Progress(self._done, float(total) if known and total is not None else None, message, ends))

    def cancelled(self) -> bool:
        """True if the caller wants the work to stop."""
        return self._cancel_asked()

    def check(self) -> None:
        """Stop here if the caller wants the work to stop.

        Raises:
            Cancelled: Cancel was requested. Let it pass; clean up in `finally`.
        """
        if self._cancel_asked():
            raise Cancelled(f"job {self.job_id} was cancelled")


class Board:
    """Memory shared by worker and task: cancel flag one way, progress the other.

    Made before the fork. There is one writer per field, so a sequence number (odd while writing) is all the
    synchronisation needed; a reader that meets a write in progress looks again at its next tick.
    """

    SIZE = 1024
    _CANCEL = 0
    _SEQUENCE = struct.Struct("<I")
    _SEQUENCE_AT = 4
    _NUMBERS = struct.Struct("<dddH")
    _NUMBERS_AT = 8
    _TEXT_AT = 40

    def __init__(self) -> None:
        self._memory = mmap.mmap(-1, self.SIZE)
        self._written = 0
        self._read = 0

    def ask_cancel(self) -> None:
        """Raise the flag that the task sees."""
        self._memory[self._CANCEL] = 1

    def cancel_asked(self) -> bool:
        """True if the flag is up."""
        return self._memory[self._CANCEL] == 1

    def write(self, progress: Progress) -> None:
        """Put up the latest progress; the one before is overwritten."""
        text = progress.message.encode("utf-8", "replace")[: self.SIZE - self._TEXT_AT]
        total = math.nan if progress.total is None else progress.total
        self._SEQUENCE.pack_into(self._memory, self._SEQUENCE_AT, (self._written + 1) & 0xFFFFFFFF)
        ends = math.nan if progress.ends is None else progress.ends
        self._NUMBERS.pack_into(self._memory, self._NUMBERS_AT, progress.done, total, ends, len(text))
        self._memory[self._TEXT_AT : self._TEXT_AT + len(text)] = text
        self._written += 2
        self._SEQUENCE.pack_into(self._memory, self._SEQUENCE_AT, self._written & 0xFFFFFFFF)

    def read_new(self) -> Progress | None:
        """The latest progress, or None if nothing new stands there."""
        (before,) = self._SEQUENCE.unpack_from(self._memory, self._SEQUENCE_AT)
        if before == self._read or before % 2:
            return None
        done, total, ends, length = self._NUMBERS.unpack_from(self._memory, self._NUMBERS_AT)
        text = self._memory[self._TEXT_AT : min(self._TEXT_AT + length, self.SIZE)]
        (after,) = self._SEQUENCE.unpack_from(self._memory, self._SEQUENCE_AT)
        if after != before:
            return None
        self._read = before
        known = (None if math.isnan(n) else n for n in (total, ends))
        return Progress(done, next(known), text.decode("utf-8", "ignore"), next(known))
