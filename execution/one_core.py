"""Linear algebra on one thread while a large world is built or judged.

Products are small there, and threads that share them wait for each other at full speed: on busy cores that takes several times the processor
time of the products, for the same numbers.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["ONE_THREAD", "one_core"]

ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "VECLIB_MAXIMUM_THREADS": "1"}
"""The same as variables of a process to be started."""

_lock = threading.Lock()
_within: list[Any] = []
"""Limits that put the numbers of threads back, one entry for each who is within."""


@contextmanager
def one_core() -> Iterator[None]:
    """Within it libraries of linear algebra use one thread; the last of several threads to leave puts them back. Also a decorator."""
    with _lock:
        _within.append(_within[0] if _within else _limited())
    try:
        yield
    finally:
        with _lock:
            limits = _within.pop()
            if not _within:
                limits.restore_original_limits()


def _limited() -> Any:
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController().select(user_api="blas").limit(limits=1)
