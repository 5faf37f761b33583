"""Points of contact of round bodies: on their surface.

The engine puts the point of a contact midway between two surfaces, which two skins keep apart: a ball rolls as if its radius were
larger by a skin, so that one of 10 mm sped down a slope by 2.7 per cent too fast. Between two bodies no point is on both surfaces;
it goes to that of the rounder one, whose rolling depends on it, and stays in the middle between equals. The other side gets its
friction as far from its surface as the two are apart, at the same point, so that angular momentum is kept.
"""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["ContactPoints"]


class ContactPoints:
    """Moves the points of a step's contacts.

    Args:
        model: the compiled model.
    """

    def __init__(self, model: Any) -> None:
        import mujoco

        kinds = mujoco.mjtGeom
        rank = {int(kinds.mjGEOM_SPHERE): 3, int(kinds.mjGEOM_CAPSULE): 2, int(kinds.mjGEOM_CYLINDER): 1}
        self.model = model
        self._round = np.array([rank.get(int(kind), 0) for kind in model.geom_type], dtype=np.int64)
        self._last = np.full(model.nbody, -1, dtype=np.int64)
        for body in range(1, model.nbody):
            own = int(model.body_dofnum[body])
            self._last[body] = model.body_dofadr[body] + own - 1 if own else self._last[model.body_parentid[body]]
        self._parent = model.dof_parentid.astype(np.int64)
        self._dense = not mujoco.mj_isSparse(model)
        self._none = np.zeros(0, dtype=np.int32)
        self._any = bool(self._round.any()) and not model.nflex

    def apply(self, data: Any) -> None:
        """Move them; `data` is the state after `mj_step1`."""
        if not self._any or not data.ncon or not data.nefc:
            return
        contact = data.contact
        sides = self._round[contact.geom]
        towards = sides[:, 1] - sides[:, 0]
        rows = contact.efc_address
        which = np.flatnonzero((towards != 0) & (rows >= 0) & (contact.dim >= 3))
        if not len(which):
            return
        from .point_kernels import move_points

        columns = (
            (self._none, self._none, self._none) if self._dense else (data.efc_J_rowadr, data.efc_J_rownnz, data.efc_J_colind)
        )
        points = contact.pos.copy()
        move_points(
            which,
            0.5 * contact.dist[which] * np.sign(towards[which]),
            rows,
            self.model.geom_bodyid[contact.geom],
            points,
            contact.frame,
            (self._last, self._parent, data.cdof),
            (data.efc_J, *columns, self.model.nv),
            data.qvel,
            data.efc_vel,
            data.efc_aref,
            data.efc_KBIP[:, 1].copy(),
        )
        contact.pos[:] = points
