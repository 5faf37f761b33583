"""Impulses of impacts that follow one another within a step. Compiled by numba, kept on disk; the law is in `impact_sequence.py`."""

from __future__ import annotations

import numpy as np
from numba import njit

from .coulomb_kernels import press, rub

__all__ = ["CONTACT", "HOLDS", "STOPS", "resolve"]

CONTACT, STOPS, HOLDS = 0, 1, 2
"""Kinds of a constraint: a contact with friction, a stop that presses one way, and what holds both ways."""
SWEEPS = 300
"""Most sweeps over the contacts of an impact."""
RIGID = 1e-9
"""Least mobility of a contact along any axis, in parts of its largest."""
FINE = 1e-11
"""Change of a speed in a sweep, in parts of the fastest closing speed, that ends the sweeps."""


@njit(cache=True, nogil=True)
def _factor(tree, adr, num, inertia, row_nnz, row_adr, col, low, at):
    """Cholesky factor of the inertia of a tree, at `low[at:]`, row by row."""
    n, first = num[tree], adr[tree]
    for i in range(n):
        for j in range(n):
            low[at + i * n + j] = 0.0
        d = first + i
        for k in range(row_nnz[d]):
            j = col[row_adr[d] + k] - first
            if 0 <= j <= i:
                low[at + i * n + j] = inertia[row_adr[d] + k]
    for i in range(n):
        for j in range(i + 1):
            total = low[at + i * n + j]
            for k in range(j):
                total -= low[at + i * n + k] * low[at + j * n + k]
            low[at + i * n + j] = np.sqrt(total) if i == j else total / low[at + j * n + j]


@njit(cache=True, nogil=True)
def _solve(n, low, at, x):
    """Inverse inertia of a tree on a vector, in place."""
    for i in range(n):
        total = x[i]
        for k in range(i):
            total -= low[at + i * n + k] * x[k]
        x[i] = total / low[at + i * n + i]
    for i in range(n - 1, -1, -1):
        total = x[i]
        for k in range(i + 1, n):
            total -= low[at + k * n + i] * x[k]
        x[i] = total / low[at + i * n + i]


@njit(cache=True, nogil=True)
def _span(c, trees, adr, num, dofs):
    """Degrees of freedom that constraint `c` acts on, into `dofs`; their number."""
    count = 0
    for side in range(2):
        tree = trees[c, side]
        if tree < 0 or (side == 1 and tree == trees[c, 0]):
            continue
        for k in range(num[tree]):
            dofs[count] = adr[tree] + k
            count += 1
    return count


@njit(cache=True, nogil=True)
def _row(row, count, dofs, jacobian, row_adr, row_nnz, col, nv, out):
    """A row of the Jacobian over some degrees of freedom; `col` is empty where rows are full."""
    if len(col) == 0:
        for k in range(count):
            out[k] = jacobian[row * nv + dofs[k]]
        return
    for k in range(count):
        out[k] = 0.0
    for i in range(row_nnz[row]):
        at = row_adr[row] + i
        for k in range(count):
            if dofs[k] == col[at]:
                out[k] = jacobian[at]
                break


@njit(cache=True, nogil=True)
def _speed(jac, count, dofs, v):
    total = 0.0
    for k in range(count):
        total += jac[k] * v[dofs[k]]
    return total


@njit(cache=True, nogil=True)
def _push(answer, count, dofs, v, amount):
    for k in range(count):
        v[dofs[k]] += answer[k] * amount


@njit(cache=True, nogil=True)
def _sweep(active, kind, sizes, friction, jac, ans, blocks, dofs, spans, v, kept, p, normal, pressing, fast):
    """Go over the active constraints until none changes: those of the first phase, or friction alone under `normal`."""
    free, found = np.zeros(6), np.zeros(3)
    for _ in range(SWEEPS):
        worst = 0.0
        for c in active:
            n = spans[c]
            if kind[c] == HOLDS:
                change = (kept[c] - _speed(jac[c, 0], n, dofs[c], v)) / blocks[c, 0, 0]
                p[c, 0] += change
                _push(ans[c, 0], n, dofs[c], v, change)
                worst = max(worst, abs(change) * blocks[c, 0, 0])
                continue
            if kind[c] == STOPS:
                if pressing:
                    wanted = max(0.0, p[c, 0] - _speed(jac[c, 0], n, dofs[c], v) / blocks[c, 0, 0])
                    change = wanted - p[c, 0]
                    p[c, 0] = wanted
                    _push(ans[c, 0], n, dofs[c], v, change)
                    worst = max(worst, abs(change) * blocks[c, 0, 0])
                continue
            for s in range(3):
                free[s] = _speed(jac[c, s], n, dofs[c], v)
            first = 0 if pressing else 1
            for s in range(3):
                for k in range(first, 3):
                    free[s] -= blocks[c, s, k] * p[c, k]
            if pressing:
                press(blocks[c], friction[c, 0], free, found)
            else:
                rub(blocks[c], friction[c, 0], free, normal[c], found)
                found[0] = p[c, 0]
            for s in range(3):
                change = found[s] - p[c, s]
                if change != 0.0:
                    p[c, s] = found[s]
                    _push(ans[c, s], n, dofs[c], v, change)
                    worst = max(worst, abs(change) * blocks[c, s, s])
            for s in range(3, sizes[c]):
                most = friction[c, s - 1] * (p[c, 0] if pressing else normal[c])
                u = _speed(jac[c, s], n, dofs[c], v)
                wanted = min(max(p[c, s] - u / blocks[c, s, s], -most), most)
                change = wanted - p[c, s]
                p[c, s] = wanted
                _push(ans[c, s], n, dofs[c], v, change)
        if worst < FINE * fast:
            break


@njit(cache=True, nogil=True)
def _measure(active, sizes, jac, dofs, spans, v, out):
    for c in active:
        for s in range(sizes[c]):
            out[c, s] = _speed(jac[c, s], spans[c], dofs[c], v)


@njit(cache=True, nogil=True)
def _work(active, sizes, p, before, after):
    """Energy that impulses give between two states [J]."""
    total = 0.0
    for c in active:
        for s in range(sizes[c]):
            total += 0.5 * p[c, s] * (before[c, s] + after[c, s])
    return total


@njit(cache=True, nogil=True)
def _strike(active, kind, sizes, friction, bounce, jac, ans, blocks, dofs, spans, v, kept, fast, given):
    """One impact of the active constraints at once: they stop each other, and give back their shares; impulses in `given`."""
    count = len(sizes)
    p, q = np.zeros((count, 6)), np.zeros((count, 6))
    normal = np.zeros(count)
    u0, u1, u2 = np.zeros((count, 6)), np.zeros((count, 6)), np.zeros((count, 6))
    start = v.copy()
    _measure(active, sizes, jac, dofs, spans, v, u0)
    _sweep(active, kind, sizes, friction, jac, ans, blocks, dofs, spans, v, kept, p, normal, True, fast)
    _measure(active, sizes, jac, dofs, spans, v, u1)
    taken = _work(active, sizes, p, u0, u1)
    if taken > 0.0:
        # Sweeps that did not end: as much of what they found as takes most.
        push, stiff = 0.0, 0.0
        for c in active:
            for s in range(sizes[c]):
                push += p[c, s] * u0[c, s]
                stiff += p[c, s] * (u1[c, s] - u0[c, s])
        share = min(1.0, max(0.0, -push / stiff)) if stiff > 0.0 else 0.0
        for d in range(len(v)):
            v[d] = start[d] + share * (v[d] - start[d])
        for c in active:
            for s in range(sizes[c]):
                given[c, s] += share * p[c, s]
        return
    middle = v.copy()
    lively = False
    for c in active:
        if kind[c] == CONTACT and bounce[c] > 0.0 and p[c, 0] > 0.0:
            lively = True
            normal[c] = q[c, 0] = bounce[c] * p[c, 0]
            _push(ans[c, 0], spans[c], dofs[c], v, normal[c])
    if lively:
        _sweep(active, kind, sizes, friction, jac, ans, blocks, dofs, spans, v, kept, q, normal, False, fast)
        _measure(active, sizes, jac, dofs, spans, v, u2)
        back, rest = 0.0, 0.0
        for c in active:
            for s in range(sizes[c]):
                back += q[c, s] * u1[c, s]
                rest += 0.5 * q[c, s] * (u2[c, s] - u1[c, s])
        share = 1.0
        if taken + back + rest > 0.0 and rest > 0.0:
            share = min(1.0, max(0.0, (-back + np.sqrt(max(back * back - 4.0 * rest * taken, 0.0))) / (2.0 * rest)))
            for d in range(len(v)):
                v[d] = middle[d] + share * (v[d] - middle[d])
        for c in active:
            for s in range(sizes[c]):
                p[c, s] += share * q[c, s]
    for c in active:
        for s in range(sizes[c]):
            given[c, s] += p[c, s]


@njit(cache=True, nogil=True)
def _build(c, rows, sizes, trees, adr, num, low, lows, model, jacobian, jac, ans, blocks, dofs, spans):
    """Jacobian, answer of the bodies and their product, of one constraint."""
    inertia, row_nnz, row_adr, col = model
    values, j_adr, j_nnz, j_col, nv = jacobian
    n = spans[c] = _span(c, trees, adr, num, dofs[c])
    for side in range(2):
        tree = trees[c, side]
        if tree >= 0 and lows[tree, 1] == 0:
            _factor(tree, adr, num, inertia, row_nnz, row_adr, col, low, lows[tree, 0])
            lows[tree, 1] = 1
    for s in range(sizes[c]):
        _row(rows[c] + s, n, dofs[c], values, j_adr, j_nnz, j_col, nv, jac[c, s])
        at = 0
        for side in range(2):
            tree = trees[c, side]
            if tree < 0 or (side == 1 and tree == trees[c, 0]):
                continue
            k = num[tree]
            ans[c, s, at : at + k] = jac[c, s, at : at + k]
            _solve(k, low, lows[tree, 0], ans[c, s, at : at + k])
            at += k
    for s in range(sizes[c]):
        for k in range(sizes[c]):
            total = 0.0
            for d in range(n):
                total += jac[c, s, d] * ans[c, k, d]
            blocks[c, s, k] = total
    # A joint may leave a direction no way to give; the sweeps end at the same impulses whatever is added here.
    most = 0.0
    for s in range(sizes[c]):
        most = max(most, blocks[c, s, s])
    for s in range(sizes[c]):
        blocks[c, s, s] += RIGID * most


@njit(cache=True, nogil=True)
def resolve(
    rows, sizes, kind, friction, bounce, trees, speeds, spreads, adr, num, model, jacobian, v, slowest, passes, impulse, told
):
    """Let impacts follow one another until nothing closes faster than `slowest`; the number of those told.

    Args:
        rows: first row of each constraint of one island among all, shape (n,).
        sizes: rows of each, shape (n,).
        kind: of each, shape (n,).
        friction: coefficients, shape (n, 5).
        bounce: restitution, shape (n,).
        trees: trees that it acts on, -1: none, shape (n, 2).
        speeds: along the first row of each, negative where it closes, shape (n,).
        spreads: False where a tree is held, and hands nothing on, shape (trees,).
        adr: first degree of freedom of each tree.
        num: number of degrees of freedom of each tree.
        model: the inertia: values, row lengths, row starts, columns.
        jacobian: values, row starts, row lengths, columns, and the number of degrees of freedom.
        v: generalized velocity, in place.
        slowest: closing speed from which on a contact is an impact [m/s].
        passes: most impacts one after another; what closes then stops, all at once.
        impulse: per row of all constraints [N s], written in place.
        told: per impact of a contact: its number, which impact of the step it is of, and its impulse along its axes; shape (most, 5).
    """
    count, widest = len(rows), 1
    for c in range(count):
        widest = max(widest, sum([num[t] for t in trees[c] if t >= 0]))
    jac, ans = np.zeros((count, 6, widest)), np.zeros((count, 6, widest))
    blocks, dofs, spans = np.zeros((count, 6, 6)), np.zeros((count, widest), np.int64), np.zeros(count, np.int64)
    lows, total = np.zeros((len(num), 2), np.int64), 0
    for t in range(len(num)):
        lows[t, 0] = total
        total += num[t] * num[t]
    low, built, kept = np.zeros(total), np.zeros(count, np.bool_), np.zeros(count)
    struck, given = np.zeros(len(num), np.bool_), np.zeros((count, 6))
    closing, chosen, near = speeds.copy(), np.zeros(count, np.int64), np.zeros(count, np.bool_)
    written, done = 0, 0
    while done <= passes:
        fast, number = 0.0, 0
        for c in range(count):
            if kind[c] == CONTACT and -closing[c] > slowest:
                fast = max(fast, -closing[c])
                for t in trees[c]:
                    if t >= 0 and spreads[t]:
                        struck[t] = True
        if fast == 0.0:
            break
        last = done == passes
        for c in range(count):
            for t in trees[c]:
                near[c] |= t >= 0 and struck[t]
            if not near[c]:
                continue
            if not built[c]:
                _build(c, rows, sizes, trees, adr, num, low, lows, model, jacobian, jac, ans, blocks, dofs, spans)
                built[c] = True
                kept[c] = closing[c]
            # What gives nothing back stays in contact with what is struck, and takes part at once.
            stays = last or kind[c] != CONTACT or bounce[c] == 0.0
            if blocks[c, 0, 0] > 0.0 and (stays or -closing[c] > slowest):
                chosen[number] = c
                number += 1
        active = chosen[:number]
        before = given.copy()
        share = np.zeros(count) if last else bounce
        _strike(active, kind, sizes, friction, share, jac, ans, blocks, dofs, spans, v, kept, fast, given)
        for c in range(count):
            if not near[c]:
                continue
            closing[c] = _speed(jac[c, 0], spans[c], dofs[c], v)
            if kind[c] == CONTACT and given[c, 0] > before[c, 0] and written < len(told):
                told[written, 0], told[written, 1] = c, done
                for s in range(min(3, sizes[c])):
                    told[written, 2 + s] = given[c, s] - before[c, s]
                written += 1
        done += 1
    for c in range(count):
        for s in range(sizes[c]):
            impulse[rows[c] + s] = given[c, s]
    return written
