"""Impacts that pass through several contacts of pieces at once: what the others are solved for.

**Contacts that open.** Moreau's law of impact asks v' >= -e v of every contact, not only of those that close: one that opens may
be closed again by what its neighbours hand on. Solved like a resting contact, for v' >= 3 v / 4, it pushed its bodies apart with
the impulse of the impact: a cradle of five balls had 3.3 times its energy after the first blow. Its restitution is the largest
of the impacts that its bodies take part in. Without friction nothing gains energy then: with w = v' + E v, which is zero where
a contact opens and negative where it closes with e < E, the gain is half the impulses on (1 - E) v + w; and the impulses on
v are those on w, less what they work on each other, over 1 + E.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ...worlds.arrays import F64

__all__ = ["Impact"]


@dataclass
class Impact:
    """Contacts of a step with impacts; n of them."""

    rows: NDArray[np.int32]
    """Their normal rows among the constraints, shape (n,)."""
    hit: NDArray[np.bool_]
    """Which close fast enough to bounce, shape (n,)."""
    parting: NDArray[np.bool_]
    """Which open while an impact passes through their bodies, shape (n,)."""
    speed: F64
    """Before the step, positive where a contact opens [m/s], shape (n,)."""
    bounce: F64
    """Restitution that each is solved with, shape (n,)."""
    island: NDArray[np.int32]
    """Which set of touching bodies each belongs to, shape (n,)."""

    @classmethod
    def of(
        cls,
        data: Any,
        rows: NDArray[np.int32],
        hit: NDArray[np.bool_],
        speed: F64,
        bounce: F64,
        tight: NDArray[np.bool_] | None,
    ) -> Impact:
        """Find the contacts that open, and what they are solved with.

        Args:
            data: state after `mj_step1`.
            rows: normal rows.
            hit: which contacts are impacts.
            speed: of all of them [m/s].
            bounce: their own restitution.
            tight: pieces of a broken body in a tight fit, which meet by a law of their own.
        """
        island = data.efc_island[rows] if data.nisland else np.zeros(len(rows), dtype=np.int32)
        most = np.full(int(island.max()) + 1, -1.0)
        np.maximum.at(most, island[hit], bounce[hit])
        parting = (speed > 0.0) & (most[island] >= 0.0)
        if tight is not None:
            parting &= ~tight
        return cls(rows, hit, parting, speed, np.where(parting, most[island], bounce), island)

    def wanted(self, dt: float) -> F64:
        """Acceleration that each is solved for [m/s^2]."""
        return np.asarray(-(1.0 + self.bounce) * self.speed / dt)
