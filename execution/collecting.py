"""Python's collector of unreachable cycles, asked seldom while a large world is built or judged.

It walks over every object that lives each time so many new ones have come: a furnished world keeps a million of them for good, and its walks
are a tenth of all work. Nothing is held back for good: what is unreachable by then goes with the first collection after.
"""

from __future__ import annotations

import gc
import threading
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["seldom_collected"]

YOUNG, MIDDLE, OLD = 100_000, 20, 1000
"""Own choice: new objects to a collection of these, such collections to one of the middle generation, and those to one of all objects."""

_lock = threading.Lock()
_before: list[tuple[int, int, int]] = []
"""Thresholds before the first of those who are within, and one entry more for each further one."""


@contextmanager
def seldom_collected() -> Iterator[None]:
    """Within it the collector walks seldom; the last of several threads to leave puts it back. Also a decorator."""
    with _lock:
        _before.append(_before[0] if _before else gc.get_threshold())
        gc.set_threshold(YOUNG, MIDDLE, OLD)
    try:
        yield
    finally:
        with _lock:
            kept = _before.pop()
            if not _before:
                gc.set_threshold(*kept)
