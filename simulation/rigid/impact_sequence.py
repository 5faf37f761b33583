"""Impacts within a step: one after another, each with Coulomb's friction, none of which gives energy.

**Sequence.** All contacts that close are struck at once, and what their bodies close then is struck next, until nothing closes
faster than `rest_speed` (generalized reflections: B. Smith, D. M. Kaufman, E. Vouga, R. Tamstorf, E. Grinspun, *Reflections on
simultaneous impact*, ACM Transactions on Graphics 31 (2012), 10.1145/2185520.2185602). So a striker of n balls sends n out of a row,
whether they touch or not. A contact without restitution stays in touch with what is struck, and takes part at once.

**One impact** has Poisson's two phases: impulses that stop all of it, with friction against the slide that is left; and those of
restitution, e times the first along the normal, with friction anew (E. J. Routh, 1905). What is struck alone leaves with e times its
closing speed, and friction takes mu times the normal impulse of its slide, or all of it. A body in a wedge that its friction cones
close stays there: its impulses are bounded by those that stop it.

**Energy.** The first phase cannot give energy. The second can, with friction (T. R. Kane, 1984) or where restitutions differ; it is
then reduced to where both together give none.

The impulses act at the beginning of the step. What lasts, gravity and all other forces are solved for afterwards with the speeds that the impacts
leave: contacts that opened are asked for nothing but not to close.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ...worlds.arrays import F64

__all__ = ["PASSES", "Blow", "ImpactSequence"]

PASSES = 200
"""Most impacts one after another in a step; what closes then stops at once. A ball between two far heavier ones takes that many."""
TOLD = 50
"""Most impacts of single contacts that are told of one step, per contact."""


class Blow(NamedTuple):
    """The impacts of a step."""

    impulse: F64
    """Impulse per constraint row [N s], shape (nefc,)."""
    change: F64
    """Gain of speed along each row [m/s], shape (nefc,)."""
    push: F64
    """Generalized impulse [N s, N m s], shape (nv,)."""
    gained: F64
    """Change of the generalized velocity, shape (nv,)."""
    told: F64
    """Per impact of a contact, in order: its number, the turn of the step it is of, and its impulse along the axes of the contact [N s],
    shape (k, 5)."""


class ImpactSequence:
    """Finds the impulses of a step's impacts.

    Args:
        model: the compiled model.
    """

    def __init__(self, model: Any) -> None:
        import mujoco

        self.mj, self.model = mujoco, model
        self._dense = not mujoco.mj_isSparse(model)
        self._applied = np.zeros(model.nv)
        self._none = np.zeros(0, dtype=np.int32)

    def resolve(self, data: Any, slowest: float, restitution: F64) -> Blow | None:
        """The impacts of this step between rigid bodies, None where nothing closes fast enough.

        Args:
            data: state after `mj_step1`.
            slowest: closing speed from which on a contact is an impact [m/s].
            restitution: of each contact listed, shape (ncon,).
        """
        from .impact_kernels import resolve

        model, contact = self.model, data.contact
        live = np.flatnonzero((contact.efc_address >= 0) & (contact.flex < 0).all(axis=1))
        first = contact.efc_address[live]
        island = data.efc_island if data.nisland else np.zeros(data.nefc, dtype=np.int32)
        # Speeds are those half a step ago: half of the step's other forces have acted by now.
        before = data.qvel + 0.5 * model.opt.timestep * data.qacc_warmstart
        self.mj.mj_mulJacVec(model, data, speeds := np.zeros(data.nefc), before)
        impulse, told = np.zeros(data.nefc), np.zeros((TOLD * len(live), 5))
        after, written, bodies = before.copy(), 0, self._bodies(data)
        for which in np.unique(island[first[data.efc_vel[first] < -slowest]]).tolist():
            mine = live[island[first] == which]
            island_of = self._constraints(data, mine, np.flatnonzero(island == which), restitution)
            k = resolve(*island_of, speeds[island_of[0]], *bodies, after, slowest, PASSES, impulse, told[written:])
            told[written : written + k, 0] = mine[told[written : written + k, 0].astype(np.int64)]
            written += k
        if not impulse.any():
            return None
        change, push = np.zeros(data.nefc), np.zeros(model.nv)
        self.mj.mj_mulJacVec(model, data, change, after - before)
        self.mj.mj_mulJacTVec(model, data, push, impulse)
        return Blow(impulse, change, push, after - before, told[:written].copy())

    def _bodies(self, data: Any) -> tuple[Any, ...]:
        """Trees of the model with their inertia, and the Jacobian, as the kernel takes them."""
        model = self.model
        held = np.zeros(model.ntree, dtype=bool)
        held[model.body_treeid[(model.body_invweight0[:, 0] == 0.0) & (model.body_treeid >= 0)]] = True
        columns = (
            (self._none, self._none, self._none) if self._dense else (data.efc_J_rowadr, data.efc_J_rownnz, data.efc_J_colind)
        )
        inertia = (data.M, model.M_rownnz, model.M_rowadr, model.M_colind)
        jacobian = (data.efc_J, *columns, model.nv)
        return ~held, model.tree_dofadr.astype(np.int64), model.tree_dofnum.astype(np.int64), inertia, jacobian

    def _constraints(self, data: Any, contacts: Any, rows: Any, restitution: F64) -> tuple[Any, ...]:
        """Rows, sizes, kinds, friction, restitution and trees of the constraints of one island: its contacts, then what holds and stops."""
        from .impact_kernels import CONTACT, HOLDS, STOPS

        model, contact, kinds = self.model, data.contact, self.mj.mjtConstraint
        holds = data.efc_type[rows] == int(kinds.mjCNSTR_EQUALITY)
        more = rows[holds | (data.efc_type[rows] == int(kinds.mjCNSTR_LIMIT_JOINT))]
        their = self._trees_of(data, more)
        more, their = more[their[:, 0] >= 0], their[their[:, 0] >= 0]
        other = np.where(data.efc_type[more] == int(kinds.mjCNSTR_EQUALITY), HOLDS, STOPS)
        trees = np.sort(model.body_treeid[model.geom_bodyid[contact.geom[contacts]]], axis=1)[:, ::-1]
        return (
            np.concatenate([contact.efc_address[contacts], more]).astype(np.int64),
            np.concatenate([contact.dim[contacts], np.ones(len(more), dtype=np.int32)]).astype(np.int64),
            np.concatenate([np.full(len(contacts), CONTACT), other]).astype(np.int64),
            np.concatenate([contact.friction[contacts], np.zeros((len(more), 5))]),
            np.concatenate([restitution[contacts], np.zeros(len(more))]),
            np.concatenate([trees, their]).astype(np.int64),
        )

    def _trees_of(self, data: Any, rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """The one or two trees that each of these rows acts on, shape (n, 2); -1 where there are none, or more than two."""
        found = np.full((len(rows), 2), -1, dtype=np.int64)
        for i, row in enumerate(rows.tolist()):
            if self._dense:
                dofs = np.flatnonzero(data.efc_J.reshape(data.nefc, -1)[row])
            else:
                at = int(data.efc_J_rowadr[row])
                dofs = data.efc_J_colind[at : at + int(data.efc_J_rownnz[row])]
            own = np.unique(self.model.dof_treeid[dofs])
            if 0 < len(own) <= 2:
                found[i, : len(own)] = own
        return found

    def begin(self, blow: Blow, data: Any, dt: float) -> None:
        """Write what the step is solved for after its impacts: references at the speeds that they leave, their push beside other forces."""
        data.efc_aref[:] += blow.change * (1.0 / dt - data.efc_KBIP[:, 1])
        self._applied = data.qfrc_applied.copy()
        data.qfrc_applied[:] += blow.push / dt
        data.qacc_warmstart[:] += blow.gained / dt

    def settle(self, blow: Blow, data: Any, dt: float) -> None:
        """Count the impacts among the forces of contacts, once those of the step are found."""
        data.qfrc_applied[:] = self._applied
        data.qfrc_smooth[:] -= blow.push / dt
        data.qfrc_constraint[:] += blow.push / dt
        data.efc_force[:] += blow.impulse / dt
