"""Longest way of what rests over `worlds/settled.py::HOLD_SECONDS`, by what the engines of several categories resolve."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..spec import WorldSpec

__all__ = ["LOOSE_SHARE", "two_skins"]

LOOSE_SHARE = 0.1
"""[1] Own choice: of the radius of a grain or the spacing of a liquid, what loose matter at rest may move."""
SKINS = 2.0
"""[1] Contacts act at the sum of two."""
LEAST_WAY = 1e-4
"""[m] Of bodies without collision skins: a tenth of what the usual two take. Own choice."""


def two_skins(spec: WorldSpec, name: str) -> float:
    """Sum of the collision skins of two bodies of an entity's instance [m]."""
    skins = [i.settings.skin for i in spec.simulation.rigid.values() if name in i.members]
    return max(SKINS * max(skins, default=0.0), LEAST_WAY)
