"""Free rotation of rigid bodies: Euler's equations, integrated for many bodies at once."""

from __future__ import annotations

import numpy as np

from ...worlds.arrays import F64

__all__ = ["tumble"]

SUBSTEP = 0.1
"""[rad] Turn per substep; the classical Runge-Kutta scheme is then exact to 1e-7 per radian."""
MOST = 4000
"""Substeps at most: 400 rad in one frame."""


def tumble(turns: F64, spins: F64, inertia: F64, torque: F64, time: float) -> tuple[F64, F64]:
    """Orientation and angular velocity after `time` [s] under constant torques in world axes.

    Euler's equations in body axes, I w' = T - w x I w, with the orientation R' = R [w].

    Args:
        turns: body to world, shape (n, 3, 3).
        spins: world axes [rad/s], shape (n, 3).
        inertia: body axes [kg m^2], shape (n, 3, 3).
        torque: world axes [N m], shape (n, 3).
        time: [s].

    Returns:
        Orientations, shape (n, 3, 3), and angular velocities in world axes, shape (n, 3).
    """
    least = np.linalg.eigvalsh(inertia)[:, 0]
    way = np.linalg.norm(spins, axis=1) * time + 0.5 * np.linalg.norm(torque, axis=1) / least * time**2
    steps = 2 ** np.ceil(np.log2(np.clip(way / SUBSTEP, 1.0, MOST))).astype(int)
    out_turns, out_spins = np.empty_like(turns), np.empty_like(spins)
    for count in np.unique(steps):
        mine = steps == count
        out_turns[mine], out_spins[mine] = _integrate(turns[mine], spins[mine], inertia[mine], torque[mine], time, int(count))
    return out_turns, out_spins


def _integrate(turns: F64, spins: F64, inertia: F64, torque: F64, time: float, count: int) -> tuple[F64, F64]:
    inverse, h = np.linalg.inv(inertia), time / count
    local = np.einsum("nji,nj->ni", turns, spins)

    def slope(r: F64, w: F64) -> tuple[F64, F64]:
        load = np.einsum("nji,nj->ni", r, torque) - np.cross(w, np.einsum("nij,nj->ni", inertia, w))
        cross = np.zeros((len(w), 3, 3))
        cross[:, 2, 1], cross[:, 0, 2], cross[:, 1, 0] = w.T
        cross -= np.swapaxes(cross, 1, 2)
        return r @ cross, np.einsum("nij,nj->ni", inverse, load)

    for _ in range(count):
        r1, w1 = slope(turns, local)
        r2, w2 = slope(turns + 0.5 * h * r1, local + 0.5 * h * w1)
        r3, w3 = slope(turns + 0.5 * h * r2, local + 0.5 * h * w2)
        r4, w4 = slope(turns + h * r3, local + h * w3)
        turns = turns + h / 6.0 * (r1 + 2 * r2 + 2 * r3 + r4)
        local = local + h / 6.0 * (w1 + 2 * w2 + 2 * w3 + w4)
    return turns, np.einsum("nij,nj->ni", turns, local)
