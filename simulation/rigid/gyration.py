"""Velocity-dependent inertial forces at the middle of the step.

MuJoCo's semi-implicit Euler is a leapfrog, of second order, as long as forces depend on positions only: velocities are
those half a step behind. Coriolis and gyroscopic forces are not: joint trees take them at the step's beginning, and
`implicitfast` takes those of standalone free bodies at its end. Either is of first order: a tumbling body gained or lost
5e-3 of its energy in ten seconds, a double pendulum 6e-3. Taking them in the middle, with the acceleration of the step
before, makes the scheme a leapfrog again (1e-7 and 5e-4).
"""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["Gyration"]

SLOW = 1.0
"""[rad/s] Below this the error per step is below a millionth and the correction is left out."""


class Gyration:
    """Corrects `qfrc_bias` between the velocity stage of a step and its solution.

    Args:
        model: the compiled model.
    """

    def __init__(self, model: Any) -> None:
        import mujoco

        self.mj, self.model = mujoco, model
        free = np.array([model.jnt_type[model.dof_jntid[d]] == 0 for d in range(model.nv)], dtype=bool)
        alone = np.array([model.tree_dofnum[model.dof_treeid[d]] == 6 for d in range(model.nv)], dtype=bool)
        slide = np.array([model.jnt_type[model.dof_jntid[d]] == 2 for d in range(model.nv)], dtype=bool)
        first = np.array([model.jnt_dofadr[model.dof_jntid[d]] for d in range(model.nv)], dtype=np.int64)
        self._turning = ~slide & ~(free & (np.arange(model.nv) - first < 3))
        self._shift = np.where(free & alone, -0.5, 0.5)
        self._bias = np.zeros(model.nv)

    def apply(self, data: Any, dt: float) -> None:
        """Take inertial forces at the middle of the step; `data` is the state after `mj_step1`."""
        speed = data.qvel
        if not len(speed) or not (np.abs(speed) > SLOW)[self._turning].any():
            return
        before = speed.copy()
        speed += dt * self._shift * data.qacc_warmstart
        self.mj.mj_comVel(self.model, data)
        self._bias[:] = data.qfrc_bias
        self.mj.mj_rne(self.model, data, 0, self._bias)
        speed[:] = before
        self.mj.mj_comVel(self.model, data)
        data.qfrc_bias[:] = self._bias
