"""Static friction: contacts that do not slip hold with the larger coefficient of rest, those that slip rub with that of motion (C. A. Coulomb, 1785).

The model is compiled with coefficients of rest. Before the forces of a step are found, contacts that slip faster than `SLIPS` get that
of motion, and their cone with it: MuJoCo keeps a cone's own measure `mu`, in proportion to its coefficients. What sticks under a load
creeps at 1e-6 to 1e-5 m/s by the softness of its rows (measured on slopes), far below `SLIPS`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from .pair_values import PairValues

__all__ = ["SLIPS", "Stiction"]

SLIPS = 2e-3
"""Speed of slip from which on a contact rubs as in motion [m/s]. Own choice: no slide that slow is seen."""


class Stiction:
    """Coefficients of contacts that slip.

    Args:
        kinetic: coefficient of motion per side of a contact (geoms, then elastic bodies), shape (sides,).
        colliders: collider per side, shape (sides,).
        pairs: coefficient of motion of pairs of colliders that have their own.
    """

    def __init__(self, kinetic: F64, colliders: Any, pairs: Mapping[tuple[int, int], float]) -> None:
        self._kinetic, self._pairs = kinetic, PairValues(colliders, pairs)

    def kinetic_of(self, sides: Any) -> F64:
        """Coefficient of motion of contacts between sides, shape (n, 2) -> (n,): the larger one, or the pair's own."""
        return self._pairs.over(self._kinetic[sides].max(axis=1), sides)

    def apply(self, data: Any, sides: Any) -> None:
        """Give contacts that slip their coefficient of motion.

        Args:
            data: state with this step's constraints, whose forces are not found yet.
            sides: of every contact, shape (ncon, 2).
        """
        contact = data.contact
        rows = contact.efc_address
        live = np.flatnonzero((rows >= 0) & (contact.dim > 1))
        if not len(live):
            return
        rows = rows[live]
        slipping = live[np.hypot(data.efc_vel[rows + 1], data.efc_vel[rows + 2]) > SLIPS]
        rest = contact.friction[slipping, 0]
        share = np.where(rest > 0, self.kinetic_of(sides[slipping]) / np.maximum(rest, 1e-12), 1.0)
        for place, factor in zip(slipping.tolist(), share.tolist(), strict=True):
            if factor < 1.0:
                one = contact[place]
                one.friction[:] *= factor
                one.mu *= factor
