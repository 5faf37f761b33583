"""Contacts and distances of present positions, apart from the steps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .holds import FIXED
from .sides import sides_of

if TYPE_CHECKING:
    from .model import RigidModel

__all__ = ["collide_all", "nearest", "settle_kinematics"]

GUARD = 2e-4
"""Listed contacts closer than this [m] are measured again before a frame is accepted."""
CLEAR = 1e-7
"""Least accepted distance of visible surfaces at a frame [m]: covers the tolerance of GJK (1e-6 of it matters nowhere)."""


def settle_kinematics(model: Any, data: Any) -> None:
    """Bring positions and velocities of bodies up to date with the state, sleeping ones included."""
    import mujoco

    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_comVel(model, data)
    if model.nflex:
        mujoco.mj_flex(model, data)
    if model.ntendon:
        mujoco.mj_tendon(model, data)


def collide_all(model: Any, data: Any) -> None:
    """List the contacts of the present positions, those among sleeping bodies included."""
    import mujoco

    flags = model.opt.enableflags
    model.opt.enableflags = flags & ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    mujoco.mj_collision(model, data)
    model.opt.enableflags = flags


def nearest(rigid: RigidModel, data: Any) -> float:
    """Smallest distance [m] of collision shapes at the present positions, less what visible surfaces stick out.

    What the collision functions list as closer than `GUARD` is measured again by GJK and EPA, which are exact. Pieces of one
    breakable body may lie in one another as deep as crumbles.
    """
    import mujoco

    model = rigid.model
    collide_all(model, data)
    if not data.ncon:
        return np.inf
    geoms = sides_of(model, data.contact).copy()
    fixed = (np.append(model.geom_contype, model.flex_contype)[geoms] == FIXED[0]).all(axis=1)
    kin = rigid.law.kin
    slack = np.zeros(len(geoms)) if kin is None else kin.overlap_of(geoms)
    gaps = data.contact.dist - rigid.excess[geoms].sum(axis=1) + slack
    close = np.unique(geoms[(gaps < GUARD) & ~fixed], axis=0)
    found, witness = np.inf, np.zeros(6)
    height_field = int(mujoco.mjtGeom.mjGEOM_HFIELD)
    for g, h in close.tolist():
        # Of height fields and elastic bodies there is no more than what is listed.
        if max(g, h) >= model.ngeom or height_field in (model.geom_type[g], model.geom_type[h]):
            mine = (geoms == (g, h)).all(axis=1)
            gap = float(gaps[mine].min())
        else:
            gap = mujoco.mj_geomDistance(model, data, g, h, 2 * GUARD, witness) - float(rigid.excess[[g, h]].sum())
            gap += 0.0 if kin is None else float(kin.overlap_of(np.array([[g, h]]))[0])
        found = min(found, gap - CLEAR)
    return float(found)
