"""Rows of the cache against bodies of the model: pieces that are bonded to one another share a body."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64, cross

if TYPE_CHECKING:
    from .model import RigidModel

__all__ = ["row_arms", "row_centers", "row_velocities", "spread"]


def row_centers(rigid: RigidModel, data: Any) -> F64:
    """Centres of mass of the rows in the world [m], shape (n, 3)."""
    ids = rigid.body_ids
    if not rigid.kin_rows.any():
        return np.asarray(data.xipos[ids])
    turn = data.xmat[ids].reshape(-1, 3, 3)
    return np.asarray(data.xpos[ids] + np.einsum("nij,nj->ni", turn, rigid.centers - rigid.offsets))


def row_arms(rigid: RigidModel, data: Any) -> F64:
    """From the centres of mass of the model's bodies to those of the rows, world axes [m], shape (n, 3)."""
    return np.asarray(row_centers(rigid, data) - data.xipos[rigid.body_ids])


def spread(rigid: RigidModel, data: Any, wrench: F64) -> F64:
    """Wrenches about the rows' centres of mass, shape (n, 6), summed over the model's bodies, shape (nbody, 6)."""
    total = np.zeros((rigid.model.nbody, 6))
    if not rigid.kin_rows.any():
        total[rigid.body_ids] = wrench
        return total
    moved = wrench.copy()
    moved[:, 3:] += cross(row_arms(rigid, data), wrench[:, :3])
    np.add.at(total, rigid.body_ids, moved)
    return total


def row_velocities(rigid: RigidModel, data: Any, speeds: tuple[F64, F64]) -> F64:
    """Velocities of the rows' centres of mass, shape (n, 3), from those of the model's bodies and their spins."""
    ids = rigid.body_ids
    linear, angular = speeds[0][ids], speeds[1][ids]
    if not rigid.kin_rows.any():
        return np.asarray(linear)
    own = np.flatnonzero(rigid.kin_rows)
    turn = data.xmat[ids[own]].reshape(-1, 3, 3)
    arm = np.einsum("nij,nj->ni", turn, (rigid.centers - rigid.offsets)[own])
    linear[own] += cross(angular[own], arm)
    return np.asarray(linear)
