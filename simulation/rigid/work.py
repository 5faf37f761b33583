"""Work of drivers on the moving bodies, accumulated over steps."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.arrays import F64
from .drivers import Drivers

__all__ = ["DriverWork"]


class DriverWork:
    """Sums force times displacement of motors, forces and paths over the steps of a segment.

    Velocities are means over the step, so that the sum is the exact change of energy under the engine's scheme. The work
    on a path's own body is in it; the caller takes the energy of such bodies out again.
    """

    def __init__(self, model: Any, actuators: dict[str, int], drivers: Drivers) -> None:
        self.model, self.drivers = model, drivers
        rows = np.array(sorted(actuators.values()), dtype=np.int64)
        self._rows = rows
        self._motor_dofs = model.jnt_dofadr[model.actuator_trnid[rows, 0]] if len(rows) else rows
        self._gain = model.actuator_gainprm[rows, 0] if len(rows) else np.zeros(0)
        self._path_dofs = drivers.kinematic_dofs
        self._armature = drivers.holds.armature(self._path_dofs)
        self._total = 0.0
        self.pushes: F64 = np.zeros((model.nbody, 6))
        """Wrenches of force drivers on all bodies in the present segment."""

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
            force = data.qfrc_applied[dofs] - self._armature * data.qacc[dofs]
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
