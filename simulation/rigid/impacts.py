"""Impacts that pass through several contacts at once: what the others are solved for, and what none of them may give.

**Contacts that open.** Moreau's law of impact asks v' >= -e v of every contact, not only of those that close: one that opens may
be closed again by what its neighbours hand on. Solved like a resting contact, for v' >= 3 v / 4, it pushed its bodies apart with
the impulse of the impact: a cradle of five balls had 3.3 times its energy after the first blow. Its restitution is the largest
of the impacts that its bodies take part in. Without friction nothing gains energy then: with w = v' + E v, which is zero where
a contact opens and negative where it closes with e < E, the gain is half the impulses on (1 - E) v + w; and the impulses on
v are those on w, less what they work on each other, over 1 + E.

**Friction.** Newton's law of restitution with Coulomb's friction can give energy all the same (T. R. Kane, 1984, *A dynamics
puzzle*): a box that lands obliquely on an edge with e = 1 gains a third of what the impact exchanged. Without restitution it
cannot. So where the contacts of touching bodies would give energy together, their restitution is lowered until they do not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .contact_gain import contact_work

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...worlds.arrays import F64

__all__ = ["Impact", "calm"]

GIVING = 1e-4
"""Energy that contacts may give in an impact, in parts of what they exchange: the solver's tolerance."""
SAFE = 0.9
"""Part of the restitution at which nothing would be given, if the gain grew linearly with it, that is tried."""


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
    lift: F64 | None = None
    """Acceleration taken out of their references against the lift of the cone [m/s^2], shape (n,); None: they are not to be solved again."""

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

    def wanted(self, dt: float, share: F64 | float = 1.0) -> F64:
        """Acceleration that each is solved for [m/s^2], with its restitution reduced to a share."""
        return np.asarray(-(1.0 + share * self.bounce) * self.speed / dt)


def calm(impact: Impact, data: Any, model: Any, solve: Callable[[Any], None]) -> None:
    """Lower the restitution of touching bodies whose contacts give energy, and solve the step again.

    Args:
        impact: contacts of the step.
        data: state with the forces of the step.
        model: the compiled model.
        solve: finds the forces of the step anew.
    """
    first, giving = _given(data, model, impact)
    if not giving.any():
        return
    dt, ruled = model.opt.timestep, impact.hit | impact.parting
    mine = impact.rows[ruled]
    lift = np.zeros(len(impact.rows)) if impact.lift is None else impact.lift

    def again(share: F64) -> None:
        data.efc_aref[mine] = (impact.wanted(dt, share[impact.island]) - lift)[ruled]
        solve(data)

    again(np.where(giving, 0.0, 1.0))
    least, _ = _given(data, model, impact)
    span = first - least
    share = np.where(giving, SAFE * np.clip(-least / np.where(span > 0.0, span, 1.0), 0.0, 1.0), 1.0)
    again(share)
    _, still = _given(data, model, impact)
    if still.any():
        again(np.where(still, 0.0, share))


def _given(data: Any, model: Any, impact: Impact) -> tuple[F64, NDArray[np.bool_]]:
    """Energy that the contacts of each set of touching bodies give [J], and whether it is more than the solver's tolerance."""
    work, exchanged = contact_work(data, model)
    island = data.efc_island if data.nisland else np.zeros(data.nefc, dtype=np.int32)
    count = int(impact.island.max()) + 1
    inside = (island >= 0) & (island < count)
    given = np.bincount(island[inside], weights=work[inside], minlength=count)
    scale = np.bincount(island[inside], weights=exchanged[inside], minlength=count)
    return np.asarray(given, dtype=np.float64), np.asarray(given > GIVING * scale)
