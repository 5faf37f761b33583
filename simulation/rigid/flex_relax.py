"""Opening the collision skins of elastic bodies at frame 0: each is moved as a whole, so that none starts deformed."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from .sides import sides_of

if TYPE_CHECKING:
    from .model import RigidModel

__all__ = ["freeze_flexes", "lift_flexes"]

ROUNDS = 60
"""Most moves of one body; a corner takes three."""
CLOSE = 0.01
"""Ends when no contact lies deeper inside the summed skins than this fraction of them."""
HEAVY = 1e6
"""Armature of nodes [kg] while rigid bodies open their skins to them."""


def lift_flexes(rigid: RigidModel, data: Any) -> float:
    """Move elastic bodies that nothing pins out of the skins of fixed things and of each other; returns the farthest move [m]."""
    import mujoco

    model = rigid.model
    margin = np.append(model.geom_margin, model.flex_margin)
    farthest = 0.0
    for index, body in enumerate(rigid.flexes):
        nodes = np.array([model.body(n).id for n, w in zip(body.carriers, body.lattice.used, strict=True) if w])
        dofs = model.body_dofadr[nodes]
        if (dofs < 0).any() or body.physics.pins:
            continue
        moved = np.zeros(3)
        side = model.ngeom + index
        for _ in range(ROUNDS):
            mujoco.mj_fwdPosition(model, data)
            step = _way_out(model, data, side, margin)
            if step is None:
                break
            moved += step
            for axis in range(3):
                data.qpos[model.jnt_qposadr[model.dof_jntid[dofs + axis]]] += step[axis]
        farthest = max(farthest, float(np.linalg.norm(moved)))
    return farthest


def _way_out(model: Any, data: Any, side: int, margin: Any) -> Any:
    """Move that opens the deepest contact of an elastic body with what does not give way, or None, shape (3,) [m]."""
    if not data.ncon:
        return None
    sides = sides_of(model, data.contact)
    other = np.where(sides[:, 0] == side, sides[:, 1], sides[:, 0])
    mine = (sides == side).any(axis=1) & (other != side)
    # Rigid bodies that move open their own skins; of two elastic ones the later gives way.
    geom = np.minimum(other, model.ngeom - 1)
    loose = (other < model.ngeom) & (model.body_treeid[model.geom_bodyid[geom]] >= 0)
    mine &= ~loose & ~((other >= model.ngeom) & (other > side))
    depth = np.where(mine, margin[sides].sum(axis=1) - data.contact.dist, 0.0)
    worst = int(depth.argmax())
    if depth[worst] <= CLOSE * margin[sides[worst]].sum():
        return None
    sign = 1.0 if sides[worst, 1] == side else -1.0
    return sign * depth[worst] * data.contact.frame[worst].reshape(-1)[:3]


def freeze_flexes(rigid: RigidModel) -> Callable[[], None]:
    """Make nodes too heavy to be moved; returns what undoes it."""
    model = rigid.model
    own = [model.body(n).id for f in rigid.flexes for n in f.own]
    dofs = np.array([d for b in own for d in range(model.body_dofadr[b], model.body_dofadr[b] + 3)], dtype=np.int64)
    before, m0 = model.dof_armature[dofs].copy(), model.dof_M0[dofs].copy()
    model.dof_armature[dofs] += HEAVY
    model.dof_M0[dofs] += HEAVY

    def undo() -> None:
        model.dof_armature[dofs], model.dof_M0[dofs] = before, m0

    return undo
