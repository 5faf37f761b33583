"""Loops of fluvial, creeping and thermal erosion. Compiled by numba, kept on disk."""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["creep_cols", "creep_rows", "incise", "move", "settle_sediment", "slump"]

ROOT_2 = 1.4142135623730951


@njit(cache=True, nogil=True)
def incise(height, filled, receiver, order, cols, cell, strength):
    """One implicit step of the stream power law with n = 1 (Braun & Willett 2013, eq. 20), upstream order.

    Cells under water (filled above ground) keep their height. Returns the new height; `strength` is K dt A^m per cell.
    """
    new = height.copy()
    for k in range(order.size):
        c = order[k]
        d = receiver[c]
        if d == c or filled[c] > height[c]:
            continue
        step = abs(c // cols - d // cols) + abs(c % cols - d % cols)
        length = cell * (ROOT_2 if step == 2 else 1.0)
        f = strength[c] / length
        base = filled[d] if filled[d] > height[d] else new[d]  # standing water keeps its level
        if base >= height[c]:
            continue
        new[c] = (height[c] + f * base) / (1.0 + f)
    return new


@njit(cache=True, nogil=True)
def move(rock, soil, wear, deposit, change, first, last):
    """Raise or lower the ground by `change` [m] in place: loose matter goes first, then rock wears."""
    for c in range(first, last):
        if change[c] > 0.0:
            soil[c] += change[c]
            deposit[c] += change[c]
        elif change[c] < 0.0:
            loose = min(-change[c], soil[c])
            soil[c] -= loose
            rock[c] -= -change[c] - loose
            wear[c] -= change[c]


@njit(cache=True, nogil=True)
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
def _too_steep(c, rock, soil, valid, rows, cols, cell, talus_loose, talus_rock, spare, movable, target):
    """Lower neighbours of a cell, in `target`, and how far each slope exceeds its angle [m], in `movable`.

    Excesses of slope up to `spare` [m/m] are left. Returns how many there are, and the largest excess of slope [m/m].
    """
    r, q = c // cols, c % cols
    top = rock[c] + soil[c]
    found, worst = 0, 0.0
    for rr in range(max(r - 1, 0), min(r + 2, rows)):
        for qq in range(max(q - 1, 0), min(q + 2, cols)):
            k = rr * cols + qq
            length = cell * (ROOT_2 if rr != r and qq != q else 1.0)
            fall = top - rock[k] - soil[k]
            if fall <= talus_loose * length or not valid[k]:
                continue
            breaking = max(fall - soil[c] - talus_rock * length, 0.0)
            excess = min(fall - talus_loose * length, soil[c] + breaking)
            worst = max(worst, excess / length)
            if excess > spare * length:
                movable[found], target[found] = excess, k
                found += 1
    return found, worst


@njit(cache=True, nogil=True)
def slump(bedrock, loose, valid, rows, cols, cell, talus_loose, talus_rock, rate, sweeps, tolerance):
    """Thermal erosion: material slides from cells steeper than their angle of repose to lower neighbours.

    A pass moves from every too steep cell a part of the excess to its lower neighbours, in proportion to theirs
    (Musgrave, Kolb & Mace 1989), all cells at once: nothing is lost and no direction is preferred. Rock that stands
    steeper than `talus_rock` breaks into loose matter first. What exceeds the angle by less than half the tolerance rests.
    After the first pass only cells with a slope that has grown are looked at again.

    Returns (bedrock, loose, passes done, largest excess of slope left).
    """
    rock, soil = bedrock.copy(), loose.copy()
    n = rows * cols
    waiting, later, touched = np.arange(n).astype(np.int32), np.empty(n, np.int32), np.empty(n, np.int32)
    change, changed, queued = np.zeros(n), np.zeros(n, np.bool_), np.zeros(n, np.bool_)
    movable, target = np.zeros(8), np.zeros(8, np.int64)
    done, count = 0, n
    while count > 0 and done < sweeps:
        hit = 0
        for at in range(count):
            c = np.int64(waiting[at])
            queued[c] = False
            if not valid[c]:
                continue
            found, _ = _too_steep(
                c, rock, soil, valid, rows, cols, cell, talus_loose, talus_rock, 0.5 * tolerance, movable, target
            )
            if found == 0:
                continue
            amount, total = rate * movable[:found].max(), movable[:found].sum()
            broken = max(amount - soil[c], 0.0)
            rock[c] -= broken
            soil[c] += broken
            change[c] -= amount
            if not changed[c]:
                changed[c], touched[hit] = True, c
                hit += 1
            for i in range(found):
                k = target[i]
                change[k] += amount * movable[i] / total
                if not changed[k]:
                    changed[k], touched[hit] = True, k
                    hit += 1
        done += 1
        for at in range(hit):
            soil[touched[at]] += change[touched[at]]
        # A slope has grown where its upper cell gained (it is looked at again) or its lower one lost.
        count = 0
        for at in range(hit):
            c = np.int64(touched[at])
            if not queued[c]:
                queued[c], later[count] = True, c
                count += 1
            lost = change[c] < 0.0
            change[c], changed[c] = 0.0, False
            if not lost:
                continue
            r, q = c // cols, c % cols
            top = rock[c] + soil[c]
            for rr in range(max(r - 1, 0), min(r + 2, rows)):
                for qq in range(max(q - 1, 0), min(q + 2, cols)):
                    k = rr * cols + qq
                    length = cell * (ROOT_2 if rr != r and qq != q else 1.0)
                    fall = rock[k] + soil[k] - top
                    if fall > talus_loose * length and (soil[k] > 0.0 or fall > talus_rock * length) and not queued[k]:
                        queued[k], later[count] = True, k
                        count += 1
        waiting, later = later, waiting
    worst = 0.0
    for c in range(n):
        if valid[c]:
            _, most = _too_steep(c, rock, soil, valid, rows, cols, cell, talus_loose, talus_rock, np.inf, movable, target)
            worst = max(worst, most)
    return rock, soil, done, worst


@njit(cache=True, nogil=True)
def creep_rows(height, fixed, valid, number, new, first, last):
    """Implicit diffusion along the rows `first` to `last` (Thomas algorithm), shape (rows, cols); `fixed` cells keep their height.

    `number` is D dt / cell^2. Nothing flows over the edge or into invalid cells. Returns what flowed into fixed cells [m].
    """
    cols = height.shape[1]
    upper = np.empty(cols)
    gone = 0.0
    for r in range(first, last):
        for q in range(cols):
            if fixed[r, q] or not valid[r, q]:
                upper[q], new[r, q] = 0.0, height[r, q]
                continue
            before = number if q > 0 and valid[r, q - 1] else 0.0
            after = number if q < cols - 1 and valid[r, q + 1] else 0.0
            pivot = 1.0 + before + after
            value = height[r, q]
            if before > 0.0:
                pivot -= before * upper[q - 1]
                value += before * new[r, q - 1]
            upper[q], new[r, q] = after / pivot, value / pivot
        for q in range(cols - 2, -1, -1):
            new[r, q] += upper[q] * new[r, q + 1]
        for q in range(cols - 1):
            if valid[r, q] and valid[r, q + 1]:
                if fixed[r, q + 1] and not fixed[r, q]:
                    gone += number * (new[r, q] - new[r, q + 1])
                elif fixed[r, q] and not fixed[r, q + 1]:
                    gone += number * (new[r, q + 1] - new[r, q])
    return gone


@njit(cache=True, nogil=True)
def creep_cols(height, fixed, valid, number, new, first, last):
    """The same along the columns `first` to `last`."""
    rows = height.shape[0]
    upper = np.zeros((rows, last - first))
    gone = 0.0
    for r in range(rows):
        for q in range(first, last):
            if fixed[r, q] or not valid[r, q]:
                new[r, q] = height[r, q]
                continue
            before = number if r > 0 and valid[r - 1, q] else 0.0
            after = number if r < rows - 1 and valid[r + 1, q] else 0.0
            pivot = 1.0 + before + after
            value = height[r, q]
            if before > 0.0:
                pivot -= before * upper[r - 1, q - first]
                value += before * new[r - 1, q]
            upper[r, q - first], new[r, q] = after / pivot, value / pivot
    for r in range(rows - 2, -1, -1):
        for q in range(first, last):
            new[r, q] += upper[r, q - first] * new[r + 1, q]
            if valid[r, q] and valid[r + 1, q]:
                if fixed[r + 1, q] and not fixed[r, q]:
                    gone += number * (new[r, q] - new[r + 1, q])
                elif fixed[r, q] and not fixed[r + 1, q]:
                    gone += number * (new[r + 1, q] - new[r, q])
    return gone
