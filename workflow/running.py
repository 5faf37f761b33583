"""Runs on record while they go on: one that is cancelled or killed leaves no less evidence than waiting for its verdict would."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from ..execution import Cancelled
from ..worlds.begun import begun_in
from ..worlds.errors import EvidenceError
from ..worlds.looks import RAN

if TYPE_CHECKING:
    from .work import Work

__all__ = ["Running"]

NOTE_S = 1.0
"""Own choice: interval of notes of a run that goes on, so that a kill leaves all but its last second on record [s]."""


class Running:
    """Notes how far a motion ran, from its first frame after the start, until its verdict settles that.

    Args:
        work: the world of the job.
        stage: `probe`, `full` or `sketch`.
        judged: last frame of this motion of which a verdict is known already.
    """

    def __init__(self, work: Work, stage: str, judged: int = 0) -> None:
        self._work, self._stage, self._judged = work, stage, judged
        self._folder = work.session.folder.candidate(work.freeze) / {"full": "bake"}.get(stage, stage)
        self._due = 0.0

    def note(self, *, now: bool = False) -> None:
        """Record the last whole frame, where a note is due or asked for `now`."""
        if not now and time.monotonic() < self._due:
            return
        work = self._work
        try:
            last = begun_in(work.session.folder, self._folder, work.session.spec, work.built).candidate.last_frame
        except EvidenceError:
            return
        if last > self._judged:
            work.session.ledger.add_look(work.freeze, f"{self._stage}{RAN}", work.session.revision, last)
            self._due = time.monotonic() + NOTE_S

    @contextmanager
    def until_cancelled(self) -> Iterator[None]:
        """Note the last frame where the run is cancelled in here."""
        try:
            yield
        except Cancelled:
            self.note(now=True)
            raise

    def noting(self, check: Callable[[], None]) -> Callable[[], None]:
        """A check between frames that takes its notes too."""

        def both() -> None:
            self.note()
            check()

        return both

    def judged(self) -> None:
        """Record that its frames are judged, where no probe or bake is recorded that says so."""
        self._work.session.ledger.settle_look(self._work.freeze, f"{self._stage}{RAN}")
