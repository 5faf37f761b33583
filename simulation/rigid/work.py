"""Work of drivers on the moving bodies, accumulated over steps."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.arrays import F64
from .drivers import Drivers

__all__ = ["DriverWork"]


class DriverWork:
    """Sums force times displacement of motors, forces and paths over the steps of a segment.

    Velocities are means over the step, so that the sum is the exact change of energy under the engine's scheme. Of a path it is
    the work on what its body pushes and carries, step by step; what moves the body itself is nobody's energy.
    """

    def __init__(self, model: Any, actuators: dict[str, int], drivers: Drivers) -> None:
        self.model, self.drivers = model, drivers
        rows = np.array(sorted(actuators.values()), dtype=np.int64)
        self._rows = rows
        self._motor_dofs = model.jnt_dofadr[model.actuator_trnid[rows, 0]] if len(rows) else rows
        self._gain = model.actuator_gainprm[rows, 0] if len(rows) else np.zeros(0)
        self._path_dofs = drivers.kinematic_dofs
        carries = np.bincount(model.body_rootid, minlength=model.nbody)[model.dof_bodyid[self._path_dofs]] > 1
        carries |= model.nflex > 0  # elasticity is not always among the engine's forces
        # Six degrees of freedom each: a body on a path is a free one.
        self._carriers = np.flatnonzero(carries).reshape(-1, 6)
        self._armature = drivers.holds.armature(self._path_dofs)
        self._total = 0.0
        self.pushes: F64 = np.zeros((model.nbody, 6))
        """Wrenches of force drivers on all bodies in the present segment, or, where none has begun yet, from its start on."""

    def stand(self, time: float) -> None:
        """A run stands at a time, from which it goes on: what drivers do then is known, and nothing of the segment before."""
        self.pushes = self.drivers.wrenches(time)

    def begin(self, data: Any, speeds: tuple[F64, F64], outside: F64 | None = None) -> bool:
        """Start a segment whose forces are already written; returns whether there is anything to sum.

        `outside` is what others apply to the bodies, shape (nbody, 6): it is not the drivers' work.
        """
        self._total = 0.0
        self.pushes = data.xfrc_applied.copy() if outside is None else data.xfrc_applied - outside
        self._pushed = np.flatnonzero(self.pushes.any(axis=1))
        self._wrench = self.pushes[self._pushed].copy()
        self._push = self._power(speeds)
        self._speed = data.qvel.copy()
        self._first = True
        return bool(len(self._rows) or len(self._path_dofs) or len(self._pushed))

    def _power(self, speeds: tuple[F64, F64]) -> float:
        twists = np.concatenate([speeds[0][self._pushed], speeds[1][self._pushed]], axis=1)
        return float((self._wrench * twists).sum())

    def after_step(self, data: Any, dt: float) -> None:
        """Add one step."""
        if len(self._rows):
            before, after = data.actuator_velocity[self._rows], data.qvel[self._motor_dofs]
            force, limit = data.actuator_force[self._rows], self.model.actuator_forcerange[self._rows, 1]
            # The velocity servo is integrated implicitly unless its force is at the limit.
            free = np.abs(force) < limit * (1 - 1e-12)
            force = force - np.where(free, self._gain * (after - before), 0.0)
            self._total += dt * float(force @ (before + after)) / 2
        if len(self._path_dofs):
            dofs = self._path_dofs
            force = -(data.qfrc_constraint[dofs] + data.qfrc_passive[dofs])
            for rows in self._carriers:
                own, at = _inertial(self.model, data, dofs[rows], dt), dofs[rows]
                force[rows] = data.qfrc_applied[at] - self._armature[rows] * data.qacc[at] - own
            self._total += dt * float(force @ (data.qvel[dofs] - 0.5 * dt * data.qacc[dofs]))
        if len(self._pushed):
            # Body velocities are still those of the step's beginning: trapezoid with the next step's.
            arm = data.xipos - data.subtree_com[self.model.body_rootid]
            angular = data.cvel[:, :3]
            power = self._power((data.cvel[:, 3:] + np.cross(angular, arm), angular))
            self._total += dt * (power if not self._first else power / 2)
            self._first = False

    def end(self, speeds: tuple[F64, F64], dt: float) -> float:
        """Work of the segment [J]."""
        return self._total + (dt * self._power(speeds) / 2 if len(self._pushed) else 0.0)


def _inertial(model: Any, data: Any, dofs: Any, dt: float) -> F64:
    """Force and torque that a free body alone takes to move as it does, against gravity, in its own six coordinates [N, N m].

    Newton and Euler about the centre of mass, carried to the body's origin; the state is that of the step's beginning, with
    velocities already integrated.
    """
    body = int(model.dof_bodyid[dofs[0]])
    turn, tilt = data.xmat[body].reshape(3, 3), data.ximat[body].reshape(3, 3)
    arm = data.xipos[body] - data.xpos[body]
    acceleration, spin = data.qacc[dofs], turn @ (data.qvel[dofs[3:]] - dt * data.qacc[dofs[3:]])
    angular = turn @ acceleration[3:]
    inertia = (tilt * model.body_inertia[body]) @ tilt.T
    linear = acceleration[:3] + np.cross(angular, arm) + np.cross(spin, np.cross(spin, arm)) - model.opt.gravity
    force = model.body_mass[body] * linear
    torque = inertia @ angular + np.cross(spin, inertia @ spin) + np.cross(arm, force)
    return np.concatenate([force, turn.T @ torque])
