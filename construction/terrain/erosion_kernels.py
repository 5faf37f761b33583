"""Loops of fluvial and thermal erosion over a drainage. Compiled by numba, kept on disk."""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["incise", "settle_sediment", "slump"]

ROOT_2 = 1.4142135623730951


@njit(cache=True)
def incise(height, filled, area, receiver, order, cols, cell, factor, m):
    """One implicit step of the stream power law with n = 1 (Braun & Willett 2013, eq. 20), upstream order.

    Cells under water (filled above ground) keep their height. Returns the new height; `factor` is K dt per cell.
    """
    new = height.copy()
    for k in range(order.size):
        c = order[k]
        d = receiver[c]
        if d == c or filled[c] > height[c]:
            continue
        step = abs(c // cols - d // cols) + abs(c % cols - d % cols)
        length = cell * (ROOT_2 if step == 2 else 1.0)
        f = factor[c] * area[c] ** m / length
        base = filled[d] if filled[d] > height[d] else new[d]  # standing water keeps its level
        if base >= height[c]:
            continue
        new[c] = (height[c] + f * base) / (1.0 + f)
    return new


@njit(cache=True)
def settle_sediment(removed, lake, capacity, receiver, order):
    """Carry what was removed [m per cell] downstream; lakes keep what they have room for, at their exit.

    Args:
        removed: [m] per cell.
        lake: number of the depression of each cell, 0 elsewhere.
        capacity: room of each depression [m summed over its cells]; used up in place.
        receiver: where each cell drains to.
        order: every cell after its receiver.

    Returns:
        kept by each depression, left the grid; both [m summed over cells].
    """
    load = removed.copy()
    kept = np.zeros_like(capacity)
    gone = 0.0
    for k in range(order.size - 1, -1, -1):
        c = order[k]
        d = receiver[c]
        here = lake[c]
        if here > 0 and (d == c or lake[d] != here):
            held = min(load[c], capacity[here])
            capacity[here] -= held
            kept[here] += held
            load[c] -= held
        if d == c:
            gone += load[c]
        else:
            load[d] += load[c]
    return kept, gone


@njit(cache=True)
def slump(bedrock, loose, valid, rows, cols, cell, talus_loose, talus_rock, rate, sweeps, tolerance):
    """Thermal erosion: material slides from cells steeper than their angle of repose to lower neighbours.

    A pass moves from every too steep cell a part of the excess to its lower neighbours, in proportion to theirs
    (Musgrave, Kolb & Mace 1989), all cells at once: nothing is lost and no direction is preferred. Rock that stands
    steeper than `talus_rock` breaks into loose matter first.

    Returns (bedrock, loose, passes done, largest excess of slope left).
    """
    rock, soil = bedrock.copy(), loose.copy()
    n = rows * cols
    change = np.zeros(n)
    movable = np.zeros(8)
    target = np.zeros(8, np.int64)
    worst, done = np.inf, 0
    while worst > tolerance and done < sweeps:
        worst = 0.0
        change[:] = 0.0
        for c in range(n):
            if not valid[c]:
                continue
            r, q = c // cols, c % cols
            count, total, most = 0, 0.0, 0.0
            for dr in range(-1, 2):
                for dq in range(-1, 2):
                    rr, qq = r + dr, q + dq
                    k = rr * cols + qq
                    if (dr == 0 and dq == 0) or rr < 0 or qq < 0 or rr >= rows or qq >= cols or not valid[k]:
                        continue
                    length = cell * (ROOT_2 if dr != 0 and dq != 0 else 1.0)
                    fall = rock[c] + soil[c] - rock[k] - soil[k]
                    breaking = max(fall - soil[c] - talus_rock * length, 0.0)
                    excess = min(fall - talus_loose * length, soil[c] + breaking)
                    if excess > 0.0:
                        movable[count], target[count] = excess, k
                        count += 1
                        total += excess
                        most = max(most, excess)
                        worst = max(worst, excess / length)
            if count == 0:
                continue
            amount = rate * most
            broken = max(amount - soil[c], 0.0)
            rock[c] -= broken
            soil[c] += broken
            change[c] -= amount
            for k in range(count):
                change[target[k]] += amount * movable[k] / total
        done += 1
        for c in range(n):
            soil[c] += change[c]
    return rock, soil, done, worst
