"""Opening the collision skins at frame 0."""

from __future__ import annotations

from typing import Any, NamedTuple

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
PUSHED = 2.0
"""Summed skins by which opening may part two bodies that are declared fastened: a corner is opened along three faces, root of three."""


class _Overlap(NamedTuple):
    """Two bodies that overlap and are declared to, before anything moved."""

    names: tuple[str, str]
    bodies: tuple[int, int]
    """Indices among the model's bodies."""
    depth: float
    """[m]"""
    skins: float
    """Summed [m]."""


def _overlaps(rigid: RigidModel, data: Any, fastened: frozenset[frozenset[str]]) -> list[_Overlap]:
    """The deepest contact of every pair that is declared to overlap and does."""
    if not fastened or not data.ncon:
        return []
    model = rigid.model
    sides = sides_of(model, data.contact)
    skins = np.append(model.geom_margin, model.flex_margin)[sides].sum(axis=1)
    found: dict[frozenset[str], _Overlap] = {}
    for row in np.argsort(data.contact.dist, kind="stable").tolist():
        a, b = (rigid.colliders[k] for k in rigid.geom_collider[sides[row]])
        pair, depth = frozenset((a, b)), -float(data.contact.dist[row])
        if depth > 0.0 and pair in fastened and pair not in found:
            one, other = (_body_of(rigid, int(k)) for k in sides[row])
            found[pair] = _Overlap((a, b), (one, other), depth, float(skins[row]))
    return list(found.values())


def _body_of(rigid: RigidModel, side: int) -> int:
    """Body of the model that moves a side of a contact; of an elastic one, one of its nodes."""
    model = rigid.model
    if side < model.ngeom:
        return int(model.geom_bodyid[side])
    return int(model.body(rigid.flexes[side - model.ngeom].own[0]).id)


def _require_kept(overlaps: list[_Overlap], shift: Any) -> None:
    """Refuse to part what is declared to overlap; `shift`: of every body of the model, shape (nbody, 3) [m]."""
    for overlap in overlaps:
        apart = float(np.linalg.norm(shift[overlap.bodies[0]] - shift[overlap.bodies[1]]))
        most = PUSHED * overlap.skins
        if apart > most:
            far = [float(np.linalg.norm(shift[body])) for body in overlap.bodies]
            child, parent = overlap.names if far[0] > far[1] else overlap.names[::-1]
            raise EngineError(
                f"{child!r} and {parent!r} are declared fastened, overlap by {overlap.depth:.4g} m, and nothing holds them together: before "
                f"frame 0 they would be pushed {apart:.4g} m apart, at most {most:.3g} m may be. Join them with a weld in /simulation/joints "
                f"(parent {parent!r}, child {child!r}, without collide), make both static, or place them apart"
            )


def open_skins(rigid: RigidModel, data: Any, settings: RigidSettings, fastened: frozenset[frozenset[str]] = frozenset()) -> float:
    """Move bodies apart, without gravity, springs or speed, until no contact lies inside its skin.

    Bodies placed exactly in contact would start inside the skin and be pushed out visibly; this moves each by at
    most about one skin per contact below it. The approximation register lists how far.

    Args:
        rigid: the model.
        data: its state, in which bodies are moved.
        settings: of the instance.
        fastened: pairs of entities that are declared to overlap; they keep their places to each other.

    Returns:
        Largest displacement of a body [m].

    Raises:
        EngineError: bodies overlap so much that this diverges, or would part a pair that is declared to overlap.
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
    mujoco.mj_fwdPosition(model, data)
    declared, overlaps = data.xpos.copy(), _overlaps(rigid, data, fastened)
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
    _require_kept(overlaps, data.xpos - declared)
    data.qacc_warmstart[:] = 0.0
    data.time = 0.0
    return max(lifted, float(moved[rigid.body_ids].max(initial=0.0)))
