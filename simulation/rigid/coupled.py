"""Bodies of a running rigid instance as coupled solvers meet them: where they are, how they move and how they answer a push."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64
from ..boundaries import BodyState, MovingSurface
from .contact_law import set_contact_law
from .records import velocities
from .rows import row_arms, row_centers, row_velocities

if TYPE_CHECKING:
    from .solver import SolverRigid

__all__ = ["RigidBodies"]

SHORT = 0.5
"""Part of the rigid step; equal steps of an exchange that is as long are no shorter. Contacts stop what closes within some of their
steps, so after an exchange of a microsecond they would tell accelerations of 1e6 m/s^2, and coupled solvers would go on with them for
milliseconds: accelerations are told as in a step of this length."""


class RigidBodies:
    """Reads the bodies of a running rigid instance without changing it.

    Pieces of a breakable body are rows of their own, whatever cluster they are in at present.
    """

    def __init__(self, solver: SolverRigid) -> None:
        import mujoco

        self._mj, self._solver = mujoco, solver
        self._model, self._probe = solver.model, mujoco.MjData(solver.model)

    def state(self) -> BodyState:
        """The moving bodies at present, one row per entry of `RigidModel.bodies`; held ones, and pieces that the world holds, do not react."""
        solver, data = self._solver, self._solver.data
        if self._model is not solver.model:
            self._model, self._probe = solver.model, self._mj.MjData(solver.model)
        ids = solver.rigid.body_ids
        rotation = data.xmat[ids].reshape(-1, 3, 3).copy()
        origin = data.xpos[ids] - np.einsum("nij,nj->ni", rotation, solver.rigid.offsets)
        speeds = velocities(solver.model, data)
        linear, angular = row_velocities(solver.rigid, data, speeds), speeds[1][ids]
        center = row_centers(solver.rigid, data).copy()
        mass, inertia = self._mobility()
        return BodyState(origin, rotation, center, linear, angular, mass, inertia, self._accelerations())

    def surfaces(self) -> dict[str, MovingSurface]:
        """Simulation vertices of elastic members at present."""
        return {} if self._solver.flexes is None else self._solver.flexes.surfaces(self._solver.data)

    def _mobility(self) -> tuple[F64, F64]:
        """1/mass (n,) and inverse inertia (n, 3, 3) of each body alone.

        What hangs on joints answers with its whole tree: the mean over the directions is taken for 1/mass. A piece answers with
        its cluster, as if all pieces of that were pushed by their share of the mass: M / m times the cluster's answer at the
        piece. By Cauchy-Schwarz that is never less than how the cluster gives way when many are pushed at once, so that a
        coupled solver which solves for its pieces one by one stays stable; a piece by itself answers as any body.
        """
        mujoco, solver = self._mj, self._solver
        model, data, ids = solver.model, solver.data, solver.rigid.body_ids
        turn = data.ximat[ids].reshape(-1, 3, 3)
        light, inverse = np.zeros(len(ids)), np.zeros((len(ids), 3, 3))
        fixed = solver.drivers.held(solver.time)
        arms, own, pieces = row_arms(solver.rigid, data), solver.rigid.masses, solver.rigid.kin_rows
        factored = False
        for row, body in enumerate(ids.tolist()):
            if solver.rigid.bodies[row].split("/", 1)[0] in fixed:
                continue
            if model.body_dofnum[body] == 0:
                continue
            free = model.jnt_type[model.body_jntadr[body]] == mujoco.mjtJoint.mjJNT_FREE
            if free and model.body_subtreemass[body] <= model.body_mass[body] * (1 + 1e-9):
                light[row] = 1.0 / model.body_mass[body]
                inverse[row] = (turn[row] / model.body_inertia[body]) @ turn[row].T
                if pieces[row]:
                    # Of [r]^T I^-1 [r], the answer at a distance r from the centre, the mean over the directions.
                    square, along = float(arms[row] @ arms[row]), float(arms[row] @ inverse[row] @ arms[row])
                    light[row] += (square * float(np.trace(inverse[row])) - along) / 3.0
                    share = model.body_mass[body] / own[row]
                    light[row], inverse[row] = share * light[row], share * inverse[row]
                continue
            if not factored:
                mujoco.mj_copyData(self._probe, model, data)
                mujoco.mj_crb(model, self._probe)
                mujoco.mj_factorM(model, self._probe)
                factored = True
            linear, angular = np.zeros((3, model.nv)), np.zeros((3, model.nv))
            mujoco.mj_jacBodyCom(model, self._probe, linear, angular, body)
            both = np.concatenate([linear, angular])
            answer = np.zeros_like(both)
            mujoco.mj_solveM(model, self._probe, answer, both)
            light[row] = float(np.trace(linear @ answer[:3].T)) / 3.0
            inverse[row] = angular @ answer[3:].T
        return light, inverse

    def _accelerations(self) -> F64:
        if not len(self._solver.rigid.body_ids):
            return np.zeros((0, 3))
        mujoco, solver, probe = self._mj, self._solver, self._probe
        model, ids = solver.model, solver.rigid.body_ids
        mujoco.mj_copyData(probe, model, solver.data)
        probe.xfrc_applied[:] = solver.work.pushes
        taken, least = model.opt.timestep, SHORT * solver.settings.step / 2**solver.refined
        if taken < least:
            set_contact_law(solver.rigid, solver.settings.contact_steps, least)
        mujoco.mj_forward(model, probe)
        mujoco.mj_rnePostConstraint(model, probe)
        if taken < least:
            set_contact_law(solver.rigid, solver.settings.contact_steps, taken)
        arm = probe.xipos - probe.subtree_com[model.body_rootid]
        spin = probe.cvel[:, :3]
        speed = probe.cvel[:, 3:] + np.cross(spin, arm)
        # Spatial accelerations, against a world that accelerates upwards; the centripetal part is not in them.
        total = probe.cacc[:, 3:] + np.cross(probe.cacc[:, :3], arm) + np.cross(spin, speed) + model.opt.gravity
        arms, turn = row_arms(solver.rigid, probe), spin[ids]
        found = total[ids] + np.cross(probe.cacc[ids, :3], arms) + np.cross(turn, np.cross(turn, arms))
        awake = solver.data.body_awake[ids] != 0
        return np.asarray(np.where(awake[:, None], found, 0.0))
