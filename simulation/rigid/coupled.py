"""Bodies of a running rigid instance as coupled solvers meet them: where they are, how they move and how they answer a push."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from threadpoolctl import ThreadpoolController

from ...worlds.arrays import F64
from ..boundaries import BodyState, MovingSurface
from .contact_law import set_contact_law
from .mobility import alone, held
from .records import velocities
from .rows import row_arms, row_centers, row_velocities

if TYPE_CHECKING:
    from .solver import SolverRigid

__all__ = ["RigidBodies", "lasting"]

SHORT = 0.5
"""Part of the rigid step; equal steps of an exchange that is as long are no shorter. Contacts stop what closes within some of their
steps, so after an exchange of a microsecond they would tell accelerations of 1e6 m/s^2, and coupled solvers would go on with them for
milliseconds: accelerations are told as in a step of this length."""


STILL = 0.05
"""[m/s] Own choice: what moves more slowly is pressed on what bears it, as often as not, and shortens no exchange."""


def lasting(bodies: BodyState, usual: float) -> float:
    """Longest exchange [s] for which the accelerations that bodies tell may be taken for steady.

    What comes to a stop at a limit or on another body is told the acceleration of its stop, which lasts for some steps of its own: over a
    longer exchange a coupled solver would expect it to fly back, and a door that falls shut would throw the water behind it. So none
    turns a speed into more than that speed against its way; infinite where none would in the `usual` time [s].
    """
    speed = np.linalg.norm(bodies.velocity, axis=1)
    against = -np.sum(bodies.acceleration * bodies.velocity, axis=1) / np.maximum(speed, STILL)
    stopped = (bodies.inverse_mass > 0.0) & (speed > STILL) & (against * usual > 2.0 * speed)
    return float((2.0 * speed[stopped] / against[stopped]).min(initial=np.inf))


class RigidBodies:
    """Reads the bodies of a running rigid instance without changing it.

    Pieces of a breakable body are rows of their own, whatever cluster they are in at present.
    """

    def __init__(self, solver: SolverRigid) -> None:
        import mujoco

        self._mj, self._solver = mujoco, solver
        self._model, self._probe = solver.model, mujoco.MjData(solver.model)
        self._blas = ThreadpoolController().select(user_api="blas")

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
        probe = self._looked_ahead()
        fixed = solver.drivers.held(solver.time)
        mass, inertia, mobility = alone(self._mj, self._model, probe, solver.rigid, fixed)
        turning = inertia.copy()
        with self._blas.limit(limits=1):  # its threads would spin for longer than they work on matrices of one island
            held(self._mj, self._model, probe, solver.rigid, mobility, turning)
        told = self._accelerations(probe)
        return BodyState(origin, rotation, center, linear, angular, mass, inertia, told, mobility, turning)

    def surfaces(self) -> dict[str, MovingSurface]:
        """Simulation vertices of elastic members at present."""
        return {} if self._solver.flexes is None else self._solver.flexes.surfaces(self._solver.data)

    def _looked_ahead(self) -> Any:
        """The state with what the engine makes of it without the coupled solvers."""
        mujoco, solver, probe = self._mj, self._solver, self._probe
        model = solver.model
        mujoco.mj_copyData(probe, model, solver.data)
        probe.xfrc_applied[:] = solver.work.pushes
        taken, least = model.opt.timestep, SHORT * solver.settings.step / 2**solver.refined
        if taken < least:
            set_contact_law(solver.rigid, solver.settings.contact_steps, least)
        mujoco.mj_forward(model, probe)
        mujoco.mj_rnePostConstraint(model, probe)
        if taken < least:
            set_contact_law(solver.rigid, solver.settings.contact_steps, taken)
        return probe

    def _accelerations(self, probe: Any) -> F64:
        """Accelerations of the rows' centres of mass by everything but the coupled solvers, (n, 3) [m/s^2]; 0 of what sleeps."""
        solver, model = self._solver, self._solver.model
        ids = solver.rigid.body_ids
        if not len(ids):
            return np.zeros((0, 3))
        arm = probe.xipos - probe.subtree_com[model.body_rootid]
        spin = probe.cvel[:, :3]
        speed = probe.cvel[:, 3:] + np.cross(spin, arm)
        # Spatial accelerations, against a world that accelerates upwards; the centripetal part is not in them.
        total = probe.cacc[:, 3:] + np.cross(probe.cacc[:, :3], arm) + np.cross(spin, speed) + model.opt.gravity
        arms, turn = row_arms(solver.rigid, probe), spin[ids]
        found = total[ids] + np.cross(probe.cacc[ids, :3], arms) + np.cross(turn, np.cross(turn, arms))
        awake = solver.data.body_awake[ids] != 0
        return np.asarray(np.where(awake[:, None], found, 0.0))
