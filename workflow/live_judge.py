"""Rows judged while a run goes on, by a process on another core: what fails is known when its frames are, not at the end.

What a verdict over the first frames says stays so (`tests/verifiers/test_prefixes.py`), so that a failure found here is one of the whole run.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING

from ..execution import core_count, die_with_parent, in_task
from ..worlds.errors import EvidenceError
from ..worlds.requirements import Row

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate

__all__ = ["DECISIVE", "LiveJudge", "judge_begun"]

DECISIVE = ("beat", "contact", "support", "relations", "numerical", "category")
"""Checks that are asked of every prefix, the cheapest and most decisive first. Claims and causes compare whole runs."""
FIRST_S = 1.0
"""A run that ends sooner is judged at its end alone [s]."""
LOOK_S = 0.2
"""Interval between looks for new frames [s]."""
POLITENESS = 5
"""Added to its niceness: the run comes first."""


class LiveJudge:
    """The process that judges the frames of a probe as they come; made before anything that starts a thread, since it is forked.

    Without a second core, or where no process can be forked safely (outside of a job's own process, no Linux), there is none: the
    rows are judged at the end as they are anyhow.

    Args:
        root: the world folder.
    """

    def __init__(self, root: Path) -> None:
        self._process, self._end = None, None
        if sys.platform != "linux" or core_count() < 2 or not in_task() or threading.active_count() > 1:
            return
        forks = multiprocessing.get_context("fork")
        self._end, theirs = forks.Pipe()
        self._process = forks.Process(target=_watch, args=(root, theirs), daemon=True)
        self._process.start()
        theirs.close()

    def watch(self, freeze: str) -> None:
        """Begin with the probe of these settings, which are recorded."""
        if self._end is not None:
            self._end.send(freeze)

    def news(self) -> list[Row]:
        """Mandatory rows that were found to fail since the last call; never waits."""
        found: list[Row] = []
        with contextlib.suppress(EOFError, OSError):  # it ended by itself: the rows are judged at the end
            while self._end is not None and self._end.poll():
                found += [Row.model_validate_json(text) for text in self._end.recv()]
        return found

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
        if self._end is not None:
            self._end.close()
        self._process = self._end = None


def _watch(root: Path, pipe: Connection) -> None:
    """Body of the process: judge every prefix that is new, until it is ended."""
    from ..worlds.begun import open_begun
    from ..worlds.candidate import recorded_inputs
    from ..worlds.folder import WorldFolder

    die_with_parent(os.getppid())
    with contextlib.suppress(OSError):
        os.nice(POLITENESS)
    freeze: str = pipe.recv()
    time.sleep(FIRST_S)
    folder, told, seen = WorldFolder.at(root), set[str](), (-1, 0)
    inputs = recorded_inputs(folder, freeze)

    def say(rows: Sequence[Row]) -> None:
        fresh = [r for r in rows if r.id not in told]
        told.update(r.id for r in fresh)
        pipe.send([r.model_dump_json() for r in fresh])

    while True:
        try:
            begun = open_begun(folder, freeze, "probe", inputs)
            state = begun.candidate.last_frame, len(begun.candidate.caches)
        except EvidenceError:
            state = seen
        if state == seen:
            time.sleep(LOOK_S)
            continue
        seen = state

        began = time.monotonic()
        judge_begun(begun.candidate, begun.unmoved, say)
        time.sleep(time.monotonic() - began)  # engines that run on all cores keep most of them


def judge_begun(candidate: Candidate, unmoved: frozenset[str], say: Callable[[Sequence[Row]], None]) -> None:
    """Judge the frames so far by one check after the other; `say` takes the mandatory rows that each finds failing.

    Rows about entities of `unmoved`, which no instance has moved yet, are not decided. Frame 0 alone decides nothing: what holds a body
    there is read from the impulses of the interval that ends at frame 1.
    """
    from ..verifiers.checks import run_checks

    if candidate.last_frame < 1:
        return
    for check in DECISIVE:
        rows = run_checks(candidate, only=(check,), reruns=False, plates=False)
        say([r for r in rows if r.mandatory and r.status == "fail" and not unmoved & {*r.entities}])
