"""Answers of bodies of a rigid instance to pushes: velocity per impulse and angular velocity per angular impulse, each by itself.

What stands on a floor does not give way to what presses it down, and what hangs on a hinge gives way along its arc only. A coupled solver
that took such bodies for free ones would let them give way until the next exchange, in every exchange anew: water sinks through the
bottom of a light glass on a table.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64
from .rows import row_arms, row_centers

if TYPE_CHECKING:
    from .model import RigidModel

__all__ = ["alone", "held"]

MOST_DOFS = 600
"""Own choice: bodies of larger islands answer as if nothing else held them; solving for one of 600 degrees of freedom takes some 5 ms."""


def alone(mj: Any, model: Any, data: Any, rigid: RigidModel, fixed: Collection[str]) -> tuple[F64, F64, F64]:
    """1/mass (n,), inverse inertia (n, 3, 3) and velocity per impulse (n, 3, 3) of each row, whatever touches it.

    What hangs on joints answers with its whole tree; its 1/mass is the mean over the directions. A piece answers with its cluster, as if
    all pieces of that were pushed by their share of the mass: M / m times the cluster's answer at the piece. By Cauchy-Schwarz that is
    never less than how the cluster gives way when many are pushed at once, so that a coupled solver which solves for its pieces one by one
    stays stable; a piece by itself answers as any body.

    Args:
        mj: the module `mujoco`.
        model: the compiled model.
        data: its state, with what `mj_forward` makes.
        rigid: rows of the model.
        fixed: entities that drivers hold: they do not answer.
    """
    ids = rigid.body_ids
    turn = data.ximat[ids].reshape(-1, 3, 3)
    light, inverse, linear = np.zeros(len(ids)), np.zeros((len(ids), 3, 3)), np.zeros((len(ids), 3, 3))
    arms, own, pieces = row_arms(rigid, data), rigid.masses, rigid.kin_rows
    for row, body in enumerate(ids.tolist()):
        if rigid.bodies[row].split("/", 1)[0] in fixed or model.body_dofnum[body] == 0:
            continue
        free = model.jnt_type[model.body_jntadr[body]] == mj.mjtJoint.mjJNT_FREE
        if free and model.body_subtreemass[body] <= model.body_mass[body] * (1 + 1e-9):
            light[row] = 1.0 / model.body_mass[body]
            inverse[row] = (turn[row] / model.body_inertia[body]) @ turn[row].T
            if pieces[row]:
                # Of [r]^T I^-1 [r], the answer at a distance r from the centre, the mean over the directions.
                square, along = float(arms[row] @ arms[row]), float(arms[row] @ inverse[row] @ arms[row])
                light[row] += (square * float(np.trace(inverse[row])) - along) / 3.0
                share = model.body_mass[body] / own[row]
                light[row], inverse[row] = share * light[row], share * inverse[row]
            linear[row] = light[row] * np.eye(3)
            continue
        ways = np.zeros((6, model.nv))
        mj.mj_jacBodyCom(model, data, ways[:3], ways[3:], body)
        answer = np.zeros_like(ways)
        mj.mj_solveM(model, data, answer, ways)
        linear[row], inverse[row] = ways[:3] @ answer[:3].T, ways[3:] @ answer[3:].T
        light[row] = float(np.trace(linear[row])) / 3.0
    return light, inverse, linear


def held(mj: Any, model: Any, data: Any, rigid: RigidModel, linear: F64, angular: F64) -> None:
    """Replace answers of rows that contacts, limits and friction hold at present, in place, by those of the rows with these.

    Velocities per impulse are J H^-1 J^T, with the Hessian H = M + C^T D C of what the engine minimises (Todorov, 2014,
    doi:10.1109/ICRA.2014.6907751), over the constraints C that are active without what the coupled solvers give. Of contacts that slide
    the normal row counts. A push that opens a contact is answered from the next exchange on.

    Args:
        mj: the module `mujoco`.
        model: the compiled model.
        data: its state after `mj_forward`.
        rigid: rows of the model.
        linear: velocity per impulse of each row, (n, 3, 3) [1/kg].
        angular: angular velocity per angular impulse, (n, 3, 3) [1/(kg m^2)].
    """
    if not data.nisland:
        return
    ids = rigid.body_ids
    first = model.body_dofadr[ids]
    moved = (first >= 0) & (linear != 0.0).any(axis=(1, 2))
    island = np.where(moved, data.dof_island[np.maximum(first, 0)], -1)
    wanted = np.flatnonzero(np.bincount(island[island >= 0], minlength=data.nisland))
    blocks = _hessians(mj, model, data, wanted)
    centers, way = row_centers(rigid, data), np.zeros((6, model.nv))
    for row in np.flatnonzero(np.isin(island, list(blocks))).tolist():
        body, (dofs, inverse) = int(ids[row]), blocks[int(island[row])]
        mj.mj_jac(model, data, way[:3], way[3:], centers[row], body)
        answer = way[:, dofs] @ inverse @ way[:, dofs].T
        share = model.body_mass[body] / rigid.masses[row] if rigid.kin_rows[row] else 1.0
        linear[row] = 0.5 * share * (answer[:3, :3] + answer[:3, :3].T)
        angular[row] = 0.5 * share * (answer[3:, 3:] + answer[3:, 3:].T)


def _hessians(mj: Any, model: Any, data: Any, wanted: Any) -> dict[int, tuple[Any, F64]]:
    """Degrees of freedom and inverse Hessian of islands, by island; those without active constraints and larger ones are left out."""
    of_dof, active = data.dof_island, _active(mj, data)
    ours = np.isin(of_dof, wanted)
    place = np.zeros(model.nv, dtype=np.intp)
    members = {k: np.flatnonzero(of_dof == k) for k in wanted.tolist()}
    for dofs in members.values():
        place[dofs] = np.arange(len(dofs))
    value, row, column = _jacobian(mj, model, data)
    kept = active[row] & ours[column]
    value, row, column = value[kept], row[kept], column[kept]
    weight, i, j = _inertia(model, data)
    kept = ours[i]
    weight, i, j = weight[kept], i[kept], j[kept]
    found = {}
    for which, dofs in members.items():
        rows = np.flatnonzero(active & (data.efc_island == which))
        if not len(rows) or len(dofs) > MOST_DOFS:
            continue
        mine, own = of_dof[column] == which, of_dof[i] == which
        ways, mass = np.zeros((len(rows), len(dofs))), np.zeros((len(dofs), len(dofs)))
        ways[np.searchsorted(rows, row[mine]), place[column[mine]]] = value[mine]
        mass[place[i[own]], place[j[own]]] = weight[own]
        mass[place[j[own]], place[i[own]]] = weight[own]
        found[which] = (dofs, np.linalg.inv(mass + ways.T @ (data.efc_D[rows, None] * ways)))
    return found


def _active(mj: Any, data: Any) -> Any:
    """Constraint rows that resist a change, (nefc,); of contacts that slide the first."""
    states, state = mj.mjtConstraintState, data.efc_state
    first = np.zeros(data.nefc, dtype=bool)
    address = data.contact.efc_address
    first[address[address >= 0]] = True
    return (state == int(states.mjCNSTRSTATE_QUADRATIC)) | ((state == int(states.mjCNSTRSTATE_CONE)) & first)


def _jacobian(mj: Any, model: Any, data: Any) -> tuple[F64, Any, Any]:
    """Jacobian of all constraint rows: values, rows and columns of its entries, each (k,)."""
    if mj.mj_isSparse(model):
        return _entries(data.efc_J, data.efc_J_rowadr, data.efc_J_rownnz, data.efc_J_colind)
    whole = data.efc_J.reshape(data.nefc, model.nv)
    row, column = np.nonzero(whole)
    return whole[row, column], row, column


def _inertia(model: Any, data: Any) -> tuple[F64, Any, Any]:
    """Lower half of the inertia of all degrees of freedom: values, rows and columns of its entries, each (k,)."""
    return _entries(data.M, model.M_rowadr, model.M_rownnz, model.M_colind)


def _entries(values: F64, first: Any, count: Any, column: Any) -> tuple[F64, Any, Any]:
    """Entries of rows that lie one behind the other."""
    row = np.repeat(np.arange(len(count)), count)
    at = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)
    return np.asarray(values)[at], row, np.asarray(column)[at]
