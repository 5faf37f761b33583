"""Progress from within a check: which row, frame or pair it is at, told to whom the check was given.

Judges are deep and take a candidate alone, so who listens stands in a context of this thread and not in their arguments.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...execution import Tell

__all__ = ["tell", "telling"]

EVERY_S = 0.5
"""Own choice: reports are at least so far apart [s]; a frame of a small world takes a thousandth of it."""


@dataclass
class _Listener:
    to: Tell
    words: str
    at: float


_LISTENER: ContextVar[_Listener | None] = ContextVar("listener", default=None)


@contextmanager
def telling(to: Tell, words: str) -> Iterator[None]:
    """Let `tell` report to `to`, after `words`, until the end of the block."""
    before = _LISTENER.set(_Listener(to, words, time.monotonic()))
    try:
        yield
    finally:
        _LISTENER.reset(before)


def tell(what: str, number: int | None = None, of: int | None = None) -> None:
    """Report that the check is at `what`, the `number`-th (from 1) of so many where they are counted; nothing where nobody listens.

    How far the work is stays as it was: what a check has still to ask is not known before.
    """
    listener = _LISTENER.get()
    if listener is None or time.monotonic() - listener.at < EVERY_S:
        return
    listener.at = time.monotonic()
    counted = "" if number is None else f" {number} of {of}" if of is not None else f" {number}"
    listener.to(0, 1, f"{listener.words}, {what}{counted}")
