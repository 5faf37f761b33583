"""Friction of impacts of what something carries already: it pushes no body on.

The engine solves friction for an acceleration of the slide of -b v. Damping b = 1 / (4 dt), which contacts have, asks for three
quarters of the slide after the step. Where other contacts stop the body within that very step, friction then pushes it on, for
the slide that it asks for: a boulder that rolled on a ramp and met a plank was wedged between both, and each gave many times
its momentum. Coulomb's friction never does work on what slides (J. J. Moreau, *Unilateral contact and dry friction in finite
freedom dynamics*, 1988). So where a body meets one thing while it lies on another the impact asks for no slide at all,
b = 1 / dt. What meets the first thing in its flight keeps the other b: nothing stops it there, and the lift that is taken out of
a long slide would not be found in the passes of a step.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from .contact_law import ContactLaw

__all__ = ["stop_slides"]


def stop_slides(law: ContactLaw, data: Any, dt: float, slowest: float) -> None:
    """Write the tangential reference accelerations of this step's impacts of bodies that something carries.

    Pieces of one body in a tight fit are left out: they ask for more than can be had already. So are models with deforming bodies,
    whose integrator damps by itself.

    Args:
        law: of the contacts.
        data: state after `mj_step1`.
        dt: time step [s].
        slowest: closing speed from which on a contact is an impact [m/s].
    """
    if not data.ncon or not data.nefc or law.model.nflex:
        return
    contact = data.contact
    hit = np.flatnonzero(contact.efc_address >= 0)
    hit = hit[data.efc_vel[contact.efc_address[hit]] < -slowest]
    if law.kin is not None:
        hit = hit[~law.kin.among(contact.geom[hit])]
    hit = hit[_carried(law.model, data, hit, slowest)]
    rows, sizes = contact.efc_address[hit], contact.dim[hit]
    for k in (1, 2):
        own = rows[sizes > k] + k
        data.efc_aref[own] = -data.efc_vel[own] / dt


def _carried(model: Any, data: Any, hit: Any, slowest: float) -> Any:
    """Which of these contacts meet a body that has others, which do not close, shape (n,)."""
    contact = data.contact
    live = np.flatnonzero(contact.efc_address >= 0)
    lasting = live[data.efc_vel[contact.efc_address[live]] >= -slowest]
    trees = model.body_treeid[model.geom_bodyid]
    carried = np.unique(trees[contact.geom[lasting]])
    carried = carried[carried >= 0]
    return np.isin(trees[contact.geom[hit]], carried).any(axis=1)
