"""Triangles cut to the cells of a grid, heights and layers of floor in its columns. Compiled by numba, kept on disk.

Cells are flat indices i * ny + j; a piece is the part of a triangle within a cell.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .bounds import SEAM, VERTICAL

__all__ = ["floors_of", "heights_at", "outlines_of", "pieces_of", "placed"]

MOST = 7
"""Corners of a triangle that all four sides of a cell cut."""


@njit(cache=True)
def _uncut(corner, into):
    """A whole triangle, its corners in the order in which `_cut` leaves them."""
    for k in range(3):
        into[0, k], into[1, k] = corner[1, k], corner[1, k]
        into[2, k], into[3, k] = corner[2, k], corner[2, k]
        into[4, k], into[5, k], into[6, k] = corner[0, k], corner[0, k], corner[1, k]


@njit(cache=True)
def _cut(corner, x, y, cell, one, two):
    """Cut a triangle by the four sides of a cell at (x, y); the result is in `two`. Returns whether anything is left.

    Sutherland and Hodgman (1974), doi:10.1145/360767.360802; each side adds one corner, repeated ones fill the rest.
    """
    slack = SEAM * cell
    count, alive = 3, True
    for i in range(3):
        for k in range(3):
            one[i, k] = corner[i, k]
    for side in range(4):
        axis, sign = side // 2, 1.0 if side % 2 == 0 else -1.0
        low = x if axis == 0 else y
        bound = low - slack if side % 2 == 0 else low + cell + slack
        found = 0
        for i in range(count):
            j = i + 1 if i + 1 < count else 0
            here, there = sign * (one[i, axis] - bound), sign * (one[j, axis] - bound)
            inside, inside_after = here >= 0, there >= 0
            if inside != inside_after and found <= count:
                t = here / (here - there)
                for k in range(3):
                    two[found, k] = one[i, k] + t * (one[j, k] - one[i, k])
                found += 1
            if inside_after and found <= count:
                for k in range(3):
                    two[found, k] = one[j, k]
                found += 1
        alive = alive and found > 0
        if found == 0:  # as where all is cut away: the first corner's end stands for nothing
            return False
        count += 1
        for i in range(count):
            for k in range(3):
                one[i, k] = two[i, k] if i < found else two[0, k]
    for i in range(count):
        for k in range(3):
            two[i, k] = one[i, k]
    return alive


@njit(cache=True)
def _part(corner, x, y, cell, alone, one, two):
    """The part of a triangle within a cell, in `two`; returns whether it is not empty. `alone`: it lies in one cell.

    Most cells of a floor lie wholly inside one triangle, or wholly outside: only the others are cut.
    """
    if alone:
        _uncut(corner, two)
        return True
    slack = SEAM * cell
    left, right, front, back = x - slack, x + (cell + slack), y - slack, y + (cell + slack)
    a, b, c = corner[0], corner[1], corner[2]
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    flat = abs(area) > SEAM * cell * cell
    turn = 1.0 if area > 0 else (-1.0 if area < 0 else 0.0)
    whole, outside = True, False
    for k in range(3):
        p, q = (b, c) if k == 0 else ((c, a) if k == 1 else (a, b))
        most = -np.inf
        for m in range(4):
            at_x = left if m == 0 or m == 3 else right
            at_y = front if m < 2 else back
            weight = ((q[0] - p[0]) * (at_y - p[1]) - (q[1] - p[1]) * (at_x - p[0])) * turn
            most = max(most, weight)
            whole = whole and weight >= 0
        outside = outside or most < 0
    if flat and outside:
        return False
    if flat and whole:
        for m in range(4):
            at_x = left if m == 0 or m == 3 else right
            at_y = front if m < 2 else back
            height = 0.0
            for k in range(3):
                p, q = (b, c) if k == 0 else ((c, a) if k == 1 else (a, b))
                weight = ((q[0] - p[0]) * (at_y - p[1]) - (q[1] - p[1]) * (at_x - p[0])) * turn
                height += (weight / abs(area)) * corner[k, 2]
            two[m, 0], two[m, 1], two[m, 2] = at_x, at_y, height
        for m in range(4, MOST):
            for k in range(3):
                two[m, k] = two[0, k]
        return True
    inner = True
    for i in range(3):
        inner = inner and corner[i, 0] >= left and corner[i, 0] <= right and corner[i, 1] >= front and corner[i, 1] <= back
    if inner:
        _uncut(corner, two)
        return True
    return _cut(corner, x, y, cell, one, two)


@njit(cache=True)
def _plane(corner):
    """Normal of a triangle (not of length one), and whether it has heights."""
    ux, uy, uz = corner[1, 0] - corner[0, 0], corner[1, 1] - corner[0, 1], corner[1, 2] - corner[0, 2]
    vx, vy, vz = corner[2, 0] - corner[0, 0], corner[2, 1] - corner[0, 1], corner[2, 2] - corner[0, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    length = np.sqrt(nx * nx + ny * ny + nz * nz)
    return nx, ny, nz, abs(nz) > VERTICAL * max(length, 1e-300)


@njit(cache=True)
def _height(corner, area, x, y):
    """Height of a triangle's plane at a place, and whether the triangle covers it; `area` is z of its normal."""
    a, b, c = corner[0], corner[1], corner[2]
    wa = ((c[0] - b[0]) * (y - b[1]) - (c[1] - b[1]) * (x - b[0])) / area
    wb = ((a[0] - c[0]) * (y - c[1]) - (a[1] - c[1]) * (x - c[0])) / area
    wc = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
    return wa * a[2] + wb * b[2] + wc * c[2], min(min(wa, wb), wc) >= -SEAM


@njit(cache=True)
def pieces_of(
    triangles,
    solid,
    low,
    high,
    origin,
    cell,
    ny,
    cells,
    first,
    cell_of,
    triangle_of,
    lowest,
    highest,
    hits,
    heights,
    ups,
    slopes,
    met,
):
    """Cut all triangles to the cells that they reach into, in their order; returns the numbers of pieces and of hits.

    Pieces go into `cell_of`, `triangle_of`, `lowest` and `highest`; where the vertical line through a cell's centre meets a solid triangle goes
    into `hits` (cell), `heights`, `ups`, `slopes` (n, 2) and `met` (triangle). `first` gets the pieces of each cell, for `placed`.
    """
    one, two = np.empty((MOST, 3)), np.empty((MOST, 3))
    pieces = found = 0
    for t in range(len(triangles)):
        corner = triangles[t]
        alone = low[t, 0] == high[t, 0] and low[t, 1] == high[t, 1]
        nx, ny_, nz, level = _plane(corner)
        for i in range(low[t, 0], high[t, 0] + 1):
            for j in range(low[t, 1], high[t, 1] + 1):
                at = i * ny + j
                if _part(corner, origin[0] + cell * i, origin[1] + cell * j, cell, alone, one, two):
                    below = above = two[0, 2]
                    for m in range(1, MOST):
                        below, above = min(below, two[m, 2]), max(above, two[m, 2])
                    cell_of[pieces], triangle_of[pieces], lowest[pieces], highest[pieces] = at, t, below, above
                    first[at + 1] += 1
                    pieces += 1
                if level and solid[t]:
                    x, y = origin[0] + cell * (i + 0.5), origin[1] + cell * (j + 0.5)
                    z, covered = _height(corner, nz, x, y)
                    if covered:
                        hits[found], heights[found], ups[found], met[found] = at, z, nz > 0, t
                        slopes[found, 0], slopes[found, 1] = -nx / nz, -ny_ / nz
                        found += 1
    for at in range(cells):
        first[at + 1] += first[at]
    return pieces, found


@njit(cache=True)
def placed(cell, first):
    """Order of pieces by cell, those of one cell as they came; `first` is the first of each cell."""
    order, free = np.empty(len(cell), np.intp), first.copy()
    for k in range(len(cell)):
        order[free[cell[k]]] = k
        free[cell[k]] += 1
    return order


@njit(cache=True)
def outlines_of(triangles, low, high, origin, cell, ny, cell_of, triangle_of, into):
    """Corners of some pieces in the xy plane, shape (n, 7, 2), padded by repetition, into `into`."""
    one, two = np.empty((MOST, 3)), np.empty((MOST, 3))
    for k in range(len(cell_of)):
        t, i, j = triangle_of[k], cell_of[k] // ny, cell_of[k] % ny
        alone = low[t, 0] == high[t, 0] and low[t, 1] == high[t, 1]
        _part(triangles[t], origin[0] + cell * i, origin[1] + cell * j, cell, alone, one, two)
        for m in range(MOST):
            into[k, m, 0], into[k, m, 1] = two[m, 0], two[m, 1]


@njit(cache=True)
def heights_at(triangles, gentle, tangent, cell, start, triangle_of, lowest, highest, cells, points, z, reach, found):
    """Height of the gentle floor nearest to z at each point within `reach`, into `found`; points outside (cell -1) and others keep theirs."""
    for k in range(len(points)):
        if cells[k] < 0:
            continue
        best = np.inf
        for piece in range(start[cells[k]], start[cells[k] + 1]):
            t = triangle_of[piece]
            if not gentle[t] or max(lowest[piece] - z[k], z[k] - highest[piece]) > reach + cell:
                continue
            nx, ny, nz, level = _plane(triangles[t])
            if not level or nz <= 0 or np.hypot(-nx / nz, -ny / nz) > tangent:
                continue
            height, covered = _height(triangles[t], nz, points[k, 0], points[k, 1])
            off = abs(height - z[k])
            if covered and off <= reach and off < best:
                best, found[k] = off, height


@njit(cache=True)
def floors_of(cell, z, up, gentle, closed, step, same, floor, blocked):
    """Marks hits (sorted by cell and height) that are floor, and those of them that lie inside a body or below a low thing.

    Args:
        cell, z, up, gentle, closed: of each hit: its cell, height [m], and whether it faces up, is no steeper than a carrier takes, and is of
            a closed surface.
        step: what a carrier steps over [m].
        same: surfaces closer than this are one [m].
        floor, blocked: the marks.
    """
    count = len(cell)
    stepped, covered = np.zeros(count, np.bool_), np.zeros(count, np.bool_)
    for i in range(count):
        seen = False
        for j in range(i + 1, count):
            if cell[j] != cell[i]:
                break
            rise = z[j] - z[i]
            if rise > same:
                if rise <= step:
                    covered[i] = covered[i] or up[j]
                    blocked[i] = blocked[i] or not up[j]
                    stepped[j] = stepped[j] or gentle[i]
                # The first surface above that faces up means that the node lies inside the body that it belongs to.
                if not seen:
                    blocked[i] = blocked[i] or (up[j] and closed[j])
                    seen = True
            elif up[i] and up[j]:
                covered[i] = True
    for i in range(count):
        floor[i] = up[i] and not covered[i] and (gentle[i] or stepped[i])
