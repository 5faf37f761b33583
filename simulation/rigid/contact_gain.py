"""The most that contacts gave in one step: no contact without an engine of its own can give energy.

Work of a contact is its force on the mean of the relative velocities before and after the step. Under the engine's scheme that
is its share in the change of kinetic energy, whatever drivers, fields, springs and other solvers do in the same step: they act on
bodies, not on what two bodies do to each other. It is summed over each set of bodies that touch one another, for one contact
of such a set may give what another takes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.arrays import F64

__all__ = ["ContactGain", "contact_work"]


class ContactGain:
    """Watches the steps of a frame.

    Args:
        model: the compiled model.
    """

    def __init__(self, model: Any) -> None:
        self.model = model
        self.begin()

    def begin(self) -> None:
        """Start a frame."""
        self.most = 0.0
        """Most that the contacts of one set of touching bodies gave in one step of the frame [J]."""

    def take_over(self, other: ContactGain) -> None:
        """Go on with a frame that the watch of the model before has begun."""
        self.most = other.most

    def watch(self, data: Any) -> None:
        """Look at one step, whose forces are found and whose constraints are still those of its beginning; a NaN stays one."""
        if not data.ncon or not data.nefc:
            return
        work, _ = contact_work(data, self.model)
        # Constraints of no island move nothing.
        total = np.bincount(data.efc_island + 1, weights=work)[1:].max(initial=0.0) if data.nisland else work.sum()
        self.most = float(np.maximum(self.most, total))


def contact_work(data: Any, model: Any) -> tuple[F64, F64]:
    """Energy that each constraint of a contact gives in the step, and the size of what it exchanges [J], each shape (nefc,).

    Forces must be found, and the constraints be those of the step's beginning.
    """
    import mujoco

    change = np.zeros(data.nefc)
    mujoco.mj_mulJacVec(model, data, change, data.qacc)
    impulse = model.opt.timestep * data.efc_force
    impulse[data.efc_type < int(mujoco.mjtConstraint.mjCNSTR_CONTACT_FRICTIONLESS)] = 0.0
    return impulse * (data.efc_vel + 0.5 * model.opt.timestep * change), np.abs(impulse * data.efc_vel)
