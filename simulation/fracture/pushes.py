"""Forces of contacts, coupled solvers and what lies asleep on them on the pieces of an instance."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64, cross
from .pieces import COUPLED, NO_CAUSE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..rigid.model import RigidModel
    from .pieces import Pieces

__all__ = ["Pushed", "Pushes"]


class Pushed(NamedTuple):
    """Pushes on n pieces in a step."""

    force: F64
    """Forces and torques about the pieces' centres, entity's frame, shape (n, 6)."""
    cause: Any
    """Collider that pushes each piece most; -1: none, shape (n,)."""
    tree: Any
    """Tree of the model that it belongs to; -1: it cannot move, shape (n,)."""


class Pushes:
    """Forces on the pieces of all breakable members, counted through.

    Args:
        entities: the members.
    """

    def __init__(self, entities: Sequence[Pieces]) -> None:
        self._entities = entities
        counts = [len(e.mass) for e in entities]
        self.first = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        """First piece of each entity, and the number of all."""
        count = int(self.first[-1])
        self._pressing: F64 = np.zeros((count, 6))
        """Contact force on each piece in the last step in which it had one."""
        self._partner = np.full(count, NO_CAUSE, dtype=np.int64)
        """Tree of the model that a piece touched then; -1: none, or none that may sleep."""

    def bind(self, rigid: RigidModel) -> None:
        """Work with this model, to whose bodies the pieces are bound."""
        model = rigid.model
        self._piece_of_geom = np.full(model.ngeom, -1, dtype=np.int64)
        row = {name: k for k, name in enumerate(rigid.bodies)}
        entities = self._entities
        self._rows = np.array([row[f"{e.built.entity}/{b.name}"] for e in entities for b in e.built.bodies], dtype=np.int64)
        self._ids = np.concatenate([e.ids for e in entities]) if entities else np.zeros(0, dtype=np.int64)
        self._arms = np.concatenate([e.centers - e.middle for e in entities]) if entities else np.zeros((0, 3))
        self._collider_of_geom = rigid.geom_collider
        self._tree_of_geom = model.body_treeid[model.geom_bodyid]
        self._tree = np.array(model.body_treeid)[self._ids]
        # Another model has other trees, all of them awake.
        self._partner[:] = NO_CAUSE
        for entity, first in zip(entities, self.first.tolist(), strict=False):
            place = {b.name: k for k, b in enumerate(entity.built.bodies)}
            for part in entity.built.parts:
                k = place[part.body]
                if entity.label[k] < len(entity.bonded):  # what is loose has no bonds to load
                    for index in range(len(part.collision)):
                        geom = model.geom(f"{entity.built.entity}/{part.part}/{index}").id
                        self._piece_of_geom[geom] = first + k

    def sleepers(self) -> tuple[F64, Any]:
        """Forces of bodies that lie on the pieces and may be asleep, for `lay`."""
        return self._pressing.copy(), self._partner.copy()

    def lay(self, sleepers: tuple[F64, Any]) -> None:
        """Put back what lay on the pieces of the same model."""
        self._pressing, self._partner = sleepers[0].copy(), sleepers[1].copy()

    def found(self, data: Any, others: F64 | None) -> tuple[Pushed, Pushed]:
        """Pushes on the pieces in a step whose contacts are solved, and how much of them the bonds feel: where a piece or what lies on it
        sleeps, whose contacts are not listed, the last forces."""
        pushed = self._contacts(data)
        if others is not None:
            pushed = self._with_coupled(pushed, others, data)
        resting = self._asleep(self._partner, data) | self._asleep(self._tree, data)
        if not resting.any():
            return pushed, pushed
        force = pushed.force.copy()
        resting &= ~force.any(axis=1)
        force[resting] = self._pressing[resting]
        return pushed, pushed._replace(force=force)

    def remember(self, pushed: Pushed, data: Any) -> None:
        """Keep the contacts of this step for when they are no longer listed; what is awake and touches nothing has none."""
        gone = (self._tree >= 0) & ~self._asleep(self._tree, data) & ~self._asleep(self._partner, data)
        self._pressing[gone], self._partner[gone] = 0.0, NO_CAUSE
        touched = pushed.force.any(axis=1)
        self._pressing[touched], self._partner[touched] = pushed.force[touched], pushed.tree[touched]

    def in_world(self, force: F64, data: Any) -> F64:
        """Forces and torques on all pieces, shape (n, 6), from the entities' axes to the world's."""
        out = np.zeros_like(force)
        rows = np.flatnonzero(force.any(axis=1))
        turn, _ = self._placed(data, rows)
        out[rows] = (turn[:, None] @ force[rows].reshape(-1, 2, 3, 1)).reshape(-1, 6)
        return out

    @staticmethod
    def _asleep(trees: Any, data: Any) -> Any:
        """Which of these trees sleep; -1 is none."""
        asleep = data.tree_asleep
        if not (asleep >= 0).any():
            return np.zeros(len(trees), dtype=bool)
        return (trees >= 0) & (asleep[np.maximum(trees, 0)] >= 0)

    def _placed(self, data: Any, piece: Any) -> tuple[F64, F64]:
        """Rotations (m, 3, 3) and centres (m, 3) of pieces in the world."""
        ids = self._ids[piece]
        turn = data.xmat[ids].reshape(-1, 3, 3)
        return turn, data.xpos[ids] + (turn @ self._arms[piece][:, :, None])[:, :, 0]

    def _contacts(self, data: Any) -> Pushed:
        """Pushes of contacts on the pieces."""
        count = int(self.first[-1])
        none = np.full(count, NO_CAUSE)
        total, cause, tree = Pushed(np.zeros((count, 6)), none, none.copy())
        if not data.ncon or not data.nefc:
            return Pushed(total, cause, tree)
        contact = data.contact
        geoms, rows = contact.geom, contact.efc_address
        hit = np.flatnonzero((self._piece_of_geom[geoms] >= 0).any(axis=1) & (rows >= 0))
        hit = hit[data.efc_force[rows[hit]] != 0.0]
        geoms, rows, sizes = geoms[hit], rows[hit], contact.dim[hit]
        frames, points = contact.frame[hit].reshape(-1, 3, 3), contact.pos[hit]
        force = _along(data.efc_force[rows[:, None] + np.arange(3)], frames)
        moment = np.zeros_like(force)
        rolling = np.flatnonzero(sizes > 3)
        moment[rolling] = _along(data.efc_force[rows[rolling, None] + np.arange(3, 6)], frames[rolling])
        at, side = np.nonzero(self._piece_of_geom[geoms] >= 0)
        piece, sign = self._piece_of_geom[geoms[at, side]], 2.0 * side[:, None] - 1.0
        turn, origin = self._placed(data, piece)
        local = _along(sign * force[at], turn)
        twist = _along(sign * moment[at], turn) + cross(_along(points[at] - origin, turn), local)
        np.add.at(total, piece, np.concatenate([local, twist], axis=1))
        strength = np.linalg.norm(local, axis=1)
        order = np.argsort(strength, kind="stable")
        order = order[strength[order] > 0]
        strongest = geoms[at[order], 1 - side[order]]
        cause[piece[order]], tree[piece[order]] = self._collider_of_geom[strongest], self._tree_of_geom[strongest]
        return Pushed(total, cause, tree)

    def _with_coupled(self, pushed: Pushed, others: F64, data: Any) -> Pushed:
        """Contacts, and what liquids, cloth and grains do to the pieces: no collider of the instance is the cause of that."""
        given = others[self._rows]
        if not given.any():
            return pushed
        turn, _ = self._placed(data, np.arange(len(given)))
        own = np.concatenate([_along(given[:, :3], turn), _along(given[:, 3:], turn)], axis=1)
        more = np.linalg.norm(own[:, :3], axis=1) > np.linalg.norm(pushed.force[:, :3], axis=1)
        return Pushed(pushed.force + own, np.where(more, COUPLED, pushed.cause), pushed.tree)


def _along(vectors: F64, axes: F64) -> F64:
    """Sum of the rows of `axes`, shape (n, 3, 3), times the components of vectors, shape (n, 3): R^T v for a rotation R."""
    return np.asarray((vectors[:, None] @ axes)[:, 0])
