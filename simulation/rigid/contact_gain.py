"""What contacts give in a step.

Work of a contact is its force on the mean of the relative velocities before and after the step. Under the engine's scheme that
is its share in the change of kinetic energy, whatever drivers, fields, springs and other solvers do in the same step: they act on
bodies, not on what two bodies do to each other.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.arrays import F64

__all__ = ["contact_work"]


def contact_work(data: Any, model: Any) -> tuple[F64, F64]:
    """What each constraint that is a contact gives in the step, and the size of what it exchanges [J], each shape (nefc,).

    Forces must be found, and the constraints be those of the step's beginning.
    """
    import mujoco

    change = np.zeros(data.nefc)
    mujoco.mj_mulJacVec(model, data, change, data.qacc)
    impulse = model.opt.timestep * data.efc_force
    impulse[data.efc_type < int(mujoco.mjtConstraint.mjCNSTR_CONTACT_FRICTIONLESS)] = 0.0
    return impulse * (data.efc_vel + 0.5 * model.opt.timestep * change), np.abs(impulse * data.efc_vel)
