"""Opening the collision skins at frame 0."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.errors import EngineError
from ...worlds.spec import RigidSettings
from .contact_law import set_contact_law
from .flex_relax import freeze_flexes, lift_flexes
from .model import RigidModel
from .sides import sides_of

__all__ = ["open_skins"]

RELAX_STEPS = 400
"""Most steps."""
RELAX_RAMP = 100
"""Steps over which the skins grow to their size."""
RELAX_CONTACT_STEPS = 2.0
"""`contact_steps` meanwhile: a step takes out a quarter of the depth."""
RELAX_TOLERANCE = 0.01
"""Ends when no contact lies deeper inside the summed skins than this fraction of them."""


def open_skins(rigid: RigidModel, data: Any, settings: RigidSettings) -> float:
    """Move bodies apart, without gravity, springs or speed, until no contact lies inside its skin.

    Bodies placed exactly in contact would start inside the skin and be pushed out visibly; this moves each by at
    most about one skin per contact below it. It is listed in the approximation register.

    Returns:
        Largest displacement of a body [m].

    Raises:
        EngineError: bodies overlap so much that this diverges.
    """
    import mujoco

    model = rigid.model

    def deepest() -> float:
        if not data.ncon:
            return 0.0
        margin = np.append(model.geom_margin, model.flex_margin)[sides_of(model, data.contact)].sum(axis=1)
        return float((data.contact.dist / np.maximum(margin, 1e-9)).min()) - 1.0

    disable, enable = model.opt.disableflags, model.opt.enableflags
    margins, pair_margins = model.geom_margin.copy(), model.pair_margin.copy()
    lifted, thaw = (lift_flexes(rigid, data), freeze_flexes(rigid)) if rigid.flexes else (0.0, None)
    bits = mujoco.mjtDisableBit
    model.opt.disableflags |= int(bits.mjDSBL_GRAVITY) | int(bits.mjDSBL_SPRING) | int(bits.mjDSBL_ACTUATION)
    model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    set_contact_law(rigid, RELAX_CONTACT_STEPS, settings.step)
    mujoco.mj_forward(model, data)
    before = data.xpos.copy()
    if margins.any() and deepest() < -RELAX_TOLERANCE:
        for k in range(RELAX_STEPS):
            grow = min(1.0, (k + 1) / RELAX_RAMP)
            model.geom_margin[:], model.pair_margin[:] = margins * grow, pair_margins * grow
            mujoco.mj_step(model, data)
            data.qvel[:] = 0.0
            if grow == 1.0 and deepest() > -RELAX_TOLERANCE:
                break
    model.opt.disableflags, model.opt.enableflags = disable, enable
    model.geom_margin[:], model.pair_margin[:] = margins, pair_margins
    if thaw is not None:
        thaw()
    set_contact_law(rigid, settings.contact_steps, settings.step)
    mujoco.mj_kinematics(model, data)
    moved = np.linalg.norm(data.xpos - before, axis=1)
    if not np.isfinite(moved).all():
        raise EngineError("opening the collision skins at frame 0 diverged; check interpenetration at frame 0")
    data.qacc_warmstart[:] = 0.0
    data.time = 0.0
    return max(lifted, float(moved[rigid.body_ids].max(initial=0.0)))
