"""Wrenches of coupled solvers on the bodies, and the part of them that the engine integrated."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64
from .flex_loads import SoftLoads
from .rows import spread

if TYPE_CHECKING:
    from .parts import Parts

__all__ = ["Exchange"]


class Exchange:
    """One frame of pushes on all rows of an instance.

    Args:
        rows: number of moving bodies, pieces counted one by one.
        soft: loads on elastic members, where they are coupled.
    """

    def __init__(self, rows: int, soft: SoftLoads | None) -> None:
        self.received: F64 = np.zeros((rows, 6))
        """Since the start of the frame [N s, N m s]."""
        self.soft = soft
        self.asked: F64 | None = None
        """Wrenches about the rows' centres of mass that are given now, world axes, shape (rows, 6) [N, N m]."""
        self._wrench: F64 | None = None
        self._absorbed: F64 | None = None

    def begin(self) -> None:
        """Start a frame."""
        self.received[:] = 0.0
        if self.soft is not None:
            self.soft.begin()

    def give(self, data: Any, wrench: F64 | None, loads: Mapping[str, F64] | None) -> None:
        """Set the loads from now on: wrenches on rows, forces at the vertices of elastic entities, each (v, 3) [N]."""
        self.asked = wrench
        if self.soft is not None:
            self.soft.lay(data, loads or {})

    def end(self, data: Any) -> None:
        """Nothing is given any more."""
        if self.soft is not None:
            self.soft.lift(data)
        self.asked = self._wrench = None

    def apply(self, parts: Parts) -> None:
        """Write what is given into the state of a model.

        Bodies on paths, and pieces that the world holds, take what they are given without giving way: the engine need not know of it,
        nor their drivers' work.
        """
        if self.asked is None:
            return
        rigid = parts.rigid
        absorbs = np.array([name.split("/", 1)[0] in parts.drivers.kinematic for name in rigid.bodies], dtype=bool)
        absorbs |= rigid.model.body_dofnum[rigid.body_ids] == 0
        self._wrench = np.where(absorbs[:, None], 0.0, self.asked)
        self._absorbed = np.where(absorbs[:, None], self.asked, 0.0)
        parts.data.xfrc_applied += self._on_bodies(parts)

    def outside(self, parts: Parts) -> F64 | None:
        """Present wrenches of others on all bodies of the model, shape (nbody, 6): their work is no driver's."""
        return None if self._wrench is None else self._on_bodies(parts)

    def _on_bodies(self, parts: Parts) -> F64:
        assert self._wrench is not None
        found = spread(parts.rigid, parts.data, self._wrench)
        return found if self.soft is None else found + self.soft.wrench

    def step(self, parts: Parts, dt: float) -> None:
        """Count a step: what the engine integrated, less what drivers and fields pushed, not what others say they gave."""
        if self._wrench is not None:
            self.received += dt * self._taken_in(parts)

    def taken(self, parts: Parts, seconds: float) -> None:
        """Count what elastic members took over some steps."""
        if self.soft is not None:
            self.soft.take(parts.data.xfrc_applied - parts.work.pushes, parts.data, seconds)

    def _taken_in(self, parts: Parts) -> F64:
        """Wrenches of others that the engine integrates in this step, per row."""
        assert self._wrench is not None
        rigid, fields = parts.rigid, parts.fields
        applied, ids = parts.data.xfrc_applied - parts.work.pushes, rigid.body_ids
        own = applied[ids]
        if self.soft is not None:
            own -= self.soft.wrench[ids]
        if fields:
            own[:, :3] -= fields.present
            own[:, 3:] -= fields.turning
        pieces = rigid.kin_rows
        if pieces.any():
            # Pieces of one cluster are pushed together: what the cluster got is theirs as it was given, and its first one's if more.
            own[pieces] = self._wrench[pieces]
            total = np.zeros((rigid.model.nbody, 3))
            np.add.at(total, ids, own[:, :3] + (fields.present if fields else 0.0))
            bodies, first = np.unique(np.where(pieces, ids, -1), return_index=True)
            own[first[bodies > 0], :3] += (applied[:, :3] - total)[bodies[bodies > 0]]
        return np.asarray(own + self._absorbed)
