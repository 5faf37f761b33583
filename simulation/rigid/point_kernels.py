"""Moving points of contact onto the surface of what is round. Compiled by numba, kept on disk; see `contact_points.py`."""

from __future__ import annotations

from numba import njit

__all__ = ["move_points"]


@njit(cache=True, nogil=True)
def move_points(which, shifts, rows, bodies, points, frames, chain, jacobian, qvel, speeds, asked, damping):
    """Move points of contact along their normals; written in place: points, tangential rows, their speeds and references.

    Args:
        which: contacts, shape (k,).
        shifts: along the normal of each [m], shape (k,).
        rows: first row of every contact, shape (n,).
        bodies: of every contact, shape (n, 2).
        points: of every contact [m], shape (n, 3).
        frames: its axes, the normal first, shape (n, 9).
        chain: of the model: last degree of freedom of each body (-1: none), the one before each, and the axes that they turn about.
        jacobian: values, row starts, row lengths, columns (empty where rows are full), and the number of degrees of freedom.
        qvel: generalized velocity.
        speeds: along every row.
        asked: reference acceleration of every row.
        damping: of every row [1/s].
    """
    last, parent, axes = chain
    values, row_adr, row_nnz, col, nv = jacobian
    for i in range(len(which)):
        c = which[i]
        nx, ny, nz = shifts[i] * frames[c, 0], shifts[i] * frames[c, 1], shifts[i] * frames[c, 2]
        points[c, 0] += nx
        points[c, 1] += ny
        points[c, 2] += nz
        for k in range(1, 3):
            tx, ty, tz = frames[c, 3 * k], frames[c, 3 * k + 1], frames[c, 3 * k + 2]
            x, y, z = ny * tz - nz * ty, nz * tx - nx * tz, nx * ty - ny * tx
            row, gained = rows[c] + k, 0.0
            for side in range(2):
                sign = 1.0 if side == 1 else -1.0
                dof = last[bodies[c, side]]
                while dof >= 0:
                    change = sign * (axes[dof, 0] * x + axes[dof, 1] * y + axes[dof, 2] * z)
                    if change != 0.0:
                        if len(col) == 0:
                            values[row * nv + dof] += change
                        else:
                            for at in range(row_adr[row], row_adr[row] + row_nnz[row]):
                                if col[at] == dof:
                                    values[at] += change
                                    break
                        gained += change * qvel[dof]
                    dof = parent[dof]
            speeds[row] += gained
            asked[row] -= damping[row] * gained
