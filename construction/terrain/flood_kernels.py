"""Priority-Flood with steepest-descent D8 routing in one pass, and the loops over its order. Compiled by numba, kept on disk.

Cells are flat indices, row-major. `receiver[c]` is the cell that `c` drains to; `c` itself where the water leaves the grid.
"""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["accumulate", "flood", "inherit", "label_basins", "order_streams", "trace"]

ROOT_2 = 1.4142135623730951
CELLS_OF_BUCKET = 16
MOST_BUCKETS = 1 << 20
OPEN, NO_LAND = -2, -3


@njit(cache=True)
def _doubled(values):
    """An array of twice the length that begins with `values`."""
    longer = np.empty(2 * values.size, values.dtype)
    longer[: values.size] = values
    return longer


@njit(cache=True)
def _push(heap_z, heap_n, heap_i, count, z, number, index):
    """Add an entry to a binary heap ordered by height, then by number of entry."""
    at = count
    while at > 0:
        up = (at - 1) >> 1
        if heap_z[up] < z or (heap_z[up] == z and heap_n[up] < number):
            break
        heap_z[at], heap_n[at], heap_i[at] = heap_z[up], heap_n[up], heap_i[up]
        at = up
    heap_z[at], heap_n[at], heap_i[at] = z, number, index


@njit(cache=True)
def _pop(heap_z, heap_n, heap_i, count):
    """Take the lowest entry off; returns its index. The heap then holds `count` - 1 entries."""
    lowest = heap_i[0]
    count -= 1
    z, number, index = heap_z[count], heap_n[count], heap_i[count]
    at = 0
    while True:
        child = 2 * at + 1
        if child >= count:
            break
        other = child + 1
        if other < count and (
            heap_z[other] < heap_z[child] or (heap_z[other] == heap_z[child] and heap_n[other] < heap_n[child])
        ):
            child = other
        if z < heap_z[child] or (z == heap_z[child] and number < heap_n[child]):
            break
        heap_z[at], heap_n[at], heap_i[at] = heap_z[child], heap_n[child], heap_i[child]
        at = child
    heap_z[at], heap_n[at], heap_i[at] = z, number, index
    return lowest


@njit(cache=True, nogil=True)
def flood(valid, rows, cols, filled, receiver, order, waiting, queue):
    """Fill depressions and route every cell (Barnes, Lehman & Mulla 2014, algorithm 2; O'Callaghan & Mark 1984).

    Water leaves over the edge of the grid and over the edge of invalid cells. A cell drains to its steepest lower
    neighbour on the filled surface; on flats to the neighbour that flooded it, which leads to the outlet.

    Cells wait in buckets of height, a list each; only those of the lowest bucket stand in a heap. The order is
    that of one heap over all cells, in half the memory.

    The caller brings all large arrays: memory of numpy lies in huge pages, where the system has them, and that of numba not.

    Args:
        valid: False where there is no land, shape (n,).
        rows: rows of the grid.
        cols: columns of the grid.
        filled: the heights [m]; the filled surface in the end; shape (n,).
        receiver: gets the receivers, shape (n,), int32.
        order: gets all valid cells, each after its receiver, shape (n,), int32.
        waiting: work space, shape (n,), int32.
        queue: work space, shape (n, 2), int32.

    Returns:
        number of valid cells: entries of `order`.
    """
    n = rows * cols
    receiver[:] = OPEN
    low, high = np.inf, -np.inf
    for c in range(n):
        if valid[c]:
            low, high = min(low, filled[c]), max(high, filled[c])
        else:
            receiver[c], filled[c] = NO_LAND, np.inf
    buckets = min(max(n // CELLS_OF_BUCKET, 1), MOST_BUCKETS)
    scale = buckets / (high - low) if high - low > 1e-300 else 0.0
    head = np.full(buckets, -1, np.int32)  # first cell of each bucket; `queue` holds per cell: the next of its list, its number
    heap_z, heap_n, heap_i = np.empty(1024), np.empty(1024, np.int32), np.empty(1024, np.int32)
    # In `waiting` stand cells below the level at which they were met: a queue needs no heap.
    first, last, in_heap, entries, done, now = 0, 0, 0, 0, 0, -1
    for r in range(rows):
        for q in range(cols):
            c = r * cols + q
            if not valid[c]:
                continue
            outlet = r == 0 or q == 0 or r == rows - 1 or q == cols - 1
            if not outlet:
                for dr in range(-1, 2):
                    for dq in range(-1, 2):
                        outlet = outlet or not valid[(r + dr) * cols + q + dq]
            if outlet:
                bucket = min(int((filled[c] - low) * scale), buckets - 1)
                queue[c, 0], queue[c, 1], head[bucket] = head[bucket], entries, c
                entries += 1
                receiver[c] = c
    while True:
        # The queue holds cells of one level, reached from a cell that was popped at that level: they go first.
        if first < last:
            c = np.int64(waiting[first])
            first += 1
        else:
            if in_heap == 0:
                now += 1
                while now < buckets and head[now] < 0:
                    now += 1
                if now >= buckets:
                    break
                k = head[now]
                while k >= 0:
                    if in_heap == heap_z.size:
                        heap_z, heap_n, heap_i = _doubled(heap_z), _doubled(heap_n), _doubled(heap_i)
                    _push(heap_z, heap_n, heap_i, in_heap, filled[k], queue[k, 1], k)
                    in_heap += 1
                    k = queue[k, 0]
            c = np.int64(_pop(heap_z, heap_n, heap_i, in_heap))
            in_heap -= 1
        order[done] = c
        done += 1
        r = c // cols
        q = c - r * cols
        level = filled[c]
        steepest = 0.0
        for dr in range(-1, 2):
            for dq in range(-1, 2):
                rr, qq = r + dr, q + dq
                if (dr == 0 and dq == 0) or rr < 0 or qq < 0 or rr >= rows or qq >= cols:
                    continue
                k = rr * cols + qq
                if receiver[k] != OPEN:
                    drop = level - filled[k]
                    if drop > 0.0:
                        slope = drop / ROOT_2 if dr != 0 and dq != 0 else drop
                        if slope > steepest:
                            steepest = slope
                            receiver[c] = k
                    continue
                receiver[k] = c
                if filled[k] <= level:
                    filled[k] = level
                    waiting[last] = k
                    last += 1
                    continue
                bucket = min(int((filled[k] - low) * scale), buckets - 1)
                if bucket > now:
                    queue[k, 0], queue[k, 1], head[bucket] = head[bucket], entries, k
                else:
                    if in_heap == heap_z.size:
                        heap_z, heap_n, heap_i = _doubled(heap_z), _doubled(heap_n), _doubled(heap_i)
                    _push(heap_z, heap_n, heap_i, in_heap, filled[k], entries, k)
                    in_heap += 1
                entries += 1
    for c in range(n):
        if receiver[c] == NO_LAND:
            receiver[c] = -1
    return done


@njit(cache=True, nogil=True)
def accumulate(weight, receiver, order):
    """Sum of `weight` over each cell and everything upstream of it; same unit and shape (n,)."""
    total = weight.copy()
    for k in range(order.size - 1, -1, -1):
        c = order[k]
        if receiver[c] != c:
            total[receiver[c]] += total[c]
    return total


@njit(cache=True)
def label_basins(receiver, order):
    """Watershed of each cell: the number of the outlet that it drains to, from 1; 0 where there is no land."""
    label = np.zeros(receiver.size, np.int32)
    count = 0
    for k in range(order.size):
        c = order[k]
        if receiver[c] == c:
            count += 1
            label[c] = count
        else:
            label[c] = label[receiver[c]]
    return label


@njit(cache=True)
def inherit(value, own, receiver, order):
    """`value` where `own` holds, else that of the first such cell downstream; 0 where there is none."""
    found = np.zeros_like(value)
    for k in range(order.size):
        c = order[k]
        if own[c]:
            found[c] = value[c]
        elif receiver[c] != c:
            found[c] = found[receiver[c]]
    return found


@njit(cache=True)
def order_streams(channel, receiver, order):
    """Strahler order of each channel cell (Strahler 1957), 0 elsewhere. `channel` must be closed downstream."""
    strahler = np.zeros(receiver.size, np.int16)
    highest = np.zeros(receiver.size, np.int16)
    twice = np.zeros(receiver.size, np.bool_)
    for k in range(order.size - 1, -1, -1):
        c = order[k]
        if not channel[c]:
            continue
        mine = 1 if highest[c] == 0 else highest[c] + 1 if twice[c] else highest[c]
        strahler[c] = mine
        d = receiver[c]
        if d != c:
            if mine > highest[d]:
                highest[d], twice[d] = mine, False
            elif mine == highest[d]:
                twice[d] = True
    return strahler


@njit(cache=True)
def trace(start, stop, receiver):
    """Cells from `start` downstream up to and including the first where `stop` holds or the water leaves the grid."""
    path = [start]
    c = start
    while not stop[c] and receiver[c] != c:
        c = receiver[c]
        path.append(c)
    return np.array(path)
