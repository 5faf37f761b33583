"""Contacts of rigid bodies in an instance with elastic ones: the law of `contact_law` under MuJoCo's `discrete` integrator.

`discrete` computes impedances and reference accelerations within the solution (MuJoCo 4.0.0), from each contact's own stiffness and damping
and from its depth as a constraint row: what is written into `efc_aref` before is overwritten, and a ball beside a cushion did not bounce at
all. So the wanted acceleration is written as a spring of `SOFT` that is as deep as gives it; friction has its damping as everywhere. Contacts of
elastic bodies keep the engine's own law, which is implicit and damps them within a step: how high they bounce follows from their elasticity.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from .contact_law import ContactLaw

__all__ = ["SOFT", "ask_beside_flexes"]

SOFT = 1.0
"""[1/s^2] Stiffness of the springs that stand for an acceleration: nothing beside 1 / step^2, which the engine adds to it."""


def ask_beside_flexes(law: ContactLaw, data: Any, mine: Any, dt: float) -> None:
    """Write what contacts between rigid bodies are solved for in this step, after its impacts.

    Args:
        law: of the model, which has elastic bodies, with the impacts of the step.
        data: state after `mj_step1`.
        mine: numbers of these contacts, shape (n,).
        dt: time step [s].
    """
    if not len(mine):
        return
    contact = data.contact
    rows, sizes, friction = contact.efc_address[mine], contact.dim[mine], contact.friction[mine]
    stiffness, damping = -contact.solref[mine, 0], -contact.solref[mine, 1]
    moving = data.efc_vel.copy() if law.blow is None else data.efc_vel + law.blow.change
    speed, depth = moving[rows], data.efc_pos[rows] - data.efc_margin[rows]
    wanted = law.wanted(rows, -damping * speed - stiffness * depth, speed, damping, dt)
    slip = np.zeros(data.nefc)
    for k in range(1, int(sizes.max(initial=1))):
        # The engine damps by the speed at the end of the step.
        more = sizes > k
        slip[rows[more] + k] = -damping[more] * moving[rows[more] + k] / (1.0 + damping[more] * dt)
    wanted -= law.lasting_lift(data, rows, friction, sizes, slip)
    contact.solreffriction[mine] = np.stack([np.zeros(len(mine)), -damping], axis=1)
    contact.solref[mine] = (-SOFT, 0.0)
    data.efc_pos[rows] = data.efc_margin[rows] - wanted / SOFT
