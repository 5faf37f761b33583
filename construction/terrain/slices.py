"""Work on a grid in slices that several threads take at once. The slices do not depend on how many threads there are."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from ...geometry.launch import cores

__all__ = ["SLICE", "in_slices"]

SLICE = 64
"""Rows of a slice: its arrays stay in the cache of a core."""

Result = TypeVar("Result")


def in_slices(count: int, work: Callable[[int, int], Result], *, size: int = SLICE) -> list[Result]:
    """Results of `work(first, last)` for slices of `size` out of `count`, in order.

    Args:
        count: rows, columns or cells.
        work: must let go of Python's lock (numpy; numba with `nogil`) and write to its own slice only.
        size: of a slice.
    """
    starts = range(0, count, size)
    threads = min(cores(), len(starts))
    if threads <= 1:
        return [work(first, min(first + size, count)) for first in starts]
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(lambda first: work(first, min(first + size, count)), starts))
